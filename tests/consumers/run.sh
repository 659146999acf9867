#!/bin/sh
# run.sh find_package|fetch_content|pkg_config SOURCE BUILD [COMPILER]
# Builds and runs the consumer program in a temporary folder, in one of the three ways a user may take softsim in.
# SOURCE is softsim's source tree, BUILD a configured build tree of it. Exit code 77: skipped.
# SPDX-License-Identifier: MIT
set -eu
way=$1 source=$2 build=$3 compiler=${4:-c++}

temporary=$(mktemp -d)
trap 'rm -rf "$temporary"' EXIT
mkdir "$temporary/consumer"
cp "$source/tests/consumers/CMakeLists.txt" "$source/tests/consumers/main.cpp" "$temporary/consumer"

# installs softsim under a first prefix and moves that away: nothing installed may remember where it was put
install_and_move() {
    cmake --install "$build" --prefix "$temporary/first" >/dev/null
    mkdir "$temporary/elsewhere"
    mv "$temporary/first" "$temporary/elsewhere/prefix"
    if grep -rlF -e "$temporary/first" -e "$source" -e "$build" "$temporary/elsewhere"; then
        echo "the installed files above hold absolute paths" >&2
        exit 1
    fi
}

build_and_run() {
    cmake -S "$temporary/consumer" -B "$temporary/build" -DCMAKE_CXX_COMPILER="$compiler" "$@"
    cmake --build "$temporary/build"
    "$temporary/build/consumer"
}

case $way in
find_package)
    install_and_move
    build_and_run -DCMAKE_PREFIX_PATH="$temporary/elsewhere/prefix"
    ;;
fetch_content)
    build_and_run -DSOFTSIM_SOURCE="$source"
    ;;
pkg_config)
    if ! command -v pkg-config >/dev/null; then
        echo "pkg-config is not installed"
        exit 77
    fi
    install_and_move
    folder=$(dirname "$(find "$temporary/elsewhere/prefix" -name softsim.pc)")
    export PKG_CONFIG_PATH="$folder${PKG_CONFIG_PATH:+:$PKG_CONFIG_PATH}"
    # shellcheck disable=SC2046  # pkg-config answers in words
    "$compiler" "$temporary/consumer/main.cpp" -o "$temporary/program" $(pkg-config --cflags --libs softsim)
    "$temporary/program"
    ;;
*)
    echo "run.sh: unknown way '$way'" >&2
    exit 2
    ;;
esac
