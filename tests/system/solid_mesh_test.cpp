// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "potential/bodies.hpp"
#include "potential/solid_bodies.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/potential/quadrature.hpp"
#include "softsim/system/element_fields.hpp"
#include "softsim/system/mass.hpp"
#include "softsim/system/supports.hpp"
#include "softsim/system/system.hpp"

// What a system makes of hexahedra and ten-node tetrahedra: mass, supports, element fields.

namespace solid_mesh_test {

using bodies::Matrix, bodies::Vec;
using softsim::Mass, softsim::State, softsim::Vector, softsim::block;

template <class Mesh>
class SolidMeshSystem : public ::testing::Test {
 protected:
  Mesh body = solid_bodies::distorted<Mesh>(2, 1, 0);
};
using Meshes = ::testing::Types<softsim::HexahedralMesh, softsim::QuadraticTetrahedralMesh>;
TYPED_TEST_SUITE(SolidMeshSystem, Meshes);

// int u.v dV of u = (x, y, z) and v = (y, z, x) on the unit cube is 3/4, of u with itself 1; lumping misses
// that but has the same total.
TYPED_TEST(SolidMeshSystem, MassIsThatOfTheBody) {
  const auto consistent = Mass<double>::consistent(this->body, 1000),
             lumped = Mass<double>::lumped(this->body, 1000);
  EXPECT_NEAR(consistent.total(), 1000, 1e-10);
  EXPECT_NEAR(lumped.total(), 1000, 1e-10);
  EXPECT_TRUE(lumped.is_lumped());
  for (std::size_t i = 0; i < this->body.points().size(); ++i)
    EXPECT_GT(lumped.diagonal()[static_cast<std::ptrdiff_t>(4 * i)], 0);
  Vector<double> u = Vector<double>::Zero(lumped.diagonal().size()), v = u, Mu = u;
  for (std::size_t i = 0; i < this->body.points().size(); ++i) {
    const Vec x = this->body.points()[i];
    block(u, static_cast<std::ptrdiff_t>(i)) = x;
    block(v, static_cast<std::ptrdiff_t>(i)) = Vec(x[1], x[2], x[0]);
  }
  consistent.add_product(u, 1, Mu);
  EXPECT_NEAR(u.dot(Mu), 1000, 1e-10);
  EXPECT_NEAR(v.dot(Mu), 750, 1e-10);
  const std::vector<double> one_density{1};
  EXPECT_NE(bodies::refusal([&] {
              return Mass<double>::lumped(this->body, one_density);
            }).find("mass: 1 densities for "),
            std::string::npos);
}

TYPED_TEST(SolidMeshSystem, SupportsAreAskedFor) {
  softsim::System system(this->body,
                         softsim::elastic(this->body, softsim::NeoHookean::from_young_poisson(10, 0.3)));
  system.prescribed.fix({0, 1});
  EXPECT_NE(bodies::refusal([&] {
              softsim::require_supports(system);
              return 0;
            }).find("is free to move: 2 of its nodes are held"),
            std::string::npos);
  system.prescribed.fix({3});
  EXPECT_NO_THROW(softsim::require_supports(system));
}

TYPED_TEST(SolidMeshSystem, FieldsOfAHomogeneousStateAreThoseOfTheLaw) {
  const auto law = softsim::NeoHookean::from_young_poisson(7e6, 0.3);
  const Matrix F = Vec(1, 1.1, 1).asDiagonal();
  const auto q = solid_bodies::affine_state(this->body, F, Vec(1, 2, 3));
  const auto fields = softsim::element_fields(this->body, std::vector{law}, {}, q);
  ASSERT_EQ(fields.size(), this->body.elements().size());
  for (const softsim::ElementField& field : fields) {
    EXPECT_NEAR(field.j, 1.1, 1e-13);
    EXPECT_NEAR(field.principal[0], 863901.0097711232, 1e-6);
    EXPECT_NEAR(field.principal[2], 349914.99578510894, 1e-6);
    EXPECT_NEAR(field.von_mises, 863901.0097711232 - 349914.99578510894, 1e-6);
    EXPECT_NEAR(field.energy_density / law.energy_density(F), 1, 1e-12);
  }
}

// J is the ratio of volumes, exactly for hexahedra.
TEST(SolidFields, JOfAHexahedronIsItsVolumeRatio) {
  const auto rest = softsim::box_hexahedra({2, 2, 2}, {1, 1, 1});
  const auto moved = solid_bodies::distorted<softsim::HexahedralMesh>(2, 3, 0);
  State<double> q(rest.points().size());
  for (std::size_t i = 0; i < rest.points().size(); ++i)
    q.point(static_cast<std::ptrdiff_t>(i)) = moved.points()[i] - rest.points()[i];
  const auto fields =
      softsim::element_fields(rest, std::vector{softsim::NeoHookean::from_young_poisson(10, 0.3)}, {}, q);
  for (std::size_t e = 0; e < fields.size(); ++e)
    EXPECT_NEAR(fields[e].j, moved.volume(e) / rest.volume(e), 1e-14);
}

}  // namespace solid_mesh_test
