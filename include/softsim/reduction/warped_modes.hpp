// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/SparseCholesky>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/rotation.hpp"
#include "softsim/core/state.hpp"
#include "softsim/kinematics/isoparametric.hpp"
#include "softsim/kinematics/linear_tetrahedron.hpp"
#include "softsim/mesh/element_mesh.hpp"
#include "softsim/solver/report.hpp"
#include "softsim/system/prescribed.hpp"

namespace softsim {

/// Shapes of large motion from modal coordinates. Phi a alone makes a body grow that bends or turns, as every
/// point moves along a straight line. The curl of Phi a says how far each place turns, w = curl u / 2, and
/// two ways put that right:
/// - `modal_warping` (Choi & Ko 2005) turns the displacement of each node on its own by the mean of the
///   rotations on the way, int_0^1 exp(t w) dt. Cheap; a long beam still changes its length where it bends
///   far.
/// - `rotation_strain` (Huang, Tong, Zhou, Bao & Desbrun 2011) turns the strain at each integration point,
///   F = exp(w) (I + e), and finds the displacements whose gradients are nearest to that: three sparse solves
///   with factors made at set-up (they allocate). Keeps lengths and volumes far better.
/// Both are exact for rotations of the whole body, and differ from Phi a in second order. Prescribed
/// components do not move. Displacements are from rest: the modes have to be those at rest.
class WarpedModes {
 public:
  /// @param mesh tetrahedra, hexahedra or ten-node tetrahedra
  /// @param shapes one flat vector per column (`Modes::shapes`), zero where something is prescribed
  /// @throws std::invalid_argument if sizes do not fit, a shape is not finite or moves a prescribed
  ///   component, or the mesh is in several pieces of which one is not held along some axis
  template <SolidMesh Mesh, class T>
  WarpedModes(const Mesh& mesh, const Prescribed<T>& prescribed, Eigen::MatrixXd shapes)
      : shapes_(std::move(shapes)), nodes_(static_cast<std::ptrdiff_t>(mesh.points().size())) {
    if (shapes_.rows() != block_stride * nodes_ || shapes_.cols() < 1 ||
        prescribed.free().size() != shapes_.rows())
      invalid(std::string("shapes: ") + std::to_string(shapes_.rows()) + " x " +
              std::to_string(shapes_.cols()) + ", must have " + std::to_string(block_stride * nodes_) +
              " rows and a column");
    if (!shapes_.allFinite()) invalid("shapes: must be finite");
    for (std::ptrdiff_t k = 0; k < shapes_.rows(); ++k)
      if (prescribed.free()[k] == T(0) && !shapes_.row(k).isZero(0))
        invalid(std::string("shapes: node ") + std::to_string(k / block_stride) +
                ": a shape moves a prescribed component");
    for (std::size_t e = 0; e < mesh.elements().size(); ++e) add_points(mesh, e);
    weight_.setZero(nodes_);
    for_each_point([&](const Point& p, const std::int32_t* node, const Vec3<double>*) {
      for (std::ptrdiff_t i = 0; i < p.count; ++i)
        weight_[node[i]] += p.volume / static_cast<double>(p.count);
    });
    for (int axis = 0; axis < 3; ++axis) factorise(prescribed, axis);
  }

  /// u = Phi a, a flat vector in m.
  LinearReport linear(const Eigen::VectorXd& a, Eigen::VectorXd& u) {
    if (a.size() != shapes_.cols())
      return detail::ended(LinearReport{}, Status::not_converged,
                           "warped modes: needs one coordinate per shape");
    linear_.noalias() = shapes_ * a;
    return finish(linear_, u);
  }

  /// Displacements by modal warping, a flat vector in m. u stays as it was unless the status is `converged`.
  LinearReport modal_warping(const Eigen::VectorXd& a, Eigen::VectorXd& u) {
    if (const LinearReport report = linear(a, linear_); report.status != Status::converged) return report;
    rotation_.setZero(block_stride * nodes_);
    for_each_point([&](const Point& p, const std::int32_t* node, const Vec3<double>* g) {
      const Vec3<double> w = rotation_of(gradient(p, node, g)) * (p.volume / static_cast<double>(p.count));
      for (std::ptrdiff_t i = 0; i < p.count; ++i) block(rotation_, node[i]) += w;
    });
    warped_.resize(linear_.size());
    for (std::ptrdiff_t i = 0; i < nodes_; ++i) {
      const Vec3<double> w = block(rotation_, i) / weight_[i], d = block(linear_, i), wd = w.cross(d);
      const double angle2 = w.squaredNorm(), angle = std::sqrt(angle2);
      const bool small = angle < 1e-3;  // two terms of the series leave 1e-15
      const double first = small ? 0.5 - angle2 / 24 : (1 - std::cos(angle)) / angle2;
      const double second = small ? 1.0 / 6 - angle2 / 120 : (angle - std::sin(angle)) / (angle2 * angle);
      block(warped_, i) = d + first * wd + second * w.cross(wd);
      warped_[block_stride * i + 3] = 0;
    }
    for (int axis = 0; axis < 3; ++axis)
      for (const std::ptrdiff_t k : axes_[static_cast<std::size_t>(axis)].held) warped_[k] = 0;
    return finish(warped_, u);
  }

  /// Displacements by rotation-strain coordinates, a flat vector in m. u stays as it was unless the status is
  /// `converged`. A body that is free along an axis keeps the mean displacement of Phi a there.
  LinearReport rotation_strain(const Eigen::VectorXd& a, Eigen::VectorXd& u) {
    if (const LinearReport report = linear(a, linear_); report.status != Status::converged) return report;
    rotation_.setZero(block_stride * nodes_);
    for_each_point([&](const Point& p, const std::int32_t* node, const Vec3<double>* g) {
      const Mat3<double> H = gradient(p, node, g), strain = 0.5 * (H + H.transpose()),
                         R = rotation_exponential(Vec3<double>(rotation_of(H)));
      const Mat3<double> wanted = R + R * strain - Mat3<double>::Identity();
      for (std::ptrdiff_t i = 0; i < p.count; ++i) block(rotation_, node[i]) += p.volume * (wanted * g[i]);
    });
    warped_.setZero(linear_.size());
    for (int axis = 0; axis < 3; ++axis) {
      Axis& one = axes_[static_cast<std::size_t>(axis)];
      one.x.resize(static_cast<std::ptrdiff_t>(one.free.size()));
      for (std::size_t k = 0; k < one.free.size(); ++k)
        one.x[static_cast<std::ptrdiff_t>(k)] = rotation_[one.free[k]];
      if (one.x.size() > 0) one.x = one.factor.solve(one.x).eval();
      for (std::size_t k = 0; k < one.free.size(); ++k)
        warped_[one.free[k]] = one.x[static_cast<std::ptrdiff_t>(k)];
      if (!one.held.empty()) continue;
      double shift = 0;
      for (std::ptrdiff_t i = 0; i < nodes_; ++i)
        shift += weight_[i] * (linear_[block_stride * i + axis] - warped_[block_stride * i + axis]);
      shift /= weight_.sum();
      for (std::ptrdiff_t i = 0; i < nodes_; ++i) warped_[block_stride * i + axis] += shift;
    }
    return finish(warped_, u);
  }

 private:
  struct Point {  // an integration point
    double volume;
    std::ptrdiff_t count, first;  // of its nodes in node_ and gradient_
  };
  struct Axis {
    std::vector<std::ptrdiff_t> free, held;  // places in a flat vector
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor;
    Eigen::VectorXd x;
  };

  template <class Mesh>
  void add_points(const Mesh& mesh, std::size_t e) {
    const auto add = [&](const auto& data) {
      points_.push_back({data.volume, static_cast<std::ptrdiff_t>(data.gradient.size()) + 1,
                         static_cast<std::ptrdiff_t>(node_.size())});
      Vec3<double> sum = Vec3<double>::Zero();
      for (const Vec3<double>& g : data.gradient) sum += g;
      gradient_.push_back(-sum);
      gradient_.insert(gradient_.end(), data.gradient.begin(), data.gradient.end());
      node_.insert(node_.end(), mesh.elements()[e].begin(), mesh.elements()[e].end());
    };
    if constexpr (requires { typename Mesh::Shape; }) {
      for (const auto& point : Mesh::Shape::stiffness_rule)
        add(Isoparametric<typename Mesh::Shape>::make(mesh.element_points(e), point));
    } else {
      add(LinearTetrahedron::make(mesh.element_points(e)));
    }
  }

  template <class Function>
  void for_each_point(Function f) const {
    for (const Point& p : points_) f(p, node_.data() + p.first, gradient_.data() + p.first);
  }

  // grad (Phi a) at a point.
  Mat3<double> gradient(const Point& p, const std::int32_t* node, const Vec3<double>* g) const {
    Mat3<double> H = Mat3<double>::Zero();
    for (std::ptrdiff_t i = 0; i < p.count; ++i) H += block(linear_, node[i]) * g[i].transpose();
    return H;
  }
  static Vec3<double> rotation_of(const Mat3<double>& H) {
    return 0.5 * Vec3<double>(H(2, 1) - H(1, 2), H(0, 2) - H(2, 0), H(1, 0) - H(0, 1));
  }

  // The matrix of int grad u_axis . grad v_axis dV; without a support node 0 is left at zero, and the mean
  // put right after the solve.
  template <class T>
  void factorise(const Prescribed<T>& prescribed, int axis) {
    Axis& one = axes_[static_cast<std::size_t>(axis)];
    std::vector<std::int32_t> number(static_cast<std::size_t>(nodes_), -1);
    for (std::ptrdiff_t i = 0; i < nodes_; ++i)
      if (prescribed.contains(static_cast<std::int32_t>(i), axis))
        one.held.push_back(block_stride * i + axis);
    for (std::ptrdiff_t i = one.held.empty() ? 1 : 0; i < nodes_; ++i)
      if (!prescribed.contains(static_cast<std::int32_t>(i), axis)) {
        number[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(one.free.size());
        one.free.push_back(block_stride * i + axis);
      }
    if (one.free.empty()) return;
    std::vector<Eigen::Triplet<double>> entries;
    for_each_point([&](const Point& p, const std::int32_t* node, const Vec3<double>* g) {
      for (std::ptrdiff_t i = 0; i < p.count; ++i)
        for (std::ptrdiff_t j = 0; j < p.count; ++j) {
          const std::int32_t row = number[static_cast<std::size_t>(node[i])],
                             column = number[static_cast<std::size_t>(node[j])];
          if (row >= 0 && column >= 0) entries.emplace_back(row, column, p.volume * g[i].dot(g[j]));
        }
    });
    const auto n = static_cast<std::ptrdiff_t>(one.free.size());
    Eigen::SparseMatrix<double> L(n, n);
    L.setFromTriplets(entries.begin(), entries.end());
    one.factor.compute(L);
    const double rounding = 1e3 * std::numeric_limits<double>::epsilon() * L.diagonal().maxCoeff();
    if (one.factor.info() != Eigen::Success || !(one.factor.vectorD().minCoeff() > rounding))
      invalid(std::string("warped modes: a piece of the mesh is not held along axis ") +
              std::to_string(axis) + ", a free body must be of one piece");
  }

  static LinearReport finish(const Eigen::VectorXd& result, Eigen::VectorXd& u) {
    if (!result.allFinite())
      return detail::ended(LinearReport{}, Status::not_finite, "warped modes: the shape is not finite");
    if (&result != &u) u = result;
    return detail::ended(LinearReport{}, Status::converged, "");
  }

  Eigen::MatrixXd shapes_;
  std::ptrdiff_t nodes_;
  std::vector<Point> points_;
  std::vector<std::int32_t> node_;
  std::vector<Vec3<double>> gradient_;
  Eigen::VectorXd weight_, linear_, rotation_, warped_;
  std::array<Axis, 3> axes_;
};

}  // namespace softsim
