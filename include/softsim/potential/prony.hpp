// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "softsim/concepts.hpp"
#include "softsim/core/error.hpp"
#include "softsim/material/prony.hpp"
#include "softsim/potential/elastic.hpp"
#include "softsim/potential/memory_elements.hpp"

namespace softsim {

/// Prony series on the nodal forces of any term (Goulette & Chen 2015, Sec. 3.5): the gradient f of the term
/// becomes f - sum gamma_k, with gamma_k one vector per node and Prony term. The cheaper of the two kinds: a
/// step costs one evaluation of f and one pass over the nodes. But a nodal history keeps its direction in
/// space: it is exact for a body that does not turn and wrong by about the angle turned since the load came
/// on, times the share that has relaxed. For bodies that turn, and where elements are removed, use
/// `PronyElastic`.
///
/// During an implicit step the energy is instant E(q) - history . q, whose derivatives are the gradient and
/// Hessian given. `add_gradient` keeps the last f for the step's end: one thread at a time.
template <ForceTerm Term>
class PronyNodes {
 public:
  using Scalar = typename Term::Scalar;
  using T = Scalar;
  static constexpr bool conservative = Term::conservative, external = false, has_hessian = Term::has_hessian;

  StaticResponse static_response = StaticResponse::relaxed;  ///< what a static solve sees

  /// @param term the elastic response
  /// @param points number of points of the system
  PronyNodes(Term term, std::size_t points, PronySeries series)
      : term_(std::move(term)), series_(std::move(series)), step_(series_) {
    const std::ptrdiff_t size = block_stride * static_cast<std::ptrdiff_t>(points);
    gamma_.assign(series_.terms().size(), Vector<T>::Zero(size));
    for (Vector<T>* v : {&force_, &state_, &start_force_, &start_, &history_, &product_}) v->setZero(size);
    reset();
  }

  /// The elastic response; may be changed between steps.
  [[nodiscard]] Term& term() {
    state_.fill(nothing);
    return term_;
  }
  /// The elastic response.
  [[nodiscard]] const Term& term() const { return term_; }
  /// The series.
  [[nodiscard]] const PronySeries& series() const { return series_; }

  /// Forgets everything: nothing has acted on the body.
  void reset() {
    for (Vector<T>& g : gamma_) g.setZero();
    state_.fill(nothing);
    start_.fill(nothing);
    now();
  }
  /// The body has been in q for ever.
  void settle(const State<T>& q) { settle(q, StaticResponse::relaxed); }

  /// Forces are those dt after the state q from now on; dt = 0 for integrators that need them at q.
  void begin_step(const State<T>& q, const Vector<T>& v, double dt) {
    if constexpr (requires { term_.begin_step(q, v, dt); }) {
      term_.begin_step(q, v, dt);
      state_.fill(nothing);
    }
    // Where the state has been changed since the last step its force came on at once, not along the step.
    if (series_.update() == PronyUpdate::exponential && !gamma_.empty()) keep_start(q);
    if (dt == 0 && ahead_ == 0) return;
    ahead_ = dt;
    step_.set(series_, dt);
    history_.setZero();
    for (std::size_t k = 0; k < gamma_.size(); ++k) {
      history_ += static_cast<T>(step_.terms[k].decay) * gamma_[k];
      if (step_.start != 0) history_ += static_cast<T>(step_.terms[k].start) * start_force_;
    }
  }
  /// A step of dt has ended in q.
  void end_step(const State<T>& q, const Vector<T>& v, double dt) {
    const Vector<T>& f = force(q);
    step_.set(series_, dt);
    // A stretch at a time, so that it is still in the cache for the next Prony term.
    constexpr std::ptrdiff_t stretch = 512;
#ifdef _OPENMP
#pragma omp parallel for schedule(static) if (f.size() > 16 * stretch)
#endif
    for (std::ptrdiff_t i = 0; i < f.size(); i += stretch) {
      const std::ptrdiff_t n = std::min(stretch, f.size() - i);
      auto sum = history_.segment(i, n);
      sum.setZero();
      for (std::size_t k = 0; k < gamma_.size(); ++k) {
        const auto [decay, start, end] = step_.terms[k];
        auto g = gamma_[k].segment(i, n);
        g = static_cast<T>(decay) * g + static_cast<T>(end) * f.segment(i, n);
        if (start != 0) g += static_cast<T>(start) * start_force_.segment(i, n);
        sum += g;
      }
    }
    step_.set(series_, 0);
    ahead_ = 0;
    if constexpr (requires { term_.end_step(q, v, dt); }) {
      term_.end_step(q, v, dt);
      state_.fill(nothing);
    }
  }
  /// Forces are those of the static problem from now on.
  void begin_static() {
    if constexpr (requires { term_.begin_static(); }) term_.begin_static();
    ahead_ = -1;
    step_.instant = static_response == StaticResponse::relaxed ? series_.relaxed() : 1;
    history_.setZero();
  }
  /// The static problem has been solved by q: dynamics may go on from there in equilibrium.
  void end_static(const State<T>& q) {
    if constexpr (requires { term_.end_static(q); }) term_.end_static(q);
    settle(q, static_response);
  }

  /// Energy whose derivative the gradient is, J: the stored energy at first and in a static problem.
  [[nodiscard]] double energy(const State<T>& q) const requires Potential<Term> {
    return step_.instant * term_.energy(q) - dot(history_, q.displacement);
  }
  /// y += instant f(q) - history, minus the force, N.
  void add_gradient(const State<T>& q, Vector<T>& y) const {
    y += static_cast<T>(step_.instant) * force(q) - history_;
  }
  /// y += instant K(q) d.
  void add_hessian_product(const State<T>& q, const Vector<T>& d, Vector<T>& y) const {
    product_.setZero(d.size());
    term_.add_hessian_product(q, d, product_);
    y += static_cast<T>(step_.instant) * product_;
  }

  /// As the term.
  [[nodiscard]] std::size_t size() const requires has_hessian { return term_.size(); }
  /// As the term.
  template <class Function>
  void for_each_stencil(Function f) const requires has_hessian {
    term_.for_each_stencil(f);
  }
  /// As the term, times `instant`.
  void add_blocks(const State<T>& q, T scale, const std::vector<std::int32_t>& places,
                  T* values) const requires has_hessian {
    term_.add_blocks(q, static_cast<T>(step_.instant) * scale, places, values);
  }

 private:
  static constexpr T nothing = std::numeric_limits<T>::quiet_NaN();  // differs from every state

  // f(q), from the last call if that was for the same state.
  const Vector<T>& force(const State<T>& q) const {
    if (!same_bits(state_, q.displacement)) {
      state_ = q.displacement;
      force_.setZero();
      term_.add_gradient(q, force_);
    }
    return force_;
  }
  void keep_start(const State<T>& q) {
    if (same_bits(start_, q.displacement)) return;
    start_ = q.displacement;
    start_force_ = force(q);
  }
  void settle(const State<T>& q, StaticResponse response) {
    const Vector<T>& f = force(q);
    for (std::size_t k = 0; k < gamma_.size(); ++k)
      gamma_[k] = static_cast<T>(response == StaticResponse::relaxed ? series_.terms()[k].weight : 0) * f;
    now();
  }
  // Forces are those of now.
  void now() {
    step_.set(series_, 0);
    ahead_ = 0;
    history_.setZero();
    for (const Vector<T>& g : gamma_) history_ += g;
  }

  Term term_;
  PronySeries series_;
  PronyStep step_;
  double ahead_ = 0;                 // s after the last state that forces stand for; -1 for a static problem
  std::vector<Vector<T>> gamma_;     // N
  Vector<T> history_;                // what the gradient is less than instant f by, N
  Vector<T> start_, start_force_;    // the state that a step starts from and f there
  mutable Vector<T> state_, force_;  // the state last asked for and f there
  mutable Vector<T> product_;
};

/// Prony series on the nodal forces of a term, in a system with `points` points.
template <ForceTerm Term>
[[nodiscard]] PronyNodes<Term> prony_nodes(Term term, std::size_t points, PronySeries series) {
  return {std::move(term), points, std::move(series)};
}

/// Prony series on the second Piola-Kirchhoff stress of one integration point: S - sum gamma_k with tau_k
/// gamma_k' + gamma_k = alpha_k S. S does not see rotations, hence neither does the history: the response is
/// objective, whatever the body does while it relaxes. Where the shape is held it is that of `PronyNodes`.
/// With E the Green strain and h the history, a step minimises V (instant psi(F) - h : E), the gradient is
/// V B^T (instant P - F h). Goes into `MemoryElements`. Needs det F != 0 where a step ends (a law's S may
/// grow without bound there); after a state that is not finite call `reset` or `settle`.
template <class K, class M>
requires Kinematics<K> && Material<M> && requires(const M& m, const Mat3<double>& F) { m.second_piola(F); }
struct PronyElastic {
  static constexpr int points = K::points;
  static constexpr bool translation_invariant = requires { requires K::translation_invariant; };
  /// That of the kinematics, and six numbers each for every term and, where the series needs it, for S at the
  /// start of the step.
  template <class T>
  using Data = Remembered<typename K::template Data<T>, T>;

  M material;
  PronySeries series;
  StaticResponse static_response = StaticResponse::relaxed;  ///< what a static solve sees

  /// A material with its series.
  PronyElastic(M material_, PronySeries series_, StaticResponse response = StaticResponse::relaxed)
      : material(std::move(material_)),
        series(std::move(series_)),
        static_response(response),
        ended_(series),
        step_(series) {}

  /// See `Remembered`.
  [[nodiscard]] std::size_t memory_size() const {
    return 6 * (series.terms().size() + (keeps_start() ? 1 : 0));
  }

  /// See `MemoryElements`.
  void set_step(double dt) {
    step_.set(series, dt);
    static_ = false;
  }
  /// See `MemoryElements`.
  void set_end(double dt) {
    ended_.set(series, dt);
    set_step(0);
  }
  /// See `MemoryElements`.
  void set_static() {
    step_.set(series, 0);
    if (static_response == StaticResponse::relaxed) step_.instant = series.relaxed();
    static_ = true;
  }
  /// Takes S at u.
  template <class T>
  void remember(const Data<T>& data, const Local<T, points>& u) const {
    if (keeps_start())
      Symmetric<T>(material.second_piola(K::deformation_gradient(data.rest, u))).write(data.memory);
  }
  /// Carries the terms to the end of a step in u. V B^T F (S - sum gamma_k), N.
  template <class T>
  Eigen::Matrix<T, 3 * points, 1> advance(const Data<T>& data, const Local<T, points>& u) const {
    const Mat3<T> F = K::deformation_gradient(data.rest, u);
    const Symmetric<T> S(material.second_piola(F));
    Symmetric<T> rest = S;
    if (keeps_start()) {
      Symmetric<T> start(data.memory);
      S.write(data.memory);
      carry(data.memory + 6, S, rest,
            [&](T& gamma, const PronySeries::Coefficients& c, int i) { gamma += T(c.start) * start[i]; });
    } else {
      carry(data.memory, S, rest, [](T&, const PronySeries::Coefficients&, int) {});
    }
    Mat3<T> P = F * rest.matrix();
    P *= K::volume(data.rest);
    return K::pullback(data.rest, u, P);
  }
  /// The terms of a body that has been in u for ever (relaxed) or has just come there.
  template <class T>
  void settle(const Data<T>& data, const Local<T, points>& u, StaticResponse response) const {
    const Symmetric<T> S(material.second_piola(K::deformation_gradient(data.rest, u)));
    if (keeps_start()) S.write(data.memory);
    T* gamma = terms(data);
    for (const PronyTerm& term : series.terms())
      for (int i = 0; i < 6; ++i, ++gamma)
        *gamma = T(response == StaticResponse::relaxed ? term.weight : 0) * S[i];
  }

  /// V (instant psi(F) - h : E), J.
  template <class T>
  [[nodiscard]] T energy(const Data<T>& data, const Local<T, points>& u) const {
    const Mat3<T> F = K::deformation_gradient(data.rest, u), H = F - Mat3<T>::Identity();
    const Mat3<T> twice_E = H + H.transpose() + H.transpose() * H;
    return K::volume(data.rest) *
           (T(step_.instant) * material.energy_density(F) - T(0.5) * double_dot(history(data), twice_E));
  }
  /// V B^T (instant P - F h), N.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 3 * points, 1> gradient(const Data<T>& data,
                                                         const Local<T, points>& u) const {
    return K::pullback(data.rest, u, scaled_stress(data, K::deformation_gradient(data.rest, u)));
  }
  /// V B^T (instant dP - dF h), and the geometric product where F is not linear in the unknowns.
  template <class T>
  [[nodiscard]] Eigen::Matrix<T, 3 * points, 1> hessian_product(
      const Data<T>& data, const Local<T, points>& u, const Eigen::Matrix<T, 3 * points, 1>& du) const {
    const Mat3<T> F = K::deformation_gradient(data.rest, u);
    const Mat3<T> dF = K::deformation_gradient_differential(data.rest, u, du), dFh = dF * history(data);
    const T c(step_.instant);
    Mat3<T> dP = material.first_piola_differential(F, dF);
    dP = c * dP - dFh;
    dP *= K::volume(data.rest);
    Eigen::Matrix<T, 3 * points, 1> df = K::pullback(data.rest, u, dP);
    if constexpr (NonlinearKinematics<K, T>)
      df += K::geometric_product(data.rest, u, scaled_stress(data, F), du);
    return df;
  }

 private:
  // The six different entries of a symmetric matrix.
  template <class T>
  struct Symmetric {
    T entry[6];

    explicit Symmetric(const T* memory) {
      for (int i = 0; i < 6; ++i) entry[i] = memory[i];
    }
    explicit Symmetric(const Mat3<T>& S) : entry{S(0, 0), S(1, 1), S(2, 2), S(0, 1), S(0, 2), S(1, 2)} {}
    T& operator[](int i) { return entry[i]; }
    const T& operator[](int i) const { return entry[i]; }
    void write(T* memory) const {
      for (int i = 0; i < 6; ++i) memory[i] = entry[i];
    }
    [[nodiscard]] Mat3<T> matrix() const {
      Mat3<T> S;  // without a comma initialiser, which counts its way at run time
      S(0, 0) = entry[0];
      S(1, 1) = entry[1];
      S(2, 2) = entry[2];
      S(0, 1) = S(1, 0) = entry[3];
      S(0, 2) = S(2, 0) = entry[4];
      S(1, 2) = S(2, 1) = entry[5];
      return S;
    }
  };

  [[nodiscard]] bool keeps_start() const { return series.update() == PronyUpdate::exponential; }
  template <class T>
  [[nodiscard]] T* terms(const Data<T>& data) const {
    return data.memory + (keeps_start() ? 6 : 0);
  }
  // gamma = decay gamma + end S + what `add_start` adds; rest -= gamma.
  template <class T, class AddStart>
  void carry(T* gamma, const Symmetric<T>& S, Symmetric<T>& rest, AddStart add_start) const {
    for (const PronySeries::Coefficients& c : ended_.terms) {
      const T decay(c.decay), end(c.end);
      for (int i = 0; i < 6; ++i) {
        T g = decay * gamma[i] + end * S[i];
        add_start(g, c, i);
        gamma[i] = g;
        rest[i] -= g;
      }
      gamma += 6;
    }
  }
  // h = sum of decay gamma + start S_0 of the step.
  template <class T>
  [[nodiscard]] Mat3<T> history(const Data<T>& data) const {
    T h[6] = {T(0), T(0), T(0), T(0), T(0), T(0)};
    if (!static_) {
      if (keeps_start())
        for (int i = 0; i < 6; ++i) h[i] = T(step_.start) * data.memory[i];
      const T* gamma = terms(data);
      for (const PronySeries::Coefficients& c : step_.terms)
        for (T& sum : h) sum += T(c.decay) * *gamma++;
    }
    return Symmetric<T>(h).matrix();
  }
  template <class T>
  Mat3<T> scaled_stress(const Data<T>& data, const Mat3<T>& F) const {
    const T c(step_.instant);
    const Mat3<T> Fh = F * history(data);
    Mat3<T> P = material.first_piola(F);
    P = c * P - Fh;
    P *= K::volume(data.rest);
    return P;
  }

  PronyStep ended_, step_;  // of the step that ended last, and of that which forces stand for
  bool static_ = false;
};

/// A mesh of linear tetrahedra with a Prony series on the stress of each, see `PronyElastic`.
template <class M, class T = double, int N = default_lanes<T>>
using PronyTetrahedra = MemoryElements<PronyElastic<LinearTetrahedron, M>, T, N>;

/// Viscoelastic tetrahedra of one material, history per element, see `PronyElastic`.
template <class T = double, int N = default_lanes<T>, class M>
requires Material<M>
[[nodiscard]] PronyTetrahedra<M, T, N> prony_elements(const TetrahedralMesh& mesh, const M& material,
                                                      PronySeries series,
                                                      StaticResponse response = StaticResponse::relaxed) {
  return {std::vector{PronyElastic<LinearTetrahedron, M>(material, std::move(series), response)},
          detail::tetrahedron_data(mesh), mesh.tetrahedra()};
}

}  // namespace softsim
