// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT

#include <algorithm>
#include <cstdint>
#include <map>

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
    ReferenceState<typename K::Law> reference(n);
    // of the state as T holds it: what its rounding changes is no error of the force
    reference.x = packed(field<double>(cube(n), rest)) + packed(q.displacement);
    force();
    force_error = relative_error(packed(y), reference.force());
    const double energy = reference.body.energy(reference.x);
    energy_error = std::abs(elements.energy(q) - energy) / std::abs(energy);
  }
  void force() {
    y.setZero();
    elements.add_gradient(q, y);
  }
  static Vec3<double> rest(const Vec3<double>& X) { return X; }
};

/// Relative error of a force: from positions in single precision a fine mesh loses digits, from displacements
/// not.
template <class T>
double allowed(const std::string& route) {
  return sizeof(T) == 4 && route == "f" ? 3e-6 : rounding<T>;
}

// What Heml's force is without the part linear in I1: from volumes alone.
template <class Law>
struct VolumeForce {
  static constexpr int points = 4;
  static constexpr bool translation_invariant = true, from_positions = true;
  template <class T>
  struct Data {
    T inverse_det;
  };
  Law law;

  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 12, 1> gradient(const Data<T>& data, const Local<T, 4>& x) const {
    Mat3<T> e;
    for (int i = 0; i < 3; ++i) e.col(i) = x.points[static_cast<std::size_t>(i) + 1] - x.points[0];
    const Mat3<T> c = cofactor(e);
    const T p =
        T(1.0 / 6) * law.first(Invariants<T>{T(3), T(3), data.inverse_det * e.col(0).dot(c.col(0))}).wj;
    Eigen::Matrix<T, 12, 1> f;
    for (int i = 0; i < 3; ++i) f.template segment<3>(3 * i + 3) = p * c.col(i);
    f.template head<3>().setZero();  // is not asked for
    return f;
  }
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 12, 1> hessian_product(const Data<T>&, const Local<T, 4>&,
                                                        const Eigen::Matrix<T, 12, 1>& dx) const {
    return dx;  // not timed
  }
};
// That part, linear in the positions: k (x_1 - x_0) on every edge of the mesh.
struct LinearEdge {
  static constexpr int points = 2;
  static constexpr bool translation_invariant = true, from_positions = true;
  template <class T>
  struct Data {
    T k;
  };

  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 6, 1> gradient(const Data<T>& data, const Local<T, 2>& x) const {
    Eigen::Matrix<T, 6, 1> f;
    f.template tail<3>() = data.k * (x.points[1] - x.points[0]);
    f.template head<3>().setZero();  // is not asked for
    return f;
  }
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 6, 1> hessian_product(const Data<T>&, const Local<T, 2>&,
                                                       const Eigen::Matrix<T, 6, 1>& dx) const {
    return dx;  // not timed
  }
};

// Neo-Hookean with the I1 part summed once per mesh edge instead of once per tetrahedron.
struct ByMeshEdges {
  Elements<VolumeForce<NeoHookean>> volumes;
  Elements<LinearEdge> edges;
  State<double> q;
  Vector<double> y;
  double error;

  explicit ByMeshEdges(int n) : volumes(make_volumes(n)), edges(make_edges(n)) {
    q.displacement = field<double>(cube(n), deformation);
    y.resize(q.size());
    force();
    error = relative_error(packed(y), ReferenceState<NeoHookean>(n).force());
  }
  void force() {
    y.setZero();
    volumes.add_gradient(q, y);
    edges.add_gradient(q, y);
  }

 private:
  static NeoHookean law() { return Kind<NeoHookean, double>::law(); }
  static Elements<VolumeForce<NeoHookean>> make_volumes(int n) {
    std::vector<VolumeForce<NeoHookean>::Data<double>> data;
    for (std::size_t t = 0; t < cube(n).tetrahedra().size(); ++t)
      data.push_back({1 / (6 * cube(n).volume(t))});
    return {{{law()}}, data, cube(n).tetrahedra(), {}, cube(n).points()};
  }
  static Elements<LinearEdge> make_edges(int n) {
    std::map<std::pair<std::int32_t, std::int32_t>, double> k;
    for (const Tetrahedron& v : cube(n).tetrahedra()) {
      std::array<Vec3<double>, 4> X, g;
      for (std::size_t i = 0; i < 4; ++i) X[i] = cube(n).points()[static_cast<std::size_t>(v[i])];
      const LinearTetrahedron::Data<double> rest = LinearTetrahedron::make(X);
      g = {-(rest.gradient[0] + rest.gradient[1] + rest.gradient[2]), rest.gradient[0], rest.gradient[1],
           rest.gradient[2]};
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i + 1; j < 4; ++j)
          k[std::minmax(v[i], v[j])] -= law().mu() * rest.volume * g[i].dot(g[j]);  // 2 w1 = mu
    }
    std::vector<LinearEdge::Data<double>> data;
    std::vector<std::array<std::int32_t, 2>> ends;
    for (const auto& [edge, value] : k) {
      ends.push_back({edge.first, edge.second});
      data.push_back({value});
    }
    return {{{}}, data, ends, {}, cube(n).points()};
  }
};

template <class K, class Route>
void add_force(const std::string& route, int n) {
  add("force", K(), route, n, [n, route](benchmark::State& state) {
    auto& c = cached<ElementsCase<K, Route>>(n);
    measure(state, tetrahedra(n), c.force_error, allowed<typename K::T>(route), [&] { c.force(); });
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
    if constexpr (sizeof(typename K::T) == sizeof(double)) add_force<K, ByGradient<K, 1>>("scalar", n);
    add_energy<K, ByGradient<K, lanes>>("f", n);
    if constexpr (InvariantLaw<typename K::Law>) {
      add_force<K, ByEdges<K, lanes>>("heml", n);
      add_energy<K, ByEdges<K, lanes>>("heml", n);
    }
  });
  for (const int n : cube_cells)
    add_named<double>("force", "neo_hookean", "heml_mesh_edges", n, [n](benchmark::State& state) {
      auto& c = cached<ByMeshEdges>(n);
      measure(state, tetrahedra(n), c.error, rounding<double>, [&] { c.force(); });
    });
  return true;
}();

}  // namespace
}  // namespace bench
