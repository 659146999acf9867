// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "softsim/concepts.hpp"
#include "softsim/core/error.hpp"
#include "softsim/core/gather.hpp"
#include "softsim/kinematics/linear_tetrahedron.hpp"
#include "softsim/material/volume_law.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"

namespace softsim {

/// Volumetric energy of linear tetrahedra that does not lock near incompressibility: sum_a V_a U(J_a), with
/// J_a the mean of J over the tetrahedra around node a, each weighted by the quarter of its rest volume that
/// V_a sums up. This is the average nodal pressure of Bonet & Burton 1998 (and Bonet, Marriott & Hassan 2001)
/// written as an energy, so that force and Hessian product are its exact derivatives: p_e = (sum of U'(J_a)
/// over the corners)/4 takes the place of U'(J_e). There is one constraint per node; one per tetrahedron,
/// five or six times as many, would leave the mesh no way to move. A node where several laws meet has a mean
/// for each.
///
/// The term stands beside `elastic`, whose law keeps the rest of the energy. For Neo-Hookean:
///     const auto shape = elastic(mesh, NeoHookean::from_lame(0, mu));
///     const auto volume = nodal_volume(mesh, LogarithmicVolume(lambda));
///     System system(mesh, shape, volume);
/// and for a law on isochoric invariants, with c below the bulk modulus and of the order of mu:
///     elastic(mesh, MooneyRivlin(c1, c2, c)) and nodal_volume(mesh, QuadraticVolume(bulk - c)).
/// Changes of volume that alternate between neighbouring tetrahedra are invisible to the means. The law left
/// to the tetrahedra has to hold them: its shear and bulk moduli at rest must be positive (the latter is 2/3
/// mu for the first, c for the second). As U adds a positive semidefinite part, the body at rest is then at
/// least as stiff as that law makes it, without spurious modes and without further stabilisation. The
/// pressures p_a may alternate from node to node (equal orders of displacement and pressure); look at the
/// p_e.
///
/// The Hessian couples nodes with a common neighbour. Products are exact and take two passes over the
/// tetrahedra; an assembled tangent is exact too, with about four times the blocks of `elastic`. Holds work
/// vectors: no two threads may evaluate one object at a time. Models `Potential`. T is float or double.
template <class U, class T = double, int N = default_lanes<T>>
class NodalVolume {
 public:
  using Scalar = T;
  using Value = Lanes<T, N>;
  static_assert(VolumeLaw<U, Value>);

  static constexpr bool conservative = true;
  static constexpr bool external = false;
  static constexpr bool has_hessian = true;

  /// @param laws one per material
  /// @param law_index which of the laws each tetrahedron has; empty means the first for all
  /// @throws std::invalid_argument for a list of the wrong length or an index out of range
  NodalVolume(const TetrahedralMesh& mesh, std::vector<U> laws,
              const std::vector<std::int32_t>& law_index = {})
      : laws_(std::move(laws)), tetrahedra_(mesh.tetrahedra().size()) {
    if (laws_.empty()) invalid("nodal volume: no law");
    if (law_index.empty() ? laws_.size() > 1 : law_index.size() != tetrahedra_)
      invalid(std::string("nodal volume: ") + std::to_string(law_index.size()) + " law indices for " +
              std::to_string(tetrahedra_) + " tetrahedra");
    for (std::size_t e = 0; e < law_index.size(); ++e)
      if (law_index[e] < 0 || static_cast<std::size_t>(law_index[e]) >= laws_.size())
        invalid(std::string("tetrahedron ") + std::to_string(e) + ": law index " +
                std::to_string(law_index[e]) + " is out of range (there are " + std::to_string(laws_.size()) +
                " laws)");
    const std::vector<Tetrahedron> patches = make_patches(mesh, law_index);
    make_chunks(mesh, patches);
    make_rings(mesh, patches);
  }

  /// Number of stencils: the tetrahedra, and the patches around nodes.
  [[nodiscard]] std::size_t size() const { return tetrahedra_ + patches_; }

  /// sum_a V_a U(J_a), J, accumulated in double in fixed order.
  [[nodiscard]] double energy(const State<T>& q) const {
    average(q, nullptr);
    double sum = 0;
    for_each_patch([&](const U& law, std::ptrdiff_t a) {
      const Value w = load(volume_.data() + a) * law.density(load(k_.data() + a));
      for (int l = 0; l < N; ++l) sum += static_cast<double>(lane(w, l));
    });
    return sum;
  }

  /// y += dE/dq: V_e p_e cof(F_e) g_i on corner i of tetrahedron e, N.
  void add_gradient(const State<T>& q, Vector<T>& y) const {
    average(q, nullptr);
    set_pressures();
    for_each_chunk([&](const Chunk& chunk, int count) {
      const Mat3<Value> F = deformation_gradient(chunk, q);
      const Value p = chunk.data.volume * mean(chunk, p_);
      const Mat3<Value> P = p * cofactor(F);
      scatter(chunk, count, P, y);
    });
  }

  /// y += (d^2E/dq^2) d.
  void add_hessian_product(const State<T>& q, const Vector<T>& d, Vector<T>& y) const {
    average(q, &d);
    set_pressures();
    dk_.array() *= dp_.array();
    for_each_chunk([&](const Chunk& chunk, int count) {
      const Mat3<Value> F = deformation_gradient(chunk, q), dF = displacement_gradient(chunk, d);
      const Value p = chunk.data.volume * mean(chunk, p_), dp = chunk.data.volume * mean(chunk, dk_);
      const Mat3<Value> dP = dp * cofactor(F) + p * cofactor_differential(F, dF);
      scatter(chunk, count, dP, y);
    });
  }

  /// Calls f(nodes) for every tetrahedron, then for every patch.
  template <class Function>
  void for_each_stencil(Function f) const {
    for_each_chunk([&](const Chunk& chunk, int count) {
      for (std::size_t l = 0; l < static_cast<std::size_t>(count); ++l) {
        const Tetrahedron v{chunk.nodes[0][l], chunk.nodes[1][l], chunk.nodes[2][l], chunk.nodes[3][l]};
        f(std::span<const std::int32_t>(v));
      }
    });
    for (std::size_t a = 0; a + 1 < ring_start_.size(); ++a)
      if (!ring(a).empty()) f(ring(a));
  }

  /// Adds scale times the Hessian to 3x3 blocks, as `Elements::add_blocks` does: V_e p_e d^2J_e of every
  /// tetrahedron, then V_a U''(J_a) dJ_a dJ_a^T of every patch.
  void add_blocks(const State<T>& q, T scale, const std::vector<std::int32_t>& places, T* values) const {
    average(q, nullptr);
    set_pressures();
    slopes_.setZero(3 * static_cast<std::ptrdiff_t>(ring_nodes_.size()));
    const std::int32_t* place = places.data();
    for_each_chunk([&](const Chunk& chunk, int count) {
      const Mat3<Value> F = deformation_gradient(chunk, q);
      add_slopes(chunk, count, cofactor(F));
      add_second_derivatives(chunk, count, F, scale, place, values);
      place += 10 * count;
    });
    for (std::size_t a = 0; a + 1 < ring_start_.size(); ++a) {
      const auto slot = static_cast<std::ptrdiff_t>(a);
      const T weight = scale * dp_[slot] * inverse_volume_[slot];
      const T* g = slopes_.data() + 3 * ring_start_[a];
      const std::size_t n = ring(a).size();
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i; j < n; ++j, ++place) {
          if (*place < 0) continue;
          T* block = values + 9 * static_cast<std::ptrdiff_t>(*place / 2);
          const T *row = g + 3 * i, *column = g + 3 * j;
          if (*place % 2 != 0) std::swap(row, column);
          for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t b = 0; b < 3; ++b) block[3 * c + b] += weight * row[b] * column[c];
        }
    }
  }

 private:
  struct Chunk {
    LinearTetrahedron::Data<Value> data;
    std::array<BlockIds<N>, 4> nodes, patches;
  };
  struct Run {
    std::size_t law;
    std::ptrdiff_t first, last;  // patches, a multiple of N of them
  };

  // Numbers the pairs of a law and a node; those of one law follow each other, filled up to whole batches
  // with patches of no volume.
  std::vector<Tetrahedron> make_patches(const TetrahedralMesh& mesh, const std::vector<std::int32_t>& index) {
    using Key = std::array<std::int32_t, 2>;
    const auto law = [&](std::size_t e) { return index.empty() ? 0 : index[e]; };
    std::vector<Key> keys;
    for (std::size_t e = 0; e < tetrahedra_; ++e)
      for (const std::int32_t node : mesh.tetrahedra()[e]) keys.push_back({law(e), node});
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    patches_ = keys.size();

    std::vector<std::int32_t> slot;
    std::ptrdiff_t end = 0;
    for (const Key& key : keys) {
      const auto m = static_cast<std::size_t>(key[0]);
      if (runs_.empty() || runs_.back().law != m) {
        end = (end + N - 1) / N * N;
        runs_.push_back({m, end, end});
      }
      slot.push_back(static_cast<std::int32_t>(end++));
      runs_.back().last = (end + N - 1) / N * N;
    }
    const std::ptrdiff_t slots = runs_.back().last;
    for (Vector<T>* v : {&volume_, &inverse_volume_, &k_, &dk_, &p_, &dp_}) v->setZero(slots);

    std::vector<Tetrahedron> patches(tetrahedra_);
    std::vector<double> volume(static_cast<std::size_t>(slots), 0.0);
    for (std::size_t e = 0; e < tetrahedra_; ++e)
      for (std::size_t i = 0; i < 4; ++i) {
        const Key key{law(e), mesh.tetrahedra()[e][i]};
        const auto k = std::lower_bound(keys.begin(), keys.end(), key) - keys.begin();
        patches[e][i] = slot[static_cast<std::size_t>(k)];
        volume[static_cast<std::size_t>(patches[e][i])] += mesh.volume(e) / 4;
      }
    for (const std::int32_t a : slot) {
      volume_[a] = static_cast<T>(volume[static_cast<std::size_t>(a)]);
      inverse_volume_[a] = static_cast<T>(1 / volume[static_cast<std::size_t>(a)]);
    }
    return patches;
  }

  void make_chunks(const TetrahedralMesh& mesh, const std::vector<Tetrahedron>& patches) {
    constexpr auto n = static_cast<std::size_t>(N);
    chunks_.resize((tetrahedra_ + n - 1) / n);
    for (std::size_t k = 0; k < chunks_.size() * n; ++k) {
      const std::size_t e = std::min(k, tetrahedra_ - 1);  // lanes left over repeat the last one
      std::array<Vec3<double>, 4> X;
      for (std::size_t i = 0; i < 4; ++i)
        X[i] = mesh.points()[static_cast<std::size_t>(mesh.tetrahedra()[e][i])];
      const LinearTetrahedron::Data<double> rest = LinearTetrahedron::make(X);
      Chunk& chunk = chunks_[k / n];
      const int l = static_cast<int>(k % n);
      set_lane(chunk.data.volume, l, static_cast<T>(rest.volume));
      for (std::size_t i = 0; i < 3; ++i)
        for (int c = 0; c < 3; ++c)
          set_lane(chunk.data.gradient[i][c], l, static_cast<T>(rest.gradient[i][c]));
      for (std::size_t i = 0; i < 4; ++i) {
        chunk.nodes[i][k % n] = mesh.tetrahedra()[e][i];
        chunk.patches[i][k % n] = patches[e][i];
      }
    }
  }

  // The nodes whose displacements change J_a: those of the patch's tetrahedra, in ascending order.
  void make_rings(const TetrahedralMesh& mesh, const std::vector<Tetrahedron>& patches) {
    std::vector<std::array<std::int32_t, 2>> pairs;
    pairs.reserve(16 * tetrahedra_);
    for (std::size_t e = 0; e < tetrahedra_; ++e)
      for (const std::int32_t a : patches[e])
        for (const std::int32_t node : mesh.tetrahedra()[e]) pairs.push_back({a, node});
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    ring_start_.assign(static_cast<std::size_t>(volume_.size()) + 1, 0);
    for (const auto& [a, node] : pairs) {
      ++ring_start_[static_cast<std::size_t>(a) + 1];
      ring_nodes_.push_back(node);
    }
    for (std::size_t a = 1; a < ring_start_.size(); ++a) ring_start_[a] += ring_start_[a - 1];
  }

  [[nodiscard]] std::span<const std::int32_t> ring(std::size_t a) const {
    return std::span(ring_nodes_)
        .subspan(static_cast<std::size_t>(ring_start_[a]),
                 static_cast<std::size_t>(ring_start_[a + 1] - ring_start_[a]));
  }

  template <class Function>
  void for_each_chunk(Function f) const {
    for (std::size_t c = 0; c + 1 < chunks_.size(); ++c) f(chunks_[c], N);
    f(chunks_.back(), static_cast<int>(tetrahedra_ - (chunks_.size() - 1) * static_cast<std::size_t>(N)));
  }
  template <class Function>
  void for_each_patch(Function f) const {
    for (const Run& run : runs_)
      for (std::ptrdiff_t a = run.first; a < run.last; a += N) f(laws_[run.law], a);
  }

  static Value load(const T* p) {
    Value v;
    std::memcpy(static_cast<void*>(&v), p, sizeof(Value));
    return v;
  }

  // Rest gradients of the four shape functions.
  static std::array<Vec3<Value>, 4> shape_gradients(const Chunk& chunk) {
    const auto& g = chunk.data.gradient;
    return {-(g[0] + g[1] + g[2]), g[0], g[1], g[2]};
  }

  static Mat3<Value> displacement_gradient(const Chunk& chunk, const Vector<T>& v) {
    const Vec3<Value> v_0 = gather_blocks<T, N>(v.data(), chunk.nodes[0]);
    Mat3<Value> H = Mat3<Value>::Zero();
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3<Value> e = gather_blocks<T, N>(v.data(), chunk.nodes[i + 1]) - v_0;
      H += e * chunk.data.gradient[i].transpose();
    }
    return H;
  }
  static Mat3<Value> deformation_gradient(const Chunk& chunk, const State<T>& q) {
    return Mat3<Value>::Identity() + displacement_gradient(chunk, q.displacement);
  }

  static void scatter(const Chunk& chunk, int count, const Mat3<Value>& P, Vector<T>& y) {
    const auto g = shape_gradients(chunk);
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3<Value> f = P * g[i];
      scatter_add_blocks<T, N>(y.data(), chunk.nodes[i], f, count);
    }
  }

  // Mean over the corners of a value of the patches.
  static Value mean(const Chunk& chunk, const Vector<T>& of) {
    alignas(64) T m[N];
    for (std::size_t l = 0; l < static_cast<std::size_t>(N); ++l)
      m[l] = (of[chunk.patches[0][l]] + of[chunk.patches[1][l]] + of[chunk.patches[2][l]] +
              of[chunk.patches[3][l]]) /
             4;
    return load(m);
  }

  // Adds a value of every tetrahedron to its patches.
  static void distribute(const Chunk& chunk, int count, const Value& value, Vector<T>& to) {
    alignas(64) T part[N];
    std::memcpy(part, static_cast<const void*>(&value), sizeof(Value));
    for (std::size_t l = 0; l < static_cast<std::size_t>(count); ++l)
      for (std::size_t i = 0; i < 4; ++i) to[chunk.patches[i][l]] += part[l];
  }

  // k_a = J_a - 1 at q and, if there is a d, dk_a = dJ_a.
  void average(const State<T>& q, const Vector<T>* d) const {
    k_.setZero();
    dk_.setZero();
    for_each_chunk([&](const Chunk& chunk, int count) {
      const Mat3<Value> H = displacement_gradient(chunk, q.displacement), c = cofactor(H);
      // det(I + H) - 1, without the digits that the 1 would take from small strains
      const Value k = trace(H) + trace(c) + H.col(0).dot(c.col(0)), quarter = Value(0.25) * chunk.data.volume;
      distribute(chunk, count, quarter * k, k_);
      if (d == nullptr) return;
      const Mat3<Value> F = Mat3<Value>::Identity() + H;
      distribute(chunk, count, quarter * double_dot(cofactor(F), displacement_gradient(chunk, *d)), dk_);
    });
    k_.array() *= inverse_volume_.array();
    dk_.array() *= inverse_volume_.array();
  }

  // p_a = U'(J_a) and dp_a = U''(J_a).
  void set_pressures() const {
    for_each_patch([&](const U& law, std::ptrdiff_t a) {
      const Value k = load(k_.data() + a), p = law.first(k), dp = law.second(k);
      std::memcpy(p_.data() + a, static_cast<const void*>(&p), sizeof(Value));
      std::memcpy(dp_.data() + a, static_cast<const void*>(&dp), sizeof(Value));
    });
  }

  // V_a dJ_a by the nodes of its ring.
  void add_slopes(const Chunk& chunk, int count, const Mat3<Value>& c) const {
    const auto g = shape_gradients(chunk);
    const Value quarter = Value(0.25) * chunk.data.volume;
    alignas(64) T slope[12][N];
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3<Value> s = quarter * (c * g[i]);
      std::memcpy(slope[3 * i], static_cast<const void*>(s.data()), sizeof(s));
    }
    for (std::size_t l = 0; l < static_cast<std::size_t>(count); ++l)
      for (const BlockIds<N>& patch : chunk.patches) {
        const auto a = static_cast<std::size_t>(patch[l]);
        const auto nodes = ring(a);
        for (std::size_t i = 0; i < 4; ++i) {
          const auto place = std::lower_bound(nodes.begin(), nodes.end(), chunk.nodes[i][l]) - nodes.begin();
          T* to = slopes_.data() + 3 * (ring_start_[a] + place);
          for (std::size_t b = 0; b < 3; ++b) to[b] += slope[3 * i + b][l];
        }
      }
  }

  // V_e p_e d^2J_e: block (i, j) is -[F (g_i x g_j)]x, since the derivative of cof(F) g_i along a g_j^T is
  // -a x F (g_j x g_i) = -[F (g_i x g_j)]x a.
  static void add_skew(const T (&r)[3], std::int32_t place, T* values) {
    if (place < 0) return;
    const T sign = place % 2 == 0 ? T(-1) : T(1);
    T* block = values + 9 * static_cast<std::ptrdiff_t>(place / 2);
    block[1] += sign * r[2];
    block[2] -= sign * r[1];
    block[3] -= sign * r[2];
    block[5] += sign * r[0];
    block[6] += sign * r[1];
    block[7] -= sign * r[0];
  }
  void add_second_derivatives(const Chunk& chunk, int count, const Mat3<Value>& F, T scale,
                              const std::int32_t* places, T* values) const {
    const auto g = shape_gradients(chunk);
    const Value p = Value(scale) * chunk.data.volume * mean(chunk, p_);
    int pair = 0;
    for (std::size_t i = 0; i < 4; ++i, ++pair)
      for (std::size_t j = i + 1; j < 4; ++j) {
        ++pair;
        const Vec3<Value> r = p * (F * g[i].cross(g[j]));
        for (int l = 0; l < count; ++l) {
          const T at[3] = {lane(r[0], l), lane(r[1], l), lane(r[2], l)};
          add_skew(at, places[10 * l + pair], values);
        }
      }
  }

  std::vector<U> laws_;
  std::size_t tetrahedra_, patches_ = 0;
  std::vector<Chunk, Eigen::aligned_allocator<Chunk>> chunks_;
  std::vector<Run> runs_;
  Vector<T> volume_, inverse_volume_;  // of the patches
  std::vector<std::ptrdiff_t> ring_start_;
  std::vector<std::int32_t> ring_nodes_;
  mutable Vector<T> k_, dk_, p_, dp_, slopes_;  // work vectors
};

/// Volumetric energy of `mesh`, averaged at its nodes; see `NodalVolume`.
template <class T = double, int N = default_lanes<T>, class U>
requires VolumeLaw<U>
[[nodiscard]] NodalVolume<U, T, N> nodal_volume(const TetrahedralMesh& mesh, const U& law) {
  return {mesh, {law}};
}

/// The same with one of `laws` per tetrahedron.
/// @throws std::invalid_argument for a list of the wrong length or an index out of range
template <class T = double, int N = default_lanes<T>, class U>
[[nodiscard]] NodalVolume<U, T, N> nodal_volume(const TetrahedralMesh& mesh, const std::vector<U>& laws,
                                                const std::vector<std::int32_t>& law_index) {
  return {mesh, laws, law_index};
}

}  // namespace softsim
