// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT

#include <algorithm>

#include "common.hpp"
#include "reference.hpp"

// Material functions over an array of deformation gradients, and the force of one element over an array of
// them.

namespace bench {
namespace {

// Deformation gradients near those of the deformed cube, all different; det F in about [0.8, 1.3].
inline Mat3<double> sample(int e, double phase) {
  Mat3<double> A;
  for (int i = 0; i < 9; ++i) A(i) = std::sin(1.7 * e + 2.3 * i + phase);
  return A;
}

// `count` tensors on N lanes each; the last lanes repeat.
template <class T, int N>
struct MaterialArrays {
  using V = Lanes<T, N>;
  using Array = std::vector<Mat3<V>, Eigen::aligned_allocator<Mat3<V>>>;
  Array F, dF, P;
  std::vector<V, Eigen::aligned_allocator<V>> psi;

  explicit MaterialArrays(int count) {
    const std::size_t chunks = static_cast<std::size_t>((count + N - 1) / N);
    F.resize(chunks);
    dF.resize(chunks);
    P.resize(chunks);
    psi.resize(chunks);
    for (std::size_t c = 0; c < chunks; ++c)
      for (int l = 0; l < N; ++l) {
        const int e = std::min(static_cast<int>(c) * N + l, count - 1);
        const Mat3<double> f = Mat3<double>::Identity() + 0.08 * sample(e, 0), df = sample(e, 1);
        for (int i = 0; i < 9; ++i) {
          set_lane(F[c](i), l, static_cast<T>(f(i)));
          set_lane(dF[c](i), l, static_cast<T>(df(i)));
        }
      }
  }
};

template <class T, int N>
Mat3<double> tensor_lane(const Mat3<Lanes<T, N>>& A, int l) {
  Mat3<double> a;
  for (int i = 0; i < 9; ++i) a(i) = static_cast<double>(lane(A(i), l));
  return a;
}

template <class K, int N>
struct MaterialCase : MaterialArrays<typename K::T, N> {
  using T = typename K::T;
  using V = Lanes<T, N>;
  using Arrays = MaterialArrays<T, N>;
  using Arrays::F, Arrays::dF, Arrays::P, Arrays::psi;
  typename K::Law law = K::law();
  double psi_error = 0, first_piola_error = 0, differential_error = 0;

  explicit MaterialCase(int n) : Arrays(tetrahedra(n)) {
    using Reference = ReferenceLaw<typename K::Law>;
    const double lambda = law.lambda(), mu = law.mu();
    // Densities lose digits where they are small: their errors count against mu, those of stresses against
    // the stress.
    energy_density();
    each_lane([&](std::size_t c, int l) {
      const Mat3<double> f = tensor_lane<T, N>(F[c], l);
      const double error =
          std::abs(static_cast<double>(lane(psi[c], l)) - Reference::template energy<double>(f, lambda, mu));
      psi_error = worse(psi_error, error / mu);
    });
    first_piola();
    each_lane([&](std::size_t c, int l) {
      const Mat3<double> p = Reference::template stress<double>(tensor_lane<T, N>(F[c], l), lambda, mu);
      first_piola_error =
          worse(first_piola_error, (tensor_lane<T, N>(P[c], l) - p).norm() / std::max(p.norm(), mu));
    });
    first_piola_differential();
    each_lane([&](std::size_t c, int l) {
      const Mat3<double> f = tensor_lane<T, N>(F[c], l), df = tensor_lane<T, N>(dF[c], l);
      const Mat3<double> p = Reference::template differential<double>(f, df, lambda, mu);
      differential_error = worse(differential_error, (tensor_lane<T, N>(P[c], l) - p).norm() / p.norm());
    });
  }

  void energy_density() {
    for (std::size_t c = 0; c < F.size(); ++c) psi[c] = law.energy_density(F[c]);
  }
  void first_piola() {
    for (std::size_t c = 0; c < F.size(); ++c) P[c] = law.first_piola(F[c]);
  }
  void first_piola_differential() {
    for (std::size_t c = 0; c < F.size(); ++c) P[c] = law.first_piola_differential(F[c], dF[c]);
  }

 private:
  template <class Function>
  void each_lane(Function f) const {
    for (std::size_t c = 0; c < F.size(); ++c)
      for (int l = 0; l < N; ++l) f(c, l);
  }
  static double worse(double a, double b) { return b <= a ? a : b; }  // keeps a NaN
};

// Gradients of all elements of the cube: rest data stream through, displacements and forces stay in a ring in
// the L1 cache.
template <class K>
struct ElementCase {
  using T = typename K::T;
  static constexpr int N = default_lanes<T>;
  using V = Lanes<T, N>;
  using Element = Elastic<LinearTetrahedron, typename K::Law>;
  using Data = LinearTetrahedron::Data<V>;
  static constexpr std::size_t ring = 16;

  Element element{K::law()};
  std::vector<Data, Eigen::aligned_allocator<Data>> data;
  std::vector<Local<V, 4>, Eigen::aligned_allocator<Local<V, 4>>> u{ring};
  std::vector<Tangent<Element, V>, Eigen::aligned_allocator<Tangent<Element, V>>> f{ring};
  double error = 0;

  explicit ElementCase(int n) {
    const TetrahedralMesh& mesh = cube(n);
    const std::size_t count = mesh.tetrahedra().size();
    data.resize((count + N - 1) / N);
    std::vector<Mat3<double>> inverse(data.size() * N);
    for (std::size_t k = 0; k < inverse.size(); ++k) {
      const Tetrahedron& v = mesh.tetrahedra()[std::min(k, count - 1)];
      std::array<Vec3<double>, 4> X;
      for (std::size_t i = 0; i < 4; ++i) X[i] = mesh.points()[static_cast<std::size_t>(v[i])];
      Mat3<double> edges;
      for (int i = 0; i < 3; ++i) edges.col(i) = X[static_cast<std::size_t>(i) + 1] - X[0];
      inverse[k] = edges.inverse();
      const LinearTetrahedron::Data<double> rest = LinearTetrahedron::make(X);
      const int l = static_cast<int>(k % N);
      for (std::size_t i = 0; i < 3; ++i)
        for (int a = 0; a < 3; ++a)
          set_lane(data[k / N].gradient[i][a], l, static_cast<T>(rest.gradient[i][a]));
      set_lane(data[k / N].volume, l, static_cast<T>(rest.volume));
    }
    for (std::size_t r = 0; r < ring; ++r)
      for (int l = 0; l < N; ++l)
        for (std::size_t i = 0; i < 4; ++i)
          for (int a = 0; a < 3;
               ++a)  // small against the edges: every element of the cube may meet every ring entry
            set_lane(u[r].points[i][a], l,
                     static_cast<T>(0.05 / n * std::sin(1.3 * a + 2.1 * double(i) + 0.7 * l + double(r))));
    check(inverse);
  }

  void evaluate(std::size_t c) { f[c % ring] = element.gradient(data[c], u[c % ring]); }
  void evaluate_all() {
    for (std::size_t c = 0; c < data.size(); ++c) evaluate(c);
  }

 private:
  void check(const std::vector<Mat3<double>>& inverse) {
    for (std::size_t k = 0; k < inverse.size(); ++k) {
      const std::size_t c = k / N;
      const int l = static_cast<int>(k % N);
      if (l == 0) evaluate(c);
      Mat3<double> edges, H;
      for (int i = 0; i < 3; ++i)
        for (int a = 0; a < 3; ++a) {
          edges(a, i) = static_cast<double>(lane(u[c % ring].points[static_cast<std::size_t>(i) + 1][a], l)) -
                        static_cast<double>(lane(u[c % ring].points[0][a], l));
          H(a, i) = static_cast<double>(lane(f[c % ring][3 * i + 3 + a], l));
        }
      const Mat3<double> F = Mat3<double>::Identity() + edges * inverse[k];
      const double lambda = element.material.lambda(), mu = element.material.mu();
      const Mat3<double> P = ReferenceLaw<typename K::Law>::template stress<double>(F, lambda, mu);
      const Mat3<double> expected = static_cast<double>(lane(data[c].volume, l)) * P * inverse[k].transpose();
      const double difference = (H - expected).norm() / expected.norm();
      error = difference <= error ? error : difference;
    }
  }
};

template <class K, int N>
void add_material(const std::string& route, int n) {
  constexpr double tolerance = rounding<typename K::T>;
  add("psi", K(), route, n, [n](benchmark::State& state) {
    auto& c = cached<MaterialCase<K, N>>(n);
    measure(state, tetrahedra(n), c.psi_error, tolerance, [&] { c.energy_density(); });
  });
  add("first_piola", K(), route, n, [n](benchmark::State& state) {
    auto& c = cached<MaterialCase<K, N>>(n);
    measure(state, tetrahedra(n), c.first_piola_error, tolerance, [&] { c.first_piola(); });
  });
  add("first_piola_differential", K(), route, n, [n](benchmark::State& state) {
    auto& c = cached<MaterialCase<K, N>>(n);
    measure(state, tetrahedra(n), c.differential_error, tolerance, [&] { c.first_piola_differential(); });
  });
}

[[maybe_unused]] const bool registered = [] {
  for_each_kind_and_size([]<class K>(K kind, int n) {
    using T = typename K::T;
    add_material<K, default_lanes<T>>("batch", n);
    add_material<K, 1>("scalar", n);
    add("element_force", kind, "batch", n, [n](benchmark::State& state) {
      auto& c = cached<ElementCase<K>>(n);
      measure(state, tetrahedra(n), c.error, rounding<T>, [&] { c.evaluate_all(); });
    });
  });
  return true;
}();

}  // namespace
}  // namespace bench
