// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "softsim/concepts.hpp"
#include "softsim/core/error.hpp"
#include "softsim/mesh/element_mesh.hpp"
#include "softsim/system/mass.hpp"
#include "softsim/system/prescribed.hpp"

namespace softsim {

/// Rayleigh damping: the force -(alpha M + beta K) v with K the Hessian at the start of the step.
struct Rayleigh {
  double alpha = 0;  ///< 1/s
  double beta = 0;   ///< s
};

/// Momentum of a motion in kg m/s, and angular momentum about the origin of space in kg m^2/s.
struct Momentum {
  Vec3<double> linear = Vec3<double>::Zero(), angular = Vec3<double>::Zero();
};

namespace detail {
template <class Term>
concept remembers = requires(Term& term, const State<typename Term::Scalar>& q,
                             const Vector<typename Term::Scalar>& v) {
  term.begin_step(q, v, 0.0);
};
template <class Term>
concept has_discrete_gradient = requires(const Term& term, const State<typename Term::Scalar>& q,
                                         Vector<typename Term::Scalar>& y) {
  term.add_discrete_gradient(q, q, y);
};
template <class Term>
concept is_viscous = Term::viscous;
template <class S>
concept has_memory = S::has_memory;
}  // namespace detail

/// How integrators and solvers take a system: writable only if one of its terms remembers something.
template <class S>
using Stepped = std::conditional_t<detail::has_memory<S>, S&, const S&>;

/// Force terms over one set of points and frames, with mass, damping and prescribed components. Models
/// `Potential` itself where all its terms do. The terms are public: a load may be changed between steps.
template <ForceTerm... Terms>
class System {
 public:
  using Scalar = typename std::tuple_element_t<0, std::tuple<Terms...>>::Scalar;
  using T = Scalar;
  static_assert((std::is_same_v<typename Terms::Scalar, Scalar> && ...), "all terms need the same scalar");
  /// True if every term derives from an energy.
  static constexpr bool conservative = (Terms::conservative && ...);
  /// True if a term remembers something from step to step.
  static constexpr bool has_memory = (detail::remembers<Terms> || ...);
  /// True if a term's Hessian is, during an implicit step, that of a damping force.
  static constexpr bool viscous = (detail::is_viscous<Terms> || ...);

  /// True if all terms that depend on the state offer a discrete gradient.
  static constexpr bool has_discrete_gradient =
      ((!Terms::has_hessian || detail::has_discrete_gradient<Terms>)&&...);

  std::tuple<Terms...> terms;
  Prescribed<T> prescribed;
  Mass<T> mass;  ///< kg; zero until set, a static solve needs none
  Rayleigh damping;

  /// A system over the nodes of `mesh`, which may have frames (`FrameNodes`).
  template <PointMesh Mesh>
  explicit System(const Mesh& mesh, Terms... terms_)
      : terms(std::move(terms_)...),
        prescribed(mesh.points().size(), frames_in(mesh)),
        mass(mesh.points().size(), frames_in(mesh)),
        rest_(mesh.points()),
        frames_(frames_in(mesh)) {
    if constexpr (requires { mesh.frames(); })
      for (const Vec3<double>& X : mesh.frames()) rest_.insert(rest_.end(), 2, X);
  }

  /// Rest positions in m, one per block: of the points, then twice of each frame.
  [[nodiscard]] const std::vector<Vec3<double>>& rest() const { return rest_; }
  /// Number of frames.
  [[nodiscard]] std::size_t frames() const { return frames_; }
  /// Number of points.
  [[nodiscard]] std::size_t points() const { return rest_.size() - 2 * frames_; }
  /// All points and frames at rest.
  [[nodiscard]] State<T> rest_state() const { return State<T>(points(), frames_); }
  /// The same, not moving.
  [[nodiscard]] Motion<T> rest_motion() const { return Motion<T>(points(), frames_); }
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
  /// Number of elements that are inverted or flat at q, of the terms that can tell: elastic solids.
  [[nodiscard]] std::size_t inverted(const State<T>& q) const {
    std::size_t count = 0;
    for_each_term([&](const auto& term) {
      if constexpr (requires { term.inverted(q); }) count += term.inverted(q);
    });
    return count;
  }
  /// y += dE/dq: minus the sum of the forces, N.
  void add_gradient(const State<T>& q, Vector<T>& y) const {
    std::apply([&](const auto&... term) { (term.add_gradient(q, y), ...); }, terms);
  }
  /// y += K d, K the Hessian at q.
  void add_hessian_product(const State<T>& q, const Vector<T>& d, Vector<T>& y) const {
    std::apply([&](const auto&... term) { (term.add_hessian_product(q, d, y), ...); }, terms);
  }
  /// y += the discrete gradients of the terms between two states, N; loads that do not depend on the state
  /// are their own.
  void add_discrete_gradient(const State<T>& q_0, const State<T>& q_1, Vector<T>& y) const
      requires(has_discrete_gradient) {
    for_each_term([&](const auto& term) {
      if constexpr (!std::decay_t<decltype(term)>::has_hessian)
        term.add_gradient(q_1, y);
      else
        term.add_discrete_gradient(q_0, q_1, y);
    });
  }
  /// y += K d without the terms that are damping forces themselves.
  void add_elastic_hessian_product(const State<T>& q, const Vector<T>& d, Vector<T>& y) const {
    for_each_term([&](const auto& term) {
      if constexpr (!detail::is_viscous<std::decay_t<decltype(term)>>) term.add_hessian_product(q, d, y);
    });
  }
  /// y += D v of the terms that offer `add_damping_product`: minus their damping forces, for integrators that
  /// take them at (q, v). In an implicit step such a term has them in its energy.
  void add_damping_product(const State<T>& q, const Vector<T>& v, Vector<T>& y) const {
    for_each_term([&](const auto& term) {
      if constexpr (requires { term.add_damping_product(q, v, y); }) term.add_damping_product(q, v, y);
    });
  }

  /// Tells the terms that remember that a step starts at (q, v), and how long after q, dt >= 0 in s, forces
  /// will be asked for: 0 by explicit integrators. A step that failed may simply be begun again.
  void begin_step(const State<T>& q, const Vector<T>& v, double dt) {
    for_each_term_writable([&](auto& term) {
      if constexpr (requires { term.begin_step(q, v, dt); }) term.begin_step(q, v, dt);
    });
  }
  /// Tells them that the step of dt in s has ended at (q, v).
  void end_step(const State<T>& q, const Vector<T>& v, double dt) {
    for_each_term_writable([&](auto& term) {
      if constexpr (requires { term.end_step(q, v, dt); }) term.end_step(q, v, dt);
    });
  }
  /// Tells them that a static problem is to be solved, and that it has been, by q.
  void begin_static() {
    for_each_term_writable([&](auto& term) {
      if constexpr (requires { term.begin_static(); }) term.begin_static();
    });
  }
  void end_static(const State<T>& q) {
    for_each_term_writable([&](auto& term) {
      if constexpr (requires { term.end_static(q); }) term.end_static(q);
    });
  }

  /// Energy of the loads from outside alone, J.
  [[nodiscard]] double external_energy(const State<T>& q) const requires(Potential<Terms>&&...) {
    double sum = 0;
    for_each_term([&](const auto& term) {
      if constexpr (std::decay_t<decltype(term)>::external) sum += term.energy(q);
    });
    return sum;
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

  /// M v . v / 2 of points, J; frames count as if they were at rest.
  [[nodiscard]] double kinetic_energy(const Vector<T>& v) const { return kinetic_energy(rest_state(), v); }
  /// M(q) v . v / 2, J.
  [[nodiscard]] double kinetic_energy(const State<T>& q, const Vector<T>& v) const {
    Vector<T> p = Vector<T>::Zero(v.size());
    mass.add_product(q, v, T(1), p);
    return dot(v, p) / 2;
  }

  /// Momentum of all points and frames: p = M(q) v; frames' parts of p about their axes, R p, count to the
  /// angular one.
  [[nodiscard]] Momentum momentum(const Motion<T>& motion) const {
    Vector<T> p = Vector<T>::Zero(motion.v.size());
    mass.add_product(motion.q, motion.v, T(1), p);
    Momentum sum;
    const auto add = [&](std::ptrdiff_t b) {
      const Vec3<double> x = rest_[static_cast<std::size_t>(b)] +
                             block(motion.q.displacement, b).template cast<double>(),
                         part = block(p, b).template cast<double>();
      sum.linear += part;
      sum.angular += x.cross(part);
    };
    for (std::ptrdiff_t i = 0; i < motion.q.points(); ++i) add(i);
    for (std::ptrdiff_t j = 0; j < motion.q.frames(); ++j) {
      add(motion.q.frame_block(j));
      sum.angular += motion.q.in_space(p, j).template cast<double>();
    }
    return sum;
  }

 private:
  template <class Mesh>
  static std::size_t frames_in(const Mesh& mesh) {
    if constexpr (requires { mesh.frames(); })
      return mesh.frames().size();
    else
      return 0;
  }
  template <class Function>
  void for_each_term_writable(Function f) {
    std::apply([&](auto&... term) { (f(term), ...); }, terms);
  }

  std::vector<Vec3<double>> rest_;
  std::size_t frames_ = 0;
  std::uint64_t number_ = detail::next_number();
};

}  // namespace softsim
