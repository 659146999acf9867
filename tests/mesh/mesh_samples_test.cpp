// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/mesh/mesh_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "refusal.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/hexahedral_mesh.hpp"
#include "softsim/mesh/quadratic_tetrahedral_mesh.hpp"

namespace mesh_samples_test {

using softsim::ElementRule, softsim::ElementSamples, softsim::equal_samples, softsim::gauss_samples;
using Vec = softsim::Vec3<double>;

using refusals::expect_refused;

/// A sheared box: elements are affine images of their reference shapes.
const softsim::Mat3<double> shear =
    (softsim::Mat3<double>() << 1, 0.3, 0.2, 0, 1.1, -0.4, 0, 0, 0.9).finished();
template <class Mesh>
Mesh sheared(const Mesh& mesh) {
  auto points = mesh.points();
  for (Vec& x : points) x = shear * x;
  return Mesh(points, mesh.elements());
}
const auto tetrahedra = sheared(softsim::box_mesh({2, 1, 3}, {1, 2, 3}));
const auto hexahedra = sheared(softsim::box_hexahedra({2, 1, 3}, {1, 2, 3}));
const softsim::QuadraticTetrahedralMesh quadratic(tetrahedra);

/// int (a . x)^degree dV over the box by its own coordinates, Simpson's rule being exact up to degree 3.
double box_integral(const Vec& a, int degree) {
  const Vec b = shear.transpose() * a;
  double sum = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) {
        const double w[] = {1.0 / 6, 4.0 / 6, 1.0 / 6};
        sum += w[i] * w[j] * w[k] * std::pow(b.dot(Vec(0.5 * i, 1.0 * j, 1.5 * k)), degree);
      }
  return sum * 6 * shear.determinant();
}

template <class Mesh>
void expect_exact(const Mesh& mesh, const ElementSamples& samples, int per_element, int degree) {
  ASSERT_EQ(samples.positions.size(), mesh.elements().size() * static_cast<std::size_t>(per_element));
  ASSERT_EQ(samples.volumes.size(), samples.positions.size());
  ASSERT_EQ(samples.elements.size(), samples.positions.size());
  EXPECT_NEAR(samples.volume(), mesh.volume(), 1e-12 * mesh.volume());
  std::vector<double> per(mesh.elements().size(), 0);
  for (std::size_t i = 0; i < samples.volumes.size(); ++i) {
    EXPECT_GT(samples.volumes[i], 0);
    per[static_cast<std::size_t>(samples.elements[i])] += samples.volumes[i];
  }
  for (std::size_t e = 0; e < per.size(); ++e) EXPECT_NEAR(per[e], mesh.volume(e), 1e-13 * mesh.volume(e));
  const Vec a(0.7, -0.4, 0.9);
  for (int d = 1; d <= 3; ++d) {
    double sum = 0;
    for (std::size_t i = 0; i < samples.volumes.size(); ++i)
      sum += samples.volumes[i] * std::pow(a.dot(samples.positions[i]), d);
    const double exact = box_integral(a, d);
    if (d <= degree) {
      EXPECT_NEAR(sum, exact, 1e-12 * std::abs(exact)) << "degree " << d << ", " << per_element;
    }
  }
}

TEST(GaussSamples, AreExactToTheDegreeOfTheirRules) {
  expect_exact(tetrahedra, gauss_samples(tetrahedra, 1), 1, 1);
  expect_exact(tetrahedra, gauss_samples(tetrahedra), 4, 2);
  expect_exact(tetrahedra, gauss_samples(tetrahedra, 14), 14, 3);
  expect_exact(hexahedra, gauss_samples(hexahedra), 8, 3);
  expect_exact(hexahedra, gauss_samples(hexahedra, ElementRule::mass), 27, 3);
  expect_exact(quadratic, gauss_samples(quadratic), 4, 2);
  expect_exact(quadratic, gauss_samples(quadratic, ElementRule::mass), 14, 3);
}

TEST(GaussSamples, CurvedSidesKeepTheVolumeOfTheElement) {
  auto points = quadratic.points();
  for (Vec& x : points) x += 0.05 * Vec(x[1] * x[1], x[2] * x[0], x[0] * x[1]);
  const softsim::QuadraticTetrahedralMesh curved(points, quadratic.elements());
  for (const ElementRule rule : {ElementRule::stiffness, ElementRule::mass})
    EXPECT_NEAR(gauss_samples(curved, rule).volume(), curved.volume(), 1e-12 * curved.volume());
  EXPECT_NEAR(equal_samples(curved, 10).volume(), curved.volume(), 1e-12 * curved.volume());
}

TEST(EqualSamples, LoseNothingAgainstGaussPointsOfDegreeTwo) {
  expect_exact(tetrahedra, equal_samples(tetrahedra, 1), 1, 1);
  for (const int n : {4, 10, 20, 35, 56}) expect_exact(tetrahedra, equal_samples(tetrahedra, n), n, 2);
  for (const int n : {4, 10, 20}) expect_exact(quadratic, equal_samples(quadratic, n), n, 2);
  expect_exact(hexahedra, equal_samples(hexahedra, 1), 1, 1);
  for (const int n : {8, 27, 64, 125}) expect_exact(hexahedra, equal_samples(hexahedra, n), n, 3);
  // four and eight of them are the Gauss points
  const auto equal = equal_samples(tetrahedra, 4), gauss = gauss_samples(tetrahedra, 4);
  for (std::size_t i = 0; i < equal.positions.size(); ++i) {
    double nearest = 1;
    for (std::size_t j = 0; j < 4; ++j)
      nearest = std::min(nearest, (equal.positions[i] - gauss.positions[i / 4 * 4 + j]).norm());
    EXPECT_LT(nearest, 1e-14);
  }
}

TEST(EqualSamples, LieInsideAndShareEqually) {
  for (const int n : {1, 4, 10, 20, 84}) {
    const auto samples = equal_samples(tetrahedra, n);
    for (std::size_t i = 0; i < samples.positions.size(); ++i) {
      const auto e = static_cast<std::size_t>(samples.elements[i]);
      EXPECT_NEAR(samples.volumes[i], tetrahedra.volume(e) / n, 1e-15);
      const auto X = tetrahedra.element_points(e);
      for (std::size_t a = 0; a < 4; ++a) {
        auto Y = X;
        Y[a] = samples.positions[i];
        EXPECT_GT(softsim::tetrahedron_volume(Y[0], Y[1], Y[2], Y[3]), 0.001 * tetrahedra.volume(e)) << n;
      }
    }
  }
  const auto box = softsim::box_hexahedra({1, 1, 1}, {1, 1, 1});
  for (const int n : {1, 8, 27, 1000})
    for (const Vec& x : equal_samples(box, n).positions)
      EXPECT_TRUE(x.minCoeff() > 0 && x.maxCoeff() < 1) << n;
}

TEST(MeshSamples, RefuseOtherNumbers) {
  expect_refused([] { (void)gauss_samples(tetrahedra, 5); },
                 "Gauss points 5: must be 1, 4 or 14 in a tetrahedron");
  expect_refused([] { (void)equal_samples(tetrahedra, 5); },
                 "per_element 5: must be a tetrahedral number such as 4 or 10");
  expect_refused([] { (void)equal_samples(tetrahedra, 0); },
                 "per_element 0: must be a tetrahedral number such as 1");
  expect_refused([] { (void)equal_samples(hexahedra, 10); },
                 "per_element 10: must be a cube such as 8 or 27");
  expect_refused([] { (void)equal_samples(quadratic, -3); },
                 "per_element -3: must be a tetrahedral number such as 1");
}

}  // namespace mesh_samples_test
