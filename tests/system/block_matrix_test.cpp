// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/system/block_matrix.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "potential/bodies.hpp"

namespace block_matrix_test {

using softsim::BlockMatrix, softsim::Vector;

using Pattern = std::vector<std::pair<std::int32_t, std::int32_t>>;

// Five rows: one full, one without any block, the blocks given out of order and one of them twice.
const Pattern pattern{{4, 4}, {0, 3}, {0, 0}, {2, 1}, {1, 0}, {1, 1}, {1, 2}, {1, 3}, {1, 4}, {0, 3}, {4, 0}};

template <class T>
BlockMatrix<T> random_matrix() {
  BlockMatrix<T> A(5, pattern);
  bodies::Random random(1);
  for (std::size_t k = 0; k < 9 * A.blocks(); ++k) A.values()[k] = static_cast<T>(random.number());
  return A;
}

TEST(BlockMatrix, KeepsEveryBlockOnce) {
  const BlockMatrix<double> A(5, pattern);
  EXPECT_EQ(A.rows(), 5u);
  EXPECT_EQ(A.blocks(), 10u);
  EXPECT_EQ(A.position(0, 0), 0);
  EXPECT_EQ(A.position(0, 3), 1);
  EXPECT_EQ(A.position(1, 4), 6);
  EXPECT_EQ(A.position(2, 1), 7);
  EXPECT_EQ(A.position(4, 4), 9);
  for (const auto& [i, j] : Pattern{{0, 1}, {0, 4}, {2, 0}, {2, 2}, {3, 3}, {4, 3}})
    EXPECT_EQ(A.position(i, j), -1);
  EXPECT_EQ(BlockMatrix<double>().rows(), 0u);
}

TEST(BlockMatrix, StoresBlocksColumnByColumn) {
  BlockMatrix<double> A(5, pattern);
  A.block(A.position(2, 1))(0, 2) = 5;
  EXPECT_EQ(A.values()[9 * 7 + 6], 5);
  const BlockMatrix<double>& constant = A;
  EXPECT_EQ(constant.block(7)(0, 2), 5);
  A.set_zero();
  EXPECT_EQ(A.values()[9 * 7 + 6], 0);
  EXPECT_EQ(A.blocks(), 10u);
}

TEST(BlockMatrix, MultipliesAsEigenDoes) {
  const auto A = random_matrix<double>();
  const Vector<double> x = bodies::random_vector(5, 1, 2);
  Vector<double> y = Vector<double>::Constant(20, 99);
  A.apply(x, y);
  EXPECT_LT(bodies::relative_error(softsim::pack(y), Vector<double>(A.to_eigen() * softsim::pack(x))), 1e-15);
  for (std::ptrdiff_t i = 0; i < 5; ++i) EXPECT_EQ(y[4 * i + 3], 0);
}

TEST(BlockMatrix, MultipliesInSinglePrecision) {
  const auto A = random_matrix<float>();
  const Vector<float> x = bodies::random_vector<float>(5, 1, 2);
  Vector<float> y(20);
  A.apply(x, y);
  EXPECT_LT(bodies::relative_error(softsim::pack(y), Vector<float>(A.to_eigen() * softsim::pack(x))), 5e-7);
}

// The product loads four scalars where a column has three; the fourth must not leak, whatever it is.
TEST(BlockMatrix, DoesNotMixNeighbouringBlocks) {
  BlockMatrix<double> A(2, {{0, 0}, {1, 1}});
  A.block(0).setIdentity();
  A.block(1).setConstant(std::numeric_limits<double>::quiet_NaN());
  Vector<double> y(8);
  A.apply(Vector<double>::Ones(8), y);
  EXPECT_EQ(y.head(4), Eigen::Vector4d(1, 1, 1, 0));
}

TEST(Packing, DropsTheFourthScalarAndPutsItBack) {
  const Vector<double> v = bodies::random_vector(7, 1, 3);
  const Vector<double> packed = softsim::pack(v);
  ASSERT_EQ(packed.size(), 21);
  for (std::ptrdiff_t i = 0; i < 7; ++i)
    for (std::ptrdiff_t a = 0; a < 3; ++a) EXPECT_EQ(packed[3 * i + a], v[4 * i + a]);
  EXPECT_EQ(softsim::unpack(packed), v);
}

}  // namespace block_matrix_test
