// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>

#include "common.hpp"
#include "reference.hpp"
#include "softsim/potential/mass_tensor.hpp"

// What a hyperelastic solid is to be weighed against: springs, mass tensors and corotational elements; and
// what the filter of a projected tangent adds to its assembly.

namespace bench {

template <>
inline constexpr const char* law_name<Corotational> = "corotational";

/// By the singular value decomposition, R = U V^T with the sign of the last axis turned for an inverted F.
template <>
struct ReferenceLaw<Corotational> {
  template <class T>
  static Mat3<T> stress(const Mat3<T>& F, T lambda, T mu) {
    const Factors<T> f(F);
    const Mat3<T> R = f.U * f.V.transpose();
    return 2 * mu * (F - R) + lambda * (f.s.sum() - 3) * R;
  }
  template <class T>
  static Mat3<T> differential(const Mat3<T>& F, const Mat3<T>& dF, T lambda, T mu) {
    const Factors<T> f(F);
    const Mat3<T> R = f.U * f.V.transpose(), D = f.U.transpose() * dF * f.V;
    Mat3<T> W = Mat3<T>::Zero();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (i != j) W(i, j) = (D(i, j) - D(j, i)) / (f.s[i] + f.s[j]);
    const Mat3<T> dR = f.U * W * f.V.transpose();
    return 2 * mu * (dF - dR) + lambda * (D.trace() * R + (f.s.sum() - 3) * dR);
  }

 private:
  template <class T>
  struct Factors {
    Mat3<T> U, V;
    Vec3<T> s;
    explicit Factors(const Mat3<T>& F) {
      const Eigen::JacobiSVD<Mat3<T>> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
      U = svd.matrixU();
      V = svd.matrixV();
      s = svd.singularValues();
      if (U.determinant() * V.determinant() < 0) {
        U.col(2) *= -1;
        s[2] *= -1;
      }
    }
  };
};

/// Neo-Hookean whose tangent, a 9x9 matrix, has zero in place of its negative eigenvalues.
struct ClampedNeoHookean : NeoHookean {};
template <>
struct ReferenceLaw<ClampedNeoHookean> {
  template <class T>
  static Mat3<T> differential(const Mat3<T>& F, const Mat3<T>& dF, T lambda, T mu) {
    using Vec9 = Eigen::Matrix<T, 9, 1>;
    Eigen::Matrix<T, 9, 9> A;
    for (int k = 0; k < 9; ++k) {
      Mat3<T> unit = Mat3<T>::Zero();
      unit(k) = 1;
      const Mat3<T> dP = ReferenceLaw<NeoHookean>::differential<T>(F, unit, lambda, mu);
      A.col(k) = Eigen::Map<const Vec9>(dP.data());
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<T, 9, 9>> eigen(A);
    const Vec9 positive = eigen.eigenvalues().cwiseMax(T(0));
    const Vec9 y = eigen.eigenvectors() *
                   (positive.asDiagonal() * (eigen.eigenvectors().transpose() * Vec9(dF.reshaped())));
    return y.reshaped(3, 3);
  }
};

namespace {

constexpr double stiffness = 50;  // N/m, of every spring

// Elastic laws: elements of the library and the force that they should have.
struct CorotationalForce {
  template <class T>
  static auto make(int n) {
    return elastic<T>(cube(n), Kind<Corotational, T>::law());
  }
  static Vector<double> expected(int n) { return ReferenceState<Corotational>(n).force(); }
};
struct LinearTensors {
  template <class T>
  static auto make(int n) {
    const LinearElastic law = Kind<LinearElastic, T>::law();
    return mass_tensors<LinearMassTensor, T>(cube(n), {law.lambda(), law.mu()});
  }
  static Vector<double> expected(int n) { return ReferenceState<LinearElastic>(n).force(); }
};
struct QuadraticTensors {
  template <class T>
  static auto make(int n) {
    const StVenantKirchhoff law = Kind<StVenantKirchhoff, T>::law();
    return mass_tensors<MassTensor, T>(cube(n), {law.lambda(), law.mu()});
  }
  static Vector<double> expected(int n) { return ReferenceState<StVenantKirchhoff>(n).force(); }
};

// One spring on every edge, Hooke's or the one that is smooth in the squared length.
template <class Law>
struct Springs {
  template <class T>
  static auto make(int n) {
    return springs<Law, T>(cube(n), stiffness);
  }
  static Vector<double> expected(int n) {
    const TetrahedralMesh& mesh = cube(n);
    std::vector<std::pair<std::int32_t, std::int32_t>> edges;
    for (const Tetrahedron& v : mesh.tetrahedra())
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i + 1; j < 4; ++j) edges.emplace_back(std::minmax(v[i], v[j]));
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    const Vector<double> x = packed(field<double>(mesh, ReferenceState<Corotational>::position));
    Vector<double> y = Vector<double>::Zero(x.size());
    for (const auto& [i, j] : edges) {
      const double rest =
          (mesh.points()[static_cast<std::size_t>(j)] - mesh.points()[static_cast<std::size_t>(i)]).norm();
      const Vec3<double> d = x.segment<3>(3 * j) - x.segment<3>(3 * i);
      const double l = d.norm();
      const double tension = std::is_same_v<Law, Spring>
                                 ? stiffness * (l - rest) / l
                                 : stiffness * (l * l - rest * rest) / (2 * rest * rest);
      const Vec3<double> f = tension * d;
      y.segment<3>(3 * i) -= f;
      y.segment<3>(3 * j) += f;
    }
    return y;
  }
};

template <class Subject, class T>
struct ForceCase {
  decltype(Subject::template make<T>(1)) elements;
  State<T> q;
  Vector<T> y;
  double error;

  explicit ForceCase(int n) : elements(Subject::template make<T>(n)) {
    q.displacement = field<T>(cube(n), deformation);
    y.resize(q.size());
    force();
    error = relative_error(packed(y), Subject::expected(n));
  }
  void force() {
    y.setZero();
    elements.add_gradient(q, y);
  }
};

template <class Subject>
void add_force(const std::string& law, const std::string& route, int n) {
  const auto with = [&]<class T>(T) {
    add_named<T>("force", law, route, n, [n](benchmark::State& state) {
      auto& c = cached<ForceCase<Subject, T>>(n);
      measure(state, tetrahedra(n), c.error, rounding<T>, [&] { c.force(); });
    });
  };
  with(double());
  with(float());
}

// Products with the corotational tangent.
template <class T>
struct CorotationalProduct {
  decltype(CorotationalForce::make<T>(1)) elements;
  State<T> q;
  Vector<T> d, y;
  double error;

  explicit CorotationalProduct(int n) : elements(CorotationalForce::make<T>(n)) {
    q.displacement = field<T>(cube(n), deformation);
    d = field<T>(cube(n), ReferenceState<Corotational>::direction);
    product();
    error = relative_error(packed(y), ReferenceState<Corotational>(n).product());
  }
  void product() {
    y = Vector<T>::Zero(d.size());
    elements.add_hessian_product(q, d, y);
  }
};

// States of which no, about every second, and every tetrahedron needs the filter: the tangent of Neo-Hookean
// turns indefinite as soon as two principal stresses add up to a pressure.
enum class Needs { none, half, all };
template <Needs needs>
Vec3<double> compression(const Vec3<double>& X) {
  constexpr double shrinkage = needs == Needs::none ? 0 : needs == Needs::half ? 0.0215 : 0.05;
  return deformation(X) - shrinkage * X;
}

template <Needs needs>
struct ProjectedAssembly {
  using Body = System<decltype(elastic(cube(1), projected(Kind<NeoHookean, double>::law())))>;
  Body system;
  State<double> q;
  AssembledTangent<Body> tangent;
  double error;

  explicit ProjectedAssembly(int n)
      : system(cube(n), elastic(cube(n), projected(Kind<NeoHookean, double>::law()))) {
    q.displacement = field<double>(cube(n), compression<needs>);
    assemble();
    assemble();  // on the pattern of the first time
    const Vector<double> d = field<double>(cube(n), ReferenceState<NeoHookean>::direction);
    Vector<double> y = d, expected(d.size() / 4 * 3);
    tangent.apply(d, y);
    const ReferenceBody<ClampedNeoHookean, double> body(cube(n), {Kind<NeoHookean, double>::law()});
    const auto position = [](const Vec3<double>& X) -> Vec3<double> { return X + compression<needs>(X); };
    body.product(packed(field<double>(cube(n), +position)), packed(d), expected);
    error = relative_error(packed(y), expected);
  }
  void assemble() { tangent.set(system, q, TangentWeights{}); }
};

template <Needs needs>
void add_projected(const std::string& route, int n) {
  add_named<double>("assemble", "neo_hookean", route, n, [n](benchmark::State& state) {
    auto& c = cached<ProjectedAssembly<needs>>(n);
    measure(state, tetrahedra(n), c.error, rounding<double>, [&] { c.assemble(); });
  });
}

[[maybe_unused]] const bool registered = [] {
  for (const int n : cube_cells) {
    add_force<CorotationalForce>("corotational", "f", n);
    add_force<Springs<Spring>>("mass_spring", "spring", n);
    add_force<Springs<SquaredLengthSpring>>("mass_spring", "squared_length", n);
    add_force<LinearTensors>("mass_tensor", "linear", n);
    add_force<QuadraticTensors>("mass_tensor", "svk", n);
    const auto product = [n]<class T>(T) {
      add_named<T>("hessian_product", "corotational", "f", n, [n](benchmark::State& state) {
        auto& c = cached<CorotationalProduct<T>>(n);
        measure(state, tetrahedra(n), c.error, rounding<T>, [&] { c.product(); });
      });
    };
    product(double());
    product(float());
    add_projected<Needs::none>("projected_none", n);
    add_projected<Needs::half>("projected", n);
    add_projected<Needs::all>("projected_all", n);
  }
  return true;
}();

}  // namespace
}  // namespace bench
