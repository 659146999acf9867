// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <list>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <typeindex>
#include <utility>
#include <vector>

#include "softsim/softsim.hpp"

// What all benchmarks share: names, laws, sizes, meshes, the deformed state, the clock and the check of
// results.

namespace bench {

using namespace softsim;

inline constexpr double young = 1e4, poisson = 0.4, c2_over_c1 = 0.5;  // Pa, 1, 1 (Mooney-Rivlin)

/// Cells along each side of the cubes: 6 n^3 tetrahedra.
inline constexpr std::array<int, 3> cube_cells{9, 15, 32};
constexpr int tetrahedra(int n) { return 6 * n * n * n; }

template <class Law>
inline constexpr const char* law_name = nullptr;
template <>
inline constexpr const char* law_name<StVenantKirchhoff> = "svk";
template <>
inline constexpr const char* law_name<NeoHookean> = "neo_hookean";
template <>
inline constexpr const char* law_name<StableNeoHookean> = "stable_neo_hookean";
template <>
inline constexpr const char* law_name<MooneyRivlin> = "mooney_rivlin";

template <class T>
inline constexpr const char* scalar_name = sizeof(T) == 8 ? "double" : "float";

/// Relative error up to which a result counts as right: rounding, with room for a sum over the mesh.
template <class T>
inline constexpr double rounding = sizeof(T) == 8 ? 1e-11 : 1e-4;

/// A law and a scalar as one tag, so that a registration is one generic lambda.
template <class L, class S>
struct Kind {
  using Law = L;
  using T = S;
  static Law law() {
    if constexpr (std::is_same_v<Law, MooneyRivlin>)
      return Law::from_young_poisson(young, poisson, c2_over_c1);
    else
      return Law::from_young_poisson(young, poisson);
  }
};

/// Calls f(Kind<Law, T>(), n) for all laws, scalars and sizes.
template <class Function>
void for_each_kind_and_size(Function f) {
  const auto sizes = [&](auto kind) {
    for (const int n : cube_cells) f(kind, n);
  };
  const auto scalars = [&]<class Law>(const Law&) {
    sizes(Kind<Law, double>());
    sizes(Kind<Law, float>());
  };
  const auto law = [](auto kind) { return kind.law(); };
  scalars(law(Kind<StVenantKirchhoff, double>()));
  scalars(law(Kind<NeoHookean, double>()));
  scalars(law(Kind<StableNeoHookean, double>()));
  scalars(law(Kind<MooneyRivlin, double>()));
}

/// Registers f(state) as what/law/route/scalar/size. Nothing is made before it runs.
template <class T, class Function>
void add_named(const std::string& what, const std::string& law, const std::string& route, int n, Function f) {
  const std::string name =
      what + "/" + law + "/" + route + "/" + scalar_name<T> + "/" + std::to_string(tetrahedra(n));
  benchmark::RegisterBenchmark(name.c_str(), f);
}
/// The same for the law of a `Kind`.
template <class K, class Function>
void add(const std::string& what, K, const std::string& route, int n, Function f) {
  add_named<typename K::T>(what, law_name<typename K::Law>, route, n, f);
}

/// CPU time of this thread, s: the wall clock of a shared machine counts others' work. With OpenMP it has to
/// be the wall clock.
inline double seconds() {
  timespec t;
#ifdef _OPENMP
  clock_gettime(CLOCK_MONOTONIC, &t);
#else
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
#endif
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Times f() and reports nanoseconds per item, `items` being what one call handles; but only if the call's
/// result, of the given relative error, is right.
template <class Function>
void measure(benchmark::State& state, double items, double error, double tolerance, Function f) {
  if (!(error <= tolerance)) {
    const std::string sentence =
        "differs from the reference by " + to_text(error) + ", allowed is " + to_text(tolerance);
    state.SkipWithError(sentence.c_str());
    return;
  }
  f();  // first use of work vectors and cold memory
  const double start = seconds();
  for (auto _ : state) {
    f();
    benchmark::ClobberMemory();
  }
  const double spent = seconds() - start;
  state.counters["ns_per_item"] = 1e9 * spent / (static_cast<double>(state.iterations()) * items);
  state.counters["relative_error"] = error;
}

/// The one `Case(n)` for a type and a size: Google Benchmark calls a benchmark several times. The last few
/// are kept.
template <class Case>
Case& cached(int n) {
  struct Entry {
    std::type_index type;
    int n;
    std::shared_ptr<void> value;
  };
  static std::list<Entry> entries;
  constexpr std::size_t kept = 4;
  for (auto e = entries.begin(); e != entries.end(); ++e)
    if (e->type == typeid(Case) && e->n == n) {
      entries.splice(entries.begin(), entries, e);
      return *static_cast<Case*>(entries.front().value.get());
    }
  if (entries.size() >= kept) entries.pop_back();
  entries.push_front({typeid(Case), n, std::make_shared<Case>(n)});
  return *static_cast<Case*>(entries.front().value.get());
}

/// Cube of n^3 cells, made once.
inline const TetrahedralMesh& cube(int n, double side = 1) {
  static std::map<std::pair<int, double>, TetrahedralMesh> meshes;
  const auto found = meshes.find({n, side});
  if (found != meshes.end()) return found->second;
  return meshes.emplace(std::pair(n, side), box_mesh({n, n, n}, {side, side, side})).first->second;
}

/// Smooth displacement of the unit cube with 10 to 20 % strain.
inline Vec3<double> deformation(const Vec3<double>& X) {
  const double x = X[0], y = X[1], z = X[2];
  return {0.10 * x + 0.05 * y * z + 0.02 * std::sin(5 * y),
          -0.05 * y + 0.08 * x * x + 0.02 * std::sin(4 * z + 1),
          0.04 * z - 0.06 * x * y + 0.02 * std::cos(6 * x)};
}

/// Flat vector with f(rest position) in each point's block.
template <class T>
Vector<T> field(const TetrahedralMesh& mesh, Vec3<double> (*f)(const Vec3<double>&)) {
  Vector<T> v = State<T>(mesh.points().size()).displacement;
  for (std::size_t i = 0; i < mesh.points().size(); ++i)
    block(v, static_cast<std::ptrdiff_t>(i)) = f(mesh.points()[i]).cast<T>();
  return v;
}

/// Largest |a - b| over the largest |b|.
inline double relative_error(const Vector<double>& a, const Vector<double>& b) {
  if (a.size() != b.size() || !a.allFinite()) return HUGE_VAL;
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

/// A flat vector of blocks in double, without the fourth scalar of each block.
template <class T>
Vector<double> packed(const Vector<T>& v) {
  const Vector<double> d = v.template cast<double>();
  return pack(d);
}

}  // namespace bench
