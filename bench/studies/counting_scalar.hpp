// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <bit>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <type_traits>
#include <utility>
#include <vector>

#include "softsim/core/elementary.hpp"

namespace studies {

/// Numbers of floating-point operations.
struct Operations {
  long additions = 0;  ///< and subtractions
  long multiplications = 0;
  long divisions = 0;
  long square_roots = 0;
  long functions = 0;  ///< logarithm, inverse cube root, ...: one each, whatever they cost
  long choices = 0;    ///< abs, min, max, select

  /// Floating-point operations, without the choices.
  [[nodiscard]] long total() const {
    return additions + multiplications + divisions + square_roots + functions;
  }
};

/// What has been computed, operation by operation, since the last `clear`. The same operation on the same
/// numbers is one entry, so that counting from the results back gives what an optimising compiler that keeps
/// to IEEE arithmetic has to execute: no common subexpression twice, nothing that is not used, no product of
/// constants; but 0 + x and 0 * x, which it may not drop.
class Tape {
 public:
  enum class Kind : std::uint8_t {
    constant,
    variable,
    addition,
    multiplication,
    division,
    root,
    function,
    choice,
    sign
  };
  using Id = std::int32_t;

  void clear() {
    entries_.clear();
    known_.clear();
    written_ = 0;
  }
  /// A new variable.
  Id variable() { return append({Kind::variable, '\0', 0, 0}); }
  /// The entry for this operation. Operands of commutative operations may come in either order.
  [[gnu::noinline]] Id record(Kind kind, char symbol, Id a, Id b) {
    written_ += kind != Kind::constant && kind != Kind::choice && kind != Kind::sign;
    if ((symbol == '+' || symbol == '*') && b < a) std::swap(a, b);
    const auto [at, is_new] = known_.try_emplace(Key{symbol, a, b}, 0);
    if (is_new) at->second = append({kind, symbol, a, b});
    return at->second;
  }
  /// The entry for a constant.
  [[gnu::noinline]] Id constant(double value) {
    const auto bits = std::bit_cast<std::array<Id, 2>>(value);
    return record(Kind::constant, '#', bits[0], bits[1]);
  }
  [[nodiscard]] bool is_constant(Id id) const {
    return entries_[static_cast<std::size_t>(id)].kind == Kind::constant;
  }

  /// Operations that the given results depend on.
  [[nodiscard]] Operations needed_for(const std::vector<Id>& results) const {
    std::vector<bool> needed(entries_.size(), false);
    for (const Id r : results) needed[static_cast<std::size_t>(r)] = true;
    Operations n;
    for (std::size_t k = entries_.size(); k-- > 0;) {  // operands stand before what is made of them
      if (!needed[k]) continue;
      const Entry& e = entries_[k];
      if (e.kind == Kind::constant || e.kind == Kind::variable) continue;
      needed[static_cast<std::size_t>(e.a)] = needed[static_cast<std::size_t>(e.b)] = true;
      n.additions += e.kind == Kind::addition;
      n.multiplications += e.kind == Kind::multiplication;
      n.divisions += e.kind == Kind::division;
      n.square_roots += e.kind == Kind::root;
      n.functions += e.kind == Kind::function;
      n.choices += e.kind == Kind::choice;
    }
    return n;
  }
  /// Operations as the source has them, repeated and unused ones included, without choices.
  [[nodiscard]] long written() const { return written_; }

 private:
  struct Entry {
    Kind kind;
    char symbol;
    Id a, b;
  };
  struct Key {
    char symbol;
    Id a, b;
    auto operator<=>(const Key&) const = default;
  };
  Id append(const Entry& e) {
    entries_.push_back(e);
    return static_cast<Id>(entries_.size()) - 1;
  }

  std::vector<Entry> entries_;
  std::map<Key, Id> known_;
  long written_ = 0;
};

/// The tape that `Counting` writes on.
[[gnu::noinline]] inline Tape& tape() {
  static thread_local Tape t;
  return t;
}

/// A double that writes every operation on the tape. Stands in for a scalar in every generic function of the
/// library and in Eigen's fixed-size matrices. What is made from a plain number, parameters of a law
/// included, is a constant: operations on constants alone are done once and for all and not counted.
/// Comparisons are not counted. Nothing is inlined: kernels that flatten their calls would take minutes to
/// compile.
struct Counting {
  double value;
  Tape::Id id;

  Counting() = default;
  /// A constant.
  template <class S>
  requires std::is_arithmetic_v<S>
  [[gnu::noinline]] Counting(S s) : value(static_cast<double>(s)), id(tape().constant(value)) {}
  /// A variable.
  [[nodiscard]] static Counting variable(double v) { return {v, tape().variable()}; }

  [[gnu::noinline]] Counting operator-() const {
    return made(Tape::Kind::sign, 'n', *this, *this, -value);  // free: it goes into the next addition
  }
  [[gnu::noinline]] Counting& operator+=(const Counting& b) { return *this = *this + b; }
  [[gnu::noinline]] Counting& operator-=(const Counting& b) { return *this = *this - b; }
  [[gnu::noinline]] Counting& operator*=(const Counting& b) { return *this = *this * b; }
  [[gnu::noinline]] Counting& operator/=(const Counting& b) { return *this = *this / b; }

  [[gnu::noinline]] friend Counting operator+(const Counting& a, const Counting& b) {
    return made(Tape::Kind::addition, '+', a, b, a.value + b.value);
  }
  [[gnu::noinline]] friend Counting operator-(const Counting& a, const Counting& b) {
    if (b.is(0) && !std::signbit(b.value)) return a;  // exact whatever a is
    return made(Tape::Kind::addition, '-', a, b, a.value - b.value);
  }
  [[gnu::noinline]] friend Counting operator*(const Counting& a, const Counting& b) {
    if (a.is(1)) return b;
    if (b.is(1)) return a;
    return made(Tape::Kind::multiplication, '*', a, b, a.value * b.value);
  }
  [[gnu::noinline]] friend Counting operator/(const Counting& a, const Counting& b) {
    if (b.is(1)) return a;
    return made(Tape::Kind::division, '/', a, b, a.value / b.value);
  }

  friend bool operator<(const Counting& a, const Counting& b) { return a.value < b.value; }
  friend bool operator<=(const Counting& a, const Counting& b) { return a.value <= b.value; }
  friend bool operator>(const Counting& a, const Counting& b) { return a.value > b.value; }
  friend bool operator>=(const Counting& a, const Counting& b) { return a.value >= b.value; }
  friend bool operator==(const Counting& a, const Counting& b) { return a.value == b.value; }
  friend bool operator!=(const Counting& a, const Counting& b) { return a.value != b.value; }

  [[gnu::noinline]] friend Counting select(bool condition, const Counting& a, const Counting& b) {
    return made(Tape::Kind::choice, '?', a, b, condition ? a.value : b.value);
  }
  [[gnu::noinline]] friend Counting abs(const Counting& a) {
    return made(Tape::Kind::choice, 'a', a, a, std::abs(a.value));
  }
  [[gnu::noinline]] friend Counting min(const Counting& a, const Counting& b) {
    return made(Tape::Kind::choice, '<', a, b, b.value < a.value ? b.value : a.value);
  }
  [[gnu::noinline]] friend Counting max(const Counting& a, const Counting& b) {
    return made(Tape::Kind::choice, '>', a, b, a.value < b.value ? b.value : a.value);
  }
  [[gnu::noinline]] friend Counting sqrt(const Counting& a) {
    return made(Tape::Kind::root, 'r', a, a, std::sqrt(a.value));
  }
  [[gnu::noinline]] friend Counting log(const Counting& a) {
    return made(Tape::Kind::function, 'l', a, a, std::log(a.value));
  }
  [[gnu::noinline]] friend Counting log1p(const Counting& a) {
    return made(Tape::Kind::function, 'p', a, a, std::log1p(a.value));
  }
  [[gnu::noinline]] friend Counting exp(const Counting& a) {
    return made(Tape::Kind::function, 'e', a, a, std::exp(a.value));
  }
  [[gnu::noinline]] friend Counting inverse_cbrt(const Counting& a) {
    return made(Tape::Kind::function, 'c', a, a, 1 / std::cbrt(a.value));
  }
  [[gnu::noinline]] friend softsim::LogAndInverse<Counting> log_and_inverse(const Counting& a) {
    return {log(a), Counting(1) / a};
  }
  /// The plain scalar within, of which code asks for the machine epsilon.
  friend double lane(const Counting& a, int) { return a.value; }

 private:
  Counting(double v, Tape::Id i) : value(v), id(i) {}
  [[nodiscard]] bool is(double v) const { return value == v && tape().is_constant(id); }
  static Counting made(Tape::Kind kind, char symbol, const Counting& a, const Counting& b, double v) {
    if (tape().is_constant(a.id) && tape().is_constant(b.id)) return Counting(v);
    return {v, tape().record(kind, symbol, a.id, b.id)};
  }
};

}  // namespace studies

/// Lets Eigen's fixed-size matrices hold them.
template <>
struct Eigen::NumTraits<studies::Counting> : Eigen::NumTraits<double> {
  using Real = studies::Counting;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};
