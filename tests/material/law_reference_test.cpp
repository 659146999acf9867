// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "material/law_checks.hpp"
#include "material/tetrahedron_reference.hpp"

// The laws against formulas and numbers that were found another way: closed forms, derivatives with respect
// to the principal stretches, values of other programs, single elements in 50 digits.

namespace law_reference_test {

using namespace law_checks;
using softsim::NeoHookean;
using softsim::StableNeoHookean;
using softsim::StVenantKirchhoff;
using Stretches = Vec3<double>;

// ---------------------------------------------------------------- principal stretches

// psi and dpsi/dl_i as functions of the (signed) principal stretches l.
struct Principal {
  double energy;
  Stretches stress;
};

Principal principal(const StVenantKirchhoff& law, const Stretches& l) {
  const Stretches e = 0.5 * (l.array().square() - 1);
  const double t = e.sum();
  return {law.lambda() / 2 * t * t + law.mu() * e.squaredNorm(),
          (l.array() * (law.lambda() * t + 2 * law.mu() * e.array())).matrix()};
}

Principal principal(const NeoHookean& law, const Stretches& l) {
  const Stretches log = l.array().log();
  const double t = log.sum();
  return {law.mu() * (0.5 * (l.squaredNorm() - 3) - t) + law.lambda() / 2 * t * t,
          (law.mu() * (l.array() - 1 / l.array()) + law.lambda() * t / l.array()).matrix()};
}

Principal principal(const StableNeoHookean& law, const Stretches& l) {
  const double J = l.prod(), slope = (law.lambda() + law.mu()) * (J - 1) - law.mu();
  const Stretches others(l[1] * l[2], l[2] * l[0], l[0] * l[1]);
  return {law.mu() / 2 * (l.squaredNorm() - 3) - law.mu() * (J - 1) +
              (law.lambda() + law.mu()) / 2 * (J - 1) * (J - 1),
          law.mu() * l + slope * others};
}

template <class Law>
class PrincipalStretches : public ::testing::Test {};
TYPED_TEST_SUITE(PrincipalStretches, ObjectiveLaws, LawName);

TYPED_TEST(PrincipalStretches, GiveTheSameEnergyAndStress) {
  Random random(31);
  for (const Moduli& m : moduli) {
    const auto law = TypeParam::from_young_poisson(m.young, m.poisson);
    const double modulus = law.mu() + std::abs(law.lambda());
    for (int n = 0; n < 100; ++n) {
      const Deformation d = std::is_same_v<TypeParam, NeoHookean> ? random.regular(5) : random.any_sign(5);
      const Principal expected = principal(law, d.stretches);
      const Matrix P = d.U * expected.stress.asDiagonal() * d.V.transpose();
      // det F of the assembled F is good to a few eps |F|^3 <= 100 eps
      EXPECT_NEAR(law.energy_density(d.F), expected.energy, 1e-12 * std::max(expected.energy, modulus));
      EXPECT_LE((law.first_piola(d.F) - P).norm(), 1e-12 * std::max(P.norm(), modulus)) << "F =\n" << d.F;
    }
  }
}

// ---------------------------------------------------------------- homogeneous states

template <class Law>
Law soft() {
  return Law::from_young_poisson(10, 0.3);
}

Matrix diagonal(double a, double b, double c) { return Stretches(a, b, c).asDiagonal(); }

template <class Law>
Matrix cauchy(const Law& law, const Matrix& F) {
  return law.first_piola(F) * F.transpose() / F.determinant();
}

// Lateral stretch l > 0 of F = diag(s, l, l) or, with `sheet`, of diag(s, s, l), at which the stress across
// it vanishes; Newton's method on the law itself from the guess l.
template <class Law>
double free_stretch(const Law& law, double s, bool sheet, double l) {
  for (int iteration = 0; iteration < 50; ++iteration) {
    const Matrix F = diagonal(s, sheet ? s : l, l), D = diagonal(0, sheet ? 0 : 1, 1);
    const Matrix P = law.first_piola(F), dP = law.first_piola_differential(F, D);
    l -= P(2, 2) / dP(2, 2);
  }
  return l;
}

// Only the diagonal, and of it only the loaded directions, carry stress.
void expect_loaded(const Matrix& P, double axial, double second, double tolerance) {
  EXPECT_LE((P - diagonal(axial, second, 0)).cwiseAbs().maxCoeff(), tolerance) << "P =\n" << P;
}

TEST(StVenantKirchhoffClosedForm, UniaxialTension) {
  const auto law = soft<StVenantKirchhoff>();
  struct Row {
    double s, P;
  };
  for (const Row& row :
       {Row{0.5, -1.875}, {0.7, -1.785}, {0.9, -0.855}, {1.1, 1.155}, {1.25, 3.515625}, {1.5, 9.375}}) {
    const double s = row.s, l = std::sqrt(1 - 0.3 * (s * s - 1));
    EXPECT_NEAR(free_stretch(law, s, false, 1), l, 1e-9);
    expect_loaded(law.first_piola(diagonal(s, l, l)), row.P, 0, 1e-9);
    EXPECT_NEAR(5 * (s * s * s - s), row.P, 1e-9);
    // E/2 E11^2
    EXPECT_NEAR(law.energy_density(diagonal(s, l, l)), 10. / 8 * (s * s - 1) * (s * s - 1), 1e-12);
  }
}

TEST(StVenantKirchhoffClosedForm, SoftensInCompressionBelowOneOverRootThree) {
  const auto law = soft<StVenantKirchhoff>();
  const auto P11 = [&](double s) {
    const double l = free_stretch(law, s, false, 1);
    return law.first_piola(diagonal(s, l, l))(0, 0);
  };
  const double s = 1 / std::sqrt(3.0);
  EXPECT_LT(P11(s), P11(s - 1e-3));
  EXPECT_LT(P11(s), P11(s + 1e-3));
}

TEST(StVenantKirchhoffClosedForm, CauchyStressOfSimpleShear) {
  const auto law = soft<StVenantKirchhoff>();
  const double l = law.lambda(), m = law.mu();
  for (const double k : {-0.3, 0.01, 0.1, 0.5, 1.0, 2.0}) {
    Matrix F = Matrix::Identity(), expected = Matrix::Zero();
    F(0, 1) = k;
    const double k2 = k * k;
    expected(0, 0) = (l / 2 + 2 * m) * k2 + (l / 2 + m) * k2 * k2;
    expected(1, 1) = (l / 2 + m) * k2;
    expected(2, 2) = l / 2 * k2;
    expected(0, 1) = expected(1, 0) = m * k + (l / 2 + m) * k2 * k;
    EXPECT_LE((cauchy(law, F) - expected).norm(), 1e-12 * std::max(expected.norm(), m));
  }
}

TEST(StVenantKirchhoffClosedForm, CauchyStressInSteelUnits) {
  const auto law = StVenantKirchhoff::from_young_poisson(7e6, 0.3);
  const Matrix stretched = cauchy(law, diagonal(1.01, 1, 1));
  EXPECT_LE((stretched - diagonal(95648.94230769236, 40184.69154607771, 40184.69154607771)).norm(),
            1e-7 * 95648.9);

  Matrix F = Matrix::Identity(), expected = diagonal(201.92307692, 740.43173077, 471.15384615);
  F(1, 2) = 0.01;
  expected(1, 2) = expected(2, 1) = 26927.78846154;
  EXPECT_LE((cauchy(law, F) - expected).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(NeoHookeanClosedForm, UniaxialTension) {
  const auto law = soft<NeoHookean>();
  struct Row {
    double s, P, lateral;
  };
  for (const Row& row : {Row{0.5, -9.3535205689, 1.2107673905},
                         {0.7, -4.0523042431, 1.1079347328},
                         {0.9, -1.0872218514, 1.0317024344},
                         {1.1, 0.9307743218, 0.9714929459},
                         {1.5, 3.7828017639, 0.8801745918},
                         {2, 6.4674466017, 0.7980775445},
                         {3, 10.9314143732, 0.6881110295}}) {
    const double l = free_stretch(law, row.s, false, 1);
    EXPECT_NEAR(l, row.lateral, 1e-8);
    expect_loaded(law.first_piola(diagonal(row.s, l, l)), row.P, 0, 1e-8);
  }
}

TEST(NeoHookeanClosedForm, EquibiaxialTension) {
  const auto law = soft<NeoHookean>();
  struct Row {
    double s, P, across;
  };
  for (const Row& row : {Row{0.7, -6.5419925607, 1.2963960221},
                         {1.2, 2.3398946814, 0.8425870041},
                         {2, 7.3361166465, 0.4303711698}}) {
    const double l = free_stretch(law, row.s, true, 0.5);
    EXPECT_NEAR(l, row.across, 1e-8);
    expect_loaded(law.first_piola(diagonal(row.s, row.s, l)), row.P, row.P, 1e-8);
  }
}

TEST(NeoHookeanClosedForm, CauchyStressInSteelUnits) {
  const auto law = NeoHookean::from_young_poisson(7e6, 0.3);
  const Matrix expected = diagonal(863901.0097711232, 349914.99578510894, 349914.99578510894);
  EXPECT_LE((cauchy(law, diagonal(1.1, 1, 1)) - expected).norm(), 1e-7 * expected.norm());
}

// With k = lambda + mu the law reads P_i = mu l_i + (k (J - 1) - mu) J / l_i, and both free stretches have a
// closed form: l^2 = ((k + mu) s - mu) / (k s^2) of a bar, l = (k + mu) s^2 / (mu + k s^4) of a sheet.
TEST(StableNeoHookeanClosedForm, UniaxialTension) {
  const auto law = soft<StableNeoHookean>();
  const double m = law.mu(), k = law.lambda() + m;
  for (const double s : {0.5, 0.7, 0.9, 1.0, 1.1, 1.5, 2.0, 3.0}) {
    const double l = std::sqrt(((k + m) * s - m) / (k * s * s)), J = s * l * l;
    EXPECT_NEAR(free_stretch(law, s, false, 1), l, 1e-12);
    expect_loaded(law.first_piola(diagonal(s, l, l)), m * s + (k * (J - 1) - m) * l * l, 0, 1e-12);
    const double energy = m / 2 * (s * s + 2 * l * l - 3) - m * (J - 1) + k / 2 * (J - 1) * (J - 1);
    EXPECT_NEAR(law.energy_density(diagonal(s, l, l)), energy, 1e-12);
  }
}

TEST(StableNeoHookeanClosedForm, EquibiaxialTension) {
  const auto law = soft<StableNeoHookean>();
  const double m = law.mu(), k = law.lambda() + m;
  for (const double s : {0.7, 0.9, 1.2, 2.0}) {
    const double l = (k + m) * s * s / (m + k * s * s * s * s), J = s * s * l;
    const double P = m * s + (k * (J - 1) - m) * s * l;
    EXPECT_NEAR(free_stretch(law, s, true, 1), l, 1e-12);
    expect_loaded(law.first_piola(diagonal(s, s, l)), P, P, 1e-12);
  }
}

TEST(StableNeoHookeanClosedForm, CauchyStressOfSimpleShear) {
  const auto law = soft<StableNeoHookean>();
  const double m = law.mu();
  for (const double k : {-0.3, 0.01, 0.5, 2.0}) {
    // J = 1 leaves mu (F F^T - I) and mu/2 (I1 - 3)
    Matrix F = Matrix::Identity(), expected = Matrix::Zero();
    F(0, 1) = k;
    expected(0, 0) = m * k * k;
    expected(0, 1) = expected(1, 0) = m * k;
    EXPECT_LE((cauchy(law, F) - expected).norm(), 1e-13 * m * (1 + k * k));
    EXPECT_NEAR(law.energy_density(F), m / 2 * k * k, 1e-13 * m);
    // the same from the principal stretches l and 1/l of the shear
    const double l = k / 2 + std::sqrt(1 + k * k / 4);
    EXPECT_NEAR(law.energy_density(F), principal(law, {l, 1 / l, 1}).energy, 1e-13 * m * (1 + k * k));
  }
}

TEST(StableNeoHookeanLaw, ResistsBeingTurnedInsideOut) {
  const auto law = soft<StableNeoHookean>();
  const double m = law.mu(), k = law.lambda() + m;
  // at F = 0 the energy is finite, at the mirror image of rest 2 (mu + k)
  EXPECT_NEAR(law.energy_density(Matrix::Zero()), -1.5 * m + m + k / 2, 1e-13 * k);
  EXPECT_NEAR(law.energy_density(diagonal(1, 1, -1)), 2 * m + 2 * k, 1e-13 * k);
  EXPECT_LT(law.first_piola(diagonal(1, 1, 0))(2, 2), 0);
}

// ---------------------------------------------------------------- single tetrahedra

template <class Law>
void expect_tetrahedron(const tetrahedron_reference::Case& c, const tetrahedron_reference::Result& expected) {
  if (!expected.defined) return;
  SCOPED_TRACE(std::string(c.name) + ", " + LawName::GetName<Law>(0));
  const Law law = Law::from_lame(tetrahedron_reference::lambda, tetrahedron_reference::mu);
  Matrix rest_edges, edges;
  for (int i = 0; i < 3; ++i)
    for (int a = 0; a < 3; ++a) {
      const auto v = static_cast<std::size_t>(i) + 1, row = static_cast<std::size_t>(a);
      rest_edges(a, i) = c.rest[v][row] - c.rest[0][row];
      edges(a, i) = c.now[v][row] - c.now[0][row];
    }
  const Matrix F = edges * rest_edges.inverse();
  const double volume = std::abs(rest_edges.determinant()) / 6;
  Eigen::Matrix<double, 3, 4> gradients;  // of the four shape functions
  gradients.rightCols<3>() = rest_edges.inverse().transpose();
  gradients.col(0) = -gradients.rightCols<3>().rowwise().sum();
  const Eigen::Matrix<double, 3, 4> forces = -volume * law.first_piola(F) * gradients;

  // where the result is zero, rounding of the terms that cancel in it
  const double rounding = 1e-14 * (law.lambda() + 2 * law.mu()) * volume;
  EXPECT_NEAR(volume * law.energy_density(F), expected.energy, c.tolerance * expected.energy + rounding);
  double largest = 0;
  for (const auto& f : expected.forces)
    for (const double component : f) largest = std::max(largest, std::abs(component));
  const double tolerance = c.tolerance * largest + rounding * gradients.cwiseAbs().maxCoeff();
  for (int n = 0; n < 4; ++n)
    for (int a = 0; a < 3; ++a) {
      const double f = expected.forces[static_cast<std::size_t>(n)][static_cast<std::size_t>(a)];
      EXPECT_NEAR(forces(a, n), f, tolerance) << "vertex " << n << " component " << a;
    }
}

TEST(SingleTetrahedron, EnergyAndForcesAgreeWithFiftyDigits) {
  for (const tetrahedron_reference::Case& c : tetrahedron_reference::cases) {
    expect_tetrahedron<StVenantKirchhoff>(c, c.st_venant_kirchhoff);
    expect_tetrahedron<NeoHookean>(c, c.neo_hookean);
    expect_tetrahedron<StableNeoHookean>(c, c.stable_neo_hookean);
  }
}

}  // namespace law_reference_test
