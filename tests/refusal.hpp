// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace refusals {

/// What f says when it refuses its arguments; empty if it takes them.
template <class Function>
std::string refusal(Function&& f) {
  try {
    (void)f();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

/// Fails unless f refuses its arguments with this message.
template <class Function>
void expect_refused(Function&& f, const std::string& message) {
  EXPECT_EQ(refusal(f), message);
}

}  // namespace refusals
