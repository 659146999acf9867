// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <vector>

#include "softsim/core/error.hpp"
#include "softsim/core/state.hpp"
#include "softsim/system/mass.hpp"

namespace softsim {

/// Natural modes of a system linearised at a state: M-orthonormal shapes, Phi^T M Phi = I, with K Phi = M Phi
/// Omega^2.
struct Modes {
  Eigen::VectorXd frequencies;  ///< rad/s, ascending; 0 for rigid motions
  Eigen::MatrixXd shapes;       ///< one flat vector per column, 1/sqrt(kg)

  /// Number of modes.
  [[nodiscard]] std::ptrdiff_t count() const { return frequencies.size(); }
  /// The first m of them.
  /// @throws std::invalid_argument unless 1 <= m <= count()
  [[nodiscard]] Modes first(std::ptrdiff_t m) const {
    if (m < 1 || m > count())
      invalid(std::string("modes ") + std::to_string(m) + ": must lie in [1, " + std::to_string(count()) +
              "]");
    return {frequencies.head(m), shapes.leftCols(m)};
  }
};

namespace detail {
// M Phi, column by column.
template <class T>
Eigen::MatrixXd mass_times(const Mass<T>& mass, const Eigen::MatrixXd& shapes) {
  Eigen::MatrixXd result(shapes.rows(), shapes.cols());
  Vector<T> x, y;
  for (std::ptrdiff_t k = 0; k < shapes.cols(); ++k) {
    x = shapes.col(k).template cast<T>();
    y.setZero(x.size());
    mass.add_product(x, T(1), y);
    result.col(k) = y.template cast<double>();
  }
  return result;
}
}  // namespace detail

/// Modes from eigenpairs K x = lambda M x of any solver: sorted, and each shape scaled to x . M x = 1.
/// Orthogonality is the solver's matter, of equal eigenvalues too.
/// @param eigenvalues (rad/s)^2
/// @param vectors one flat vector per column, of any length, zero where a component is prescribed
/// @param zero_below eigenvalues of at most this magnitude are those of rigid motions and become 0
/// @throws std::invalid_argument if sizes do not fit, a number is not finite, an eigenvalue is below
///   -zero_below (the state is unstable), or a vector carries no mass
template <class T>
[[nodiscard]] Modes make_modes(const Mass<T>& mass, const Eigen::VectorXd& eigenvalues,
                               const Eigen::MatrixXd& vectors, double zero_below) {
  if (eigenvalues.size() == 0) invalid("modes: no eigenpair");
  if (vectors.cols() != eigenvalues.size() || vectors.rows() != mass.diagonal().size())
    invalid(std::string("modes: vectors are ") + std::to_string(vectors.rows()) + " x " +
            std::to_string(vectors.cols()) + ", must be " + std::to_string(mass.diagonal().size()) + " x " +
            std::to_string(eigenvalues.size()));
  if (!(zero_below >= 0))
    invalid(std::string("zero_below ") + to_text(zero_below) + ": must not be negative");
  std::vector<std::ptrdiff_t> order(static_cast<std::size_t>(eigenvalues.size()));
  std::iota(order.begin(), order.end(), std::ptrdiff_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::ptrdiff_t a, std::ptrdiff_t b) { return eigenvalues[a] < eigenvalues[b]; });
  const Eigen::MatrixXd products = detail::mass_times(mass, vectors);
  Modes modes{Eigen::VectorXd(eigenvalues.size()), Eigen::MatrixXd(vectors.rows(), vectors.cols())};
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::ptrdiff_t from = order[k], to = static_cast<std::ptrdiff_t>(k);
    const double lambda = eigenvalues[from], square = vectors.col(from).dot(products.col(from));
    const auto refuse = [&](const std::string& why) {
      invalid(std::string("eigenpair ") + std::to_string(from) + ": " + why);
    };
    if (!std::isfinite(lambda) || !std::isfinite(square)) refuse("must be finite");
    if (!(square > 0)) refuse("the vector carries no mass");
    if (lambda < -zero_below)
      refuse(std::string("eigenvalue ") + to_text(lambda) + ": must not be negative, the state is unstable");
    modes.frequencies[to] = lambda > zero_below ? std::sqrt(lambda) : 0;
    modes.shapes.col(to) = vectors.col(from) / std::sqrt(square);
  }
  return modes;
}

/// Largest entry of |Phi^T M Phi - I|: what a user's own modes are worth.
template <class T>
[[nodiscard]] double orthonormality_error(const Mass<T>& mass, const Modes& modes) {
  const Eigen::MatrixXd gram = modes.shapes.transpose() * detail::mass_times(mass, modes.shapes);
  return (gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff();
}

/// Effective mass of each mode along x, y, z, kg: (phi . M r)^2 with r the unit translation. The sum over all
/// modes is the mass that is free to move along that axis.
template <class T>
[[nodiscard]] Eigen::Matrix<double, Eigen::Dynamic, 3> effective_masses(const Mass<T>& mass,
                                                                        const Modes& modes) {
  Eigen::MatrixXd r = Eigen::MatrixXd::Zero(modes.shapes.rows(), 3);
  const State<T> rest = mass.rest_state();
  for (std::ptrdiff_t i = 0; i < rest.points(); ++i) r.block<3, 3>(block_stride * i, 0).setIdentity();
  for (std::ptrdiff_t j = 0; j < rest.frames(); ++j)
    r.block<3, 3>(block_stride * rest.frame_block(j), 0).setIdentity();  // and no rotation
  return (modes.shapes.transpose() * detail::mass_times(mass, r)).array().square();
}

}  // namespace softsim
