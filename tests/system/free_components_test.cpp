// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/system/free_components.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "softsim/kinematics/frame_body.hpp"
#include "softsim/kinematics/shepard.hpp"

namespace free_components_test {

using namespace softsim;
using V = Vec3<double>;

// Two points, of which one is heavy, and three frames that blend twelve samples.
struct Mixed {
  FrameNodes nodes{{V(0, 0, 0), V(1, 0.2, 0), V(0.3, 1, 0.4)}, {}, {V(5, 0, 0), V(6, 0, 0)}};
  Mass<double> lumped, consistent;
  Prescribed<double> prescribed{2, 3};

  Mixed() {
    std::vector<V> X;
    for (int i = 0; i < 12; ++i) X.emplace_back(0.3 * (i % 3), 0.4 * (i / 6), 0.25 * (i / 3 % 2) - 0.05 * i);
    const FrameBody<3> body(nodes, Shepard<>(nodes.frames()), X, std::vector<double>(12, 0.1));
    lumped = Mass<double>::lumped(body, 30);
    consistent = Mass<double>::consistent(body, 30);
    prescribed.set(1, 0, 0);         // a component of a point,
    prescribed.set(4, 2, 0);         // of a frame's displacement,
    prescribed.hold_rotation(0, 1);  // and of a rotation,
    prescribed.fix_frames({2});      // and all of a frame
  }
};

// Columns are the products with unit vectors, prescribed rows left out.
void expect_product(const Mass<double>& mass, const FreeComponents& free) {
  const Eigen::MatrixXd M(free.matrix(mass));
  ASSERT_EQ(M.rows(), free.size());
  for (std::ptrdiff_t k = 0; k < free.size(); ++k) {
    Vector<double> column = Vector<double>::Zero(free.flat_size());
    mass.add_product(Vector<double>(Vector<double>::Unit(free.flat_size(), free.flat(k))), 1, column);
    Eigen::VectorXd expected(free.size());
    free.gather(column, expected);
    EXPECT_LT((M.col(k) - expected).norm(), 1e-14 * M.norm()) << free.flat(k);
  }
}

TEST(FreeComponents, TheMassOfFramesIsItsProduct) {
  const Mixed mixed;
  const FreeComponents free(mixed.prescribed);
  EXPECT_EQ(free.size(), 3 * 8 - 1 - 1 - 1 - 6);
  expect_product(mixed.lumped, free);
  expect_product(mixed.consistent, free);
  EXPECT_EQ(Eigen::MatrixXd(free.matrix(Mass<double>(2, 3))).norm(), 0);
}

}  // namespace free_components_test
