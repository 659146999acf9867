// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <type_traits>
#include <vector>

#include "potential/bodies.hpp"
#include "softsim/integrator/static_solver.hpp"
#include "softsim/material/holzapfel_gasser_ogden.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/material/sum.hpp"
#include "softsim/mesh/selection.hpp"
#include "softsim/potential/dead_load.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/system/system.hpp"

// Laws whose data differ from element to element.

namespace fibre_field_test {

using bodies::Vec, bodies::gradient, bodies::hessian_product, bodies::refusal, bodies::relative_error;
using softsim::elastic, softsim::FibreField, softsim::HolzapfelGasserOgden, softsim::NeoHookean,
    softsim::State, softsim::TetrahedralMesh, softsim::Vector;

const NeoHookean matrix = NeoHookean::from_young_poisson(10, 0.3);
const HolzapfelGasserOgden fibres({.k1 = 20, .k2 = 2, .kappa = 0.1});
const auto tissue = matrix + fibres;
using Tissue = std::remove_const_t<decltype(tissue)>;

static_assert(softsim::MaterialField<FibreField<Tissue, 2>> && !softsim::Material<FibreField<Tissue, 2>>);
static_assert(!softsim::MaterialField<Tissue> && !softsim::MaterialField<NeoHookean>);
// a law without data costs nothing: its elements store what the kinematics stores
static_assert(std::is_same_v<softsim::Elastic<softsim::LinearTetrahedron, NeoHookean>::Data<double>,
                             softsim::LinearTetrahedron::Data<double>>);

// A stiffness that differs from element to element, as a user writes it.
struct Graded {
  template <class T>
  struct Data {
    T factor;
  };
  // w = factor/2 |F^T F - I|^2 / 4
  template <class T>
  struct Bound {
    T factor;
    T energy_density(const softsim::Mat3<T>& F) const {
      const softsim::Mat3<T> E = F.transpose() * F - softsim::Mat3<T>::Identity();
      return factor * T(0.125) * softsim::double_dot(E, E);
    }
    softsim::Mat3<T> first_piola(const softsim::Mat3<T>& F) const {
      const softsim::Mat3<T> E = F.transpose() * F - softsim::Mat3<T>::Identity();
      const T c = factor * T(0.5);
      const softsim::Mat3<T> FE = F * E;
      return c * FE;
    }
    softsim::Mat3<T> first_piola_differential(const softsim::Mat3<T>& F, const softsim::Mat3<T>& dF) const {
      const softsim::Mat3<T> E = F.transpose() * F - softsim::Mat3<T>::Identity(), M = F.transpose() * dF;
      const softsim::Mat3<T> D = dF * E + F * (M + M.transpose());
      const T c = factor * T(0.5);
      return c * D;
    }
  };
  template <class T>
  Bound<T> at(const Data<T>& data) const {
    return {data.factor};
  }
};

class FibreFields : public ::testing::Test {
 protected:
  TetrahedralMesh mesh = bodies::distorted_cube(3, 111);  // 162 tetrahedra: the last batch is not full
  std::size_t count = mesh.tetrahedra().size(), nodes = mesh.points().size();
  State<double> q = bodies::random_state(nodes, 0.04, 112);
  Vector<double> d = bodies::random_vector(nodes, 1, 113);

  // Tetrahedron e alone.
  template <class Law>
  auto tetrahedron(std::size_t e, const Law& law) const {
    using Local = softsim::Elastic<softsim::LinearTetrahedron, Law>;
    const softsim::Tetrahedron& v = mesh.tetrahedra()[e];
    std::array<Vec, 4> X;
    for (std::size_t i = 0; i < 4; ++i) X[i] = mesh.points()[static_cast<std::size_t>(v[i])];
    return softsim::Elements<Local, double, 1>({Local{law}}, {softsim::LinearTetrahedron::make(X)}, {v});
  }
  static Vec unit(bodies::Random& random) { return random.rotation().col(0); }
};

TEST_F(FibreFields, OfOneDirectionAreTheLawOfConstantDirection) {
  const Vec a = Vec(1, 1, 0.5).normalized(), b = Vec(0, 1, -2).normalized();
  const auto one = elastic(mesh, tissue, std::vector<Vec>(count, a));
  const auto one_constant = elastic(mesh, tissue.along(a));
  EXPECT_NEAR(one.energy(q) / one_constant.energy(q), 1, 1e-14);
  EXPECT_LT(relative_error(gradient(one, q), gradient(one_constant, q)), 1e-14);
  EXPECT_LT(relative_error(hessian_product(one, q, d), hessian_product(one_constant, q, d)), 1e-14);

  const auto two = elastic(mesh, tissue, std::vector<std::array<Vec, 2>>(count, {a, b}));
  const auto two_constant = elastic(mesh, tissue.along(a, b));
  EXPECT_NEAR(two.energy(q) / two_constant.energy(q), 1, 1e-14);
  EXPECT_LT(relative_error(gradient(two, q), gradient(two_constant, q)), 1e-14);
  EXPECT_LT(relative_error(hessian_product(two, q, d), hessian_product(two_constant, q, d)), 1e-14);
}

// Each tetrahedron alone, with its own direction, one at a time; in lanes, in single precision.
TEST_F(FibreFields, GiveEachTetrahedronItsOwnDirection) {
  bodies::Random random(114);
  std::vector<Vec> directions;
  for (std::size_t e = 0; e < count; ++e) directions.push_back(unit(random));
  double energy = 0;
  Vector<double> g = Vector<double>::Zero(q.size()), Kd = g;
  for (std::size_t e = 0; e < count; ++e) {
    const auto alone = tetrahedron(e, tissue.along(directions[e]));
    energy += alone.energy(q);
    alone.add_gradient(q, g);
    alone.add_hessian_product(q, d, Kd);
  }
  const auto body = elastic(mesh, tissue, directions);
  EXPECT_NEAR(body.energy(q) / energy, 1, 1e-13);
  EXPECT_LT(relative_error(gradient(body, q), g), 1e-13);
  EXPECT_LT(relative_error(hessian_product(body, q, d), Kd), 1e-13);

  State<float> single;
  single.displacement = q.displacement.cast<float>();
  const auto body_float = elastic<float>(mesh, tissue, directions);
  EXPECT_LT(relative_error(gradient(body_float, single), g), 1e-5);
}

TEST_F(FibreFields, HaveConsistentDerivatives) {
  bodies::Random random(115);
  std::vector<std::array<Vec, 2>> directions;
  for (std::size_t e = 0; e < count; ++e) directions.push_back({unit(random), unit(random)});
  const auto body = elastic(mesh, tissue, directions);
  // no fibre is within the step of its switch in all but a few tetrahedra: 1e-6 of d
  const double h = 1e-6;
  State<double> plus = q, minus = q;
  softsim::retract(plus, d, h);
  softsim::retract(minus, d, -h);
  EXPECT_NEAR((body.energy(plus) - body.energy(minus)) / (2 * h) / gradient(body, q).dot(d), 1, 1e-6);
  EXPECT_LT(relative_error(hessian_product(body, q, d),
                           ((gradient(body, plus) - gradient(body, minus)) / (2 * h)).eval()),
            1e-6);
}

TEST_F(FibreFields, AreOneKindOfElementwiseData) {
  std::vector<Graded::Data<double>> data;
  for (std::size_t e = 0; e < count; ++e) data.push_back({1 + static_cast<double>(e)});
  const auto body = elastic(mesh, Graded(), data);
  double energy = 0;
  for (std::size_t e = 0; e < count; ++e) energy += tetrahedron(e, Graded().at(data[e])).energy(q);
  EXPECT_NEAR(body.energy(q) / energy, 1, 1e-13);
  data.pop_back();
  EXPECT_EQ(refusal([&] { return elastic(mesh, Graded(), data); }),
            "elastic: 161 material data for 162 tetrahedra");
}

TEST_F(FibreFields, RefuseDirectionsByNumber) {
  std::vector<Vec> directions(count, Vec::UnitX());
  directions[17] = Vec(0.5, 0, 0);
  EXPECT_EQ(refusal([&] { return elastic(mesh, tissue, directions); }),
            "tetrahedron 17: fibre direction (0.5, 0, 0): length 0.5 must be 1");
  directions.resize(5);
  EXPECT_EQ(refusal([&] { return elastic(mesh, tissue, directions); }),
            "elastic: 5 fibre directions for 162 tetrahedra");
}

// A block pulled at its end: with fibres along the load it gives way less than with fibres across it, which
// are slack and as good as none.
TEST(FibreReinforcedBlock, IsStiffAlongItsFibres) {
  const TetrahedralMesh mesh = softsim::box_mesh({4, 2, 2}, {2, 1, 1});
  const auto elongation = [&mesh](const Vec& direction) {
    const HolzapfelGasserOgden aligned({.k1 = 20, .k2 = 2});
    softsim::System system(
        mesh, elastic(mesh, matrix + aligned, std::vector<Vec>(mesh.tetrahedra().size(), direction)),
        softsim::gravity(mesh, 1, {1, 0, 0}));
    system.prescribed.fix(softsim::nodes_near(mesh, softsim::Side::xmin, 0));
    State<double> q(mesh.points().size());
    const auto report = softsim::StaticSolver<decltype(system)>({.tolerance = 1e-8}).solve(system, q);
    EXPECT_EQ(report.status, softsim::Status::converged);
    const auto end = softsim::nodes_near(mesh, softsim::Side::xmax, 0);
    return q.point(static_cast<std::ptrdiff_t>(end.front()))[0];
  };
  const double along = elongation(Vec::UnitX()), across = elongation(Vec::UnitY());
  EXPECT_GT(along, 0);
  // Young's modulus 10 of the matrix against 10 + 4 k1 = 90
  EXPECT_GT(across, 5 * along);
}

}  // namespace fibre_field_test
