// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "softsim/integrator/implicit.hpp"
#include "softsim/kinematics/frame_body.hpp"
#include "softsim/kinematics/shepard.hpp"
#include "softsim/material/neo_hookean.hpp"
#include "softsim/mesh/generators.hpp"
#include "softsim/mesh/poisson_disk.hpp"
#include "softsim/mesh/sampling.hpp"
#include "softsim/mesh/surface_domain.hpp"
#include "softsim/potential/frame_elastic.hpp"
#include "softsim/potential/frame_loads.hpp"
#include "softsim/system/system.hpp"

namespace frames_without_mesh_test {

using namespace softsim;

// The program that the README shows, on a cylinder: a body without a mesh falls and hangs on three frames.
TEST(FramesWithoutMesh, ABodyOfSixtyFramesMoves) {
  const TetrahedralMesh mesh = cylinder_mesh(0.03, 0.1, 3, 6);
  const auto law = NeoHookean::from_young_poisson(5e4, 0.4);

  const SurfaceDomain domain = surface_domain(mesh);
  const FrameNodes nodes(poisson_disk_count(domain, 60));
  const Samples samples = sample(domain, 0.008);
  const FrameBody<8> body(nodes, Shepard<>(nodes.frames(), {.nearest = 8}), samples.positions,
                          samples.volumes);
  System fat(nodes, elastic(body, law), gravity(body, 1000.0, {0, 0, -9.81}));
  fat.mass = Mass<double>::lumped(body, 1000.0);
  fat.prescribed.fix_frames({0, 1, 2});
  BackwardEuler<decltype(fat), Assembled, BlockJacobi> step({.dt = 0.01});

  EXPECT_EQ(nodes.frames().size(), 60u);
  EXPECT_NEAR(body.volume(), domain.volume(), 1e-12 * domain.volume());
  EXPECT_NEAR(fat.mass.total(), 1000 * domain.volume(), 1e-11 * fat.mass.total());
  Motion<double> motion = fat.rest_motion();
  for (int k = 0; k < 50; ++k) {
    const StepReport report = step.step(fat, motion);
    ASSERT_EQ(report.status, Status::converged) << report.reason;
  }
  double lowest = 0;
  for (std::ptrdiff_t j = 0; j < motion.q.frames(); ++j)
    lowest = std::min(lowest, motion.q.translation(j)[2]);
  EXPECT_LT(lowest, -1e-4);
  EXPECT_GT(lowest, -0.1);
  // no more than its fall gave it
  EXPECT_LT(fat.kinetic_energy(motion.q, motion.v), fat.mass.total() * 9.81 * -lowest);
}

}  // namespace frames_without_mesh_test
