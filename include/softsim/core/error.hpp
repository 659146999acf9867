// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <string_view>

namespace softsim {

/// How a solve or a step ended. Anything but `converged` leaves the last finite state in place.
/// `stationary_not_minimum`: forces are in equilibrium, but there is a direction in which the energy falls.
/// `inverted`: forces are in equilibrium, but elements are turned inside out, which no body can do.
enum class Status { converged, not_converged, not_finite, stationary_not_minimum, inverted };

/// The name of the status.
[[nodiscard]] constexpr std::string_view to_string(Status status) {
  switch (status) {
    case Status::converged:
      return "converged";
    case Status::not_converged:
      return "not_converged";
    case Status::not_finite:
      return "not_finite";
    case Status::inverted:
      return "inverted";
    default:
      return "stationary_not_minimum";
  }
}

/// A number as text with up to nine significant digits, as every error message writes it.
[[nodiscard]] inline std::string to_text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.9g", value);
  return buffer;
}

/// Throws `std::invalid_argument` with `message`; set-up code calls it with the entity and the value in it.
[[noreturn]] inline void invalid(const std::string& message) { throw std::invalid_argument(message); }

namespace detail {
// A number that was not given before: what is worked out for one object and kept names it by this.
inline std::uint64_t next_number() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}
}  // namespace detail

}  // namespace softsim
