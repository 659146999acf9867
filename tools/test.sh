#!/bin/sh
# Installs what is missing, builds everything in build/release and runs the tests. Arguments go to ctest.
# SPDX-License-Identifier: MIT
set -eu
cd "$(dirname "$0")/.."
. tools/prerequisites.sh
prerequisites g++ cmake make libeigen3-dev python3-matplotlib libgtest-dev libbenchmark-dev pkg-config

cmake --preset release
cmake --build build/release -j "$(processors)"
exec ctest --test-dir build/release --output-on-failure --no-tests=error -j "$(processors)" "$@"
