// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/potential/spring.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "potential/bodies.hpp"

namespace spring_test {

using bodies::gradient, bodies::hessian_product, bodies::refusal, bodies::relative_error, bodies::Vec;
using softsim::Edge, softsim::Local, softsim::Spring, softsim::SquaredLengthSpring, softsim::State;
using softsim::TetrahedralMesh, softsim::Vector;
using Vec6 = Eigen::Matrix<double, 6, 1>;

static_assert(softsim::LocalPotential<Spring> && softsim::LocalPotential<SquaredLengthSpring>);
static_assert(softsim::LocalPotential<Spring, softsim::Batch<float, 16>>);
static_assert(!softsim::LocalForce<softsim::SpringLink>);

const TetrahedralMesh cube = bodies::distorted_cube(2, 7);
const TetrahedralMesh one_tetrahedron({{0, 0, 0}, {1.1, 0.1, 0}, {0.2, 0.9, -0.1}, {0.1, 0.3, 1.2}},
                                      {{0, 1, 2, 3}});

template <class S>
class SpringOf : public ::testing::Test {};
struct SpringName {
  template <class S>
  static std::string GetName(int) {
    return std::is_same_v<S, Spring> ? "Hooke" : "SquaredLength";  // short: g++ 12 warns wrongly
  }
};
using Kinds = ::testing::Types<Spring, SquaredLengthSpring>;
TYPED_TEST_SUITE(SpringOf, Kinds, SpringName);

// Links stretched, compressed and turned; central differences of step cbrt(eps) are good to about 1e-10.
TYPED_TEST(SpringOf, ForceAndProductAreDerivatives) {
  const TypeParam spring;
  bodies::Random random(1);
  const auto data = Spring::make({0.1, 0.2, 0.3}, {0.8, -0.2, 0.5}, 7);
  const double h = 6e-6;
  for (int i = 0; i < 20; ++i) {
    const Local<double, 2> u{{0.5 * random.vec(), 0.5 * random.vec()}};
    Vec6 difference;
    Eigen::Matrix<double, 6, 6> K, K_difference;
    for (int a = 0; a < 6; ++a) {
      Local<double, 2> plus = u, minus = u;
      plus.points[static_cast<std::size_t>(a / 3)][a % 3] += h;
      minus.points[static_cast<std::size_t>(a / 3)][a % 3] -= h;
      difference[a] = (spring.energy(data, plus) - spring.energy(data, minus)) / (2 * h);
      K_difference.col(a) = (spring.gradient(data, plus) - spring.gradient(data, minus)) / (2 * h);
      K.col(a) = spring.hessian_product(data, u, Vec6(Vec6::Unit(a)));
    }
    EXPECT_LE((spring.gradient(data, u) - difference).norm(), 1e-8 * data.stiffness);
    EXPECT_LE((K - K_difference).norm(), 1e-7 * data.stiffness);
    EXPECT_LE((K - K.transpose()).norm(), 1e-14 * K.norm());
  }
}

TYPED_TEST(SpringOf, RigidMotionGivesNoForceAndAnyMotionBalances) {
  const auto net = softsim::springs<TypeParam>(cube, 3);
  bodies::Random random(2);
  const State<double> rigid = bodies::affine_state(cube, random.rotation(), {1, -2, 3});
  EXPECT_LT(gradient(net, rigid).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_LT(net.energy(rigid), 1e-26);

  const State<double> q = bodies::random_state(cube.points().size(), 0.2, 3);
  const Vector<double> f = gradient(net, q);
  Vec force = Vec::Zero(), moment = Vec::Zero();
  for (std::size_t i = 0; i < cube.points().size(); ++i) {
    const Vec fi = softsim::block(f, static_cast<std::ptrdiff_t>(i));
    force += fi;
    moment += bodies::position(cube, q, i).cross(fi);
  }
  EXPECT_LT(force.norm(), 1e-14 * f.norm());
  EXPECT_LT(moment.norm(), 1e-14 * f.norm());
}

TYPED_TEST(SpringOf, EnergyTakenOutOfAPathIsTheWorkOfTheForce) {
  const auto net = softsim::springs<TypeParam>(cube, 3);
  const State<double> end = bodies::random_state(cube.points().size(), 0.2, 4);
  // Simpson's rule along a straight path; the integrand is smooth
  const int n = 64;
  double work = 0;
  for (int i = 0; i <= n; ++i) {
    State<double> q = end;
    q.displacement *= static_cast<double>(i) / n;
    work += (i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2) * softsim::dot(gradient(net, q), end.displacement);
  }
  EXPECT_NEAR(work / (3 * n) / net.energy(end), 1, 1e-6);
}

TYPED_TEST(SpringOf, LanesAndSinglePrecisionAgree) {
  const State<float> q = bodies::random_state<float>(cube.points().size(), 0.1, 5);
  const Vector<double> d = bodies::random_vector(cube.points().size(), 1, 6);
  State<double> exact;
  exact.displacement = q.displacement.cast<double>();
  const auto one = softsim::springs<TypeParam, double, 1>(cube, 3);
  const auto many = softsim::springs<TypeParam>(cube, 3);
  EXPECT_EQ(many.size(), softsim::mesh_edges(cube).edges.size());
  EXPECT_NEAR(many.energy(exact) / one.energy(exact), 1, 1e-14);
  EXPECT_LT(relative_error(gradient(many, exact), gradient(one, exact)), 1e-14);
  EXPECT_LT(relative_error(hessian_product(many, exact, d), hessian_product(one, exact, d)), 1e-14);
  EXPECT_LT(relative_error(gradient(softsim::springs<TypeParam, float>(cube, 3), q), gradient(one, exact)),
            2e-6);
}

// From the difference of displacements, whatever the size of the strain: l - l0 would leave no digit here.
TYPED_TEST(SpringOf, KeepsItsDigitsAtTinyStrain) {
  const auto data = Spring::make({0.1, 0.2, 0.3}, {0.8, -0.2, 0.5}, 7);
  const Vec du(3e-13, -1e-13, 2e-13), n = data.link / data.length;
  const Local<double, 2> u{{Vec::Zero(), du}};
  const Vec f = TypeParam{}.gradient(data, u).template tail<3>();
  const Vec expected = data.stiffness * n.dot(du) * n;  // to first order; the second is 1e-12 of it
  EXPECT_LE((f - expected).norm(), 3e-12 * expected.norm());
}

TEST(Spring, HangingMassesFindTheirClosedForm) {
  // three springs and three masses in a line: spring i carries the weight below it
  const double g = 9.81, mass = 0.2;
  const std::array<double, 3> k{50, 80, 20};
  std::vector<softsim::SpringLink::Data<double>> data;
  std::vector<Edge> links;
  State<double> q(4);
  double sag = 0;
  for (int i = 0; i < 3; ++i) {
    data.push_back(Spring::make({0, 0, -1.0 * i}, {0, 0, -1.0 * (i + 1)}, k[static_cast<std::size_t>(i)]));
    links.push_back({i, i + 1});
    sag += (3 - i) * mass * g / k[static_cast<std::size_t>(i)];
    q.point(i + 1) = Vec(0, 0, -sag);
  }
  const softsim::Elements<Spring> chain({Spring{}}, data, links);
  const Vector<double> f = gradient(chain, q);
  for (int i = 1; i < 4; ++i) EXPECT_NEAR(softsim::block(f, i)[2], -mass * g, 1e-14);
  EXPECT_NEAR(softsim::block(f, 0)[2], 3 * mass * g, 1e-13);
  // a loaded spring resists sideways like a pendulum: its force over its length
  Vector<double> d = Vector<double>::Zero(q.size());
  softsim::block(d, 3)[0] = 1;
  const double length = 1 + mass * g / k[2];
  EXPECT_NEAR(softsim::block(hessian_product(chain, q, d), 3)[0], mass * g / length, 1e-13);
}

// Goulette & Chen 2015, Eqs. 36 and 41, on every corner of a tetrahedron.
TEST(Spring, OnATetrahedronIsTheDegenerateCaseOfHeml) {
  const auto net = softsim::springs(one_tetrahedron, 5);
  const State<double> q = bodies::random_state(4, 0.3, 8);
  const Vector<double> f = gradient(net, q);
  for (std::size_t i = 0; i < 4; ++i) {
    Vec expected = Vec::Zero();
    for (std::size_t j = 0; j < 4; ++j) {
      if (i == j) continue;
      const Vec v = bodies::position(one_tetrahedron, q, j) - bodies::position(one_tetrahedron, q, i);
      const double l0 = (one_tetrahedron.points()[j] - one_tetrahedron.points()[i]).norm();
      expected += 5 * (v.norm() - l0) / v.norm() * v;
    }
    EXPECT_LE((softsim::block(f, static_cast<std::ptrdiff_t>(i)) + expected).norm(), 1e-14 * f.norm());
  }
}

TEST(Spring, StaysFiniteWhereItsEndsMeet) {
  const Spring spring;
  const auto data = Spring::make({0, 0, 0}, {0, 0, 2}, 3);
  const Vec6 du = Vec6::Ones();
  for (const double gap : {1e-3, 1e-6, 1e-12, 1e-300, 0.0}) {
    const Local<double, 2> u{{Vec::Zero(), Vec(gap, 0, -2)}};
    const Vec6 f = spring.gradient(data, u);
    ASSERT_TRUE(f.allFinite() && spring.hessian_product(data, u, du).allFinite()) << gap;
    EXPECT_NEAR(spring.energy(data, u), 1.5 * (2 - gap) * (2 - gap), 1e-12);
    // k (l0 - l) pushes the ends apart until the direction is lost
    if (gap > 1e-7) {
      EXPECT_NEAR(f[3], -3 * (2 - gap), 1e-9) << gap;
    }
    if (gap == 0) {
      EXPECT_EQ(f.norm(), 0);
    }
  }
  const SquaredLengthSpring smooth;
  EXPECT_EQ(smooth.gradient(data, Local<double, 2>{{Vec::Zero(), Vec(0, 0, -2)}}).norm(), 0);
}

// In closed form along the link: f = k l (l^2 - l0^2)/(2 l0^2), lowest at l0/sqrt(3).
TEST(SquaredLengthSpring, SoftensBelowItsLimitPoint) {
  const SquaredLengthSpring spring;
  const auto data = Spring::make({0, 0, 0}, {0, 0, 2}, 3);
  const auto force = [&](double l) {
    return spring.gradient(data, Local<double, 2>{{Vec::Zero(), Vec(0, 0, l - 2)}})[5];
  };
  for (const double l : {0.5, 1.0, 2.0, 3.0}) EXPECT_NEAR(force(l), 3 * l * (l * l - 4) / 8, 1e-14);
  const double limit = 2 / std::sqrt(3.0);
  EXPECT_LT(force(limit), force(limit + 1e-3));
  EXPECT_LT(force(limit), force(limit - 1e-3));
}

TEST(VanGelderSprings, StiffnessIsVolumeOverSquaredLength) {
  const auto net = softsim::van_gelder_springs<Spring, double, 1>(one_tetrahedron, 4);
  State<double> q(4);
  q.point(1) = Vec(1e-3, 2e-3, 0);
  double expected = 0;
  for (const std::size_t j : {0u, 2u, 3u}) {
    const Vec D = one_tetrahedron.points()[1] - one_tetrahedron.points()[j];
    const double stretch = (D + q.point(1)).norm() - D.norm();
    expected += 4 * one_tetrahedron.volume() / D.squaredNorm() / 2 * stretch * stretch;
  }
  EXPECT_NEAR(net.energy(q) / expected, 1, 1e-11);
}

// Bulk modulus E/(3 (1 - 2/4)) = 2 E/3 on any mesh: every spring is stretched alike, and the energy stays
// quadratic however large the dilation.
TEST(VanGelderSprings, DilateLikePoissonsRatioOneQuarter) {
  const double E = 4, h = 0.1;
  const State<double> q = bodies::affine_state(cube, (1 + h) * bodies::Matrix::Identity(), Vec::Zero());
  EXPECT_NEAR(softsim::van_gelder_springs(cube, E).energy(q), 4.5 * (2 * E / 3) * h * h * cube.volume(),
              1e-13);
}

// The six diagonals of an icosahedron average (n . a)^4 to 1/5 whatever n, as all directions together do:
// the mean energy of a uniaxial strain is (lambda/2 + mu) h^2 V = 3/5 E h^2 V.
TEST(VanGelderSprings, StretchLikeYoungsModulusOnAverageOverDirections) {
  const double E = 4, h = 1e-6, golden = (1 + std::sqrt(5.0)) / 2;
  double mean = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    Vec a = Vec::Zero();
    a[static_cast<int>(i % 3)] = 1;
    a[static_cast<int>((i + 1) % 3)] = i < 3 ? golden : -golden;
    a.normalize();
    const bodies::Matrix A = bodies::Matrix::Identity() + h * a * a.transpose();
    mean += softsim::van_gelder_springs(cube, E).energy(bodies::affine_state(cube, A, Vec::Zero())) / 6;
  }
  EXPECT_NEAR(mean / (0.6 * E * h * h * cube.volume()), 1, 1e-5);  // first order in h
}

TEST(Spring, RefusesWhatIsNoSpring) {
  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal([] {
              return Spring::make({0, 0, 0}, {1, 0, 0}, 0);
            }),
            "spring: stiffness 0 N/m must be positive and finite");
  EXPECT_EQ(refusal([] {
              return Spring::make({0, 0, 1}, {0, 0, 1}, 2);
            }),
            "spring: rest length 0 m must be positive and finite");
  EXPECT_EQ(refusal([] {
              return Spring::make({0, 0, nan}, {0, 0, 1}, 2);
            }),
            "spring: rest length nan m must be positive and finite");
  EXPECT_EQ(refusal([] {
              return softsim::springs(one_tetrahedron, {{0, 1}, {1, 3}}, {1, -2});
            }),
            "spring between nodes 1 and 3: stiffness -2 N/m must be positive and finite");
  EXPECT_EQ(refusal([] {
              return softsim::springs(one_tetrahedron, {{0, 1}}, {1, 2});
            }),
            "springs: 2 stiffnesses for 1 edges");
  EXPECT_EQ(refusal([] {
              return softsim::springs(one_tetrahedron, {{0, 4}}, {1});
            }),
            "spring between nodes 0 and 4: out of range (the mesh has 4 nodes)");
  EXPECT_EQ(refusal([] { return softsim::van_gelder_springs(one_tetrahedron, -1); }),
            "young -1 Pa: must be positive and finite");
}

}  // namespace spring_test
