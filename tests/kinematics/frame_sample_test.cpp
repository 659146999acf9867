// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/kinematics/frame_sample.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "kinematics/frame_reference.hpp"
#include "refusal.hpp"
#include "softsim/core/rotation.hpp"
#include "softsim/kinematics/frame_matrices.hpp"
#include "softsim/material/mooney_rivlin.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/potential/elastic.hpp"

namespace frame_sample_test {

using namespace softsim;
using V = Vec3<double>;
using M = Mat3<double>;

static_assert(Kinematics<FrameSample<4>>);
static_assert(NonlinearKinematics<FrameSample<4>>);
static_assert(NonlinearKinematics<FrameSample<8>, Batch<double, 4>>);
static_assert(!NonlinearKinematics<LinearTetrahedron>);
static_assert(LocalPotential<Elastic<FrameSample<4>, NeoHookean>, Batch<float, 8>>);

template <int N>
typename FrameSample<N>::template Data<double> data_of(const frame_reference::Case& c) {
  std::array<V, N> X, g;
  std::array<double, N> w;
  for (std::size_t i = 0; i < N; ++i) {
    X[i] = c.frames[i].rest;
    g[i] = c.frames[i].gradient;
    w[i] = c.frames[i].weight;
  }
  return FrameSample<N>::make(c.rest, X, w, g, c.volume);
}
template <int N>
Local<double, 0, N> values_of(const frame_reference::Case& c) {
  Local<double, 0, N> u;
  for (std::size_t i = 0; i < N; ++i) {
    const auto& f = c.frames[i];
    u.frames[i].displacement = f.position - f.rest;
    u.frames[i].turn = f.axes * f.rest_axes.transpose() - M::Identity();
  }
  return u;
}

template <int N>
void meets(const frame_reference::Case& c) {
  const auto data = data_of<N>(c);
  const auto u = values_of<N>(c);
  const M F = FrameSample<N>::deformation_gradient(data, u);
  EXPECT_LT((F - c.F).norm(), 1e-12 * c.F.norm());
  const Elastic<FrameSample<N>, StVenantKirchhoff> elastic{StVenantKirchhoff::from_lame(400, 300)};
  EXPECT_NEAR(elastic.energy(data, u), c.energy, 1e-11 * c.energy);
  const auto f = elastic.gradient(data, u);
  double scale = 0;
  for (const auto& frame : c.frames) scale = std::max(scale, frame.force.norm());
  for (std::size_t i = 0; i < N; ++i) {
    const auto& frame = c.frames[i];
    const auto at = static_cast<int>(6 * i);
    EXPECT_LT((-f.template segment<3>(at) - frame.force).norm(), 1e-9 * scale);
    const V torque = -f.template segment<3>(at + 3);  // in axes parallel to those of space at rest
    EXPECT_LT((frame.rest_axes.transpose() * torque - frame.torque_body).norm(), 1e-9 * scale);
    const M Q = u.frames[i].turn + M::Identity();
    EXPECT_LT((Q * torque - frame.torque_world).norm(), 1e-9 * scale);
  }
}

TEST(FrameSample, MeetsIndependentNumbersOfTwoFrames) { meets<2>(frame_reference::two_frames()); }
TEST(FrameSample, MeetsIndependentNumbersOfEightFramesAtVeryLargeStrain) {
  meets<8>(frame_reference::eight_frames());
}

struct Random {
  std::mt19937 engine{7};
  double operator()(double a = -1, double b = 1) {
    return a + (b - a) * static_cast<double>(engine()) / 4294967296.0;
  }
  V vector(double size = 1) { return {size * (*this)(), size * (*this)(), size * (*this)()}; }
};

// A general blend with large random rotations, far from equilibrium.
template <int N>
struct Sample {
  typename FrameSample<N>::template Data<double> data;
  std::array<V, N> displacement, rotation;  // rotation vectors

  explicit Sample(Random& random) {
    std::array<V, N> X, g;
    std::array<double, N> w;
    double sum = 0;
    V mean = V::Zero();
    for (std::size_t i = 0; i < N; ++i) {
      X[i] = random.vector();
      w[i] = random(0.1, 1);
      g[i] = random.vector();
      sum += w[i];
      mean += g[i] / N;
      displacement[i] = random.vector(0.2);
      rotation[i] = random.vector(3);
    }
    for (std::size_t i = 0; i < N; ++i) {
      w[i] /= sum;
      g[i] -= mean;
    }
    data = FrameSample<N>::make(random.vector(0.3), X, w, g, 0.25);
  }
  // After the increment s d, rotations from the side of the body.
  template <class T>
  Local<T, 0, N> at(const Eigen::Matrix<double, 6 * N, 1>& d, double s) const {
    Local<T, 0, N> u;
    for (std::size_t i = 0; i < N; ++i) {
      const auto k = static_cast<int>(6 * i);
      const V x = displacement[i] + s * d.template segment<3>(k);
      const M R =
          rotation_exponential(rotation[i]) * rotation_exponential(V(s * d.template segment<3>(k + 3)));
      u.frames[i].displacement = x;
      u.frames[i].turn = R - M::Identity();
    }
    return u;
  }
};

template <int N>
void matches_differences() {
  Random random;
  for (int trial = 0; trial < 5; ++trial) {
    const Sample<N> s(random);
    using Direction = Eigen::Matrix<double, 6 * N, 1>;
    Direction d = Direction::NullaryExpr([&] { return random(); });
    const auto u = s.template at<double>(d, 0);
    const M F = FrameSample<N>::deformation_gradient(s.data, u);
    const double h = 1e-5;
    const auto F_at = [&](double t) {
      return FrameSample<N>::deformation_gradient(s.data, s.template at<double>(d, t));
    };
    const auto strain_at = [&](double t) {
      const M G = F_at(t);
      return strain_to_voigt<double>(0.5 * (G.transpose() * G - M::Identity()));
    };
    Eigen::Matrix<double, 9, 1> dF = Eigen::Matrix<double, 9, 1>::Zero();
    Vec6<double> dL = Vec6<double>::Zero();
    for (std::size_t i = 0; i < N; ++i) {
      const auto B = deformation_gradient_matrix<N>(s.data, u, i);
      const auto part = d.template segment<6>(static_cast<int>(6 * i));
      dF += B * part;
      dL += green_strain_matrix(B, F) * part;
    }
    const M difference = (F_at(h) - F_at(-h)) / (2 * h);
    const M exact = Eigen::Map<const M>(dF.data());
    EXPECT_LT((exact - difference).norm(), 1e-8 * exact.norm());
    const M direct = FrameSample<N>::deformation_gradient_differential(s.data, u, d);
    EXPECT_LT((exact - direct).norm(), 1e-13 * exact.norm());
    const Vec6<double> strain_difference = (strain_at(h) - strain_at(-h)) / (2 * h);
    EXPECT_LT((dL - strain_difference).norm(), 1e-7 * dL.norm());
  }
}

TEST(FrameSample, MatricesOfTheThesisMatchDifferences) {
  matches_differences<2>();
  matches_differences<4>();
  matches_differences<8>();
}

// The gradient by the route of the second Piola-Kirchhoff stress, v M^T {S} (Eq. 3.52 without its sign).
TEST(FrameSample, BothStressRoutesAgree) {
  Random random;
  const Sample<4> s(random);
  Eigen::Matrix<double, 24, 1> d = Eigen::Matrix<double, 24, 1>::Zero();
  const auto u = s.at<double>(d, 0);
  const M F = FrameSample<4>::deformation_gradient(s.data, u);
  const auto check = [&](const auto& law) {
    const Elastic<FrameSample<4>, std::decay_t<decltype(law)>> elastic{law};
    const auto f = elastic.gradient(s.data, u);
    const Vec6<double> S = stress_to_voigt<double>(law.second_piola(F));
    for (std::size_t i = 0; i < 4; ++i) {
      const auto Mi = green_strain_matrix(deformation_gradient_matrix<4>(s.data, u, i), F);
      const Vec6<double> fi = s.data.volume * Mi.transpose() * S;
      EXPECT_LT((fi - f.template segment<6>(static_cast<int>(6 * i))).norm(), 1e-12 * f.norm());
    }
  };
  check(StVenantKirchhoff::from_young_poisson(10, 0.3));
  check(MooneyRivlin::from_young_poisson(10, 0.3, 0.2));
}

template <int N, class Law>
void derives_from_its_energy(const Law& law) {
  Random random;
  const Elastic<FrameSample<N>, Law> elastic{law};
  using Direction = Eigen::Matrix<double, 6 * N, 1>;
  for (int trial = 0; trial < 5; ++trial) {
    const Sample<N> s(random);
    const Direction d = Direction::NullaryExpr([&] { return random(); });
    const auto u = s.template at<double>(d, 0);
    const auto energy = [&](double t) { return elastic.energy(s.data, s.template at<double>(d, t)); };
    const Direction f = elastic.gradient(s.data, u), Hd = elastic.hessian_product(s.data, u, d);
    const double h = 1e-4;
    const double slope = (8 * (energy(h) - energy(-h)) - (energy(2 * h) - energy(-2 * h))) / (12 * h);
    EXPECT_NEAR(f.dot(d), slope, 1e-6 * (std::abs(slope) + f.norm()));
    const double curvature =
        (-energy(2 * h) + 16 * energy(h) - 30 * energy(0) + 16 * energy(-h) - energy(-2 * h)) / (12 * h * h);
    EXPECT_NEAR(d.dot(Hd), curvature, 1e-6 * (std::abs(curvature) + Hd.norm()));
    // The derivative of the gradient, in axes that turn with the bodies: the product less r x m / 2 for a
    // moment m in the gradient.
    const Direction difference = (elastic.gradient(s.data, s.template at<double>(d, h / 10)) -
                                  elastic.gradient(s.data, s.template at<double>(d, -h / 10))) /
                                 (h / 5);
    Direction expected = Hd;
    for (int i = 0; i < N; ++i) {
      const V r = d.template segment<3>(6 * i + 3), m = f.template segment<3>(6 * i + 3);
      expected.template segment<3>(6 * i + 3) -= 0.5 * r.cross(m);
    }
    EXPECT_LT((expected - difference).norm(), 1e-6 * difference.norm());
    // Symmetry.
    const Direction e = Direction::NullaryExpr([&] { return random(); });
    const Direction He = elastic.hessian_product(s.data, u, e);
    EXPECT_NEAR(e.dot(Hd), d.dot(He), 1e-12 * Hd.norm() * e.norm());
  }
}

TEST(FrameSample, ForcesAndTangentsDeriveFromTheEnergy) {
  derives_from_its_energy<2>(StVenantKirchhoff::from_lame(400, 300));
  derives_from_its_energy<4>(StVenantKirchhoff::from_lame(400, 300));
  derives_from_its_energy<8>(StVenantKirchhoff::from_lame(400, 300));
}

TEST(FrameSample, BatchesOfSamplesGiveTheSameNumbers) {
  using B = Batch<double, 4>;
  const Elastic<FrameSample<4>, StVenantKirchhoff> elastic{StVenantKirchhoff::from_lame(400, 300)};
  Random random;
  FrameSample<4>::Data<B> data;
  Local<B, 0, 4> u;
  Eigen::Matrix<B, 24, 1> d;
  std::vector<Eigen::Matrix<double, 24, 1>> f, Hd;
  for (int l = 0; l < 4; ++l) {
    const Sample<4> s(random);
    const Eigen::Matrix<double, 24, 1> direction =
        Eigen::Matrix<double, 24, 1>::NullaryExpr([&] { return random(); });
    const auto ul = s.at<double>(direction, 0);
    f.push_back(elastic.gradient(s.data, ul));
    Hd.push_back(elastic.hessian_product(s.data, ul, direction));
    set_lane(data.volume, l, s.data.volume);
    for (std::size_t i = 0; i < 4; ++i)
      for (int k = 0; k < 9; ++k) {
        set_lane(data.lever[i](k), l, s.data.lever[i](k));
        set_lane(u.frames[i].turn(k), l, ul.frames[i].turn(k));
        if (k >= 3) continue;
        set_lane(data.gradient[i][k], l, s.data.gradient[i][k]);
        set_lane(u.frames[i].displacement[k], l, ul.frames[i].displacement[k]);
      }
    for (int k = 0; k < 24; ++k) set_lane(d[k], l, direction[k]);
  }
  const Eigen::Matrix<B, 24, 1> fb = elastic.gradient(data, u), Hb = elastic.hessian_product(data, u, d);
  for (int l = 0; l < 4; ++l)
    for (int k = 0; k < 24; ++k) {
      const auto i = static_cast<std::size_t>(l);
      EXPECT_NEAR(lane(fb[k], l), f[i][k], 1e-13 * f[i].norm());
      EXPECT_NEAR(lane(Hb[k], l), Hd[i][k], 1e-13 * Hd[i].norm());
    }
}

TEST(FrameSample, RigidMotionsOfAllFramesDoNotStrain) {
  Random random;
  const Elastic<FrameSample<8>, StVenantKirchhoff> elastic{StVenantKirchhoff::from_lame(400, 300)};
  for (int trial = 0; trial < 1000; ++trial) {
    const V r = random.vector(3), t = random.vector(10);
    const M R = rotation_exponential(r);
    std::array<V, 8> X, g;
    std::array<double, 8> w;
    V mean = V::Zero();
    double sum = 0;
    for (std::size_t i = 0; i < 8; ++i) {
      X[i] = random.vector();
      g[i] = random.vector();
      w[i] = random(0.1, 1);
      mean += g[i] / 8;
      sum += w[i];
    }
    for (std::size_t i = 0; i < 8; ++i) {
      g[i] -= mean;
      w[i] /= sum;
    }
    const auto data = FrameSample<8>::make(random.vector(), X, w, g, 1);
    Local<double, 0, 8> u;
    for (std::size_t i = 0; i < 8; ++i) {
      u.frames[i].displacement = R * X[i] + t - X[i];
      u.frames[i].turn = R - M::Identity();
    }
    const M F = FrameSample<8>::deformation_gradient(data, u);
    EXPECT_LT((F - R).norm(), 1e-13 * 10 * 8);
    EXPECT_LT(elastic.gradient(data, u).norm(), 1e-8);
  }
}

// Two frames on a line, linear weights, turned against each other by theta about the line: what lies between
// them off the line is drawn towards it, at the middle by cos(theta/2), and vanishes at half a turn.
TEST(FrameSample, ATwistBetweenTwoFramesShrinksTheSection) {
  const std::array<V, 2> X = {V::Zero(), V(1, 0, 0)};
  const auto data = FrameSample<2>::make(V(0.5, 0, 0), X, {0.5, 0.5}, {V(-1, 0, 0), V(1, 0, 0)}, 1);
  const double pi = std::acos(-1.0);
  for (const double theta : {0.1, 20 * pi / 180, 1.0, pi / 2, 3.0, pi}) {
    Local<double, 0, 2> u;
    for (std::size_t i = 0; i < 2; ++i) {
      u.frames[i].displacement.setZero();
      u.frames[i].turn = rotation_exponential(V((i == 0 ? -0.5 : 0.5) * theta, 0, 0)) - M::Identity();
    }
    const M F = FrameSample<2>::deformation_gradient(data, u);
    const double c = std::cos(theta / 2);
    EXPECT_NEAR((F * V(0, 1, 0)).norm(), c, 1e-14);
    EXPECT_NEAR(F.determinant(), c * c, 1e-14);
  }
  // Ten frames over half a turn: 20 degrees a gap (Bosman 2015, Fig. 4.11).
  EXPECT_NEAR(std::pow(std::cos(pi / 18), 2), 0.96985, 1e-5);
}

TEST(FrameSample, RefusesWhatIsNoBlend) {
  const std::array<V, 2> X = {V::Zero(), V(1, 0, 0)};
  const V x(0.5, 0, 0);
  const std::array<V, 2> g = {V(-1, 0, 0), V(1, 0, 0)};
  EXPECT_EQ(refusals::refusal([&] {
              (void)FrameSample<2>::make(x, X, {0.5, 0.6}, g, 1);
            }),
            "weights sum to 1.1, they have to sum to 1");
  EXPECT_EQ(refusals::refusal([&] {
              (void)FrameSample<2>::make(x, X, {0.5, 0.5}, {g[1], g[1]}, 1);
            }),
            "gradients of the weights sum to 2 1/m, they have to sum to 0");
  EXPECT_EQ(refusals::refusal([&] {
              (void)FrameSample<2>::make(x, X, {0.5, 0.5}, g, -1);
            }),
            "volume -1 m^3 is not positive and finite");
  const std::array<M, 2> lever = {M::Identity(), M::Identity()};
  EXPECT_EQ(refusals::refusal([&] { (void)FrameSample<2>::make(X, g, lever, 1); }),
            "F at rest is off the identity by 2.44948974");
  EXPECT_NE(refusals::refusal([&] { (void)FrameSample<2>::make(x, X, {NAN, 0.5}, g, 1); }), "");
}

}  // namespace frame_sample_test
