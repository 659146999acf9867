// SPDX-FileCopyrightText: 2026 The softsim authors
// SPDX-License-Identifier: MIT

#include <benchmark/benchmark.h>

// What Google Benchmark's output says about the build, for compare.py.

namespace {

[[maybe_unused]] const bool added = [] {
  benchmark::AddCustomContext("compiler", SOFTSIM_BENCH_COMPILER);
  benchmark::AddCustomContext("flags", SOFTSIM_BENCH_FLAGS);
  return true;
}();

}  // namespace
