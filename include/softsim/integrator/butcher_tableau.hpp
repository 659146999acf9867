// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "softsim/core/error.hpp"

namespace softsim {

/// Coefficients that a `ButcherTableau` is made of.
struct ButcherCoefficients {
  std::vector<std::vector<double>> a;  ///< row by row; entries left out at the end of a row are 0
  std::vector<double> b;               ///< weights, one per stage
  std::vector<double> c;               ///< times of the stages, parts of the step
  std::vector<double> b_hat = {};      ///< embedded weights for an error estimate, or none
};

/// An explicit Runge-Kutta method for y' = f(t, y): y_i = y_0 + h sum_j a_ij f(y_j), y_1 = y_0 + h sum_i b_i
/// f(y_i) (d'Aulignac 2001, Eq. 3.18). Checked when it is made; orders are worked out from the order
/// conditions.
class ButcherTableau {
 public:
  /// @throws std::invalid_argument naming row and value unless all lists fit each other, everything is
  /// finite, a is strictly lower triangular, sum b = 1 (b_hat too) and c_i = sum_j a_ij
  explicit ButcherTableau(const ButcherCoefficients& t) : b_(t.b), c_(t.c), b_hat_(t.b_hat) {
    const std::size_t s = t.b.size();
    if (s == 0) invalid("tableau: b has no entry");
    const auto check_length = [&](const char* name, std::size_t length) {
      if (length != s)
        invalid(std::string("tableau: ") + name + " has " + std::to_string(length) + " rows for " +
                std::to_string(s) + " stages");
    };
    check_length("a", t.a.size());
    check_length("c", t.c.size());
    if (!t.b_hat.empty()) check_length("b_hat", t.b_hat.size());
    a_.assign(s * s, 0);
    for (std::size_t i = 0; i < s; ++i) {
      if (t.a[i].size() > s)
        invalid(row("a", i) + std::to_string(t.a[i].size()) + " entries for " + std::to_string(s) +
                " stages");
      double sum = 0;
      for (std::size_t j = 0; j < t.a[i].size(); ++j) {
        const double a = t.a[i][j];
        if (!std::isfinite(a)) invalid(row("a", i) + to_text(a) + " must be finite");
        if (j >= i && a != 0)
          invalid(row("a", i) + to_text(a) + " at stage " + std::to_string(j) + " must be 0 (explicit)");
        sum += a_[i * s + j] = a;
      }
      if (!std::isfinite(t.c[i])) invalid(row("c", i) + to_text(t.c[i]) + " must be finite");
      if (!(std::abs(sum - t.c[i]) <= tolerance))
        invalid(row("c", i) + to_text(t.c[i]) + " must be the sum of a's row, " + to_text(sum));
    }
    check_weights("b", b_);
    if (has_embedded()) check_weights("b_hat", b_hat_);
    order_ = order_of(b_);
    embedded_order_ = has_embedded() ? order_of(b_hat_) : 0;
    // R(z) = 1 + sum_k z^k b . A^(k-1) 1
    polynomial_.push_back(1);
    std::vector<double> power(s, 1.0);
    for (std::size_t k = 0; k < s; ++k) {
      polynomial_.push_back(sum_of(b_, power));
      power = times_a(power);
    }
  }

  /// y_1 = y_0 + h f(y_0).
  [[nodiscard]] static ButcherTableau explicit_euler() { return make({{}}, {1}, {0}); }
  /// Order 2, with the slope in the middle of the step (d'Aulignac 2001, Eq. 3.17).
  [[nodiscard]] static ButcherTableau midpoint() { return make({{}, {1. / 2}}, {0, 1}, {0, 1. / 2}); }
  /// Order 2, with the mean of the slopes at both ends.
  [[nodiscard]] static ButcherTableau heun() { return make({{}, {1}}, {1. / 2, 1. / 2}, {0, 1}); }
  /// Kutta's method of order 3.
  [[nodiscard]] static ButcherTableau kutta3() {
    return make({{}, {1. / 2}, {-1, 2}}, {1. / 6, 2. / 3, 1. / 6}, {0, 1. / 2, 1});
  }
  /// The classical method of order 4 (d'Aulignac 2001, Table 3.2).
  [[nodiscard]] static ButcherTableau rk4() {
    return make({{}, {1. / 2}, {0, 1. / 2}, {0, 0, 1}}, {1. / 6, 1. / 3, 1. / 3, 1. / 6},
                {0, 1. / 2, 1. / 2, 1});
  }
  /// Bogacki & Shampine 1989: order 3, with an embedded order 2.
  [[nodiscard]] static ButcherTableau bogacki_shampine() {
    return make({{}, {1. / 2}, {0, 3. / 4}, {2. / 9, 1. / 3, 4. / 9}}, {2. / 9, 1. / 3, 4. / 9, 0},
                {0, 1. / 2, 3. / 4, 1}, {7. / 24, 1. / 4, 1. / 3, 1. / 8});
  }
  /// Dormand & Prince 1980: order 5, with an embedded order 4.
  [[nodiscard]] static ButcherTableau dormand_prince() {
    return make({{},
                 {1. / 5},
                 {3. / 40, 9. / 40},
                 {44. / 45, -56. / 15, 32. / 9},
                 {19372. / 6561, -25360. / 2187, 64448. / 6561, -212. / 729},
                 {9017. / 3168, -355. / 33, 46732. / 5247, 49. / 176, -5103. / 18656},
                 {35. / 384, 0, 500. / 1113, 125. / 192, -2187. / 6784, 11. / 84}},
                {35. / 384, 0, 500. / 1113, 125. / 192, -2187. / 6784, 11. / 84, 0},
                {0, 1. / 5, 3. / 10, 4. / 5, 8. / 9, 1, 1},
                {5179. / 57600, 0, 7571. / 16695, 393. / 640, -92097. / 339200, 187. / 2100, 1. / 40});
  }

  /// Number of stages.
  [[nodiscard]] std::size_t stages() const { return b_.size(); }
  /// Entry of a.
  [[nodiscard]] double a(std::size_t i, std::size_t j) const { return a_[i * stages() + j]; }
  /// Weight of stage i.
  [[nodiscard]] double b(std::size_t i) const { return b_[i]; }
  /// Time of stage i as a part of the step.
  [[nodiscard]] double c(std::size_t i) const { return c_[i]; }
  /// True if it has embedded weights.
  [[nodiscard]] bool has_embedded() const { return !b_hat_.empty(); }
  /// Embedded weight of stage i.
  [[nodiscard]] double b_hat(std::size_t i) const { return b_hat_[i]; }
  /// Order, 1 to 5: conditions beyond are not looked at.
  [[nodiscard]] int order() const { return order_; }
  /// Order of the embedded weights, 0 without.
  [[nodiscard]] int embedded_order() const { return embedded_order_; }

  /// R(z): y' = lambda y goes to y_1 = R(h lambda) y_0.
  [[nodiscard]] std::complex<double> stability_function(std::complex<double> z) const {
    std::complex<double> sum = 0;
    for (std::size_t k = polynomial_.size(); k-- > 0;) sum = sum * z + polynomial_[k];
    return sum;
  }

 private:
  // Coefficients are given to 16 digits; sums of them lose a few.
  static constexpr double tolerance = 1e-12;

  static ButcherTableau make(std::vector<std::vector<double>> a, std::vector<double> b, std::vector<double> c,
                             std::vector<double> b_hat = {}) {
    return ButcherTableau(ButcherCoefficients{std::move(a), std::move(b), std::move(c), std::move(b_hat)});
  }
  static std::string row(const char* name, std::size_t i) {
    return std::string("tableau: row ") + std::to_string(i) + " of " + name + ": ";
  }
  static void check_weights(const char* name, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < b.size(); ++i) {
      if (!std::isfinite(b[i])) invalid(row(name, i) + to_text(b[i]) + " must be finite");
      sum += b[i];
    }
    if (!(std::abs(sum - 1) <= tolerance))
      invalid(std::string("tableau: sum of ") + name + " " + to_text(sum) + " must be 1");
  }

  using List = std::vector<double>;
  [[nodiscard]] List times_a(const List& x) const {
    List y(stages(), 0.0);
    for (std::size_t i = 0; i < stages(); ++i)
      for (std::size_t j = 0; j < i; ++j) y[i] += a(i, j) * x[j];
    return y;
  }
  static List product(const List& x, const List& y) {
    List z(x);
    for (std::size_t i = 0; i < x.size(); ++i) z[i] *= y[i];
    return z;
  }
  static double sum_of(const List& b, const List& x) {
    double sum = 0;
    for (std::size_t i = 0; i < b.size(); ++i) sum += b[i] * x[i];
    return sum;
  }

  // The conditions of all 17 rooted trees of up to five nodes (Hairer, Norsett & Wanner 1993, Sec. II.2).
  [[nodiscard]] int order_of(const List& b) const {
    const List &c = c_, cc = product(c, c), ccc = product(cc, c), cccc = product(cc, cc);
    const List Ac = times_a(c), Acc = times_a(cc), AAc = times_a(Ac);
    const auto holds = [&](const List& x, double value) {
      return std::abs(sum_of(b, x) - value) <= tolerance;
    };
    if (!holds(c, 1. / 2)) return 1;
    if (!holds(cc, 1. / 3) || !holds(Ac, 1. / 6)) return 2;
    if (!holds(ccc, 1. / 4) || !holds(product(c, Ac), 1. / 8) || !holds(Acc, 1. / 12) || !holds(AAc, 1. / 24))
      return 3;
    if (!holds(cccc, 1. / 5) || !holds(product(cc, Ac), 1. / 10) || !holds(product(Ac, Ac), 1. / 20) ||
        !holds(product(c, Acc), 1. / 15) || !holds(times_a(ccc), 1. / 20) ||
        !holds(product(c, AAc), 1. / 30) || !holds(times_a(product(c, Ac)), 1. / 40) ||
        !holds(times_a(Acc), 1. / 60) || !holds(times_a(AAc), 1. / 120))
      return 4;
    return 5;
  }

  List a_, b_, c_, b_hat_, polynomial_;
  int order_ = 0, embedded_order_ = 0;
};

}  // namespace softsim
