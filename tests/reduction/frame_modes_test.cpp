// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "softsim/kinematics/frame_body.hpp"
#include "softsim/kinematics/mesh_shapes.hpp"
#include "softsim/material/fibre.hpp"
#include "softsim/material/st_venant_kirchhoff.hpp"
#include "softsim/material/sum.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/mesh_samples.hpp"
#include "softsim/potential/frame_elastic.hpp"
#include "softsim/potential/rotation_tie.hpp"
#include "softsim/reduction/linearised.hpp"
#include "softsim/reduction/modes.hpp"
#include "softsim/system/system.hpp"

// Natural frequencies of a cantilever of 1 x 0.1 x 0.1 m of steel, refcases S4.6: 40 x 4 x 4 quadratic
// hexahedra of another code have bending at 81.592, 489.34 and 1288.5 Hz, each twice, torsion at 722.9 and
// axial motion at 1269.9 Hz.

namespace frame_modes_test {

using namespace softsim;
using V = Vec3<double>;

constexpr double E = 2e11, nu = 0.3, G = E / (2 + 2 * nu), density = 7800;
constexpr std::array<double, 8> reference{81.592, 81.592, 489.34, 489.34, 722.9, 1269.9, 1288.5, 1288.5};

// The lowest eight in Hz. As M x = 1/lambda K x: the mass of frames may be singular, their stiffness is not.
template <class S>
std::array<double, 8> frequencies(const S& system) {
  const FreeComponents free(system.prescribed);
  const Eigen::MatrixXd K(stiffness_matrix(system, system.rest_state(), free)), M(free.matrix(system.mass));
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(M, K, Eigen::EigenvaluesOnly);
  std::array<double, 8> f;
  for (std::size_t k = 0; k < f.size(); ++k) {
    const double inverse = solver.eigenvalues()[K.rows() - 1 - static_cast<std::ptrdiff_t>(k)];
    f[k] = 1 / (2 * std::numbers::pi * std::sqrt(inverse));
  }
  return f;
}

// n + 1 frames in a row with linear weights between them; in every gap `along` Gauss points, four of the
// section at each.
FrameBody<2> row(const FrameNodes& nodes, int along) {
  const int n = static_cast<int>(nodes.frames().size()) - 1;
  const double h = 1.0 / n, y = 0.05 / std::sqrt(3.0);
  std::vector<V> X;
  std::vector<double> volumes;
  std::vector<ShapeValues> shapes;
  for (int i = 0; i < n; ++i)
    for (const GaussPoint& point : gauss_legendre(along))
      for (int k = 0; k < 4; ++k) {
        const double t = (1 + point.x) / 2;
        X.emplace_back((i + t) * h, k % 2 ? y : -y, k / 2 ? y : -y);
        volumes.push_back(0.01 / 4 * h * point.weight / 2);
        shapes.push_back({{i, i + 1}, {1 - t, t}, {V(-1 / h, 0, 0), V(1 / h, 0, 0)}, {}, {}});
      }
  return {nodes, shapes, X, volumes};
}
FrameNodes frames_in_a_row(int n) {
  std::vector<V> X;
  for (int i = 0; i <= n; ++i) X.emplace_back(static_cast<double>(i) / n, 0, 0);
  return FrameNodes(X);
}

// Fibres that resist as a spring does: k more Young's modulus along them at small strains.
struct Springs : FibreTerm<Springs> {
  static constexpr bool depends_on_j = false;
  double k;  // Pa

  explicit Springs(double k_) : k(k_) {}
  template <class T>
  T density(const FibreInvariants<T>& i) const {
    return T(k / 8) * i.k4 * i.k4;
  }
  template <class T>
  FibreFirst<T> first(const FibreInvariants<T>& i) const {
    FibreFirst<T> w{};
    w.w4 = T(k / 4) * i.k4;
    return w;
  }
  template <class T>
  FibreSecond<T> second(const FibreInvariants<T>&) const {
    FibreSecond<T> w{};
    w.w44 = T(k / 4);
    return w;
  }
};

// Held at the first frame; of shear modulus mu and Young's modulus 2 mu + k.
auto beam(const FrameNodes& nodes, double mu, double k) {
  System system(nodes, elastic<double, 1>(row(nodes, 1),
                                          StVenantKirchhoff::from_lame(0, mu) + Springs(k).along({1, 0, 0})));
  system.prescribed.fix_frames({0});
  return system;
}

// Sections that stay rigid shear like the whole square, whose real stiffness is 5/6 G A, and twist with G Ip,
// really 0.8436 G Ip: a law with 5/6 of the shear modulus and fibres that make up for it in Young's modulus
// is right in the first and 0.6 % low in the frequency of the second. Five gaps are enough for 1 %, 20 with a
// lumped mass. Stiffness by one sample position a gap (no shear locking), mass by two.
TEST(FrameModes, ARowOfFramesVibratesLikeABeam) {
  for (const int n : {5, 20}) {
    const FrameNodes nodes = frames_in_a_row(n);
    constexpr double mu = 5.0 / 6 * G;
    auto system = beam(nodes, mu, E - 2 * mu);
    const auto within = [&](const Mass<double>& mass, const std::string& kind) {
      system.mass = mass;
      const auto f = frequencies(system);
      for (std::size_t k = 0; k < f.size(); ++k) {
        EXPECT_NEAR(f[k] / reference[k], 1, 0.01) << n << ' ' << kind << ": " << f[k];
        RecordProperty(kind + std::to_string(n) + '_' + std::to_string(k), std::to_string(f[k]));
      }
    };
    within(Mass<double>::consistent(row(nodes, 2), density), "consistent");
    if (n == 20) within(Mass<double>::lumped(row(nodes, 2), density), "lumped");
  }
}

// An isotropic law without lateral contraction has 1.3 G, for a beam of Timoshenko's with G A and G Ip.
TEST(FrameModes, WithoutLateralContractionABeamShearsAndTwistsTooLittle) {
  const FrameNodes nodes = frames_in_a_row(10);
  auto system = beam(nodes, E / 2, 0);
  system.mass = Mass<double>::consistent(row(nodes, 2), density);
  const auto f = frequencies(system);
  // Torsion and axial motion: quarter waves of sqrt(G/rho) and sqrt(E/rho), 0.1 % high with ten elements
  EXPECT_NEAR(f[4] / (std::sqrt(E / 2 / density) / 4), 1, 2e-3);
  EXPECT_NEAR(f[5] / (std::sqrt(E / density) / 4), 1, 2e-3);
  EXPECT_NEAR(f[0] / reference[0], 1, 0.005);
  EXPECT_NEAR(f[2] / reference[2], 1, 0.02);
}

// A frame that translates does not rotate.
TEST(FrameModes, ATranslationHasTheMassOfTheBody) {
  const FrameNodes nodes = frames_in_a_row(3);
  const auto mass = Mass<double>::consistent(row(nodes, 2), density);
  Eigen::MatrixXd shape = Eigen::MatrixXd::Zero(mass.diagonal().size(), 1);
  for (std::ptrdiff_t j = 0; j < 4; ++j) shape(2 * block_stride * j + 1, 0) = 1;
  const Modes modes = make_modes(mass, Eigen::VectorXd::Zero(1), shape, 0);
  EXPECT_NEAR(effective_masses(mass, modes)(0, 1), 78, 1e-12 * 78);
}

// Frames on the nodes of hexahedra, n along and m across.
struct Block {
  MeshShapes<HexahedralMesh> shapes;
  ElementSamples samples;
  FrameNodes nodes;
  FrameBody<8> body;
  std::vector<std::int32_t> clamped;

  Block(int n, int m)
      : shapes(box_hexahedra({n, m, m}, {1, 0.1, 0.1})),
        samples(gauss_samples(shapes.mesh(), ElementRule::mass)),
        nodes(shapes.nodes()),
        body(nodes, shapes, samples.positions, samples.volumes) {
    for (std::size_t j = 0; j < nodes.frames().size(); ++j)
      if (nodes.frames()[j][0] == 0) clamped.push_back(static_cast<std::int32_t>(j));
  }
};

// What moves no point of the body has neither stiffness nor mass: here turns of all frames of one section,
// each in its place, about the axis. The tie gives them stiffness, their frequency is infinite, and those of
// the others rise: frequencies by half of what stiffness does, by at most 3/2 gamma/E (h/t)^2 with h/t = 1.25
// here.
TEST(FrameModes, TheTieMakesShapeFunctionsOfAMeshFit) {
  const int n = 8;
  const Block block(n, 1);
  const auto tied = [&](double gamma) {
    System system(block.nodes, elastic<double, 1>(block.body, StVenantKirchhoff::from_young_poisson(E, nu)),
                  rotation_tie<double, 1>(block.body, gamma * E));
    system.prescribed.fix_frames(block.clamped);
    system.mass = Mass<double>::consistent(block.body, density);
    return system;
  };
  const auto bare = tied(1e-100);  // below rounding
  const FreeComponents free(bare.prescribed);
  const Eigen::MatrixXd K(stiffness_matrix(bare, bare.rest_state(), free)), M(free.matrix(bare.mass));
  // In units in which both have a unit trace, and with the range of both as a basis.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> both(K / K.trace() + M / M.trace());
  const double largest = both.eigenvalues().tail<1>()[0];
  std::ptrdiff_t null = 0;
  while (both.eigenvalues()[null] < 1e-12 * largest) ++null;
  EXPECT_EQ(null, n);
  const Eigen::MatrixXd P = both.eigenvectors().rightCols(K.rows() - null);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> projected(
      P.transpose() * M * P, P.transpose() * K * P, Eigen::EigenvaluesOnly);

  const auto loose = frequencies(tied(1e-6)), usual = frequencies(tied(1e-3));
  for (std::size_t k = 0; k < 8; ++k) {
    const double inverse = projected.eigenvalues()[P.cols() - 1 - static_cast<std::ptrdiff_t>(k)];
    const double exact = 1 / (2 * std::numbers::pi * std::sqrt(inverse));
    EXPECT_NEAR(loose[k] / exact, 1, 1e-5) << k;
    EXPECT_NEAR(usual[k] / exact, 1, 1.5e-3 * 1.25 * 1.25) << k;
    EXPECT_GE(usual[k], exact * (1 - 1e-9)) << k;
  }
}

}  // namespace frame_modes_test
