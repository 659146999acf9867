#!/bin/sh
# Installs what is missing, builds the example `deform` in build/release and runs it. Arguments go to deform; without any
# it deforms the shipped organ and writes to out/organ in the current folder.
# SPDX-License-Identifier: MIT
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
. "$root/tools/prerequisites.sh"
prerequisites g++ cmake make libeigen3-dev python3-matplotlib

# Where the test libraries are missing CMake would fetch them, for a program that does not use them.
others=ON
if lacks libgtest-dev || lacks libbenchmark-dev; then others=OFF; fi
(
    cd "$root"
    cmake --preset release -DSOFTSIM_BUILD_TESTS=$others -DSOFTSIM_BUILD_BENCH=$others
    cmake --build build/release --target deform -j "$(processors)"
)

exec "$root/build/release/examples/deform" "$@"
