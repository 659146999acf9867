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

using softsim::SymmetricBlockMatrix, softsim::Vector;

using Pattern = std::vector<std::pair<std::int32_t, std::int32_t>>;

// Five rows: one full, one without a stored block of its own; blocks out of order, below the diagonal and
// twice.
const Pattern pattern{{4, 4}, {0, 3}, {0, 0}, {2, 1}, {1, 0}, {1, 1}, {1, 3}, {1, 4}, {3, 0}, {4, 0}};

template <class T>
SymmetricBlockMatrix<T> random_matrix() {
  SymmetricBlockMatrix<T> A(5, pattern);
  bodies::Random random(1);
  for (std::size_t k = 0; k < 9 * A.blocks(); ++k) A.values()[k] = static_cast<T>(random.number());
  for (const std::int32_t i : {0, 1, 4}) {
    auto D = A.block(A.place(i, i) / 2);
    D = softsim::symmetric_part<T>(D);
  }
  return A;
}

TEST(SymmetricBlockMatrix, KeepsEveryPairOfBlocksOnce) {
  const SymmetricBlockMatrix<double> A(5, pattern);
  EXPECT_EQ(A.rows(), 5u);
  EXPECT_EQ(A.blocks(), 9u);
  EXPECT_EQ(A.place(0, 0), 0);
  EXPECT_EQ(A.place(0, 1), 2);
  EXPECT_EQ(A.place(1, 0), 3);
  EXPECT_EQ(A.place(0, 3), 4);
  EXPECT_EQ(A.place(3, 0), 5);
  EXPECT_EQ(A.place(1, 4), 14);
  EXPECT_EQ(A.place(4, 1), 15);
  EXPECT_EQ(A.place(4, 4), 16);
  for (const auto& [i, j] : Pattern{{0, 2}, {2, 0}, {2, 2}, {3, 3}, {4, 3}}) EXPECT_EQ(A.place(i, j), -1);
  EXPECT_EQ(SymmetricBlockMatrix<double>().rows(), 0u);
}

TEST(SymmetricBlockMatrix, StoresBlocksColumnByColumn) {
  SymmetricBlockMatrix<double> A(5, pattern);
  A.block(A.place(1, 2) / 2)(0, 2) = 5;
  EXPECT_EQ(A.place(1, 2), 10);
  EXPECT_EQ(A.values()[9 * 5 + 6], 5);
  const SymmetricBlockMatrix<double>& constant = A;
  EXPECT_EQ(constant.block(5)(0, 2), 5);
  A.set_zero();
  EXPECT_EQ(A.values()[9 * 5 + 6], 0);
  EXPECT_EQ(A.blocks(), 9u);
}

TEST(SymmetricBlockMatrix, IsTheSymmetricMatrixOfItsBlocks) {
  const auto A = random_matrix<double>();
  const Eigen::MatrixXd dense = A.to_eigen();
  ASSERT_EQ(dense.rows(), 15);
  EXPECT_EQ(dense, dense.transpose());
  for (std::int32_t i = 0; i < 5; ++i)
    for (std::int32_t j = i; j < 5; ++j) {
      const std::int32_t p = A.place(i, j);
      const softsim::Mat3<double> expected =
          p < 0 ? softsim::Mat3<double>::Zero() : softsim::Mat3<double>(A.block(p / 2));
      EXPECT_EQ((dense.block<3, 3>(3 * i, 3 * j)), expected);
    }
}

TEST(SymmetricBlockMatrix, MultipliesAsEigenDoes) {
  const auto A = random_matrix<double>();
  const Vector<double> x = bodies::random_vector(5, 1, 2);
  Vector<double> y = Vector<double>::Constant(20, 99);
  A.apply(x, y);
  EXPECT_LT(bodies::relative_error(softsim::pack(y), Vector<double>(A.to_eigen() * softsim::pack(x))), 1e-15);
  for (std::ptrdiff_t i = 0; i < 5; ++i) EXPECT_EQ(y[4 * i + 3], 0);
}

TEST(SymmetricBlockMatrix, MultipliesInSinglePrecision) {
  const auto A = random_matrix<float>();
  const Vector<float> x = bodies::random_vector<float>(5, 1, 2);
  Vector<float> y(20);
  A.apply(x, y);
  EXPECT_LT(bodies::relative_error(softsim::pack(y), Vector<float>(A.to_eigen() * softsim::pack(x))), 5e-7);
}

// The product loads four scalars where a column has three, and four of x; the fourth must not leak, whatever
// it is.
TEST(SymmetricBlockMatrix, DoesNotMixNeighbouringBlocks) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  SymmetricBlockMatrix<double> A(3, {{0, 0}, {0, 1}, {2, 2}});
  A.block(0).setIdentity();
  A.block(1).setIdentity();
  A.block(2).setConstant(nan);
  Vector<double> x = Vector<double>::Ones(12), y(12);
  for (const std::ptrdiff_t k : {3, 7, 11}) x[k] = nan;
  A.apply(x, y);
  EXPECT_EQ(y.head(4), Eigen::Vector4d(2, 2, 2, 0));
  EXPECT_EQ(y.segment(4, 4), Eigen::Vector4d(1, 1, 1, 0));
}

// The two rows of a frame are multiplied together: three points and five frames, the last of them alone.
template <class T>
void expect_products_of_frames(double tolerance) {
  constexpr T nan = std::numeric_limits<T>::quiet_NaN();
  const Pattern groups{{0, 0}, {1, 1}, {2, 2}, {3, 4}, {5, 6}, {7, 8}, {9, 10}, {11, 12}};
  const Pattern couplings{{0, 1}, {0, 3}, {1, 2}, {1, 3}, {1, 4}, {2, 4},
                          {2, 5}, {3, 4}, {3, 6}, {4, 6}, {5, 6}};
  Pattern blocks;
  const auto couple = [&](std::size_t g, std::size_t h) {
    for (std::int32_t i = groups[g].first; i <= groups[g].second; ++i)
      for (std::int32_t j = groups[h].first; j <= groups[h].second; ++j) blocks.emplace_back(i, j);
  };
  for (std::size_t g = 0; g < groups.size(); ++g) couple(g, g);
  for (const auto& [g, h] : couplings) couple(static_cast<std::size_t>(g), static_cast<std::size_t>(h));
  SymmetricBlockMatrix<T> A(13, blocks);
  bodies::Random random(1);
  for (std::size_t k = 0; k < 9 * A.blocks(); ++k) A.values()[k] = static_cast<T>(random.number());
  for (std::int32_t i = 0; i < 13; ++i) {
    auto D = A.block(A.place(i, i) / 2);
    D = softsim::symmetric_part<T>(D);
  }
  Vector<T> x = bodies::random_vector<T>(13, 1, 2), y = Vector<T>::Constant(52, 99);
  for (std::ptrdiff_t i = 0; i < 13; ++i) x[4 * i + 3] = nan;
  A.apply(x, y);
  EXPECT_LT(bodies::relative_error(softsim::pack(y), Vector<T>(A.to_eigen() * softsim::pack(x))), tolerance);
  for (std::size_t i = 0; i < 13; ++i) {
    T row[4];
    A.row_product(i, x, row);
    const auto at = 4 * static_cast<std::ptrdiff_t>(i);
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(y[at + a], row[a], 10 * tolerance) << "row " << i;
    EXPECT_EQ(y[at + 3], 0) << "row " << i;
  }
}

TEST(SymmetricBlockMatrix, MultipliesTheTwoRowsOfAFrameTogether) {
  expect_products_of_frames<double>(1e-15);
  expect_products_of_frames<float>(5e-7);
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
