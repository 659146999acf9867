// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/potential/heml.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/material/mooney_rivlin.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/material/stable_neo_hookean.hpp"
#include "softsim/material/linear_elastic.hpp"
#include "softsim/potential/edge_lengths.hpp"
#include "softsim/system/system.hpp"
#include "softsim/system/tangent.hpp"

namespace heml_test {

using bodies::gradient, bodies::hessian_product, bodies::relative_error, bodies::Vec;
using softsim::EdgeLengths, softsim::Heml, softsim::LinearTetrahedron, softsim::Local, softsim::Mat3;
using softsim::MooneyRivlin, softsim::NeoHookean, softsim::StableNeoHookean, softsim::State,
    softsim::StVenantKirchhoff, softsim::TetrahedralMesh, softsim::Vector;
using Vec12 = Eigen::Matrix<double, 12, 1>;

static_assert(softsim::LocalPotential<Heml<NeoHookean>> &&
              softsim::LocalPotential<Heml<MooneyRivlin>, softsim::Batch<float, 8>>);
static_assert(softsim::LocalPotential<EdgeLengths<NeoHookean>>);
static_assert(softsim::Linearisable<Heml<NeoHookean>, double>);
static_assert(softsim::Potential<softsim::HemlTetrahedra<StVenantKirchhoff>>);
// the cache of a product stays below 100 bytes a tetrahedron
static_assert(sizeof(Heml<NeoHookean>::Linearisation<double>) <= 100);

// A law in which every derivative of w is there and not constant in its arguments.
struct Everything : softsim::Isotropic<Everything> {
  template <class T>
  T density(const softsim::Invariants<T>& i) const {
    return T(40) * i.k1 + T(3) * i.k1 * i.k1 + T(20) * i.k2 + T(0.7) * i.k1 * i.k2 + T(0.3) * i.k2 * i.k2 +
           T(0.5) * i.k1 * i.kj * i.kj + T(0.2) * i.k2 * i.kj + T(90) * i.kj * i.kj - T(160) * i.kj;
  }
  template <class T>
  softsim::First<T> first(const softsim::Invariants<T>& i) const {
    return {T(40) + T(6) * i.k1 + T(0.7) * i.k2 + T(0.5) * i.kj * i.kj,
            T(20) + T(0.7) * i.k1 + T(0.6) * i.k2 + T(0.2) * i.kj,
            i.k1 * i.kj + T(0.2) * i.k2 + T(180) * i.kj - T(160)};
  }
  template <class T>
  softsim::Second<T> second(const softsim::Invariants<T>& i) const {
    return {T(6), T(0.7), T(0.6), i.kj, T(0.2), i.k1 + T(180)};
  }
};
// Depends on I1 and J alone, but not linearly.
struct Curved : softsim::Isotropic<Curved> {
  static constexpr bool depends_on_i2 = false;
  template <class T>
  T density(const softsim::Invariants<T>& i) const {
    return T(50) * i.k1 + T(4) * i.k1 * i.k1 + T(3) * i.k1 * i.kj + T(80) * i.kj * i.kj - T(100) * i.kj;
  }
  template <class T>
  softsim::First<T> first(const softsim::Invariants<T>& i) const {
    return {T(50) + T(8) * i.k1 + T(3) * i.kj, T(0), T(3) * i.k1 + T(160) * i.kj - T(100)};
  }
  template <class T>
  softsim::Second<T> second(const softsim::Invariants<T>&) const {
    return {T(8), T(0), T(0), T(3), T(0), T(160)};
  }
};

template <class Law>
Law make_law() {
  if constexpr (std::is_same_v<Law, MooneyRivlin>)
    return MooneyRivlin::from_lame(400, 300, 0.7);
  else if constexpr (std::is_same_v<Law, Everything> || std::is_same_v<Law, Curved>)
    return Law();
  else
    return Law::from_lame(400, 300);
}
constexpr double p_wave_modulus = 400 + 2 * 300;  // of make_law; the two laws above are no stiffer

template <class Law>
class HemlOf : public ::testing::Test {};
using Laws =
    ::testing::Types<NeoHookean, StableNeoHookean, StVenantKirchhoff, MooneyRivlin, Everything, Curved>;
TYPED_TEST_SUITE(HemlOf, Laws);

// Whole meshes with one law of each way through the kernels: compiling them takes time.
template <class Law>
class HemlMeshOf : public ::testing::Test {};
using MeshLaws = ::testing::Types<NeoHookean, Everything>;
TYPED_TEST_SUITE(HemlMeshOf, MeshLaws);

// The bound of the derivation: entries of E carry eps |e|^2, F^T F = B^T E B magnifies them by |g|^2.
double bound(const std::array<Vec, 4>& X, const LinearTetrahedron::Data<double>& rest) {
  const double kappa = softsim::edge_condition(X);
  double g = (rest.gradient[0] + rest.gradient[1] + rest.gradient[2]).norm();
  for (const Vec& v : rest.gradient) g = std::max(g, v.norm());
  return kappa * kappa * rest.volume * p_wave_modulus * g;
}

// A random tetrahedron; `flatness` scales its height.
std::array<Vec, 4> tetrahedron(bodies::Random& random, double flatness) {
  for (;;) {
    std::array<Vec, 4> X{random.vec(), random.vec(), random.vec(), random.vec()};
    Mat3<double> e;
    for (int i = 0; i < 3; ++i) e.col(i) = X[static_cast<std::size_t>(i) + 1] - X[0];
    if (e.determinant() < 0.3) continue;
    const Vec n = e.col(0).cross(e.col(1)).normalized();
    X[3] += (flatness - 1) * n.dot(X[3] - X[0]) * n;
    return X;
  }
}

struct Deformed {
  std::array<Vec, 4> X;
  LinearTetrahedron::Data<double> rest;
  Local<double, 4> x, u;
  Vec12 d;
};
Deformed deformed(bodies::Random& random, double flatness, double strain) {
  Deformed t;
  t.X = tetrahedron(random, flatness);
  t.rest = LinearTetrahedron::make(t.X);
  Mat3<double> F;
  do {
    F = random.rotation() * (Mat3<double>::Identity() + strain * random.matrix());
  } while (F.determinant() < 0.5);  // the bound below knows the stiffness at rest only
  const Vec shift = random.vec();
  for (std::size_t i = 0; i < 4; ++i) {
    t.x.points[i] = F * t.X[i] + shift;
    t.u.points[i] = t.x.points[i] - t.X[i];
  }
  for (int i = 0; i < 12; ++i) t.d[i] = random.number();
  return t;
}

TYPED_TEST(HemlOf, OneTetrahedronEqualsTheFiniteElementWithinItsCondition) {
  using Law = TypeParam;
  const Law law = make_law<Law>();
  const softsim::Elastic<LinearTetrahedron, Law> element{law};
  const Heml<Law> edges{law};
  const EdgeLengths<Law> lengths{law};
  bodies::Random random(5);
  for (const double flatness : {1.0, 0.1, 0.01})
    for (int k = 0; k < 200; ++k) {
      const Deformed t = deformed(random, flatness, 0.3);
      const auto metric = Heml<Law>::make(t.rest);
      const auto squares = EdgeLengths<Law>::make(t.rest);
      const double tolerance = 1e-12 * bound(t.X, t.rest), length = 4;  // no edge is longer than that
      const Vec12 f = element.gradient(t.rest, t.u);
      ASSERT_LT((edges.gradient(metric, t.x) - f).cwiseAbs().maxCoeff(), tolerance) << flatness;
      // Mtr holds products of four gradients, and the lengths cancel in it once more
      const double twice = softsim::edge_condition(t.X) * tolerance;
      ASSERT_LT((lengths.gradient(squares, t.x) - f).cwiseAbs().maxCoeff(), twice) << flatness;
      const double energy = element.energy(t.rest, t.u);
      ASSERT_NEAR(edges.energy(metric, t.x), energy, length * tolerance) << flatness;
      ASSERT_NEAR(lengths.energy(squares, t.x), energy, length * twice) << flatness;
      // one more gradient stands before a product than before a force
      const Vec12 Kd = element.hessian_product(t.rest, t.u, t.d);
      double g = 0;
      for (const Vec& v : t.rest.gradient) g = std::max(g, v.norm());
      ASSERT_LT((edges.hessian_product(metric, t.x, t.d) - Kd).cwiseAbs().maxCoeff(), 4 * g * tolerance)
          << flatness;
      ASSERT_LT((lengths.hessian_product(squares, t.x, t.d) - Kd).cwiseAbs().maxCoeff(), 4 * g * twice)
          << flatness;
    }
}

// Well-shaped elements at finite strain: 1e-12 relative.
TYPED_TEST(HemlMeshOf, AMeshHasTheForcesEnergiesAndProductsOfTheFiniteElements) {
  const auto law = make_law<TypeParam>();
  const TetrahedralMesh mesh = bodies::distorted_cube(4, 3);  // 384 tetrahedra: two stretches
  const std::size_t nodes = mesh.points().size();
  const auto by_gradient = softsim::elastic(mesh, law);
  const auto by_edges = softsim::heml(mesh, law);
  EXPECT_EQ(by_edges.size(), mesh.tetrahedra().size());
  const State<double> q = bodies::random_state(nodes, 0.02, 4);
  const Vector<double> d = bodies::random_vector(nodes, 1, 5);
  EXPECT_NEAR(by_edges.energy(q) / by_gradient.energy(q), 1, 1e-12);
  EXPECT_LT(relative_error(gradient(by_edges, q), gradient(by_gradient, q)), 1e-12);
  const Vector<double> Kd = hessian_product(by_gradient, q, d);
  EXPECT_LT(relative_error(hessian_product(by_edges, q, d), Kd), 1e-12);
  typename decltype(by_edges)::Linearised at;
  by_edges.linearise(q, at);
  Vector<double> y = Vector<double>::Zero(q.size());
  by_edges.add_linearised_product(at, d, y);
  EXPECT_LT(relative_error(y, Kd), 1e-12);
  // blocks in closed form, of both routes
  const auto assembled = [&](const auto& term) {
    softsim::System system(mesh, term);
    softsim::AssembledTangent<decltype(system)> tangent;
    tangent.set(system, q, {});
    tangent.apply(d, y);
    return relative_error(y, Kd);
  };
  EXPECT_LT(assembled(by_edges), 1e-12);
  EXPECT_LT(assembled(by_gradient), 1e-12);
}

TYPED_TEST(HemlOf, TheProductIsTheDerivativeOfTheForceAndTheForceOfTheEnergy) {
  const auto law = make_law<TypeParam>();
  const Heml<TypeParam> edges{law};
  bodies::Random random(6);
  for (int k = 0; k < 20; ++k) {
    const Deformed t = deformed(random, 1, 0.3);
    const auto data = Heml<TypeParam>::make(t.rest);
    const double h = 1e-5;  // error h^2 and eps/h, both about 1e-10 of the third derivative
    Local<double, 4> forward = t.x, backward = t.x;
    for (std::size_t i = 0; i < 4; ++i) {
      forward.points[i] += h * t.d.segment<3>(3 * static_cast<int>(i));
      backward.points[i] -= h * t.d.segment<3>(3 * static_cast<int>(i));
    }
    const Vec12 f = edges.gradient(data, t.x), Kd = edges.hessian_product(data, t.x, t.d);
    const double work = (edges.energy(data, forward) - edges.energy(data, backward)) / (2 * h);
    EXPECT_NEAR(work, f.dot(t.d), 1e-6 * f.norm() * t.d.norm());
    const Vec12 difference = (edges.gradient(data, forward) - edges.gradient(data, backward)) / (2 * h);
    EXPECT_LT((difference - Kd).norm(), 1e-6 * Kd.norm());
  }
}

// Table 3 with the factor 2 that is printed nowhere: f = 2 V dl^T MW (DLM v), MW = lambda/8 vtr vtr^T + mu/4 Mtr.
TEST(EdgeLengthForms, SaintVenantKirchhoffIsTheCorrectedTable) {
  const auto law = StVenantKirchhoff::from_lame(400, 300);
  bodies::Random random(7);
  const Deformed t = deformed(random, 1, 0.3);
  const auto data = EdgeLengths<StVenantKirchhoff>::make(t.rest);
  const auto squares = [](const std::array<Vec, 4>& p) {
    Eigen::Matrix<double, 6, 1> l;
    l << (p[1] - p[0]).squaredNorm(), (p[2] - p[0]).squaredNorm(), (p[3] - p[0]).squaredNorm(),
        (p[2] - p[1]).squaredNorm(), (p[3] - p[2]).squaredNorm(), (p[1] - p[3]).squaredNorm();
    return l;
  };
  const auto C = EdgeLengths<StVenantKirchhoff>::strain_of_length(t.rest);
  const Eigen::Matrix<double, 6, 1> l = squares(t.x.points), dl = l - squares(t.X);
  Mat3<double> sum = Mat3<double>::Zero();
  Eigen::Matrix<double, 6, 1> vtr;
  Eigen::Matrix<double, 6, 6> Mtr;
  for (std::size_t i = 0; i < 6; ++i) {
    sum += l[static_cast<int>(i)] * C[i];
    vtr[static_cast<int>(i)] = C[i].trace();
    for (std::size_t j = 0; j < 6; ++j) Mtr(static_cast<int>(i), static_cast<int>(j)) = (C[i] * C[j]).trace();
  }
  const Mat3<double> F = LinearTetrahedron::deformation_gradient(t.rest, t.u);
  EXPECT_LT((sum - F.transpose() * F).norm(), 1e-13 * sum.norm());
  const Eigen::Matrix<double, 6, 6> MW = 400.0 / 8 * vtr * vtr.transpose() + 300.0 / 4 * Mtr;
  EXPECT_NEAR(t.rest.volume * dl.dot(MW * dl), (EdgeLengths<StVenantKirchhoff>{law}.energy(data, t.x)), 1e-10);
  const Eigen::Matrix<double, 6, 1> s = 2 * t.rest.volume * (MW * dl);
  const auto& x = t.x.points;
  // the force on corner 0 is along its three edges, and 2 s v
  const Vec at_0 = -2 * (s[0] * (x[1] - x[0]) + s[1] * (x[2] - x[0]) + s[2] * (x[3] - x[0]));
  const Vec12 f = EdgeLengths<StVenantKirchhoff>{law}.gradient(data, t.x);
  EXPECT_LT((f.head<3>() - at_0).norm(), 1e-12 * f.norm());
}

TEST(Heml, WarnsOfSliversOnceAndOffersTheOtherRoute) {
  const TetrahedralMesh good = bodies::distorted_cube(2, 3);
  std::vector<std::string> heard;
  const softsim::Warn warn = [&](const std::string& s) { heard.push_back(s); };
  (void)softsim::heml(good, make_law<NeoHookean>(), warn);
  EXPECT_TRUE(heard.empty());
  const TetrahedralMesh flat({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 0.005}, {0, 0, 1}},
                             {{0, 1, 2, 3}, {3, 1, 2, 4}});
  (void)softsim::heml(flat, make_law<NeoHookean>(), warn);
  ASSERT_EQ(heard.size(), 1u);
  EXPECT_NE(heard[0].find("heml: 1 of 2 tetrahedra are slivers (worst: 0, longest edge over height 282"),
            std::string::npos)
      << heard[0];
  EXPECT_NE(heard[0].find("elastic()"), std::string::npos);
}

TEST(Heml, ALawThatIsNotOfTheInvariantsTakesTheOtherRoute) {
  const TetrahedralMesh mesh = bodies::distorted_cube(2, 3);
  const auto law = softsim::LinearElastic::from_lame(400, 300);
  const auto term = softsim::heml(mesh, law);
  static_assert(std::is_same_v<decltype(term), const softsim::ElasticTetrahedra<softsim::LinearElastic>>);
  const State<double> q = bodies::random_state(mesh.points().size(), 0.02, 4);
  EXPECT_EQ(gradient(term, q), gradient(softsim::elastic(mesh, law), q));
}

TEST(Heml, EachLawActsOnItsOwnTetrahedra) {
  const TetrahedralMesh mesh = bodies::distorted_cube(2, 3);
  const std::vector<NeoHookean> laws{NeoHookean::from_lame(400, 300), NeoHookean::from_lame(10, 20)};
  std::vector<std::int32_t> index;
  for (std::size_t t = 0; t < mesh.tetrahedra().size(); ++t) index.push_back(t % 3 == 0);
  const State<double> q = bodies::random_state(mesh.points().size(), 0.02, 4);
  EXPECT_LT(relative_error(gradient(softsim::heml(mesh, laws, index), q),
                           gradient(softsim::elastic(mesh, laws, index), q)),
            1e-12);
  EXPECT_EQ(bodies::refusal([&] { return softsim::heml(mesh, laws); }),
            "heml: 2 laws need an index per tetrahedron");
  EXPECT_EQ(bodies::refusal([&] { return softsim::heml(mesh, std::vector<NeoHookean>{}); }), "heml: no law");
}

TEST(Heml, SinglePrecisionCarriesSixDigitsOfASmallMesh) {
  const TetrahedralMesh mesh = bodies::distorted_cube(3, 3);
  const auto law = make_law<NeoHookean>();
  const State<float> q = bodies::random_state<float>(mesh.points().size(), 0.03, 4);
  State<double> q_double;
  q_double.displacement = q.displacement.cast<double>();
  // positions of size 1 rounded to 6e-8, edges of size 1/3, strains of 0.1
  EXPECT_LT(relative_error(gradient(softsim::heml<float>(mesh, law), q),
                           gradient(softsim::elastic(mesh, law), q_double)),
            1e-5);
}

}  // namespace heml_test
