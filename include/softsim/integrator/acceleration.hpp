// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once
#include "softsim/solver/conjugate_gradient.hpp"
#include "softsim/system/system.hpp"
namespace softsim {
template <class S>
class Acceleration {
 public:
  using T = typename S::Scalar;
  ConjugateGradient linear{.max_iterations = 500, .tolerance = 1e-12};
  LinearReport compute(const S& system, const State<T>& q, const Vector<T>& v, Vector<T>& a) {
    f_.setZero(system.size());
    system.add_gradient(q, f_);
    system.add_damping_product(q, v, f_);
    if (system.damping.beta != 0) {
      p_ = static_cast<T>(system.damping.beta) * v;
      system.add_elastic_hessian_product(q, p_, f_);
    }
    if (system.damping.alpha != 0) system.mass.add_product(v, static_cast<T>(system.damping.alpha), f_);
    f_ = -f_;
    system.prescribed.mask(f_);
    a.setZero(system.size());
    const auto& m = system.mass.diagonal();
    for (std::ptrdiff_t k = 0; k < a.size(); ++k)
      if (f_[k] != T(0)) a[k] = f_[k] / m[k];
    return {.status = Status::converged};
  }

 private:
  Vector<T> f_, p_;
};
}  // namespace softsim
