// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "softsim/core/state.hpp"
#include "softsim/system/block_matrix.hpp"
#include "softsim/system/system.hpp"

namespace softsim {

/// Weights of the operator A = mass M + stiffness K(q) + lagged K(q_0), the last without damping forces. In
/// K(q) loads from outside that depend on the state count `external` times as much.
struct TangentWeights {
  double mass = 0;
  double stiffness = 1;
  double lagged = 0;
  double external = 1;
};

namespace detail {

// Places of the upper triangles of all stencils of one term in a matrix.
template <class Term, class Place>
std::vector<std::int32_t> stencil_places(const Term& term, Place place) {
  std::vector<std::int32_t> result;
  if constexpr (Term::has_hessian)
    term.for_each_stencil([&](const auto& stencil) {
      for (std::size_t i = 0; i < stencil.size(); ++i)
        for (std::size_t j = i; j < stencil.size(); ++j) result.push_back(place(stencil[i], stencil[j]));
    });
  return result;
}

template <class S>
std::size_t stencil_count(const S& system) {
  std::size_t count = 0;
  system.for_each_term([&](const auto& term) {
    if constexpr (std::decay_t<decltype(term)>::has_hessian) count += term.size();
  });
  return count;
}

// Adds scale K(q) block by block, without the terms that are damping forces themselves if not asked for them.
template <bool with_viscous = true, class S, class T>
void add_stiffness(const S& system, const State<T>& q, double scale, double external,
                   const std::vector<std::vector<std::int32_t>>& places, T* values) {
  std::size_t k = 0;
  system.for_each_term([&](const auto& term) {
    using Term = std::decay_t<decltype(term)>;
    if constexpr (Term::has_hessian && (with_viscous || !is_viscous<Term>))
      term.add_blocks(q, static_cast<T>(Term::external ? scale * external : scale), places[k], values);
    ++k;
  });
}

}  // namespace detail

/// The tangent as an assembled matrix of 3x3 blocks: the pattern is made at the first `set`, later ones
/// refill it. The faster choice where the same tangent multiplies more than about eight times.
template <class S>
class AssembledTangent {
 public:
  using T = typename S::Scalar;

  /// Linearises `system` at q (and q_0, if its weight is not zero).
  void set(const S& system, const State<T>& q, const TangentWeights& weights, const State<T>* q_0 = nullptr) {
    if (number_ != system.number() || stencils_ != detail::stencil_count(system) ||
        couplings_ != system.mass.couplings() || frame_masses_ != system.mass.frames().size())
      make_pattern(system);
    system_ = &system;
    matrix_.set_zero();
    detail::add_stiffness(system, q, weights.stiffness, weights.external, places_, matrix_.values());
    if (weights.lagged != 0)
      detail::add_stiffness<false>(system, *q_0, weights.lagged, 1, places_, matrix_.values());
    if (weights.mass != 0) {
      const T w = static_cast<T>(weights.mass);
      const std::size_t points = system.mass.frames().size() > 0 ? system.points() : diagonal_.size();
      for (std::size_t i = 0; i < points; ++i)
        matrix_.block(diagonal_[i]).diagonal() +=
            w * block(system.mass.diagonal(), static_cast<std::ptrdiff_t>(i));
      std::size_t k = 0;
      system.mass.for_each_coupling([&](std::int32_t i, std::int32_t j, T m) {
        if (i < j) matrix_.block(mass_places_[k] / 2).diagonal().array() += w * m;
        ++k;
      });
      system.mass.frames().for_each_block(q, [&](std::int32_t, std::int32_t, const Mat3<T>& M) {
        matrix_.block(mass_places_[k++] / 2) += w * M;
      });
    }
  }

  /// y = A x, zero where a component is prescribed.
  void apply(const Vector<T>& x, Vector<T>& y) const {
    matrix_.apply(x, y);
    system_->prescribed.mask(y);
  }

  /// Diagonal blocks of A.
  void diagonal_blocks(std::vector<Mat3<T>>& blocks) const {
    blocks.resize(diagonal_.size());
    for (std::size_t i = 0; i < diagonal_.size(); ++i) blocks[i] = matrix_.block(diagonal_[i]);
  }

  /// Number of frames, whose blocks come last.
  [[nodiscard]] std::size_t frames() const { return system_->frames(); }
  /// Blocks of A that couple displacement (rows) and rotation (columns) of each frame.
  void frame_blocks(std::vector<Mat3<T>>& blocks) const {
    blocks.resize(frame_.size());
    for (std::size_t j = 0; j < frame_.size(); ++j) blocks[j] = matrix_.block(frame_[j]);
  }

  /// Rest positions, m, one per block.
  [[nodiscard]] const std::vector<Vec3<double>>& rest() const { return system_->rest(); }
  /// The matrix, prescribed components included.
  [[nodiscard]] const SymmetricBlockMatrix<T>& matrix() const { return matrix_; }

 private:
  void make_pattern(const S& system) {
    number_ = system.number();
    stencils_ = detail::stencil_count(system);
    couplings_ = system.mass.couplings();
    frame_masses_ = system.mass.frames().size();
    const State<T> rest = system.rest_state();
    const std::size_t n = system.rest().size();
    std::vector<std::pair<std::int32_t, std::int32_t>> blocks;
    for (std::size_t i = 0; i < n; ++i)
      blocks.emplace_back(static_cast<std::int32_t>(i), static_cast<std::int32_t>(i));
    for (std::size_t i = system.points(); i < n; i += 2)
      blocks.emplace_back(static_cast<std::int32_t>(i), static_cast<std::int32_t>(i + 1));
    system.for_each_term([&](const auto& term) {
      if constexpr (std::decay_t<decltype(term)>::has_hessian)
        term.for_each_stencil([&](const auto& stencil) {
          for (std::size_t i = 0; i < stencil.size(); ++i)
            for (std::size_t j = i; j < stencil.size(); ++j) blocks.emplace_back(stencil[i], stencil[j]);
        });
    });
    system.mass.for_each_coupling([&](std::int32_t i, std::int32_t j, T) { blocks.emplace_back(i, j); });
    system.mass.frames().for_each_block(
        rest, [&](std::int32_t i, std::int32_t j, const Mat3<T>&) { blocks.emplace_back(i, j); });
    matrix_ = SymmetricBlockMatrix<T>(n, std::move(blocks));
    const auto place = [&](std::int32_t i, std::int32_t j) { return matrix_.place(i, j); };
    places_.clear();
    system.for_each_term([&](const auto& term) { places_.push_back(detail::stencil_places(term, place)); });
    diagonal_.clear();
    for (std::size_t i = 0; i < n; ++i)
      diagonal_.push_back(place(static_cast<std::int32_t>(i), static_cast<std::int32_t>(i)) / 2);
    frame_.clear();
    for (std::size_t i = system.points(); i < n; i += 2)
      frame_.push_back(place(static_cast<std::int32_t>(i), static_cast<std::int32_t>(i + 1)) / 2);
    mass_places_.clear();
    system.mass.for_each_coupling(
        [&](std::int32_t i, std::int32_t j, T) { mass_places_.push_back(place(i, j)); });
    system.mass.frames().for_each_block(
        rest, [&](std::int32_t i, std::int32_t j, const Mat3<T>&) { mass_places_.push_back(place(i, j)); });
  }

  const S* system_ = nullptr;
  std::uint64_t number_ = 0;
  std::size_t stencils_ = 0, couplings_ = 0, frame_masses_ = 0;
  SymmetricBlockMatrix<T> matrix_;
  std::vector<std::vector<std::int32_t>> places_;
  std::vector<std::int32_t> diagonal_, frame_, mass_places_;
};

namespace detail {

// What a term keeps between products with the same tangent.
struct KeepsNothing {};
template <class Term>
struct Kept {
  using type = KeepsNothing;
};
template <class Term>
requires requires(const Term& term, const State<typename Term::Scalar>& q, typename Term::Linearised& kept,
                  Vector<typename Term::Scalar>& y) {
  term.linearise(q, kept);
  term.add_linearised_product(kept, y, y);
}
struct Kept<Term> {
  using type = typename Term::Linearised;
};
template <class Terms>
struct KeptByAll;
template <class... Terms>
struct KeptByAll<std::tuple<Terms...>> {
  using type = std::tuple<typename Kept<Terms>::type...>;
};

}  // namespace detail

/// The tangent as a product that stores nothing but the states and what terms keep between products (see
/// `Linearisable`): the choice for few products or little memory.
template <class S>
class MatrixFreeTangent {
 public:
  using T = typename S::Scalar;

  /// Linearises `system` at q (and q_0, if its weight is not zero); the states must stay alive and unchanged.
  void set(const S& system, const State<T>& q, const TangentWeights& weights, const State<T>* q_0 = nullptr) {
    if (number_ != system.number() || stencils_ != detail::stencil_count(system)) {
      number_ = system.number();
      stencils_ = detail::stencil_count(system);
      places_.clear();
      // The blocks on the diagonal, and behind them those that couple the two of each frame.
      const auto n = static_cast<std::int32_t>(system.rest().size()),
                 points = static_cast<std::int32_t>(system.points());
      const auto place = [&](std::int32_t i, std::int32_t j) {
        const bool one_frame = i >= points && (i - points) % 2 == 0 && j == i + 1;
        return i == j ? 2 * i : one_frame ? 2 * (n + (i - points) / 2) : -1;
      };
      system.for_each_term([&](const auto& term) { places_.push_back(detail::stencil_places(term, place)); });
    }
    system_ = &system;
    q_ = &q;
    q_0_ = q_0;
    weights_ = weights;
    scratch_.setZero(system.size());
    for_each_kept([&](const auto& term, auto& kept) { term.linearise(q, kept); });
  }

  /// y = A x, zero where a component is prescribed.
  void apply(const Vector<T>& x, Vector<T>& y) const {
    y.setZero();
    if (weights_.stiffness == 1) {
      add_product(x, y);
    } else {
      scratch_ = static_cast<T>(weights_.stiffness) * x;  // the Hessian is linear in its direction
      add_product(scratch_, y);
    }
    if (weights_.lagged != 0) {
      scratch_ = static_cast<T>(weights_.lagged) * x;
      system_->add_elastic_hessian_product(*q_0_, scratch_, y);
    }
    if (weights_.mass != 0) system_->mass.add_product(*q_, x, static_cast<T>(weights_.mass), y);
    system_->prescribed.mask(y);
  }

  /// Diagonal blocks of A.
  void diagonal_blocks(std::vector<Mat3<T>>& blocks) const {
    all_blocks(blocks);
    blocks.resize(system_->rest().size());
  }
  /// Number of frames, whose blocks come last.
  [[nodiscard]] std::size_t frames() const { return system_->frames(); }
  /// Blocks of A that couple displacement (rows) and rotation (columns) of each frame.
  void frame_blocks(std::vector<Mat3<T>>& blocks) const {
    all_blocks(blocks);
    blocks.erase(blocks.begin(), blocks.begin() + static_cast<std::ptrdiff_t>(system_->rest().size()));
  }

 private:
  void all_blocks(std::vector<Mat3<T>>& blocks) const {
    const std::size_t n = system_->rest().size();
    blocks.assign(n + frames(), Mat3<T>::Zero());
    for (std::size_t i = 0; i < n; ++i)
      blocks[i] =
          static_cast<T>(weights_.mass) *
          block(system_->mass.diagonal(), static_cast<std::ptrdiff_t>(i)).asDiagonal().toDenseMatrix();
    const std::size_t points = system_->points();
    if (weights_.mass != 0)
      system_->mass.frames().for_each_block(*q_, [&](std::int32_t i, std::int32_t j, const Mat3<T>& M) {
        const std::size_t row = static_cast<std::size_t>(i), column = static_cast<std::size_t>(j);
        if (row == column)
          blocks[row] = static_cast<T>(weights_.mass) * M;
        else if (column == row + 1 && (row - points) % 2 == 0)
          blocks[n + (row - points) / 2] = static_cast<T>(weights_.mass) * M;
      });
    T* values = blocks.front().data();
    detail::add_stiffness(*system_, *q_, weights_.stiffness, weights_.external, places_, values);
    if (weights_.lagged != 0)
      detail::add_stiffness<false>(*system_, *q_0_, weights_.lagged, 1, places_, values);
  }

  using AllKept = typename detail::KeptByAll<decltype(S::terms)>::type;

  void add_product(const Vector<T>& x, Vector<T>& y) const {
    [&]<std::size_t... i>(std::index_sequence<i...>) {
      (add_product_of(std::get<i>(system_->terms), std::get<i>(kept_), x, y), ...);
    }
    (std::make_index_sequence<std::tuple_size_v<AllKept>>());
  }
  template <class Term, class Kept>
  void add_product_of(const Term& term, const Kept& kept, const Vector<T>& x, Vector<T>& y) const {
    if constexpr (Term::external && Term::has_hessian)
      if (weights_.external != 1) {
        external_ = static_cast<T>(weights_.external) * x;
        return add_product_of_one(term, kept, external_, y);
      }
    add_product_of_one(term, kept, x, y);
  }
  template <class Term, class Kept>
  void add_product_of_one(const Term& term, const Kept& kept, const Vector<T>& x, Vector<T>& y) const {
    if constexpr (std::is_same_v<Kept, detail::KeepsNothing>)
      term.add_hessian_product(*q_, x, y);
    else
      term.add_linearised_product(kept, x, y);
  }
  template <class Function>
  void for_each_kept(Function f) {
    [&]<std::size_t... i>(std::index_sequence<i...>) {
      const auto one = [&](const auto& term, auto& kept) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(kept)>, detail::KeepsNothing>) f(term, kept);
      };
      (one(std::get<i>(system_->terms), std::get<i>(kept_)), ...);
    }
    (std::make_index_sequence<std::tuple_size_v<AllKept>>());
  }

  const S* system_ = nullptr;
  AllKept kept_;
  const State<T>*q_ = nullptr, *q_0_ = nullptr;
  TangentWeights weights_;
  std::uint64_t number_ = 0;
  std::size_t stencils_ = 0;
  std::vector<std::vector<std::int32_t>> places_;
  mutable Vector<T> scratch_, external_;
};

/// Chooses the assembled tangent for a solver or an integrator.
struct Assembled {
  template <class S>
  using Tangent = AssembledTangent<S>;
};
/// Chooses the matrix-free tangent for a solver or an integrator.
struct MatrixFree {
  template <class S>
  using Tangent = MatrixFreeTangent<S>;
};

}  // namespace softsim
