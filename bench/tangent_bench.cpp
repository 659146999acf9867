// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT

#include "common.hpp"
#include "reference.hpp"

// Products with the tangent of a whole mesh, its assembly, and iterations of block Jacobi conjugate gradients
// with it.

namespace bench {
namespace {

constexpr double density = 1000;  // kg/m^3
constexpr double dt = 0.05;       // s; makes A = M/dt^2 + K positive definite, and CG not converge at once
constexpr int timed_iterations = 30;    // the product before the first iteration then is 2 % of the time
constexpr int compared_iterations = 8;  // few, since rounding errors grow along a sequence of iterations

// The routes of the library to one law.
template <class K>
struct ByGradient {
  static auto make(int n) { return elastic<typename K::T>(cube(n), K::law()); }
};
template <class K>
struct ByEdges {
  static auto make(int n) { return heml<typename K::T>(cube(n), K::law()); }
};

template <class Route>
using Body = System<decltype(Route::make(1))>;

template <class K, class Route>
struct TangentCase {
  using T = typename K::T;
  Body<Route> system;
  State<T> q;
  Vector<T> d, y;

  explicit TangentCase(int n) : system(cube(n), Route::make(n)) {
    q.displacement = field<T>(cube(n), deformation);
    d = field<T>(cube(n), ReferenceState<typename K::Law>::direction);
    y = d;
  }
};

// One product with a matrix-free tangent: what terms keep between products is made beforehand.
template <class K, class Route>
struct ProductCase : TangentCase<K, Route> {
  MatrixFreeTangent<Body<Route>> tangent;
  double error = 0;

  explicit ProductCase(int n) : TangentCase<K, Route>(n) {
    tangent.set(this->system, this->q, TangentWeights{});
    product();
    error = relative_error(packed(this->y), ReferenceState<typename K::Law>(n).product());
  }
  void product() { tangent.apply(this->d, this->y); }
};

template <class K, class Route>
struct AssembledCase : TangentCase<K, Route> {
  AssembledTangent<Body<Route>> tangent;
  double error = 0;

  explicit AssembledCase(int n) : TangentCase<K, Route>(n) {
    assemble();
    assemble();  // on the pattern of the first time
    apply();
    error = relative_error(packed(this->y), ReferenceState<typename K::Law>(n).product());
  }
  void assemble() { tangent.set(this->system, this->q, TangentWeights{}); }
  void apply() { tangent.apply(this->d, this->y); }
};

// The same iterations as a textbook has them, over the reference kernel.
template <class Law>
Vector<double> reference_iterations(const ReferenceState<Law>& state, const Vector<double>& mass,
                                    int iterations) {
  const std::ptrdiff_t size = state.x.size();
  const auto apply = [&](const Vector<double>& p, Vector<double>& Ap) {
    state.body.product(state.x, p, Ap);
    Ap += (mass.array() * p.array() / (dt * dt)).matrix();
  };
  std::vector<Mat3<double>> inverse = state.body.diagonal_blocks(state.x);
  for (std::size_t i = 0; i < inverse.size(); ++i) {
    inverse[i].diagonal() += mass.segment<3>(3 * static_cast<std::ptrdiff_t>(i)) / (dt * dt);
    inverse[i] = inverse[i].inverse().eval();
  }
  const auto precondition = [&](const Vector<double>& r, Vector<double>& z) {
    for (std::size_t i = 0; i < inverse.size(); ++i) {
      const std::ptrdiff_t k = 3 * static_cast<std::ptrdiff_t>(i);
      z.segment<3>(k) = inverse[i] * r.segment<3>(k);
    }
  };
  Vector<double> x = Vector<double>::Zero(size), r = state.d, z(size), Ap(size);
  precondition(r, z);
  Vector<double> p = z;
  double rz = r.dot(z);
  for (int k = 0; k < iterations; ++k) {
    apply(p, Ap);
    const double alpha = rz / p.dot(Ap);
    x += alpha * p;
    r -= alpha * Ap;
    precondition(r, z);
    const double next = r.dot(z);
    p = z + next / rz * p;
    rz = next;
  }
  return x;
}

template <class K, class Route, class Operator>
struct IterationCase : TangentCase<K, Route> {
  using T = typename K::T;
  typename Operator::template Tangent<Body<Route>> tangent;
  BlockJacobi<T> preconditioner;
  ConjugateGradient::Workspace<T> workspace;
  double error = 0;

  explicit IterationCase(int n) : TangentCase<K, Route>(n) {
    this->system.mass = Mass<T>::lumped(cube(n), density);
    tangent.set(this->system, this->q, TangentWeights{.mass = 1 / (dt * dt)});
    preconditioner.compute(tangent, this->system.prescribed.free());
    const Mass<double> mass = Mass<double>::lumped(cube(n), density);
    const Vector<double> expected = reference_iterations(ReferenceState<typename K::Law>(n),
                                                         packed(mass.diagonal()), compared_iterations);
    if (iterate(compared_iterations) == compared_iterations)
      error = relative_error(packed(this->y), expected);
    if (iterate(timed_iterations) != timed_iterations) error = HUGE_VAL;
  }
  // Solves A y = d with no tolerance. Returns the iterations done.
  int iterate(int count) {
    this->y.setZero();
    const ConjugateGradient cg{.max_iterations = count, .tolerance = 0};
    return cg.solve(tangent, preconditioner, this->d, this->y, workspace).iterations;
  }
};

template <class K, class Route, class Operator>
void add_iteration(const std::string& route, int n) {
  constexpr double tolerance = rounding<typename K::T>;
  add("cg_iteration", K(), route, n, [n](benchmark::State& state) {
    auto& c = cached<IterationCase<K, Route, Operator>>(n);
    measure(state, double(tetrahedra(n)) * timed_iterations, c.error, tolerance,
            [&] { benchmark::DoNotOptimize(c.iterate(timed_iterations)); });
  });
}

template <class K, class Route>
void add_product(const std::string& route, int n) {
  add("hessian_product", K(), route, n, [n](benchmark::State& state) {
    auto& c = cached<ProductCase<K, Route>>(n);
    measure(state, tetrahedra(n), c.error, rounding<typename K::T>, [&] { c.product(); });
  });
}
template <class K, class Route>
void add_assembly(const std::string& route, int n) {
  add("assemble", K(), route, n, [n](benchmark::State& state) {
    auto& c = cached<AssembledCase<K, Route>>(n);
    measure(state, tetrahedra(n), c.error, rounding<typename K::T>, [&] { c.assemble(); });
  });
}

[[maybe_unused]] const bool registered = [] {
  for_each_kind_and_size([]<class K>(K kind, int n) {
    // the other laws' tangents in single precision take minutes to compile and tell nothing new
    if constexpr (std::is_same_v<typename K::Law, NeoHookean> || std::is_same_v<typename K::T, double>) {
      using F = ByGradient<K>;
      add_product<K, F>("f", n);
      add_assembly<K, F>("f", n);
      if constexpr (InvariantLaw<typename K::Law>) {
        add_product<K, ByEdges<K>>("heml", n);
        add_assembly<K, ByEdges<K>>("heml", n);
      }
      add("apply", kind, "assembled", n, [n](benchmark::State& state) {
        auto& c = cached<AssembledCase<K, F>>(n);
        measure(state, tetrahedra(n), c.error, rounding<typename K::T>, [&] { c.apply(); });
      });
      if constexpr (std::is_same_v<typename K::Law, NeoHookean>) {
        add_iteration<K, F, Assembled>("assembled", n);
        add_iteration<K, F, MatrixFree>("matrix_free", n);
        add_iteration<K, ByEdges<K>, MatrixFree>("matrix_free_heml", n);
      }
    }
  });
  return true;
}();

}  // namespace
}  // namespace bench
