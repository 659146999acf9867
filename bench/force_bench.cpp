// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT

#include "common.hpp"
#include "reference.hpp"

// Elastic force and energy of a whole mesh.

namespace bench {
namespace {

// The plain kernel itself, in the scalar of the benchmark.
template <class K>
struct ReferenceCase {
  using T = typename K::T;
  ReferenceBody<typename K::Law, T> body;
  Vector<T> x, y;
  double error = 0;

  explicit ReferenceCase(int n) : body(cube(n), K::law()) {
    const ReferenceState<typename K::Law> reference(n);
    x = reference.x.template cast<T>();
    y = x;
    body.force(x, y);
    error = relative_error(y.template cast<double>(), reference.force());
  }
};

// The two routes of the library to one law.
template <class K, int N>
struct ByGradient {
  static auto make(int n) { return elastic<typename K::T, N>(cube(n), K::law()); }
};
template <class K, int N>
struct ByEdges {
  static auto make(int n) { return heml<typename K::T, N>(cube(n), K::law()); }
};

// The library's elements, N at a time.
template <class K, class Route>
struct ElementsCase {
  using T = typename K::T;
  decltype(Route::make(1)) elements;
  State<T> q;
  Vector<T> y;
  double force_error = 0, energy_error = 0;

  explicit ElementsCase(int n) : elements(Route::make(n)) {
    q.displacement = field<T>(cube(n), deformation);
    y.resize(q.size());
    const ReferenceState<typename K::Law> reference(n);
    force();
    force_error = relative_error(packed(y), reference.force());
    const double energy = reference.body.energy(reference.x);
    energy_error = std::abs(elements.energy(q) - energy) / std::abs(energy);
  }
  void force() {
    y.setZero();
    elements.add_gradient(q, y);
  }
};

template <class K, class Route>
void add_force(const std::string& route, int n) {
  add("force", K(), route, n, [n](benchmark::State& state) {
    auto& c = cached<ElementsCase<K, Route>>(n);
    measure(state, tetrahedra(n), c.force_error, rounding<typename K::T>, [&] { c.force(); });
  });
}
template <class K, class Route>
void add_energy(const std::string& route, int n) {
  add("energy", K(), route, n, [n](benchmark::State& state) {
    auto& c = cached<ElementsCase<K, Route>>(n);
    measure(state, tetrahedra(n), c.energy_error, rounding<typename K::T>,
            [&] { benchmark::DoNotOptimize(c.elements.energy(c.q)); });
  });
}

[[maybe_unused]] const bool registered = [] {
  for_each_kind_and_size([]<class K>(K kind, int n) {
    add("force", kind, "reference", n, [n](benchmark::State& state) {
      auto& c = cached<ReferenceCase<K>>(n);
      measure(state, tetrahedra(n), c.error, rounding<typename K::T>, [&] { c.body.force(c.x, c.y); });
    });
    constexpr int lanes = default_lanes<typename K::T>;
    add_force<K, ByGradient<K, lanes>>("f", n);
    add_force<K, ByGradient<K, 1>>("scalar", n);
    add_energy<K, ByGradient<K, lanes>>("f", n);
    if constexpr (InvariantLaw<typename K::Law>) {
      add_force<K, ByEdges<K, lanes>>("heml", n);
      add_energy<K, ByEdges<K, lanes>>("heml", n);
    }
  });
  return true;
}();

}  // namespace
}  // namespace bench
