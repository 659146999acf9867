// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "softsim/concepts.hpp"
#include "softsim/core/error.hpp"
#include "softsim/core/gather.hpp"

namespace softsim {

/// A set of like stencils, evaluated N at a time on SIMD lanes (N = 1: one at a time): the only place that
/// gathers unknowns and scatters forces. Stencils are sorted by model, so that every chunk of N shares its
/// parameters; lanes left over at the end of a model's run repeat a real stencil and are not scattered.
/// Models `ForceTerm`, and `Potential` where E has an energy. T is float or double.
template <class E, class T = double, int N = default_lanes<T>>
class Elements {
 public:
  using Scalar = T;
  using Value = Lanes<T, N>;
  using RestData = typename E::template Data<double>;
  static_assert(LocalForce<E, Value>);

  /// Number of blocks in a stencil.
  static constexpr int blocks = E::points;
  /// Block numbers of one stencil.
  using Stencil = std::array<std::int32_t, blocks>;
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
  /// @throws std::invalid_argument for lists of different lengths or an index out of range
  Elements(std::vector<E> models, const std::vector<RestData>& data, const std::vector<Stencil>& stencils,
           const std::vector<std::int32_t>& model_index = {})
      : models_(std::move(models)) {
    if (data.size() != stencils.size())
      invalid(std::string("elements: ") + std::to_string(data.size()) + " rest data for " +
              std::to_string(stencils.size()) + " stencils");
    if (!model_index.empty() && model_index.size() != stencils.size())
      invalid(std::string("elements: ") + std::to_string(model_index.size()) + " material indices for " +
              std::to_string(stencils.size()) + " elements");
    std::vector<std::vector<std::size_t>> members(models_.size());
    for (std::size_t e = 0; e < stencils.size(); ++e) {
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

  /// Sum of the energies in J, accumulated in double in fixed order.
  [[nodiscard]] double energy(const State<T>& q) const requires LocalPotential<E, Value> {
    double sum = 0;
    for_each_chunk([&](const E& model, const Chunk& chunk, int count) {
      const Value w = model.energy(chunk.data, gather(chunk, q.displacement));
      for (int l = 0; l < count; ++l) sum += static_cast<double>(lane(w, l));
    });
    return sum;
  }

  /// y += dE/dq (minus the force), N.
  void add_gradient(const State<T>& q, Vector<T>& y) const {
    for_each_chunk([&](const E& model, const Chunk& chunk, int count) {
      scatter(chunk, count, model.gradient(chunk.data, gather(chunk, q.displacement)), y);
    });
  }

  /// y += (d^2E/dq^2) d.
  void add_hessian_product(const State<T>& q, const Vector<T>& d, Vector<T>& y) const {
    for_each_chunk([&](const E& model, const Chunk& chunk, int count) {
      const Unknowns<E, Value> u = gather(chunk, q.displacement), du = gather(chunk, d);
      Tangent<E, Value> increment;
      for (int i = 0; i < blocks; ++i)
        increment.template segment<3>(3 * i) = du.points[static_cast<std::size_t>(i)];
      scatter(chunk, count, model.hessian_product(chunk.data, u, increment), y);
    });
  }

  /// Calls f(stencil) for every stencil in storage order.
  template <class Function>
  void for_each_stencil(Function f) const {
    for_each_chunk([&](const E&, const Chunk& chunk, int count) {
      for (int l = 0; l < count; ++l) {
        Stencil s;
        for (std::size_t i = 0; i < blocks; ++i) s[i] = chunk.ids[i][static_cast<std::size_t>(l)];
        f(s);
      }
    });
  }

  /// Adds scale times each stencil's Hessian to 3x3 blocks (nine scalars each, column-major). `positions`
  /// holds, stencil by stencil in storage order, the block numbers of (0,0), (0,1), ... row-major; -1 leaves
  /// a block out.
  void add_blocks(const State<T>& q, T scale, const std::vector<std::int32_t>& positions, T* values) const {
    const std::int32_t* position = positions.data();
    for_each_chunk([&](const E& model, const Chunk& chunk, int count) {
      const Unknowns<E, Value> u = gather(chunk, q.displacement);
      const typename E::template Data<Value>& data = chunk.data;
      for (int j = 0; j < blocks; ++j)
        for (int a = 0; a < 3; ++a) {
          Tangent<E, Value> unit = Tangent<E, Value>::Zero();
          unit[3 * j + a] = Value(scale);
          const Tangent<E, Value> column = model.hessian_product(data, u, unit);
          add_column(column, count, position + j, values + 3 * a);
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
    size_ += members.size();
    runs_.push_back({model, first, first + count, static_cast<int>(members.size() - (count - 1) * n)});
  }

  template <class Function>
  void for_each_chunk(Function f) const {
    for (const Run& run : runs_) {
      const E& model = models_[run.model];
      for (std::size_t c = run.first; c + 1 < run.last; ++c) f(model, chunks_[c], N);
      f(model, chunks_[run.last - 1], run.tail);
    }
  }

  static Unknowns<E, Value> gather(const Chunk& chunk, const Vector<T>& from) {
    Unknowns<E, Value> u;
    for (std::size_t i = 0; i < blocks; ++i) u.points[i] = gather_blocks<T, N>(from.data(), chunk.ids[i]);
    return u;
  }

  static void scatter(const Chunk& chunk, int count, const Tangent<E, Value>& f, Vector<T>& y) {
    for (int i = 0; i < blocks; ++i) {
      const Vec3<Value> part = f.template segment<3>(3 * i);
      scatter_add_blocks<T, N>(y.data(), chunk.ids[static_cast<std::size_t>(i)], part, count);
    }
  }

  // Adds the three scalars of every row block of one Hessian column at stride 9 positions; `position` points
  // to the column's block in row 0 of the first stencil.
  static void add_column(const Tangent<E, Value>& column, int count, const std::int32_t* position,
                         T* values) {
    alignas(64) T scratch[3 * blocks][N];
    std::memcpy(scratch, static_cast<const void*>(column.data()), sizeof(scratch));
    for (int l = 0; l < count; ++l)
      for (int i = 0; i < blocks; ++i) {
        const std::int32_t p = position[(l * blocks + i) * blocks];
        if (p < 0) continue;
        T* block = values + 9 * static_cast<std::ptrdiff_t>(p);
        for (int b = 0; b < 3; ++b) block[b] += scratch[3 * i + b][l];
      }
  }

  std::vector<E> models_;
  std::vector<Chunk, Eigen::aligned_allocator<Chunk>> chunks_;
  std::vector<Run> runs_;
  std::size_t size_ = 0;
};

}  // namespace softsim
