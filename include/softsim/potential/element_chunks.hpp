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
#include "softsim/potential/stretches.hpp"

namespace softsim {

/// `Data<T>` of a local force that remembers: what the rest shape determines, and the `memory_size()` numbers
/// that the stencil carries from step to step, zero at first.
template <class D, class T>
struct Remembered {
  const D& rest;
  T* memory;
};

namespace detail {
template <class D>
struct Stored {
  using Rest = D;
  static constexpr bool remembers = false;
};
template <class D, class T>
struct Stored<Remembered<D, T>> {
  using Rest = D;
  static constexpr bool remembers = true;
};
}  // namespace detail

/// The store of a set of like stencils: N at a time in chunks whose stencils share one of the models, chunks
/// in stretches, stretches in colours. See `Elements`, which evaluates it.
template <class E, class T, int N>
class ElementChunks {
 public:
  /// N numbers side by side.
  using Value = Lanes<T, N>;
  /// What a stencil's rest shape determines, as it is given at construction.
  using RestData = typename detail::Stored<typename E::template Data<double>>::Rest;
  /// Number of blocks in a stencil: one a point, two a frame.
  static constexpr int blocks = E::points + 2 * frames_of<E>;
  /// Block numbers of one stencil: those of its points, and the two of each frame.
  using Stencil = std::array<std::int32_t, blocks>;

  /// Number of stencils.
  [[nodiscard]] std::size_t size() const { return size_; }

  /// Calls f(stencil) for every stencil in storage order.
  template <class Function>
  void for_each_stencil(Function f) const {
    for (const Stretch& s : stretches_)
      for (int k = 0; k < s.count; ++k) f(stencil(s.first * lanes + static_cast<std::size_t>(k)));
  }

  /// Takes a stencil out at run time, by its place in the lists given at construction; nothing is made anew.
  /// The last stencil of its stretch moves to its lane, so that the storage order changes: an assembled
  /// tangent finds its pattern again by itself. Removing one twice does nothing.
  /// @throws std::invalid_argument if there never was such a stencil
  void remove(std::size_t index) {
    if (index >= place_.size())
      invalid(std::string("elements: no element ") + std::to_string(index) + " to remove (there were " +
              std::to_string(place_.size()) + ")");
    if (place_[index] == removed) return;
    const std::size_t place = place_[index];
    Stretch& s = *std::find_if(stretches_.begin(), stretches_.end(), [&](const Stretch& t) {
      return place >= t.first * lanes && place < t.first * lanes + static_cast<std::size_t>(t.count);
    });
    const std::size_t last = s.first * lanes + static_cast<std::size_t>(s.count) - 1;
    write(place, rest_data(last), stencil(last));
    for (std::size_t i = 0; i < memory_size_; ++i)
      set_lane(memory(place / lanes)[i], static_cast<int>(place % lanes),
               lane(memory(last / lanes)[i], static_cast<int>(last % lanes)));
    index_[place] = index_[last];
    place_[index_[place]] = place;
    place_[index] = removed;
    --s.count;
    --size_;
    number_stencils();
  }

 protected:
  using Data = typename E::template Data<Value>;
  static constexpr bool remembers = detail::Stored<Data>::remembers;
  static constexpr std::size_t points = E::points, frames = frames_of<E>;
  struct Chunk {
    typename detail::Stored<Data>::Rest data;
    std::array<BlockIds<N>, points + frames> ids;  // of points, and first ones of frames
  };
  static constexpr std::size_t lanes = static_cast<std::size_t>(N), removed = static_cast<std::size_t>(-1);
  // Long enough that its own overhead and the blocks it shares with others do not count, short enough that a
  // body of a thousand tetrahedra still keeps two threads busy.
  static constexpr std::size_t stretch_length = std::max<std::size_t>(256, lanes);

  struct Stretch {
    std::size_t model, first;   // first chunk
    int count;                  // stencils
    std::ptrdiff_t before = 0;  // stencils of the stretches before
    mutable double sum = 0;
  };

  /// As `Elements`, but for the rest positions.
  ElementChunks(std::vector<E> models, const std::vector<RestData>& data,
                const std::vector<Stencil>& stencils, const std::vector<std::int32_t>& model_index)
      : models_(std::move(models)) {
    if (data.size() != stencils.size())
      invalid(std::string("elements: ") + std::to_string(data.size()) + " rest data for " +
              std::to_string(stencils.size()) + " stencils");
    if (!model_index.empty() && model_index.size() != stencils.size())
      invalid(std::string("elements: ") + std::to_string(model_index.size()) + " material indices for " +
              std::to_string(stencils.size()) + " elements");
    for (std::size_t e = 0; e < stencils.size(); ++e)
      for (std::size_t i = 0; i < blocks; ++i)
        for (std::size_t j = 0; j < i; ++j)
          if (stencils[e][i] == stencils[e][j])
            invalid(std::string("element ") + std::to_string(e) + ": node " + std::to_string(stencils[e][i]) +
                    " occurs twice");
    for (std::size_t e = 0; e < stencils.size(); ++e)
      for (std::size_t i = points; i < blocks; i += 2)
        if (stencils[e][i + 1] != stencils[e][i] + 1)
          invalid(std::string("element ") + std::to_string(e) + ": block " + std::to_string(stencils[e][i]) +
                  " is followed by block " + std::to_string(stencils[e][i + 1]) + ", which is no frame");
    std::vector<std::vector<std::size_t>> members(models_.size());
    for (std::size_t e = 0; e < stencils.size(); ++e) {
      const std::int32_t m = model_index.empty() ? 0 : model_index[e];
      if (m < 0 || static_cast<std::size_t>(m) >= models_.size())
        invalid(std::string("element ") + std::to_string(e) + ": material index " + std::to_string(m) +
                " is out of range (there are " + std::to_string(models_.size()) + " materials)");
      members[static_cast<std::size_t>(m)].push_back(e);
    }
    store(members, data, stencils);
  }

  /// Calls f(model) for every parameter set.
  template <class Function>
  void set_models(Function f) {
    for (E& model : models_) f(model);
  }
  /// Sets the memory of all stencils to zero.
  void forget() { std::fill(memory_.begin(), memory_.end(), Value(0)); }

  [[nodiscard]] Value* memory(std::size_t chunk) const { return memory_.data() + chunk * memory_size_; }
  // What the functions of E get.
  [[nodiscard]] decltype(auto) data_of(const Chunk& chunk) const {
    if constexpr (remembers)
      return Data{chunk.data, memory(static_cast<std::size_t>(&chunk - chunks_.data()))};
    else
      return (chunk.data);
  }

  // Calls f for every stretch; those of one colour may run at the same time.
  template <class Function>
  void for_each_stretch(Function f) const {
#ifdef _OPENMP
#pragma omp parallel if (coloured_ && stretches_.size() > 2)
#endif
    for (std::size_t c = 0; c + 1 < colour_begin_.size(); ++c) {
      const auto begin = static_cast<std::ptrdiff_t>(colour_begin_[c]),
                 end = static_cast<std::ptrdiff_t>(colour_begin_[c + 1]);
#ifdef _OPENMP
#pragma omp for schedule(static)
#endif
      for (std::ptrdiff_t s = begin; s < end; ++s) f(stretches_[static_cast<std::size_t>(s)]);
    }
  }

  std::vector<E> models_;
  std::vector<Chunk, Eigen::aligned_allocator<Chunk>> chunks_;
  std::vector<Stretch> stretches_;  // in the order they are worked off

 private:
  static constexpr std::size_t numbers = sizeof(RestData) / sizeof(double);
  static_assert(sizeof(Chunk::data) == numbers * sizeof(Value), "Data<T> may hold scalars T only");

  void store(const std::vector<std::vector<std::size_t>>& members, const std::vector<RestData>& data,
             const std::vector<Stencil>& stencils) {
    const auto [plans, coloured] = detail::plan_stretches<N>(members, stencils, stretch_length);
    coloured_ = coloured;
    std::size_t chunks = 0;
    for (const auto& plan : plans) chunks += (plan.stencils.size() + lanes - 1) / lanes;
    chunks_.resize(chunks);
    if constexpr (remembers) {
      for (const E& e : models_) memory_size_ = std::max(memory_size_, e.memory_size());
      memory_.assign(chunks * memory_size_, Value(0));
    }
    index_.assign(chunks * lanes, 0);
    place_.assign(stencils.size(), removed);
    size_ = stencils.size();
    std::size_t first = 0;
    int last_colour = -1;
    for (const auto& [model, colour, part] : plans) {
      if (colour != last_colour) colour_begin_.push_back(stretches_.size());
      last_colour = colour;
      stretches_.push_back({model, first, static_cast<int>(part.size())});
      const std::size_t count = (part.size() + lanes - 1) / lanes;
      for (std::size_t k = 0; k < count * lanes; ++k) {
        const std::size_t e = part[std::min(k, part.size() - 1)], place = first * lanes + k;
        std::array<double, numbers> rest;
        std::memcpy(rest.data(), &data[e], sizeof(RestData));
        write(place, rest, stencils[e]);
        index_[place] = e;
        if (k < part.size()) place_[e] = place;
      }
      first += count;
    }
    colour_begin_.push_back(stretches_.size());
    number_stencils();
  }

  void number_stencils() {
    std::ptrdiff_t before = 0;
    for (Stretch& s : stretches_) {
      s.before = before;
      before += s.count;
    }
  }

  // One lane's data and stencil; a place is chunk * N + lane.
  void write(std::size_t place, const std::array<double, numbers>& rest, const Stencil& stencil) {
    Chunk& chunk = chunks_[place / lanes];
    std::array<Value, numbers> values;
    std::memcpy(static_cast<void*>(values.data()), static_cast<const void*>(&chunk.data), sizeof(values));
    for (std::size_t i = 0; i < numbers; ++i)
      set_lane(values[i], static_cast<int>(place % lanes), static_cast<T>(rest[i]));
    std::memcpy(static_cast<void*>(&chunk.data), static_cast<const void*>(values.data()), sizeof(values));
    for (std::size_t i = 0; i < points; ++i) chunk.ids[i][place % lanes] = stencil[i];
    for (std::size_t j = 0; j < frames; ++j) chunk.ids[points + j][place % lanes] = stencil[points + 2 * j];
  }
  [[nodiscard]] std::array<double, numbers> rest_data(std::size_t place) const {
    std::array<Value, numbers> values;
    std::memcpy(static_cast<void*>(values.data()), static_cast<const void*>(&chunks_[place / lanes].data),
                sizeof(values));
    std::array<double, numbers> rest;
    for (std::size_t i = 0; i < numbers; ++i)
      rest[i] = static_cast<double>(lane(values[i], static_cast<int>(place % lanes)));
    return rest;
  }
  [[nodiscard]] Stencil stencil(std::size_t place) const {
    Stencil s;
    const auto& ids = chunks_[place / lanes].ids;
    for (std::size_t i = 0; i < points; ++i) s[i] = ids[i][place % lanes];
    for (std::size_t j = 0; j < frames; ++j) {
      s[points + 2 * j] = ids[points + j][place % lanes];
      s[points + 2 * j + 1] = s[points + 2 * j] + 1;
    }
    return s;
  }

  mutable std::vector<Value, Eigen::aligned_allocator<Value>> memory_;  // chunk by chunk
  std::size_t memory_size_ = 0;                                         // numbers of one stencil
  std::vector<std::size_t> colour_begin_;   // first stretch of each colour, and the end
  bool coloured_ = false;                   // see StretchPlans
  std::vector<std::size_t> index_, place_;  // of each lane the place in the lists given, and back
  std::size_t size_ = 0;
};

}  // namespace softsim
