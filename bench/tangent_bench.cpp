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

template <class K>
using Body = System<ElasticTetrahedra<typename K::Law, typename K::T>>;

template <class K>
struct TangentCase {
  using T = typename K::T;
  Body<K> system;
  State<T> q;
  Vector<T> d, y;

  explicit TangentCase(int n) : system(cube(n), elastic<T>(cube(n), K::law())) {
    q.displacement = field<T>(cube(n), deformation);
    d = field<T>(cube(n), ReferenceState<typename K::Law>::direction);
    y = d;
  }
};

template <class K>
struct ProductCase : TangentCase<K> {
  double error = 0;

  explicit ProductCase(int n) : TangentCase<K>(n) {
    product();
    error = relative_error(packed(this->y), ReferenceState<typename K::Law>(n).product());
  }
  void product() {
    this->y.setZero();
    this->system.add_hessian_product(this->q, this->d, this->y);
  }
};

template <class K>
struct AssembledCase : TangentCase<K> {
  AssembledTangent<Body<K>> tangent;
  double error = 0;

  explicit AssembledCase(int n) : TangentCase<K>(n) {
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

template <class K, class Operator>
struct IterationCase : TangentCase<K> {
  using T = typename K::T;
  typename Operator::template Tangent<Body<K>> tangent;
  BlockJacobi<T> preconditioner;
  ConjugateGradientWorkspace<T> workspace;
  double error = 0;

  explicit IterationCase(int n) : TangentCase<K>(n) {
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

template <class K, class Operator>
void add_iteration(const std::string& route, int n) {
  constexpr double tolerance = rounding<typename K::T>;
  add("cg_iteration", K(), route, n, [n](benchmark::State& state) {
    auto& c = cached<IterationCase<K, Operator>>(n);
    measure(state, double(tetrahedra(n)) * timed_iterations, c.error, tolerance,
            [&] { benchmark::DoNotOptimize(c.iterate(timed_iterations)); });
  });
}

[[maybe_unused]] const bool registered = [] {
  for_each_kind_and_size([]<class K>(K kind, int n) {
    constexpr double tolerance = rounding<typename K::T>;
    add("hessian_product", kind, "f", n, [n](benchmark::State& state) {
      auto& c = cached<ProductCase<K>>(n);
      measure(state, tetrahedra(n), c.error, tolerance, [&] { c.product(); });
    });
    add("assemble", kind, "f", n, [n](benchmark::State& state) {
      auto& c = cached<AssembledCase<K>>(n);
      measure(state, tetrahedra(n), c.error, tolerance, [&] { c.assemble(); });
    });
    add("apply", kind, "assembled", n, [n](benchmark::State& state) {
      auto& c = cached<AssembledCase<K>>(n);
      measure(state, tetrahedra(n), c.error, tolerance, [&] { c.apply(); });
    });
    add_iteration<K, Assembled>("assembled", n);
    add_iteration<K, MatrixFree>("matrix_free", n);
  });
  return true;
}();

}  // namespace
}  // namespace bench
