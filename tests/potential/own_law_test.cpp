// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "potential/bodies.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/material/energy_law.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/system/system.hpp"

// A law that a user writes in ten lines, on tetrahedra up to Newton's method.

namespace own_law_test {

struct OfF : softsim::EnergyLaw<OfF> {
  double lambda = 400, mu = 300;

  template <class T>
  T energy_density(const softsim::Mat3<T>& F) const {
    using std::log;
    const T log_j = log(F.determinant());
    return T(mu / 2) * (F.squaredNorm() - T(3)) - T(mu) * log_j + T(lambda / 2) * log_j * log_j;
  }
};

struct OfInvariants : softsim::IsotropicEnergyLaw<OfInvariants> {
  double lambda = 400, mu = 300;

  template <class T>
  T density(const softsim::Invariants<T>& i) const {
    using std::log;
    const T log_j = log(i.j);
    return T(mu / 2) * (i.i1 - T(3)) - T(mu) * log_j + T(lambda / 2) * log_j * log_j;
  }
};

template <class Law>
class OwnLawBody : public ::testing::Test {
 protected:
  softsim::TetrahedralMesh mesh = softsim::box_mesh({4, 2, 2}, {2, 1, 1});
  Law law;
  softsim::NeoHookean by_hand = softsim::NeoHookean::from_lame(law.lambda, law.mu);
};
using Styles = ::testing::Types<OfF, OfInvariants>;
TYPED_TEST_SUITE(OwnLawBody, Styles);

TYPED_TEST(OwnLawBody, IsConsistentAndEqualsTheOneDerivedByHand) {
  const auto own = softsim::elastic(this->mesh, this->law);
  const auto reference = softsim::elastic(this->mesh, this->by_hand);
  const std::size_t nodes = this->mesh.points().size();
  const softsim::State<double> q = bodies::random_state(nodes, 0.05, 81);
  const softsim::Vector<double> d = bodies::random_vector(nodes, 1, 82);
  const softsim::Vector<double> g = bodies::gradient(own, q), Kd = bodies::hessian_product(own, q, d);

  softsim::State<double> plus = q, minus = q;
  const double h = 1e-5;  // truncation and rounding both about 1e-9 of the value
  softsim::retract(plus, d, h);
  softsim::retract(minus, d, -h);
  EXPECT_NEAR((own.energy(plus) - own.energy(minus)) / (2 * h) / g.dot(d), 1, 1e-7);
  EXPECT_LT(bodies::relative_error(
                Kd, ((bodies::gradient(own, plus) - bodies::gradient(own, minus)) / (2 * h)).eval()),
            1e-7);

  EXPECT_NEAR(own.energy(q) / reference.energy(q), 1, 1e-13);
  EXPECT_LT(bodies::relative_error(g, bodies::gradient(reference, q)), 1e-13);
  EXPECT_LT(bodies::relative_error(Kd, bodies::hessian_product(reference, q, d)), 1e-13);
}

TYPED_TEST(OwnLawBody, BendsUnderItsWeightAsTheOneDerivedByHand) {
  softsim::System system(this->mesh, softsim::elastic(this->mesh, this->law),
                         softsim::gravity(this->mesh, 1, {0, 0, -20}));
  system.prescribed.fix(softsim::nodes_near(this->mesh, softsim::Side::xmin, 0));
  softsim::State<double> q(this->mesh.points().size());
  const auto report = softsim::StaticSolver<decltype(system)>({.tolerance = 1e-10}).solve(system, q);
  EXPECT_EQ(report.status, softsim::Status::converged);
  EXPECT_GT(q.displacement.cwiseAbs().maxCoeff(), 0.1);
  // the other law's forces balance the weight there
  softsim::Vector<double> load = std::get<1>(system.terms).force();
  softsim::Vector<double> g = bodies::gradient(softsim::elastic(this->mesh, this->by_hand), q) - load;
  system.prescribed.mask(g);
  system.prescribed.mask(load);
  EXPECT_LT(g.norm(), 1e-9 * load.norm());
}

}  // namespace own_law_test
