# Sourced by the other scripts: finds what this machine lacks and installs it from Debian's archive.
# SPDX-License-Identifier: MIT

# has_package NAME: is there a CMake package configuration file NAMEConfig.cmake where CMake looks first?
has_package() {
    for prefix in $(printf '%s' "${CMAKE_PREFIX_PATH:-}" | tr ':;' '  ') /usr/local /usr; do
        for file in "$prefix"/share/cmake/"$1"/"$1"Config.cmake "$prefix"/share/"$2"/cmake/"$1"Config.cmake \
                    "$prefix"/lib*/cmake/"$1"/"$1"Config.cmake "$prefix"/lib/*/cmake/"$1"/"$1"Config.cmake; do
            if [ -f "$file" ]; then return 0; fi
        done
    done
    return 1
}

# has_matplotlib PYTHON: can it draw? (find_spec, because importing takes a second)
has_matplotlib() {
    "$1" -c 'import importlib.util as u, sys; sys.exit(u.find_spec("matplotlib") is None)' 2>/dev/null
}

# lacks NAME: is NAME (a Debian package) needed here? Asks for the thing itself, not for the package: a compiler from
# elsewhere will do.
lacks() {
    case $1 in
    g++) ! command -v "${CXX:-c++}" >/dev/null ;;
    cmake | make | pkg-config) ! command -v "$1" >/dev/null ;;
    libeigen3-dev) ! has_package Eigen3 eigen3 ;;
    libgtest-dev) ! has_package GTest gtest ;;
    libbenchmark-dev) ! has_package benchmark benchmark ;;
    python3-matplotlib) ! has_matplotlib python3 && ! has_matplotlib /usr/bin/python3 ;;
    libspectra-dev) [ ! -f /usr/include/Spectra/SymGEigsShiftSolver.h ] ;;
    libnanoflann-dev) [ ! -f /usr/include/nanoflann.hpp ] ;;
    libsuitesparse-dev) [ ! -f /usr/include/suitesparse/cholmod.h ] ;;
    clang) ! command -v clang++ >/dev/null ;;
    libclang-rt-14-dev) # the sanitizers of clang
        ! command -v clang++ >/dev/null || [ ! -d "$(clang++ -print-resource-dir)/lib/linux" ] ;;
    esac
}

# prerequisites PACKAGE...: returns when all are there; otherwise says in one sentence what is missing and exits with 2.
prerequisites() {
    missing=
    for package; do
        if lacks "$package"; then missing="$missing $package"; fi
    done
    if [ -z "$missing" ]; then return 0; fi
    if ! command -v apt-get >/dev/null; then
        echo "softsim: this system lacks what Debian calls$missing; install it with your own package manager." >&2
        exit 2
    fi
    as_root=
    if [ "$(id -u)" -ne 0 ]; then
        if ! command -v sudo >/dev/null; then
            echo "softsim: please have root install the packages$missing." >&2
            exit 2
        fi
        as_root=sudo
    fi
    echo "softsim: installing$missing"
    # shellcheck disable=SC2086  # words are wanted
    if ! $as_root apt-get update -q ||
        ! $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $missing; then
        echo "softsim: apt-get could not install$missing." >&2
        exit 2
    fi
}

# processors: how many compilers may run at once
processors() {
    nproc 2>/dev/null || echo 2
}
