// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "softsim/core/error.hpp"
#include "softsim/reduction/modes.hpp"
#include "softsim/system/mass.hpp"

namespace softsim {

/// Options of `pod`.
struct PodOptions {
  double energy = 0.9999;          ///< share of the sum of squared singular values to keep, in (0, 1]
  std::ptrdiff_t max_vectors = 0;  ///< at most so many, whatever the share; 0: no bound
};

/// Proper orthogonal decomposition of snapshots.
struct PodBasis {
  Eigen::MatrixXd vectors;          ///< one flat vector per column, orthonormal (M-orthonormal if weighted)
  Eigen::VectorXd singular_values;  ///< all of them, descending; those of the vectors come first
  double energy_kept = 0;           ///< share of the sum of squares
};

namespace detail {

inline void check_snapshots(const Eigen::MatrixXd& snapshots, const PodOptions& options) {
  if (snapshots.cols() == 0 || snapshots.rows() == 0) invalid("pod: no snapshots");
  if (!snapshots.allFinite()) invalid("pod: snapshots must be finite");
  if (snapshots.isZero(0)) invalid("pod: all snapshots are zero");
  if (!(options.energy > 0 && options.energy <= 1))
    invalid(std::string("energy ") + to_text(options.energy) + ": must lie in (0, 1]");
  const std::ptrdiff_t most = std::min(snapshots.rows(), snapshots.cols());
  if (options.max_vectors < 0 || options.max_vectors > most)
    invalid(std::string("max_vectors ") + std::to_string(options.max_vectors) + ": must lie in [0, " +
            std::to_string(most) + "], the smaller of unknowns and snapshots");
}

// How many singular values the options keep; those below `floor` times the first are rounding.
inline std::ptrdiff_t kept_vectors(PodBasis& basis, const PodOptions& options, double floor) {
  const Eigen::VectorXd& s = basis.singular_values;
  const double total = s.squaredNorm();
  double sum = 0;
  std::ptrdiff_t r = 0;
  while (r < s.size() && s[r] > floor * s[0] && (r == 0 || sum < options.energy * total) &&
         (options.max_vectors == 0 || r < options.max_vectors))
    sum += s[r] * s[r], ++r;
  basis.energy_kept = sum / total;
  return r;
}

inline PodBasis pod_by_svd(const Eigen::MatrixXd& weighted, const PodOptions& options) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(weighted, Eigen::ComputeThinU);
  PodBasis basis;
  basis.singular_values = svd.singularValues();
  const double floor =
      std::numeric_limits<double>::epsilon() * static_cast<double>(weighted.rows() + weighted.cols());
  basis.vectors = svd.matrixU().leftCols(kept_vectors(basis, options, floor));
  // what no snapshot moves stays exactly where it is
  for (std::ptrdiff_t k = 0; k < weighted.rows(); ++k)
    if (weighted.row(k).isZero(0)) basis.vectors.row(k).setZero();
  return basis;
}

}  // namespace detail

/// Orthonormal vectors that represent the snapshots best in the mean square, by singular value decomposition.
/// @param snapshots one flat vector of displacements per column: as a rule increments from the state that
///   the reduced motion starts at, so that prescribed components are zero
/// @throws std::invalid_argument for no snapshots, ones that are all zero or not finite, an energy outside
///   (0, 1], more vectors than unknowns or snapshots
[[nodiscard]] inline PodBasis pod(const Eigen::MatrixXd& snapshots, const PodOptions& options = {}) {
  detail::check_snapshots(snapshots, options);
  return detail::pod_by_svd(snapshots, options);
}

/// The same with lengths measured by the mass, x . M x: heavy nodes count more, and fine regions of the mesh
/// no more than coarse ones. With a lumped mass by singular value decomposition; with a consistent mass by
/// the method of snapshots (Sirovich 1987), which sees singular values down to 1e-7 of the first.
/// @throws std::invalid_argument as above, and if the mass has another size or a node that moves has none
template <class T>
[[nodiscard]] PodBasis pod(const Eigen::MatrixXd& snapshots, const Mass<T>& mass,
                           const PodOptions& options = {}) {
  detail::check_snapshots(snapshots, options);
  if (mass.diagonal().size() != snapshots.rows())
    invalid(std::string("pod: mass of ") + std::to_string(mass.diagonal().size()) + " scalars, must be " +
            std::to_string(snapshots.rows()));
  Eigen::VectorXd root = mass.diagonal().template cast<double>().cwiseSqrt();
  for (std::ptrdiff_t k = 0; k < root.size(); ++k) {
    if (root[k] > 0) continue;
    if (!snapshots.row(k).isZero(0))
      invalid(std::string("node ") + std::to_string(k / block_stride) + ": moves, but has no mass");
    root[k] = 1;
  }
  if (mass.is_lumped()) {
    PodBasis basis = detail::pod_by_svd(root.asDiagonal() * snapshots, options);
    basis.vectors = root.cwiseInverse().asDiagonal() * basis.vectors;
    return basis;
  }
  const Eigen::MatrixXd gram = snapshots.transpose() * detail::mass_times(mass, snapshots);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gram);
  PodBasis basis;
  basis.singular_values = eigen.eigenvalues().reverse().cwiseMax(0).cwiseSqrt();
  const std::ptrdiff_t r = detail::kept_vectors(basis, options, 1e-7);
  basis.vectors = snapshots * eigen.eigenvectors().rowwise().reverse().leftCols(r);
  // Small singular values leave the columns a little oblique: twice is enough.
  for (int pass = 0; pass < 2; ++pass) {
    const Eigen::MatrixXd scaled = basis.vectors * basis.vectors.colwise().norm().cwiseInverse().asDiagonal();
    const Eigen::LLT<Eigen::MatrixXd> factor(scaled.transpose() * detail::mass_times(mass, scaled));
    basis.vectors = factor.matrixU().template solve<Eigen::OnTheRight>(scaled);
  }
  return basis;
}

}  // namespace softsim
