// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "softsim/concepts.hpp"
#include "softsim/material/prony.hpp"
#include "softsim/potential/elements.hpp"

namespace softsim {

/// True if two flat vectors hold the same bits.
template <class T>
[[nodiscard]] bool same_bits(const Vector<T>& a, const Vector<T>& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(T)) == 0;
}

/// `Elements` of a local potential that remembers numbers from step to step (its `Data<T>` is a
/// `Remembered`), and whose energy is, during a step, what the step minimises. Beside the functions of a
/// `LocalPotential` and `memory_size()`, E has
/// - set_step(dt), set_static(): which step or problem energy and forces stand for from now on; dt = 0: now;
/// - remember(data, u): u is where the step starts;
/// - if all steps count: set_end(dt), a step of dt has ended and forces stand for now; advance(data, u), it
/// has
///   ended in u, which returns the gradient there; and settle(data, u, response), u has been solved for
///   statically.
template <class E, class T = double, int N = default_lanes<T>>
class MemoryElements : Elements<E, T, N> {
  using Base = Elements<E, T, N>;
  using typename Base::Chunk, typename Base::Data;

 public:
  using Base::add_damping_product, Base::blocks, Base::conservative, Base::external, Base::for_each_stencil,
      Base::has_hessian, Base::remove, Base::size;
  using typename Base::RestData, typename Base::Scalar, typename Base::Stencil, typename Base::Value;
  static_assert(Base::remembers);
  /// The Hessian is that of a damping force, which Rayleigh damping leaves out.
  static constexpr bool viscous = requires { requires E::viscous; };
  /// The memory is of all steps, not only of the start of the last one.
  static constexpr bool accumulates = requires { &E::template advance<Value>; };

  /// As `Elements`.
  using Base::Base;

  /// Forgets everything: the body is at rest and nothing has acted on it.
  void reset() {
    Base::forget();
    known_.displacement.resize(0);
    ended_ = false;
    stand_for(0);
  }
  /// Forces are those dt after the state q from now on; dt = 0 for integrators that need them at q.
  void begin_step(const State<T>& q, const Vector<T>&, double dt) {
    if (dt > 0) catch_up();
    if ((dt > 0 || accumulates) && !same_bits(known_.displacement, q.displacement)) {
      catch_up();
      update(q, [](const E& model, const Data& data, const auto& u) { model.remember(data, u); });
      known_ = q;
    }
    stand_for(dt);
  }
  /// A step of dt has ended in q. The memory takes it in when it is next asked for: most often by the force
  /// at q, with which it shares the stress.
  void end_step(const State<T>& q, const Vector<T>&, double dt) requires accumulates {
    catch_up();
    Base::set_models([dt](E& model) { model.set_end(dt); });
    ahead_ = 0;
    known_ = q;
    ended_ = true;
  }
  /// Forces are those of the static problem from now on.
  void begin_static() {
    catch_up();
    Base::set_models([](E& model) { model.set_static(); });
    ahead_ = -1;
  }
  /// The static problem has been solved by q: dynamics may go on from there in equilibrium.
  void end_static(const State<T>& q) requires accumulates {
    settle(q, [](const E& model) { return model.static_response; });
  }
  /// The body has been in q for ever.
  void settle(const State<T>& q) requires accumulates {
    settle(q, [](const E&) { return StaticResponse::relaxed; });
  }

  /// Sum of the energies in J, accumulated in double in fixed order.
  [[nodiscard]] double energy(const State<T>& q) const {
    catch_up();
    return Base::energy(q);
  }
  /// y += dE/dq (minus the force), N.
  void add_gradient(const State<T>& q, Vector<T>& y) const {
    if (viscous && ahead_ <= 0) return;  // at a velocity it is the damping product
    if constexpr (accumulates)
      if (ended_ && same_bits(known_.displacement, q.displacement)) {
        Base::visit(q, &y, [](const E& model, const Data& data, const auto& u, const Chunk&) {
          return model.advance(data, u);
        });
        ended_ = false;
        return;
      }
    catch_up();
    Base::add_gradient(q, y);
  }
  /// y += (d^2E/dq^2) d.
  void add_hessian_product(const State<T>& q, const Vector<T>& d, Vector<T>& y) const {
    catch_up();
    Base::add_hessian_product(q, d, y);
  }
  /// As `Elements::add_blocks`.
  void add_blocks(const State<T>& q, T scale, const std::vector<std::int32_t>& places, T* values) const {
    catch_up();
    Base::add_blocks(q, scale, places, values);
  }

 private:
  // f(model, data with memory to write, unknowns)
  template <class Function>
  void update(const State<T>& q, Function f) const {
    Base::visit(q, nullptr,
                [&](const E& model, const Data& data, const auto& u, const Chunk&) { f(model, data, u); });
  }
  // Takes in the step that has ended.
  void catch_up() const {
    if constexpr (accumulates) {
      if (ended_)
        update(known_, [](const E& model, const Data& data, const auto& u) { (void)model.advance(data, u); });
      ended_ = false;
    }
  }
  template <class Response>
  void settle(const State<T>& q, Response response) {
    ended_ = false;
    update(q,
           [&](const E& model, const Data& data, const auto& u) { model.settle(data, u, response(model)); });
    known_ = q;
    stand_for(0);
  }
  void stand_for(double dt) {
    if (dt == ahead_) return;
    Base::set_models([dt](E& model) { model.set_step(dt); });
    ahead_ = dt;
  }

  State<T> known_;              // that the memory is of, or will be with the step that has ended
  mutable bool ended_ = false;  // in known_, but the memory has not taken it in
  double ahead_ = 0;            // s after known_ that forces stand for; -1 for the static problem
};

}  // namespace softsim
