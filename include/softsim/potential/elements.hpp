// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "softsim/concepts.hpp"
#include "softsim/core/gather.hpp"
#include "softsim/potential/element_chunks.hpp"
#include "softsim/potential/hessian_blocks.hpp"

// Everything that a loop over chunks calls is inlined into it by force: with g++ a batch is else handed over
// through memory, which costs two to four times the arithmetic. Not where sanitizers multiply the code.
#if defined(__SANITIZE_ADDRESS__)
#define SOFTSIM_FLATTEN
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SOFTSIM_FLATTEN
#endif
#endif
#ifndef SOFTSIM_FLATTEN
#define SOFTSIM_FLATTEN [[gnu::flatten]]
#endif

namespace softsim {

/// What a local force may declare beside `LocalForce`:
///  - `translation_invariant = true`: no translation of its points changes it. It is then given displacements
///    relative to point 0 (which are zero there), and its force on point 0 is not asked for: the set makes
///    it minus the sum of the others.
///  - `from_positions = true`: it is given positions in m instead of displacements.
///  - `linearise(data, u)` and `linearised_product(data, linearisation, du)`: what is worth keeping between
///    products with the same tangent.
///  - `block_form(data, u)` and `hessian_block<i, j>(form)`, with `translation_invariant`: a 3x3 block of the
///    Hessian in closed form for 1 <= i <= j.
///  - `add_blocks(data, u, scale, add)`, which calls add(i, j, block) for all blocks i <= j of the Hessian
///  times
///    scale.
template <class E, class T>
concept Linearisable = requires(const E& e, const typename E::template Data<T>& data, const Unknowns<E, T>& u,
                                const Tangent<E, T>& du) {
  { e.linearised_product(data, e.linearise(data, u), du) } -> std::convertible_to<Tangent<E, T>>;
};

/// A set of like stencils, evaluated N at a time on SIMD lanes (N = 1: one at a time): the only place that
/// gathers unknowns and scatters forces. Stencils are sorted by model, so that every chunk of N shares its
/// parameters, and cut into stretches, within which neighbours in a chunk share no block where that can be
/// had. With OpenMP, stretches are worked off colour by colour in parallel, with the same bits for any number
/// of threads; without, one after the other, which a large mesh's memory likes better (and which rounds in
/// another order). Lanes left over at the end of a stretch repeat a real stencil and are not scattered. One
/// object serves one caller at a time. Models `ForceTerm`, and `Potential` where E has an energy. T is float
/// or double.
template <class E, class T = double, int N = default_lanes<T>>
class Elements : ElementChunks<E, T, N> {
  using Store = ElementChunks<E, T, N>;
  using Store::chunks_, Store::data_of, Store::for_each_stretch, Store::frames, Store::lanes, Store::models_,
      Store::points, Store::stretches_;
  using typename Store::Stretch;

 public:
  using Scalar = T;
  using Store::blocks, Store::for_each_stencil, Store::remove, Store::size;
  using typename Store::RestData, typename Store::Stencil, typename Store::Value;
  static_assert(LocalForce<E, Value>);

  /// False if the Hessian product given to solvers is only the symmetric part of the force's derivative.
  static constexpr bool conservative = LocalPotential<E, Value>;
  /// True for a load from outside, which residuals are measured against.
  static constexpr bool external = requires { requires E::external; };
  /// The force depends on the state.
  static constexpr bool has_hessian = true;

  /// @param models parameter sets, one per material
  /// @param data rest data per stencil
  /// @param stencils block numbers per stencil
  /// @param model_index which of the models each stencil uses; empty means the first for all
  /// @param rest rest positions of all points in m, for an E that works from positions
  /// @throws std::invalid_argument for lists of different lengths, an index out of range or a stencil with a
  ///   block twice
  Elements(std::vector<E> models, const std::vector<RestData>& data, const std::vector<Stencil>& stencils,
           const std::vector<std::int32_t>& model_index = {}, const std::vector<Vec3<double>>& rest = {})
      : Store(std::move(models), data, stencils, model_index) {
    if constexpr (from_positions) {
      rest_ = State<T>(rest.size()).displacement;
      for (std::size_t i = 0; i < rest.size(); ++i)
        block(rest_, static_cast<std::ptrdiff_t>(i)) = rest[i].template cast<T>();
    }
  }

  /// Sum of the energies in J, accumulated in double in fixed order.
  [[nodiscard]] double energy(const State<T>& q) const requires LocalPotential<E, Value> {
    return sum(q, [](const E& model, const Data& data, const Unknowns<E, Value>& u) {
      return model.energy(data, u);
    });
  }

  /// Number of elements that are inverted or flat at q: det F <= 0 at an integration point.
  [[nodiscard]] std::size_t inverted(const State<T>& q) const requires requires {
    &E::template volume_ratio<Value>;
  }
  {
    const double count = sum(q, [](const E& model, const Data& data, const Unknowns<E, Value>& u) {
      return select(model.volume_ratio(data, u) > Value(0), Value(0), Value(1));
    });
    return static_cast<std::size_t>(count);
  }

  /// y += dE/dq (minus the force), N.
  void add_gradient(const State<T>& q, Vector<T>& y) const {
    visit(q, &y, [](const E& model, const Data& data, const Unknowns<E, Value>& u, const Chunk&) {
      return model.gradient(data, u);
    });
  }

  /// y += (d^2E/dq^2) d.
  void add_hessian_product(const State<T>& q, const Vector<T>& d, Vector<T>& y) const {
    const T* from = d.data();
    visit(q, &y, [from](const E& model, const Data& data, const Unknowns<E, Value>& u, const Chunk& chunk) {
      return model.hessian_product(data, u, gather_tangent(chunk, from));
    });
  }

  /// What products with one tangent share, chunk by chunk.
  class Linearised {
    friend Elements;
    template <class F, bool keeps>
    struct Kept {
      using type = char;
    };
    template <class F>
    struct Kept<F, true> {
      using type = std::remove_cvref_t<decltype(std::declval<const F&>().linearise(
          std::declval<const typename F::template Data<Value>&>(),
          std::declval<const Unknowns<F, Value>&>()))>;
    };
    using Item = typename Kept<E, Linearisable<E, Value>>::type;
    std::vector<Item, Eigen::aligned_allocator<Item>> items;
  };

  /// Keeps in `to` what products with the tangent at q share.
  void linearise(const State<T>& q, Linearised& to) const requires Linearisable<E, Value> {
    to.items.resize(chunks_.size());
    visit(q, nullptr, [&](const E& model, const Data& data, const Unknowns<E, Value>& u, const Chunk& chunk) {
      to.items[static_cast<std::size_t>(&chunk - chunks_.data())] = model.linearise(data, u);
    });
  }
  /// y += (d^2E/dq^2) d at the state of the last `linearise`.
  void add_linearised_product(const Linearised& at, const Vector<T>& d,
                              Vector<T>& y) const requires Linearisable<E, Value> {
    for_each_stretch(
        [&](const Stretch& s) { add_linearised_product_of(s, at.items.data(), d.data(), y.data()); });
  }

  /// y += D(q) v: minus a damping force, N.
  void add_damping_product(const State<T>& q, const Vector<T>& v, Vector<T>& y) const requires requires {
    &E::template damping_product<Value>;
  }
  {
    visit(q, &y, [&](const E& model, const Data& data, const Unknowns<E, Value>& u, const Chunk& chunk) {
      return model.damping_product(data, u, gather_tangent(chunk, v.data()));
    });
  }

  /// y += the discrete gradient between two states: in every stencil it does the work of the difference of
  /// the energies over q_1 - q_0 and has the symmetries of the energy (Gonzalez), N.
  void add_discrete_gradient(const State<T>& q_0, const State<T>& q_1, Vector<T>& y) const requires(
      !requires { requires E::from_positions; } && requires { &E::template discrete_gradient<Value>; }) {
    const T* from = q_0.displacement.data();
    visit(q_1, &y, [&](const E& model, const Data& data, const Unknowns<E, Value>& u, const Chunk& chunk) {
      return model.discrete_gradient(data, gather(chunk, from), u);
    });
  }

  /// Adds scale times the upper triangle of each stencil's Hessian to 3x3 blocks (nine scalars each,
  /// column-major). `places` holds, stencil by stencil in storage order, those of the blocks (0,0), (0,1),
  /// ..., (1,1), ...: see `SymmetricBlockMatrix::place`; -1 leaves a block out.
  void add_blocks(const State<T>& q, T scale, const std::vector<std::int32_t>& places, T* values) const {
    const T* from = unknowns(q);
    for_each_stretch([&](const Stretch& s) {
      add_blocks_of(s, from, scale, places.data() + s.before * Places::stride, values);
    });
  }

 protected:
  using Store::forget, Store::remembers, Store::set_models;
  using typename Store::Chunk, typename Store::Data;

  /// Calls f(model, data, u, chunk) for every chunk; f may write to the memory in `data`. The forces that it
  /// returns, if any, are added to y.
  template <class Function>
  void visit(const State<T>& q, Vector<T>* y, Function f) const {
    const T* from = unknowns(q);
    for_each_stretch([&](const Stretch& s) { visit_of(s, from, y, f); });
  }

 private:
  static constexpr bool translation_invariant = requires { requires E::translation_invariant; };
  static constexpr bool from_positions = requires { requires E::from_positions; };

  // What the stencils gather from: displacements, or positions made of them once for all stencils.
  const T* unknowns(const State<T>& q) const {
    if constexpr (from_positions) {
      positions_ = rest_ + q.displacement;
      return positions_.data();
    } else {
      return q.displacement.data();
    }
  }

  // Sum of f(model, data, u) over all stencils, stretch by stretch in fixed order.
  template <class Function>
  [[nodiscard]] double sum(const State<T>& q, Function f) const {
    const T* from = unknowns(q);
    for_each_stretch([&](const Stretch& s) { s.sum = sum_of(s, from, f); });
    double result = 0;
    for (const Stretch& s : stretches_) result += s.sum;
    return result;
  }

  // The loops over chunks.

  template <class Function>
  SOFTSIM_FLATTEN void visit_of(const Stretch& s, const T* from, Vector<T>* y, const Function& f) const {
    const E& model = models_[s.model];
    const Chunk* chunk = chunks_.data() + s.first;
    for (int k = 0; k < s.count; k += N, ++chunk) {
      const auto call = [&] { return f(model, data_of(*chunk), gather(*chunk, from), *chunk); };
      if constexpr (std::is_void_v<decltype(call())>)
        call();
      else
        scatter(*chunk, std::min(N, s.count - k), call(), y->data());
    }
  }
  template <class Function>
  SOFTSIM_FLATTEN double sum_of(const Stretch& s, const T* from, const Function& f) const {
    const E& model = models_[s.model];
    double sum = 0;
    const Chunk* chunk = chunks_.data() + s.first;
    for (int k = 0; k < s.count; k += N, ++chunk) {
      const Value w = f(model, data_of(*chunk), gather(*chunk, from));
      for (int l = 0; l < std::min(N, s.count - k); ++l) sum += static_cast<double>(lane(w, l));
    }
    return sum;
  }
  template <class Item>
  SOFTSIM_FLATTEN void add_linearised_product_of(const Stretch& s, const Item* items, const T* d,
                                                 T* y) const {
    const E& model = models_[s.model];
    const Chunk* chunk = chunks_.data() + s.first;
    const Item* item = items + s.first;
    for (int k = 0; k < s.count; k += N, ++chunk, ++item)
      scatter(*chunk, std::min(N, s.count - k),
              model.linearised_product(data_of(*chunk), *item, gather_tangent(*chunk, d)), y);
  }

  using Places = detail::BlockPlaces<T, N, blocks>;
  SOFTSIM_FLATTEN void add_blocks_of(const Stretch& s, const T* from, T scale, const std::int32_t* places,
                                     T* values) const {
    const E& model = models_[s.model];
    const Chunk* chunk = chunks_.data() + s.first;
    for (int k = 0; k < s.count; k += N, ++chunk, places += N * Places::stride) {
      const Places to{values, places, std::min(N, s.count - k), scale};
      const Unknowns<E, Value> u = gather(*chunk, from);
      if constexpr (requires {
                      model.add_blocks(data_of(*chunk), u, Value(scale), [](int, int, Mat3<Value>) {});
                    }) {
        const auto add = [&](int i, int j, const Mat3<Value>& m) { to.add(i, j, m); };
        model.add_blocks(data_of(*chunk), u, Value(scale), add);
      } else if constexpr (closed_blocks) {
        detail::add_closed_blocks(model, model.block_form(data_of(*chunk), u), to);
      } else if constexpr (Linearisable<E, Value>) {
        const auto at = model.linearise(data_of(*chunk), u);
        detail::add_block_columns<translation_invariant>(
            to, [&](const Tangent<E, Value>& d) { return model.linearised_product(data_of(*chunk), at, d); });
      } else {
        detail::add_block_columns<translation_invariant>(
            to, [&](const Tangent<E, Value>& d) { return model.hessian_product(data_of(*chunk), u, d); });
      }
    }
  }

  static constexpr bool closed_blocks =
      translation_invariant &&
      requires(const E& e, const typename E::template Data<Value>& data, const Unknowns<E, Value>& u) {
    { e.template hessian_block<1, 1>(e.block_form(data, u)) } -> std::convertible_to<Mat3<Value>>;
  };

  static Unknowns<E, Value> gather(const Chunk& chunk, const T* from) {
    Unknowns<E, Value> u;
    if constexpr (translation_invariant)
      gather_relative<T, N>(from, chunk.ids, u.points);
    else
      for (std::size_t i = 0; i < points; ++i) u.points[i] = gather_blocks<T, N>(from, chunk.ids[i]);
    if constexpr (frames > 0)
      for (std::size_t j = 0; j < frames; ++j) {
        const BlockIds<N>& ids = chunk.ids[points + j];
        u.frames[j].displacement = gather_blocks<T, N>(from, ids);
        u.frames[j].turn = rotation_less_identity<Value>(gather_whole_blocks<T, N>(from + block_stride, ids));
      }
    return u;
  }
  static Tangent<E, Value> gather_tangent(const Chunk& chunk, const T* from) {
    Tangent<E, Value> d;
    if constexpr (translation_invariant) {
      const Unknowns<E, Value> u = gather(chunk, from);
      for (std::size_t i = 0; i < points; ++i) d.template segment<3>(3 * static_cast<int>(i)) = u.points[i];
    } else {
      for_each_block(chunk, [&](int i, const BlockIds<N>& ids, int rotational) {
        d.template segment<3>(3 * i) = gather_blocks<T, N>(from + rotational, ids);
      });
    }
    return d;
  }
  // Calls f(block of the stencil, ids, how far the flat vector is to be shifted) for points, and twice for
  // frames: their rotational blocks follow the others.
  template <class Function>
  static void for_each_block(const Chunk& chunk, Function f) {
    for (std::size_t i = 0; i < points; ++i) f(static_cast<int>(i), chunk.ids[i], 0);
    for (std::size_t j = 0; j < frames; ++j) {
      f(static_cast<int>(points + 2 * j), chunk.ids[points + j], 0);
      f(static_cast<int>(points + 2 * j + 1), chunk.ids[points + j], block_stride);
    }
  }

  static void scatter(const Chunk& chunk, int count, const Tangent<E, Value>& f, T* y) {
    if constexpr (translation_invariant) {
      scatter_add_balanced<T, N>(y, chunk.ids, f.data(), count);
    } else {
      for_each_block(chunk, [&](int i, const BlockIds<N>& ids, int rotational) {
        const Vec3<Value> part = f.template segment<3>(3 * i);
        scatter_add_blocks<T, N>(y + rotational, ids, part, count);
      });
    }
  }

  Vector<T> rest_;
  mutable Vector<T> positions_;
};

}  // namespace softsim
