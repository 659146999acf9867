// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "softsim/concepts.hpp"
#include "softsim/mesh/tetrahedral_mesh.hpp"
#include "softsim/system/mass.hpp"
#include "softsim/system/prescribed.hpp"

namespace softsim {

/// Rayleigh damping: the force -(alpha M + beta K) v with K the Hessian at the start of the step.
struct Rayleigh {
  double alpha = 0;  ///< 1/s
  double beta = 0;   ///< s
};

namespace detail {
inline std::uint64_t next_system_number() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}
}  // namespace detail

/// Force terms over one set of points, with mass, damping and prescribed components. Models `Potential`
/// itself where all its terms do. The terms are public: a load may be changed between steps.
template <ForceTerm... Terms>
class System {
 public:
  using Scalar = typename std::tuple_element_t<0, std::tuple<Terms...>>::Scalar;
  using T = Scalar;
  static_assert((std::is_same_v<typename Terms::Scalar, Scalar> && ...), "all terms need the same scalar");
  /// True if every term derives from an energy.
  static constexpr bool conservative = (Terms::conservative && ...);

  std::tuple<Terms...> terms;
  Prescribed<T> prescribed;
  Mass<T> mass;  ///< kg; zero until set, a static solve needs none
  Rayleigh damping;

  /// A system over the nodes of `mesh`.
  explicit System(const TetrahedralMesh& mesh, Terms... terms_)
      : terms(std::move(terms_)...),
        prescribed(mesh.points().size()),
        mass(mesh.points().size()),
        rest_(mesh.points()) {}

  /// Rest positions of the points, m.
  [[nodiscard]] const std::vector<Vec3<double>>& rest() const { return rest_; }
  /// Different for every system that is made of a mesh, shared by copies: tells a cached pattern that a
  /// system at the same address is another one.
  [[nodiscard]] std::uint64_t number() const { return number_; }
  /// Scalars in a flat vector of this system.
  [[nodiscard]] std::ptrdiff_t size() const {
    return block_stride * static_cast<std::ptrdiff_t>(rest_.size());
  }

  /// Sum of the terms' energies, J.
  [[nodiscard]] double energy(const State<T>& q) const requires(Potential<Terms>&&...) {
    return std::apply([&](const auto&... term) { return (term.energy(q) + ...); }, terms);
  }
  /// y += dE/dq: minus the sum of the forces, N.
  void add_gradient(const State<T>& q, Vector<T>& y) const {
    std::apply([&](const auto&... term) { (term.add_gradient(q, y), ...); }, terms);
  }
  /// y += K d, K the Hessian at q.
  void add_hessian_product(const State<T>& q, const Vector<T>& d, Vector<T>& y) const {
    std::apply([&](const auto&... term) { (term.add_hessian_product(q, d, y), ...); }, terms);
  }
  /// y -= the loads from outside alone, N.
  void add_external_gradient(const State<T>& q, Vector<T>& y) const {
    for_each_term([&](const auto& term) {
      if constexpr (std::decay_t<decltype(term)>::external) term.add_gradient(q, y);
    });
  }

  /// Calls f on every term in turn.
  template <class Function>
  void for_each_term(Function f) const {
    std::apply([&](const auto&... term) { (f(term), ...); }, terms);
  }

  /// M v . v / 2, J.
  [[nodiscard]] double kinetic_energy(const Vector<T>& v) const {
    Vector<T> p = Vector<T>::Zero(v.size());
    mass.add_product(v, T(1), p);
    return dot(v, p) / 2;
  }

 private:
  std::vector<Vec3<double>> rest_;
  std::uint64_t number_ = detail::next_system_number();
};

}  // namespace softsim
