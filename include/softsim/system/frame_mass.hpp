// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/frame_block.hpp"
#include "softsim/core/state.hpp"

namespace softsim {

template <int N>
class FrameBody;

/// Mass matrix of frames, rotary inertia included: T = 1/2 sum_s m_s |v_s|^2 with the velocity of a sample
/// v_s = sum_i w_i v_i + R_i (omega_i x c_i), omega in the axes of the body. With a_i = (w_i, c_i) all that
/// is needed of the samples are the 4x4 matrices sum_s m_s a_i a_j^T, which do not change; the mass matrix
/// does, with the rotations, and so has a gyroscopic force beside it (Bosman 2015, Sec. 3.6, leaves both
/// open).
///
/// Consistent: all of that, the frames coupled. Lumped: every frame is a rigid body of its share w_i m_s of
/// the samples, one 6x6 block each; mass, centre and inertia of the whole body as it moves rigidly are exact.
///
/// With shape functions that reproduce linear fields some turns of frames move no sample (see `RotationTie`):
/// the consistent matrix is singular then. It serves to find modes, with a tie, but integrators need the
/// lumped one.
template <class T>
class FrameMass {
 public:
  using Moments = Eigen::Matrix<T, 4, 4>;

  /// No frames.
  FrameMass() = default;

  /// @param density kg/m^3, one per sample
  /// @throws std::invalid_argument unless there is one positive, finite density per sample, and naming a
  /// frame
  ///   whose 6x6 matrix is not positive definite: of samples on a line, or (lumped) of negative weights
  template <int N>
  [[nodiscard]] static FrameMass lumped(const FrameBody<N>& body, const std::vector<double>& density) {
    return summed(body, density, true);
  }
  /// The same, coupled. @throws as `lumped`
  template <int N>
  [[nodiscard]] static FrameMass consistent(const FrameBody<N>& body, const std::vector<double>& density) {
    return summed(body, density, false);
  }

  /// Number of frames.
  [[nodiscard]] std::size_t size() const { return diagonal_.size(); }
  /// True if frames are not coupled.
  [[nodiscard]] bool is_lumped() const { return column_.empty(); }
  /// Number of entries off the diagonal.
  [[nodiscard]] std::size_t couplings() const { return column_.size(); }
  /// sum_s m_s a_j a_j^T of frame j: mass in kg, first and second moments.
  [[nodiscard]] const Moments& moments(std::size_t j) const { return diagonal_[j]; }
  /// Mass of the body, kg.
  [[nodiscard]] double total() const {
    double sum = 0;
    for (const Moments& m : diagonal_) sum += static_cast<double>(m(0, 0));
    for (const Moments& m : coupling_) sum += static_cast<double>(m(0, 0));
    return sum;
  }

  /// y += scale M(q) x.
  void add_product(const State<T>& q, const Vector<T>& x, T scale, Vector<T>& y) const {
    apply(q, scale, y, [&](std::size_t j) {
      const std::ptrdiff_t b = q.frame_block(static_cast<std::ptrdiff_t>(j));
      Motion4 W;
      W.col(0) = block(x, b);
      W.template rightCols<3>() =
          q.rotation(static_cast<std::ptrdiff_t>(j)) * skew<T>(Vec3<T>(block(x, b + 1)));
      return W;
    });
  }
  /// y += scale times the gyroscopic force in N and N m, M a + this = force: J^T m
  /// dJ/dt v, the centripetal accelerations R_j [omega_j]x^2 c_j.
  void add_gyroscopic(const State<T>& q, const Vector<T>& v, T scale, Vector<T>& y) const {
    apply(q, scale, y, [&](std::size_t j) {
      const std::ptrdiff_t b = q.frame_block(static_cast<std::ptrdiff_t>(j));
      const Mat3<T> w = skew<T>(Vec3<T>(block(v, b + 1)));
      Motion4 W;
      W.col(0).setZero();
      W.template rightCols<3>() = q.rotation(static_cast<std::ptrdiff_t>(j)) * (w * w);
      return W;
    });
  }

  /// Calls f(row, column, block) for the 3x3 blocks of M(q) with row <= column.
  template <class Function>
  void for_each_block(const State<T>& q, Function f) const {
    const auto frame = [&](std::size_t i, std::size_t j, const Moments& m) {  // m = sum m_s a_j a_i^T
      const auto row = static_cast<std::int32_t>(q.frame_block(static_cast<std::ptrdiff_t>(i))),
                 column = static_cast<std::int32_t>(q.frame_block(static_cast<std::ptrdiff_t>(j)));
      const Mat3<T> Ri = q.rotation(static_cast<std::ptrdiff_t>(i)),
                    Rj = q.rotation(static_cast<std::ptrdiff_t>(j));
      f(row, column, Mat3<T>(m(0, 0) * Mat3<T>::Identity()));
      f(row, column + 1, Mat3<T>(-Rj * skew<T>(Vec3<T>(m.template block<3, 1>(1, 0)))));
      const Mat3<T> turn = Ri.transpose() * Rj, second = m.template block<3, 3>(1, 1);
      Mat3<T> rotational;
      for (int k = 0; k < 3; ++k) rotational.col(k) = axial<T>(turn * skew<T>(Vec3<T>::Unit(k)) * second);
      if (i != j)
        f(row + 1, column,
          Mat3<T>(skew<T>(Vec3<T>(m.template block<1, 3>(0, 1).transpose())) * Ri.transpose()));
      f(row + 1, column + 1, rotational);
    };
    for (std::size_t i = 0; i < size(); ++i) {
      frame(i, i, diagonal_[i]);
      for (std::int32_t k = row_start_[i]; k < row_start_[i + 1]; ++k)
        if (const auto j = static_cast<std::size_t>(column_[static_cast<std::size_t>(k)]); j > i)
          frame(i, j, coupling_[static_cast<std::size_t>(k)]);
    }
  }

  /// a = D^-1 f frame by frame on the components that are free (1 in `free`, else 0), where D is M without
  /// couplings; 0 on the others.
  void divide(const State<T>& q, const Vector<T>& free, const Vector<T>& f, Vector<T>& a) const {
    for (std::size_t j = 0; j < size(); ++j) {
      const std::ptrdiff_t b = q.frame_block(static_cast<std::ptrdiff_t>(j));
      const Vec3<T> open_t = block(free, b), open_r = block(free, b + 1);
      FrameBlock<T> inverse;
      if (!invert(
              restricted(matrix(q.rotation(static_cast<std::ptrdiff_t>(j)), diagonal_[j]), open_t, open_r),
              inverse))
        inverse.tt = inverse.tr = inverse.rr = Mat3<T>::Constant(std::numeric_limits<T>::quiet_NaN());
      const Vec3<T> x = open_t.cwiseProduct(block(f, b)), y = open_r.cwiseProduct(block(f, b + 1));
      block(a, b) = open_t.cwiseProduct(inverse.translational(x, y));
      block(a, b + 1) = open_r.cwiseProduct(inverse.rotational(x, y));
      a[block_stride * b + 3] = a[block_stride * (b + 1) + 3] = T(0);
    }
  }

  /// Adds another body on the same frames.
  /// @throws std::invalid_argument for another number of frames
  FrameMass& operator+=(const FrameMass& other) {
    if (size() == 0) return *this = other;
    if (other.size() != size())
      invalid(std::string("mass: ") + std::to_string(other.size()) + " frames added to " +
              std::to_string(size()));
    std::vector<Entry> entries;
    for (const FrameMass* mass : {static_cast<const FrameMass*>(this), &other})
      for (std::size_t i = 0; i < size(); ++i)
        for (std::int32_t k = mass->row_start_[i]; k < mass->row_start_[i + 1]; ++k)
          entries.push_back({static_cast<std::int32_t>(i), mass->column_[static_cast<std::size_t>(k)],
                             mass->coupling_[static_cast<std::size_t>(k)].template cast<double>()});
    for (std::size_t j = 0; j < size(); ++j) diagonal_[j] += other.diagonal_[j];
    couple(entries);
    return *this;
  }

 private:
  using Motion4 = Eigen::Matrix<T, 3, 4>;  // what acts on (w, c): velocities or accelerations of a frame
  struct Entry {
    std::int32_t row, column;
    Eigen::Matrix<double, 4, 4, Eigen::DontAlign> value;  // std::stable_sort does not keep to alignments
  };

  template <int N>
  static FrameMass summed(const FrameBody<N>& body, const std::vector<double>& density, bool lumped) {
    if (density.size() != body.size())
      invalid(std::string("mass: ") + std::to_string(density.size()) + " densities for " +
              std::to_string(body.size()) + " samples");
    for (const double rho : density)
      if (!(rho > 0) || !(rho <= 1e300))
        invalid(std::string("density ") + to_text(rho) + " kg/m^3: must be positive and finite");
    std::vector<Eigen::Matrix4d> diagonal(body.frames().size(), Eigen::Matrix4d::Zero());
    std::vector<Entry> entries;
    for (std::size_t s = 0; s < body.size(); ++s) {
      const auto& blend = body.blends()[s];
      const double m = density[s] * body.volumes()[s];
      std::array<Eigen::Vector4d, FrameBody<N>::count> a;
      for (std::size_t i = 0; i < a.size(); ++i) {
        const auto frame = static_cast<std::size_t>(blend.frames[i]);
        if (lumped) {
          a[i] << 1, body.positions()[s] - body.frames()[frame];
          diagonal[frame] += m * blend.weights[i] * a[i] * a[i].transpose();
        } else {
          a[i] << blend.weights[i], blend.arms[i];
          diagonal[frame] += m * a[i] * a[i].transpose();
        }
      }
      if (lumped) continue;
      for (std::size_t i = 0; i < a.size(); ++i)
        for (std::size_t j = 0; j < a.size(); ++j)
          if (i != j && !a[i].isZero(0) && !a[j].isZero(0))
            entries.push_back({blend.frames[i], blend.frames[j], m * a[j] * a[i].transpose()});
    }
    FrameMass mass;
    for (std::size_t j = 0; j < diagonal.size(); ++j) {
      require_inertia(j, diagonal[j]);
      mass.diagonal_.push_back(diagonal[j].template cast<T>());
    }
    mass.couple(entries);
    return mass;
  }

  // A template like all of this, so that only who has frames waits for its compilation.
  template <class Real>
  static void require_inertia(std::size_t j, const Eigen::Matrix<Real, 4, 4>& moments) {
    const Mat3<Real> about_frame = moments.template block<3, 3>(1, 1);
    const Real m = moments(0, 0), size = trace(about_frame);
    const auto refuse = [&](const std::string& what) {
      invalid(std::string("mass of frame ") + std::to_string(j) + ": " + what);
    };
    if (!(m > 0)) refuse(to_text(m) + " kg is not positive");
    // About the centre of its samples; the least of three is zero for samples on a line.
    const Vec3<Real> centre = moments.template block<3, 1>(1, 0) / m;
    const Mat3<Real> second = about_frame - m * centre * centre.transpose();
    const Mat3<Real> inertia = trace(second) * Mat3<Real>::Identity() - second;
    Mat3<Real> inverse;
    if (!(size > 0) || !invert(Mat3<Real>(inertia - 1e-12 * size * Mat3<Real>::Identity()), inverse))
      refuse("its samples have no inertia about some axis: spread them over a cross-section");
  }

  // Sorted and summed up, row by row.
  void couple(std::vector<Entry>& entries) {
    std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
      return a.row != b.row ? a.row < b.row : a.column < b.column;
    });
    row_start_.assign(size() + 1, 0);
    column_.clear();
    std::vector<Eigen::Matrix4d> sums;
    for (std::size_t k = 0; k < entries.size(); ++k) {
      if (k > 0 && entries[k].row == entries[k - 1].row && entries[k].column == entries[k - 1].column) {
        sums.back() += entries[k].value;
        continue;
      }
      column_.push_back(entries[k].column);
      sums.push_back(entries[k].value);
      ++row_start_[static_cast<std::size_t>(entries[k].row) + 1];
    }
    for (std::size_t i = 0; i < size(); ++i) row_start_[i + 1] += row_start_[i];
    coupling_.clear();
    for (const Eigen::Matrix4d& m : sums) coupling_.push_back(m.template cast<T>());
  }

  // 6x6 matrix of one frame.
  static FrameBlock<T> matrix(const Mat3<T>& R, const Moments& m) {
    const Mat3<T> second = m.template block<3, 3>(1, 1);
    return {m(0, 0) * Mat3<T>::Identity(), -R * skew<T>(Vec3<T>(m.template block<3, 1>(1, 0))),
            trace(second) * Mat3<T>::Identity() - second};
  }

  // y_i += scale times the force and torque of sum_j W(j) sum m_s a_j a_i^T.
  template <class MotionOf>
  void apply(const State<T>& q, T scale, Vector<T>& y, MotionOf W) const {
    for (std::size_t i = 0; i < size(); ++i) {
      Motion4 sum = W(i) * diagonal_[i];
      for (std::int32_t k = row_start_[i]; k < row_start_[i + 1]; ++k)
        sum += W(static_cast<std::size_t>(column_[static_cast<std::size_t>(k)])) *
               coupling_[static_cast<std::size_t>(k)];
      const std::ptrdiff_t b = q.frame_block(static_cast<std::ptrdiff_t>(i));
      block(y, b) += scale * sum.col(0);
      block(y, b + 1) += scale * axial<T>(q.rotation(static_cast<std::ptrdiff_t>(i)).transpose() *
                                          sum.template rightCols<3>());
    }
  }

  std::vector<Moments> diagonal_, coupling_;  // coupling_ of (i, j): sum m_s a_j a_i^T
  std::vector<std::int32_t> row_start_, column_;
};

}  // namespace softsim
