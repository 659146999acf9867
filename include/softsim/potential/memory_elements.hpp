// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "softsim/concepts.hpp"
#include "softsim/core/error.hpp"
#include "softsim/core/gather.hpp"
#include "softsim/material/prony.hpp"

namespace softsim {

/// True if two flat vectors hold the same bits.
template <class T>
[[nodiscard]] bool same_bits(const Vector<T>& a, const Vector<T>& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(T)) == 0;
}

/// A set of like stencils, each of which remembers numbers from step to step; else as `Elements`. E computes
/// on a stencil's rest data and memory, and during a step its energy is what the step minimises:
/// - memory_size(): numbers to remember per stencil, zero at first;
/// - energy, gradient, hessian_product(data, memory, u, ...): as in `LocalPotential`;
/// - set_step(dt), set_static(): which step or problem they stand for from now on; dt = 0 means now;
/// - remember(data, memory, u): u is where the step starts; then prepare(memory);
/// - optionally, if all steps count: close(data, memory, u), a step of the dt set has ended in u, and
///   settle(data, memory, u, response), u has been solved for statically;
/// - optionally damping_product(data, u, v).
template <class E, class T = double, int N = default_lanes<T>>
class MemoryElements {
 public:
  using Scalar = T;
  using Value = Lanes<T, N>;
  using RestData = typename E::template Data<double>;

  /// Number of blocks in a stencil.
  static constexpr int blocks = E::points;
  /// Block numbers of one stencil.
  using Stencil = std::array<std::int32_t, blocks>;
  static constexpr bool conservative = true, external = false, has_hessian = true;
  /// The Hessian is that of a damping force, which Rayleigh damping leaves out.
  static constexpr bool viscous = requires { requires E::viscous; };
  /// The memory is of all steps, not only of the start of the last one.
  static constexpr bool accumulates = requires { &E::template close<Value>; };

  /// @param models parameter sets, one per material
  /// @param data rest data per stencil
  /// @param stencils block numbers per stencil
  /// @param model_index which of the models each stencil uses; empty means the first for all
  /// @throws std::invalid_argument for no model, lists of different lengths or an index out of range
  MemoryElements(std::vector<E> models, const std::vector<RestData>& data,
                 const std::vector<Stencil>& stencils, const std::vector<std::int32_t>& model_index = {})
      : models_(std::move(models)), size_(stencils.size()) {
    if (models_.empty()) invalid("elements with memory: no material");
    if (data.size() != size_)
      invalid(std::string("elements with memory: ") + std::to_string(data.size()) + " rest data for " +
              std::to_string(size_) + " stencils");
    if (!model_index.empty() && model_index.size() != size_)
      invalid(std::string("elements with memory: ") + std::to_string(model_index.size()) +
              " material indices for " + std::to_string(size_) + " elements");
    std::vector<std::vector<std::size_t>> members(models_.size());
    for (std::size_t e = 0; e < size_; ++e) {
      const std::int32_t m = model_index.empty() ? 0 : model_index[e];
      if (m < 0 || static_cast<std::size_t>(m) >= models_.size())
        invalid(std::string("element ") + std::to_string(e) + ": material index " + std::to_string(m) +
                " is out of range (there are " + std::to_string(models_.size()) + " materials)");
      members[static_cast<std::size_t>(m)].push_back(e);
    }
    for (std::size_t m = 0; m < models_.size(); ++m) add_run(m, members[m], data, stencils);
  }

  /// Number of stencils.
  [[nodiscard]] std::size_t size() const { return size_; }

  /// Forgets everything: the body is at rest and nothing has acted on it.
  void reset() {
    std::fill(memory_.begin(), memory_.end(), Value(0));
    known_.fill(std::numeric_limits<T>::quiet_NaN());  // the same as no state
    ahead_ = 0;
    set([](E& model) { model.set_step(0); });
  }
  /// Forces are those dt after the state q from now on; dt = 0 for integrators that need them at q.
  void begin_step(const State<T>& q, const Vector<T>&, double dt) {
    const bool moved = (dt > 0 || accumulates) && !same_bits(known_, q.displacement);
    if (dt == 0 && ahead_ == 0 && !moved) return;
    set([dt](E& model) { model.set_step(dt); });
    ahead_ = dt;
    if (moved) {
      visit(q, [](const E& model, auto&... stencil) { model.remember(stencil...); });
      known_ = q.displacement;
    }
    prepare();
  }
  /// A step of dt has ended in q.
  void end_step(const State<T>& q, const Vector<T>&, double dt) requires accumulates {
    set([dt](E& model) { model.set_step(dt); });
    visit(q, [](const E& model, auto&... stencil) { model.close(stencil...); });
    forces_of_now(q);
  }
  /// Forces are those of the static problem from now on.
  void begin_static() {
    set([](E& model) { model.set_static(); });
    ahead_ = -1;
    prepare();
  }
  /// The static problem has been solved by q: dynamics may go on from there in equilibrium.
  void end_static(const State<T>& q) requires accumulates {
    visit(q, [](const E& model, auto&... stencil) { model.settle(stencil..., model.static_response); });
    forces_of_now(q);
  }
  /// The body has been in q for ever.
  void settle(const State<T>& q) requires accumulates {
    visit(q, [](const E& model, auto&... stencil) { model.settle(stencil..., StaticResponse::relaxed); });
    forces_of_now(q);
  }

  /// Sum of the energies in J, accumulated in double in fixed order.
  [[nodiscard]] double energy(const State<T>& q) const {
    double sum = 0;
    for_each_chunk([&](const E& model, const Chunk& chunk, const Value* memory, int count) {
      const Value w = model.energy(chunk.data, memory, gather(chunk, q.displacement));
      for (int l = 0; l < count; ++l) sum += static_cast<double>(lane(w, l));
    });
    return sum;
  }
  /// y += dE/dq (minus the force), N.
  void add_gradient(const State<T>& q, Vector<T>& y) const {
    for_each_chunk([&](const E& model, const Chunk& chunk, const Value* memory, int count) {
      scatter(chunk, count, model.gradient(chunk.data, memory, gather(chunk, q.displacement)), y);
    });
  }
  /// y += (d^2E/dq^2) d.
  void add_hessian_product(const State<T>& q, const Vector<T>& d, Vector<T>& y) const {
    for_each_chunk([&](const E& model, const Chunk& chunk, const Value* memory, int count) {
      const Unknowns<E, Value> u = gather(chunk, q.displacement);
      scatter(chunk, count, model.hessian_product(chunk.data, memory, u, flat(gather(chunk, d))), y);
    });
  }
  /// y += D(q) v: minus the damping force that needs no memory, N.
  void add_damping_product(const State<T>& q, const Vector<T>& v, Vector<T>& y) const requires requires {
    &E::template damping_product<Value>;
  }
  {
    for_each_chunk([&](const E& model, const Chunk& chunk, const Value*, int count) {
      const Unknowns<E, Value> u = gather(chunk, q.displacement);
      scatter(chunk, count, model.damping_product(chunk.data, u, flat(gather(chunk, v))), y);
    });
  }

  /// Calls f(stencil) for every stencil in storage order.
  template <class Function>
  void for_each_stencil(Function f) const {
    for_each_chunk([&](const E&, const Chunk& chunk, const Value*, int count) {
      for (int l = 0; l < count; ++l) {
        Stencil s;
        for (std::size_t i = 0; i < blocks; ++i) s[i] = chunk.ids[i][static_cast<std::size_t>(l)];
        f(s);
      }
    });
  }
  /// Adds scale times each stencil's Hessian to 3x3 blocks, as `Elements::add_blocks`.
  void add_blocks(const State<T>& q, T scale, const std::vector<std::int32_t>& positions, T* values) const {
    const std::int32_t* position = positions.data();
    for_each_chunk([&](const E& model, const Chunk& chunk, const Value* memory, int count) {
      const Unknowns<E, Value> u = gather(chunk, q.displacement);
      for (int column = 0; column < 3 * blocks; ++column) {
        Tangent<E, Value> unit = Tangent<E, Value>::Zero();
        unit[column] = Value(scale);
        const Tangent<E, Value> h = model.hessian_product(chunk.data, memory, u, unit);
        for (int l = 0; l < count; ++l)
          for (int i = 0; i < blocks; ++i) {
            const std::int32_t p = position[(l * blocks + i) * blocks + column / 3];
            if (p < 0) continue;
            T* block = values + 9 * static_cast<std::ptrdiff_t>(p) + column % 3 * 3;
            for (int b = 0; b < 3; ++b) block[b] += lane(h[3 * i + b], l);
          }
      }
      position += count * blocks * blocks;
    });
  }

 private:
  struct Chunk {
    typename E::template Data<Value> data;
    std::array<BlockIds<N>, blocks> ids;
  };
  struct Run {
    std::size_t model, first, last;  // chunks [first, last)
    int tail;                        // stencils in the last chunk
    std::size_t memory;              // where the memory of its first chunk starts
  };

  void add_run(std::size_t model, const std::vector<std::size_t>& members, const std::vector<RestData>& data,
               const std::vector<Stencil>& stencils) {
    if (members.empty()) return;
    constexpr std::size_t n = static_cast<std::size_t>(N), numbers = sizeof(RestData) / sizeof(double);
    static_assert(sizeof(typename E::template Data<Value>) == numbers * sizeof(Value),
                  "Data<T> may hold scalars T only");
    const std::size_t first = chunks_.size(), count = (members.size() + n - 1) / n;
    chunks_.resize(first + count);
    for (std::size_t k = 0; k < count * n; ++k) {
      const std::size_t e = members[std::min(k, members.size() - 1)];
      Chunk& chunk = chunks_[first + k / n];
      std::array<double, numbers> rest;
      std::memcpy(rest.data(), &data[e], sizeof(RestData));
      std::array<Value, numbers> lanes;
      std::memcpy(static_cast<void*>(lanes.data()), &chunk.data, sizeof(lanes));
      for (std::size_t i = 0; i < numbers; ++i)
        set_lane(lanes[i], static_cast<int>(k % n), static_cast<T>(rest[i]));
      std::memcpy(static_cast<void*>(&chunk.data), lanes.data(), sizeof(lanes));
      for (std::size_t i = 0; i < blocks; ++i) chunk.ids[i][k % n] = stencils[e][i];
    }
    runs_.push_back(
        {model, first, first + count, static_cast<int>(members.size() - (count - 1) * n), memory_.size()});
    memory_.resize(memory_.size() + count * models_[model].memory_size(), Value(0));
  }

  // f(model, chunk, position of its memory, number of its stencils)
  template <class Function>
  void for_each_position(Function f) const {
    for (const Run& run : runs_) {
      const E& model = models_[run.model];
      std::size_t memory = run.memory;
      for (std::size_t c = run.first; c < run.last; ++c, memory += model.memory_size())
        f(model, chunks_[c], memory, c + 1 == run.last ? run.tail : N);
    }
  }
  template <class Function>
  void for_each_chunk(Function f) const {
    for_each_position([&](const E& model, const Chunk& chunk, std::size_t memory, int count) {
      f(model, chunk, memory_.data() + memory, count);
    });
  }
  // f(model, data, memory to write, unknowns)
  template <class Function>
  void visit(const State<T>& q, Function f) {
    for_each_position([&](const E& model, const Chunk& chunk, std::size_t memory, int) {
      Value* const m = memory_.data() + memory;
      const Unknowns<E, Value> u = gather(chunk, q.displacement);
      f(model, chunk.data, m, u);
    });
  }
  template <class Function>
  void set(Function f) {
    for (E& model : models_) f(model);
  }
  void prepare() {
    for_each_position([&](const E& model, const Chunk&, std::size_t memory, int) {
      model.prepare(memory_.data() + memory);
    });
  }
  void forces_of_now(const State<T>& q) {
    set([](E& model) { model.set_step(0); });
    known_ = q.displacement;
    ahead_ = 0;
  }

  static Unknowns<E, Value> gather(const Chunk& chunk, const Vector<T>& from) {
    Unknowns<E, Value> u;
    for (std::size_t i = 0; i < blocks; ++i) u.points[i] = gather_blocks<T, N>(from.data(), chunk.ids[i]);
    return u;
  }
  static Tangent<E, Value> flat(const Unknowns<E, Value>& u) {
    Tangent<E, Value> t;
    for (int i = 0; i < blocks; ++i) t.template segment<3>(3 * i) = u.points[static_cast<std::size_t>(i)];
    return t;
  }
  static void scatter(const Chunk& chunk, int count, const Tangent<E, Value>& f, Vector<T>& y) {
    for (int i = 0; i < blocks; ++i) {
      const Vec3<Value> part = f.template segment<3>(3 * i);
      scatter_add_blocks<T, N>(y.data(), chunk.ids[static_cast<std::size_t>(i)], part, count);
    }
  }

  std::vector<E> models_;
  std::size_t size_;
  std::vector<Chunk, Eigen::aligned_allocator<Chunk>> chunks_;
  std::vector<Run> runs_;
  std::vector<Value, Eigen::aligned_allocator<Value>> memory_;
  Vector<T> known_;   // the state that the memory is of
  double ahead_ = 0;  // s after it that forces stand for; -1 for the static problem
};

}  // namespace softsim
