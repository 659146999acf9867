// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/material/continued.hpp"
#include "softsim/material/energy_law.hpp"
#include "softsim/material/fung.hpp"
#include "softsim/material/holzapfel_gasser_ogden.hpp"
#include "softsim/material/isochoric_neo_hookean.hpp"
#include "softsim/material/mooney_rivlin.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/ogden.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/material/stable_neo_hookean.hpp"
#include "softsim/material/sum.hpp"
#include "softsim/material/veronda_westmann.hpp"
#include "softsim/material/yeoh.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/heml.hpp"
#include "softsim/potential/prony.hpp"
#include "softsim/system/system.hpp"
#include "softsim/system/tangent.hpp"

// Every law from edge lengths is that law on the finite element; a law continued below J0 is so through
// inversion.

namespace heml_laws_test {

using bodies::gradient, bodies::hessian_product, bodies::relative_error, bodies::Vec;
using softsim::Continued, softsim::Heml, softsim::LinearTetrahedron, softsim::Local, softsim::Mat3,
    softsim::MooneyRivlin, softsim::NeoHookean, softsim::State, softsim::TetrahedralMesh, softsim::Vector;
using Vec12 = Eigen::Matrix<double, 12, 1>;

// Ten lines: a user's own law, from its energy alone.
struct Own : softsim::IsotropicEnergyLaw<Own> {
  template <class T>
  T density(const softsim::Invariants<T>& i) const {
    return T(100) * i.k1 + T(20) * i.k2 - T(280) * i.kj + T(200) * i.kj * i.kj + T(3) * i.k1 * i.k1;
  }
};

// Another, from psi(F): no invariants, hence no edge form.
struct OfF : softsim::EnergyLaw<OfF> {
  template <class T>
  T energy_density(const Mat3<T>& F) const {
    const T j = F.determinant() - T(1);
    return T(100) * (F.squaredNorm() - T(3)) - T(200) * j + T(200) * j * j;
  }
};

// One tetrahedron with one law, by both routes.
struct Routes {
  using Rest = LinearTetrahedron::Data<double>;
  using Points = Local<double, 4>;
  struct Answer {
    double energy;
    Vec12 force, product;
  };
  std::string name;
  double p_wave_modulus;  // lambda + 2 mu of small strain
  std::function<Answer(const Rest&, const Points&x, const Points&u, const Vec12&d)> edges, element;
  std::function<double(const Mat3<double>&)> stiffness;  // norm of dP/dF

  template <class Law>
  Routes(std::string n, const Law& law) : name(std::move(n)) {
    const softsim::Lame rest = softsim::rest_moduli(law);
    p_wave_modulus = rest.lambda + 2 * rest.mu;
    edges = [law](const Rest& data, const Points& x, const Points&, const Vec12& d) -> Answer {
      const Heml<Law> model{law};
      const auto metric = Heml<Law>::make(data);
      return {model.energy(metric, x), model.gradient(metric, x), model.hessian_product(metric, x, d)};
    };
    element = [law](const Rest& data, const Points&, const Points& u, const Vec12& d) -> Answer {
      const softsim::Elastic<LinearTetrahedron, Law> model{law};
      return {model.energy(data, u), model.gradient(data, u), model.hessian_product(data, u, d)};
    };
    stiffness = [law](const Mat3<double>& F) {
      double sum = 0;
      for (int k = 0; k < 9; ++k) {
        Mat3<double> unit = Mat3<double>::Zero();
        unit(k) = 1;
        sum += law.first_piola_differential(F, unit).squaredNorm();
      }
      return std::sqrt(sum);
    };
  }
};

const std::vector<Routes>& laws() {
  static const std::vector<Routes> all{
      {"St. Venant-Kirchhoff", softsim::StVenantKirchhoff::from_lame(400, 300)},
      {"Neo-Hookean", NeoHookean::from_lame(400, 300)},
      {"stable Neo-Hookean", softsim::StableNeoHookean::from_lame(400, 300)},
      {"isochoric Neo-Hookean", softsim::IsochoricNeoHookean::from_lame(400, 300)},
      {"Mooney-Rivlin", MooneyRivlin::from_lame(400, 300, 0.5)},
      {"coupled Mooney-Rivlin", softsim::CoupledMooneyRivlin(120, 30, 280)},
      {"Yeoh", softsim::Yeoh(150, 10, 1, 600)},
      {"Fung", softsim::Fung(300, 0.2, 600)},
      {"Veronda-Westmann", softsim::VerondaWestmann(600, 0.5, 600)},
      {"own", Own()}};
  return all;
}
const std::vector<Routes>& continued_laws() {
  static const std::vector<Routes> all{
      {"Neo-Hookean", Continued(NeoHookean::from_lame(400, 300))},
      {"coupled Mooney-Rivlin", Continued(softsim::CoupledMooneyRivlin(120, 30, 280))},
      {"Mooney-Rivlin", Continued(MooneyRivlin::from_lame(400, 300, 0.5), 0.5)},
      {"Yeoh", Continued(softsim::Yeoh(150, 10, 1, 600), 0.6)},
      {"Fung", Continued(softsim::Fung(300, 0.02, 600))},
      {"Veronda-Westmann", Continued(softsim::VerondaWestmann(6000, 0.05, 600), 0.5)}};
  return all;
}

// A random tetrahedron, a deformation F of it, and what rounding may do to a force of a law as stiff as
// `modulus`: entries of E = e^T e carry eps |e|^2, and C = B^T E B magnifies them by |g|^2.
struct Case {
  LinearTetrahedron::Data<double> rest;
  Local<double, 4> x, u;
  Vec12 d;
  double kappa, slope;  // longest edge times the largest gradient; that gradient, 1/m

  Case(bodies::Random& random, double flatness, const Mat3<double>& F) {
    std::array<Vec, 4> X;
    Mat3<double> e;
    do {
      X = {random.vec(), random.vec(), random.vec(), random.vec()};
      for (int i = 0; i < 3; ++i) e.col(i) = X[static_cast<std::size_t>(i) + 1] - X[0];
    } while (e.determinant() < 0.3);
    const Vec n = e.col(0).cross(e.col(1)).normalized();
    X[3] += (flatness - 1) * n.dot(X[3] - X[0]) * n;
    rest = LinearTetrahedron::make(X);
    kappa = softsim::edge_condition(X);
    slope = (rest.gradient[0] + rest.gradient[1] + rest.gradient[2]).norm();
    for (const Vec& g : rest.gradient) slope = std::max(slope, g.norm());
    const Vec shift = random.vec();
    for (std::size_t i = 0; i < 4; ++i) {
      x.points[i] = F * X[i] + shift;
      u.points[i] = x.points[i] - X[i];
    }
    for (int i = 0; i < 12; ++i) d[i] = random.number();
  }
  void expect_equal(const Routes& law, double modulus) const {
    const Routes::Answer a = law.edges(rest, x, u, d), b = law.element(rest, x, u, d);
    const double tolerance = 1e-12 * kappa * kappa * rest.volume * modulus * slope, length = 4;
    ASSERT_TRUE(std::isfinite(b.energy) && b.force.allFinite() && b.product.allFinite());
    EXPECT_LE((a.force - b.force).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_NEAR(a.energy, b.energy, length * tolerance);
    // one more gradient stands before a product than before a force
    EXPECT_LE((a.product - b.product).cwiseAbs().maxCoeff(), 4 * slope * tolerance);
  }
};

TEST(HemlLaws, OneTetrahedronEqualsTheFiniteElementForEveryLaw) {
  for (const Routes& law : laws()) {
    SCOPED_TRACE(law.name);
    bodies::Random random(11);
    for (const double flatness : {1.0, 0.1, 0.01})
      for (int k = 0; k < 100; ++k) {
        Mat3<double> F;
        do {
          F = random.rotation() * (Mat3<double>::Identity() + 0.3 * random.matrix());
        } while (F.determinant() < 0.5);  // the modulus is that at rest
        Case(random, flatness, F).expect_equal(law, law.p_wave_modulus);
        if (::testing::Test::HasFailure()) return;
      }
  }
}

// det F from -1 to 3, with the stiffness that the law has there in place of that at rest.
TEST(HemlLaws, ContinuedLawsEqualTheFiniteElementThroughInversion) {
  for (const Routes& law : continued_laws()) {
    SCOPED_TRACE(law.name);
    bodies::Random random(12);
    int inverted = 0;
    for (int k = 0; k < 300; ++k) {
      Mat3<double> F;
      do {
        F = random.rotation() * (Mat3<double>::Identity() + random.matrix());
      } while (!(F.determinant() >= -1 && F.determinant() <= 3));
      inverted += F.determinant() < 0;
      const double size = (1 + F.norm()) * (1 + F.norm()) * law.stiffness(F);
      Case(random, 1, F).expect_equal(law, std::max(law.p_wave_modulus, size));
      if (::testing::Test::HasFailure()) return;
    }
    EXPECT_GT(inverted, 30);
  }
}

int inverted_tetrahedra(const TetrahedralMesh& mesh, const State<double>& q) {
  int count = 0;
  for (const softsim::Tetrahedron& v : mesh.tetrahedra()) {
    Mat3<double> e;
    const auto at = [&](std::size_t i) { return bodies::position(mesh, q, static_cast<std::size_t>(v[i])); };
    for (std::size_t i = 0; i < 3; ++i) e.col(static_cast<int>(i)) = at(i + 1) - at(0);
    count += e.determinant() < 0;
  }
  return count;
}

// All kernels of a mesh: energy, force, product, what `linearise` keeps, and the blocks of the tangent.
template <class Law>
void expect_equal_meshes(const Law& law, double amplitude, bool inverted) {
  const TetrahedralMesh mesh = bodies::distorted_cube(4, 3);
  const std::size_t nodes = mesh.points().size();
  const auto by_gradient = softsim::elastic(mesh, law);
  const auto by_edges = softsim::heml(mesh, law);
  const State<double> q = bodies::random_state(nodes, amplitude, 4);
  const Vector<double> d = bodies::random_vector(nodes, 1, 5);
  EXPECT_EQ(inverted_tetrahedra(mesh, q) > 0, inverted);
  EXPECT_NEAR(by_edges.energy(q) / by_gradient.energy(q), 1, 1e-12);
  EXPECT_LT(relative_error(gradient(by_edges, q), gradient(by_gradient, q)), 1e-12);
  const Vector<double> Kd = hessian_product(by_gradient, q, d);
  EXPECT_LT(relative_error(hessian_product(by_edges, q, d), Kd), 1e-12);
  Vector<double> y = d;
  const auto expect_tangents = [&](const auto& term) {
    softsim::System system(mesh, term);
    softsim::AssembledTangent<decltype(system)> assembled;
    softsim::MatrixFreeTangent<decltype(system)> matrix_free;
    assembled.set(system, q, {});
    assembled.apply(d, y);
    EXPECT_LT(relative_error(y, Kd), 1e-12);
    matrix_free.set(system, q, {});
    matrix_free.apply(d, y);
    EXPECT_LT(relative_error(y, Kd), 1e-12);
  };
  expect_tangents(by_edges);
  expect_tangents(by_gradient);
}

TEST(HemlLaws, AContinuedLawHasTheSameMeshFullOfInvertedElements) {
  expect_equal_meshes(Continued(NeoHookean::from_lame(400, 300)), 0.3, true);
  expect_equal_meshes(Continued(MooneyRivlin::from_lame(400, 300, 0.5)), 0.3, true);
}

TEST(HemlLaws, AUsersOwnLawRunsOnMeshesByBothRoutes) { expect_equal_meshes(Own(), 0.02, false); }

// Laws without an edge form take the route of F by themselves.
TEST(HemlLaws, LawsOfStretchesFibresAndPlainEnergiesFallBackToTheFiniteElement) {
  const TetrahedralMesh mesh = bodies::distorted_cube(2, 3);
  const State<double> q = bodies::random_state(mesh.points().size(), 0.02, 4);
  const auto expect_fallback = [&](const auto& law) {
    using Law = std::decay_t<decltype(law)>;
    const auto term = softsim::heml(mesh, law);
    static_assert(std::is_same_v<decltype(term), const softsim::ElasticTetrahedra<Law>>);
    EXPECT_EQ(gradient(term, q), gradient(softsim::elastic(mesh, law), q));
    EXPECT_EQ(term.energy(q), softsim::elastic(mesh, law).energy(q));
  };
  expect_fallback(OfF());
  expect_fallback(softsim::Ogden({{300, 2}, {50, -2}}, 600));
  expect_fallback(NeoHookean::from_lame(400, 300) +
                  softsim::HolzapfelGasserOgden({.k1 = 200, .k2 = 1}).along({1, 0, 0}));
}

// The paper's own pair: a Prony series on forces from edge lengths.
TEST(HemlLaws, APronySeriesOverEdgeLengthsIsThatOverTheFiniteElements) {
  const TetrahedralMesh mesh = bodies::distorted_cube(2, 3);
  const std::size_t nodes = mesh.points().size();
  const auto law = NeoHookean::from_lame(400, 300);
  const softsim::PronySeries series({{0.3, 0.02}, {0.2, 0.3}});
  auto by_edges = softsim::prony_nodes(softsim::heml(mesh, law), nodes, series);
  auto by_gradient = softsim::prony_nodes(softsim::elastic(mesh, law), nodes, series);
  const Vector<double> v = bodies::random_vector(nodes, 1, 5);
  const double dt = 0.01;
  for (std::uint64_t k = 0; k < 4; ++k) {
    const State<double> from = bodies::random_state(nodes, 0.02, k),
                        to = bodies::random_state(nodes, 0.02, k + 1);
    const auto after_a_step = [&](auto& term) {
      term.begin_step(from, v, dt);
      const Vector<double> during = gradient(term, to);
      term.end_step(to, v, dt);
      return Vector<double>(during + gradient(term, to));
    };
    EXPECT_LT(relative_error(after_a_step(by_edges), after_a_step(by_gradient)), 1e-12);
  }
}

// All nodes but those of one side thrown about until tetrahedra lie inverted: Newton's method finds the way
// back to rest.
TEST(HemlLaws, NewtonRecoversAnInvertedBodyWithAContinuedLaw) {
  const TetrahedralMesh mesh = softsim::box_mesh({3, 3, 3}, {1, 1, 1});
  const auto law = Continued(NeoHookean::from_lame(400, 300));
  const auto recovers = [&](const auto& term) {
    softsim::System system(mesh, term);
    system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::xmin, 0.0));
    State<double> q = bodies::random_state(mesh.points().size(), 0.35, 8);
    for (const std::int32_t i : softsim::nodes_near(mesh, softsim::Side::xmin, 0.0)) q.point(i).setZero();
    EXPECT_GT(inverted_tetrahedra(mesh, q), 10);
    const auto report =
        softsim::StaticSolver<decltype(system)>({.max_iterations = 200, .tolerance = 1e-9}).solve(system, q);
    EXPECT_EQ(report.status, softsim::Status::converged) << report.reason;
    EXPECT_EQ(inverted_tetrahedra(mesh, q), 0);
    EXPECT_LT(q.displacement.cwiseAbs().maxCoeff(), 1e-6);
  };
  recovers(softsim::heml(mesh, law));
  recovers(softsim::elastic(mesh, law));
}

}  // namespace heml_laws_test
