// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>

#include "softsim/system/prescribed.hpp"

namespace prescribed_frames_test {

using namespace softsim;
using V = Vec3<double>;
using Q = UnitQuaternion<double>;

// q after the increment of prescribed components has been made.
State<double> corrected(const Prescribed<double>& prescribed, State<double> q, double fraction = 1) {
  Vector<double> d(q.size());
  const State<double> start = q;
  if (fraction == 1)
    prescribed.increment(q, d);
  else
    prescribed.increment(q, d, start, fraction);
  retract(q, d);
  return q;
}

TEST(PrescribedFrames, ArriveAtTheirTargetAndStay) {
  Prescribed<double> prescribed(1, 2);
  const Q target = quaternion_exponential(V(0.3, -1, 2));
  prescribed.set_frame(1, {1, 2, 3}, target);
  State<double> q(1, 2);
  q.quaternion(0) = quaternion_exponential(V(1, 1, 1));
  q.quaternion(1) = quaternion_exponential(V(-0.2, 0.4, 1));
  const State<double> half = corrected(prescribed, q, 0.5), there = corrected(prescribed, q);
  EXPECT_LT(rotation_between<double>(there.quaternion(1), target).norm(), 1e-15);
  EXPECT_NEAR(rotation_between<double>(half.quaternion(1), target).norm(),
              rotation_between<double>(q.quaternion(1), target).norm() / 2, 1e-15);
  EXPECT_EQ(there.translation(1), V(1, 2, 3));
  EXPECT_EQ(Q(there.quaternion(0)), Q(q.quaternion(0)));  // free
  Vector<double> d(q.size());
  EXPECT_EQ(prescribed.increment(there, d), 0);  // exactly: Newton's method waits for it
}

// Wherever a hinge has turned to, one correction brings it back from any distance: without a twist about the
// free axis, to the last bits.
TEST(PrescribedFrames, AHingeFindsItsWayBackAtEveryAngle) {
  Prescribed<double> prescribed(0, 1);
  prescribed.hold_rotation(0, 0);
  prescribed.hold_rotation(0, 2);
  for (double angle = -6; angle < 6.1; angle += 0.25)
    for (const double off : {1e-9, 0.3}) {
      State<double> q(0, 1);
      q.quaternion(0) = quaternion_product<double>(quaternion_exponential(V(0, angle, 0)),
                                                   quaternion_exponential(V(off, 0, -off)));
      const State<double> back = corrected(prescribed, q);
      EXPECT_LT(std::hypot(back.quaternion(0)[0], back.quaternion(0)[2]), 1e-15) << angle;
      // The shortest way: by no more than it was off.
      Vector<double> d(8);
      prescribed.increment(q, d);
      EXPECT_LE(d.norm(), std::sqrt(2.0) * off * (1 + 1e-12)) << angle;
      EXPECT_EQ(prescribed.increment(back, d), 0) << angle;
    }
}

TEST(PrescribedFrames, OneHeldAxisTakesBackTheTwistAboutIt) {
  Prescribed<double> prescribed(0, 1);
  prescribed.hold_rotation(0, 1);
  State<double> q(0, 1);
  q.quaternion(0) = quaternion_exponential(V(1, -0.5, 0.4));
  EXPECT_LT(std::abs(quaternion_logarithm<double>(corrected(prescribed, q).quaternion(0))[1]), 1e-15);
}

// Half a turn about a held axis has no shortest way back to the hinge; it takes one.
TEST(PrescribedFrames, AHingeThatIsHalfATurnOffIsBroughtBack) {
  Prescribed<double> prescribed(0, 1);
  prescribed.hold_rotation(0, 0);
  prescribed.hold_rotation(0, 2);
  State<double> q(0, 1);
  q.quaternion(0) = Q(1, 0, 0, 0);
  EXPECT_LT(std::abs(corrected(prescribed, q).quaternion(0)[0]), 1e-15);
}

}  // namespace prescribed_frames_test
