// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include "softsim/core/voigt.hpp"

#include <gtest/gtest.h>

#include "softsim/core/batch.hpp"

namespace voigt_test {

using Mat = softsim::Mat3<double>;
using Vec6 = softsim::Vec6<double>;

Mat symmetric() { return (Mat() << 1, 6, 5, 6, 2, 4, 5, 4, 3).finished(); }

TEST(Voigt, ComponentsFollowTheOrder00_11_22_12_02_01) {
  EXPECT_EQ(softsim::stress_to_voigt(symmetric()), (Vec6() << 1, 2, 3, 4, 5, 6).finished());
}

TEST(Voigt, StrainsCarryDoubledShears) {
  EXPECT_EQ(softsim::strain_to_voigt(symmetric()), (Vec6() << 1, 2, 3, 8, 10, 12).finished());
}

TEST(Voigt, TensorsComeBackUnchanged) {
  EXPECT_EQ(softsim::voigt_to_stress(softsim::stress_to_voigt(symmetric())), symmetric());
  EXPECT_EQ(softsim::voigt_to_strain(softsim::strain_to_voigt(symmetric())), symmetric());
}

TEST(Voigt, StressTimesStrainIsTheDoubleContraction) {
  const Mat S = symmetric(), E = (Mat() << 7, -1, 2, -1, -3, 5, 2, 5, 4).finished();
  // Small whole numbers: the sums are exact.
  EXPECT_EQ(softsim::stress_to_voigt(S).dot(softsim::strain_to_voigt(E)), softsim::double_dot(S, E));
}

TEST(Voigt, BatchesConvertLaneByLane) {
  using B = softsim::Batch<float, 8>;
  softsim::Mat3<B> E;
  for (int i = 0; i < 9; ++i)
    for (int l = 0; l < 8; ++l) softsim::set_lane(E(i), l, static_cast<float>(symmetric()(i) + l));
  const softsim::Vec6<B> e = softsim::strain_to_voigt(E), s = softsim::stress_to_voigt(E);
  const softsim::Mat3<B> back = softsim::voigt_to_strain(e), same = softsim::voigt_to_stress(s);
  for (int l = 0; l < 8; ++l) {
    EXPECT_EQ(softsim::lane(s[3], l), static_cast<float>(4 + l));
    EXPECT_EQ(softsim::lane(e[3], l), static_cast<float>(2 * (4 + l)));
    for (int i = 0; i < 9; ++i) {
      EXPECT_EQ(softsim::lane(back(i), l), softsim::lane(E(i), l));
      EXPECT_EQ(softsim::lane(same(i), l), softsim::lane(E(i), l));
    }
  }
}

}  // namespace voigt_test
