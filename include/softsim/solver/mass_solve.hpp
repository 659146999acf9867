// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "softsim/core/state.hpp"
#include "softsim/solver/conjugate_gradient.hpp"
#include "softsim/solver/report.hpp"

namespace softsim {

/// Division by a system's mass matrix on its free components: entry by entry, for frames block by block, if
/// the mass is lumped, by conjugate gradients with these blocks as preconditioner if it is consistent (to the
/// tolerance given; few iterations, for the matrix is as well conditioned as the mesh is regular in size).
template <class S>
class MassSolve {
 public:
  using T = typename S::Scalar;

  /// @param linear for a consistent mass only
  explicit MassSolve(const ConjugateGradient& linear = {.max_iterations = 500, .tolerance = 1e-12})
      : linear_(linear) {}

  /// a = M^-1 f on free components and 0 elsewhere. A free point without mass makes a infinite or NaN there;
  /// with a consistent mass the status is then `not_finite`.
  LinearReport solve(const S& system, const State<T>& q, const Vector<T>& f, Vector<T>& a) {
    b_ = f;
    return divide(system, q, a);
  }
  /// The same where the prescribed components have the accelerations `held` (0 on free ones), which pull on
  /// their neighbours through a consistent mass: M_ff a_f = f_f - M_fp held_p.
  LinearReport solve(const S& system, const State<T>& q, const Vector<T>& f, const Vector<T>& held,
                     Vector<T>& a) {
    b_ = f;
    if (!system.mass.is_lumped() || system.frames() > 0) system.mass.add_product(q, held, T(-1), b_);
    return divide(system, q, a);
  }

 private:
  struct Operator {
    const S* system;
    const State<T>* q;
    void apply(const Vector<T>& x, Vector<T>& y) const {
      y.setZero();
      system->mass.add_product(*q, x, T(1), y);
      system->prescribed.mask(y);
    }
  };
  struct Diagonal {
    const S* system;
    const State<T>* q;
    void apply(const Vector<T>& r, Vector<T>& z) const {
      const Vector<T>& m = system->mass.diagonal();
      for (std::ptrdiff_t k = 0; k < r.size(); ++k) z[k] = r[k] == T(0) ? T(0) : r[k] / m[k];
      system->mass.frames().divide(*q, system->prescribed.free(), r, z);
    }
  };

  LinearReport divide(const S& system, const State<T>& q, Vector<T>& a) {
    if (!system.mass.is_lumped()) {
      system.prescribed.mask(b_);
      a.setZero(system.size());
      return linear_.solve(Operator{&system, &q}, Diagonal{&system, &q}, b_, a, work_);
    }
    a.resize(system.size());
    const Vector<T>&m = system.mass.diagonal(), &free = system.prescribed.free();
    for (std::ptrdiff_t k = 0; k < a.size(); ++k) a[k] = free[k] == T(0) ? T(0) : b_[k] / m[k];
    system.mass.frames().divide(q, free, b_, a);
    return detail::ended(LinearReport{}, Status::converged, "");
  }

  ConjugateGradient linear_;
  Vector<T> b_;
  ConjugateGradient::Workspace<T> work_;
};

}  // namespace softsim
