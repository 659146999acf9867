// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "softsim/system/system.hpp"
#include "softsim/system/tangent.hpp"

namespace bench {

/// Any term with an energy behind virtual calls, one a term and not one an element: charts and atlas have a
/// hundred kinds of terms, and their solvers compile once. Empty, it is a term without stencils.
/// @tparam is_external the term is a load from outside
template <class T, bool is_external = false>
class AnyTerm {
 public:
  using Scalar = T;
  static constexpr bool conservative = true, external = is_external, has_hessian = true;
  using Stencil = std::span<const std::int32_t>;

  AnyTerm() = default;
  template <softsim::Potential Term>
  AnyTerm(Term term) : term_(std::make_shared<Model<Term>>(std::move(term))) {}

  [[nodiscard]] std::size_t size() const { return term_ ? term_->size() : 0; }
  [[nodiscard]] double energy(const softsim::State<T>& q) const { return term_ ? term_->energy(q) : 0; }
  [[nodiscard]] std::size_t inverted(const softsim::State<T>& q) const {
    return term_ ? term_->inverted(q) : 0;
  }
  void add_gradient(const softsim::State<T>& q, softsim::Vector<T>& y) const {
    if (term_) term_->add_gradient(q, y);
  }
  void add_hessian_product(const softsim::State<T>& q, const softsim::Vector<T>& d,
                           softsim::Vector<T>& y) const {
    if (term_) term_->add_hessian_product(q, d, y);
  }
  /// What the term keeps between products with one tangent, or the state itself.
  struct Linearised {
    const softsim::State<T>* q = nullptr;
    std::shared_ptr<void> kept;
    const void* of = nullptr;  ///< the term whose it is
  };
  void linearise(const softsim::State<T>& q, Linearised& to) const {
    if (to.of != term_.get()) to.kept.reset();
    to.q = &q;
    to.of = term_.get();
    if (term_) term_->linearise(q, to.kept);
  }
  void add_linearised_product(const Linearised& at, const softsim::Vector<T>& d,
                              softsim::Vector<T>& y) const {
    if (term_) term_->add_linearised_product(*at.q, at.kept.get(), d, y);
  }
  void for_each_stencil(const std::function<void(Stencil)>& f) const {
    if (term_) term_->for_each_stencil(f);
  }
  void add_blocks(const softsim::State<T>& q, T scale, const std::vector<std::int32_t>& places,
                  T* values) const {
    if (term_) term_->add_blocks(q, scale, places, values);
  }

 private:
  using State = softsim::State<T>;
  using Vector = softsim::Vector<T>;
  struct Interface {
    virtual ~Interface() = default;
    virtual std::size_t size() const = 0;
    virtual double energy(const State& q) const = 0;
    virtual std::size_t inverted(const State& q) const = 0;
    virtual void add_gradient(const State& q, Vector& y) const = 0;
    virtual void add_hessian_product(const State& q, const Vector& d, Vector& y) const = 0;
    virtual void linearise(const State& q, std::shared_ptr<void>& kept) const = 0;
    virtual void add_linearised_product(const State& q, const void* kept, const Vector& d,
                                        Vector& y) const = 0;
    virtual void for_each_stencil(const std::function<void(Stencil)>& f) const = 0;
    virtual void add_blocks(const State& q, T scale, const std::vector<std::int32_t>& places,
                            T* values) const = 0;
  };
  template <class Term>
  struct Model final : Interface {
    using Kept = typename softsim::detail::Kept<Term>::type;
    static constexpr bool keeps = !std::is_same_v<Kept, softsim::detail::KeepsNothing>;

    explicit Model(Term t) : term(std::move(t)) {}
    std::size_t size() const override {
      if constexpr (requires { term.size(); })
        return term.size();
      else
        return 0;
    }
    double energy(const State& q) const override { return term.energy(q); }
    std::size_t inverted(const State& q) const override {
      if constexpr (requires { term.inverted(q); })
        return term.inverted(q);
      else
        return 0;
    }
    void add_gradient(const State& q, Vector& y) const override { term.add_gradient(q, y); }
    void add_hessian_product(const State& q, const Vector& d, Vector& y) const override {
      term.add_hessian_product(q, d, y);
    }
    void linearise(const State& q, std::shared_ptr<void>& kept) const override {
      if constexpr (keeps) {
        if (!kept) kept = std::make_shared<Kept>();
        term.linearise(q, *static_cast<Kept*>(kept.get()));
      }
    }
    void add_linearised_product(const State& q, const void* kept, const Vector& d, Vector& y) const override {
      if constexpr (keeps)
        term.add_linearised_product(*static_cast<const Kept*>(kept), d, y);
      else
        term.add_hessian_product(q, d, y);
    }
    void for_each_stencil(const std::function<void(Stencil)>& f) const override {
      if constexpr (Term::has_hessian)
        term.for_each_stencil([&](const auto& stencil) { f(Stencil(stencil)); });
    }
    void add_blocks(const State& q, T scale, const std::vector<std::int32_t>& places,
                    T* values) const override {
      if constexpr (Term::has_hessian) term.add_blocks(q, scale, places, values);
    }
    Term term;
  };

  std::shared_ptr<const Interface> term_;
};

}  // namespace bench
