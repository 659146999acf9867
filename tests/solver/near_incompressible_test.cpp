// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "../../bench/studies/near_incompressible.hpp"

#include <gtest/gtest.h>

#include "softsim/material/mooney_rivlin.hpp"

// Short form of the study bench/studies/near_incompressible.cpp. References and their errors (below 0.03 %) stand
// there.

namespace near_incompressible_test {

using namespace near_incompressible;
using softsim::State;

struct Ratios {
  double nu, linear, nodal;
};

// Answers over references at some of the Poisson's ratios, each from the state of the one before.
std::vector<Ratios> sweep(const Problem& problem, double Answers::*answer, double last_linear) {
  State<double> plain(problem.mesh.points().size()), nodal = plain;
  std::vector<Ratios> ratios;
  for (const Answers& reference : references) {
    if (reference.nu == 0.4 || reference.nu == 0.45) continue;
    Ratios r{reference.nu, 0, solve_nodal(problem, nodal, reference.nu) / reference.*answer};
    if (reference.nu <= last_linear) r.linear = solve_plain(problem, plain, reference.nu) / reference.*answer;
    ratios.push_back(r);
  }
  return ratios;
}

// 16 x 16 cells, 1,536 tetrahedra. Linear tetrahedra reach 98 % of the deflection at nu = 0.3, 91 % at 0.49
// and 74 % at 0.499 (and 57 % at 0.4999); with the volume averaged at the nodes it is 99 % to 98 %
// throughout.
TEST(CooksMembrane, LocksWithPlainTetrahedraAndNotWithNodalVolumes) {
  const auto ratios = sweep(cooks_membrane(16), &Answers::cook, 0.499);
  for (const Ratios& r : ratios) EXPECT_NEAR(r.nodal, 1, 0.03) << "nu " << r.nu;
  EXPECT_NEAR(ratios[0].linear, 0.985, 0.01);
  EXPECT_NEAR(ratios[1].linear, 0.915, 0.01);
  EXPECT_NEAR(ratios[2].linear, 0.737, 0.01);
}

// 8^3 cells, 3,072 tetrahedra. Linear tetrahedra are 0.5 % too stiff at nu = 0.3, 8 % at 0.49 and more than
// four times too stiff at 0.4999; with the volume averaged at the nodes it is 2.5 % at most.
TEST(BondedBlock, LocksWithPlainTetrahedraAndNotWithNodalVolumes) {
  const auto ratios = sweep(bonded_block(8), &Answers::block, 0.4999);
  for (const Ratios& r : ratios) EXPECT_NEAR(r.nodal, 1, 0.03) << "nu " << r.nu;
  EXPECT_NEAR(ratios[0].linear, 1.005, 0.005);
  EXPECT_NEAR(ratios[1].linear, 1.08, 0.01);
  EXPECT_NEAR(ratios[3].linear, 4.36, 0.05);
}

// A law on isochoric invariants: of its bulk modulus the tetrahedra keep what nu = 0 would give, 2/3 mu, and
// the nodes take the rest. Incompressible it is the Neo-Hookean of the reference; at nu = 0.4999 the two
// differ by the order of mu/lambda, 2e-4.
TEST(BondedBlock, TakesALawOnIsochoricInvariants) {
  const Problem problem = bonded_block(8);
  const double share = 2.0 / 3;
  State<double> q(problem.mesh.points().size());
  double force = 0;
  for (const double nu : {0.49, 0.4999})
    force = solve(problem, q, softsim::elastic(problem.mesh, softsim::MooneyRivlin(0.5, 0, share)),
                  softsim::nodal_volume(problem.mesh, softsim::QuadraticVolume(problem.lambda(nu))));
  EXPECT_NEAR(force / references[5].block, 1, 0.03);
}

}  // namespace near_incompressible_test
