// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "softsim/potential/dead_load.hpp"
#include "softsim/system/system.hpp"

/// What the programs of the stability atlas share.
namespace atlas {

using softsim::State, softsim::Vector;

/// Any conservative term behind virtual calls: the atlas has a hundred of them, and the solvers compile once.
/// Empty, it is a term without stencils.
class AnyTerm {
 public:
  using Scalar = double;
  static constexpr bool conservative = true, external = false, has_hessian = true;
  using Stencil = std::span<const std::int32_t>;

  AnyTerm() = default;
  template <softsim::Potential Term>
  AnyTerm(Term term) : term_(std::make_shared<Model<Term>>(std::move(term))) {}

  [[nodiscard]] std::size_t size() const { return term_ ? term_->size() : 0; }
  [[nodiscard]] double energy(const State<double>& q) const { return term_ ? term_->energy(q) : 0; }
  [[nodiscard]] std::size_t inverted(const State<double>& q) const { return term_ ? term_->inverted(q) : 0; }
  void add_gradient(const State<double>& q, Vector<double>& y) const {
    if (term_) term_->add_gradient(q, y);
  }
  void add_hessian_product(const State<double>& q, const Vector<double>& d, Vector<double>& y) const {
    if (term_) term_->add_hessian_product(q, d, y);
  }
  void for_each_stencil(const std::function<void(Stencil)>& f) const {
    if (term_) term_->for_each_stencil(f);
  }
  void add_blocks(const State<double>& q, double scale, const std::vector<std::int32_t>& places,
                  double* values) const {
    if (term_) term_->add_blocks(q, scale, places, values);
  }

 private:
  struct Interface {
    virtual ~Interface() = default;
    virtual std::size_t size() const = 0;
    virtual double energy(const State<double>& q) const = 0;
    virtual std::size_t inverted(const State<double>& q) const = 0;
    virtual void add_gradient(const State<double>& q, Vector<double>& y) const = 0;
    virtual void add_hessian_product(const State<double>& q, const Vector<double>& d,
                                     Vector<double>& y) const = 0;
    virtual void for_each_stencil(const std::function<void(Stencil)>& f) const = 0;
    virtual void add_blocks(const State<double>& q, double scale, const std::vector<std::int32_t>& places,
                            double* values) const = 0;
  };
  template <class Term>
  struct Model final : Interface {
    explicit Model(Term t) : term(std::move(t)) {}
    std::size_t size() const override { return term.size(); }
    double energy(const State<double>& q) const override { return term.energy(q); }
    std::size_t inverted(const State<double>& q) const override {
      if constexpr (requires { term.inverted(q); })
        return term.inverted(q);
      else
        return 0;
    }
    void add_gradient(const State<double>& q, Vector<double>& y) const override { term.add_gradient(q, y); }
    void add_hessian_product(const State<double>& q, const Vector<double>& d,
                             Vector<double>& y) const override {
      term.add_hessian_product(q, d, y);
    }
    void for_each_stencil(const std::function<void(Stencil)>& f) const override {
      term.for_each_stencil([&](const auto& stencil) { f(Stencil(stencil)); });
    }
    void add_blocks(const State<double>& q, double scale, const std::vector<std::int32_t>& places,
                    double* values) const override {
      term.add_blocks(q, scale, places, values);
    }
    Term term;
  };

  std::shared_ptr<const Interface> term_;
};

/// Elastic terms of one body, the second for volumes averaged at nodes.
using Elasticity = std::array<AnyTerm, 2>;
/// A system of them under dead loads.
using AnySystem = softsim::System<AnyTerm, AnyTerm, softsim::DeadLoad<double>>;

}  // namespace atlas
