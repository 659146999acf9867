#!/bin/sh
# Compares the time to compile <softsim/softsim.hpp> with that of <Eigen/Dense> and <Eigen/Sparse> alone, on g++ and
# clang++: parsing only, and a full -O2 compilation; the least of three alternating runs. Exits with 1 if softsim costs more
# than 2.5 times as much anywhere. Arguments: the compilers to ask (default: g++ clang++).
# SPDX-License-Identifier: MIT
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
limit=2.5
[ $# -gt 0 ] || set -- g++ clang++

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
printf '#include <Eigen/Dense>\n#include <Eigen/Sparse>\n' >"$folder/eigen.cpp"
printf '#include <softsim/softsim.hpp>\n' >"$folder/softsim.cpp"
eigen_flags=$(pkg-config --cflags eigen3 2>/dev/null || echo -I/usr/include/eigen3)

# seconds COMMAND...: wall-clock time of the command
seconds() {
    start=$(date +%s.%N)
    "$@"
    end=$(date +%s.%N)
    echo "$end $start" | awk '{printf "%.3f\n", $1 - $2}'
}
least() { sort -n "$1" | sed -n 1p; }  # what a shared machine disturbs the least

failed=0
printf '%-10s %-14s %9s %9s %7s\n' compiler mode 'Eigen/s' 'softsim/s' ratio
for compiler; do
    for mode in -fsyntax-only '-O2 -c'; do
        rm -f "$folder"/*.times
        for _ in 1 2 3; do
            for source in eigen softsim; do
                # shellcheck disable=SC2086  # flags are words
                seconds "$compiler" -std=c++20 $mode $eigen_flags -I"$root/include" "$folder/$source.cpp" \
                    -o "$folder/object" >>"$folder/$source.times"
            done
        done
        eigen=$(least "$folder/eigen.times")
        softsim=$(least "$folder/softsim.times")
        printf '%-10s %-14s %9s %9s %7s\n' "$compiler" "$mode" "$eigen" "$softsim" \
            "$(echo "$softsim $eigen" | awk '{printf "%.2f", $1 / $2}')"
        echo "$softsim $eigen $limit" | awk '{exit $1 > $3 * $2}' || failed=1
    done
done
if [ $failed -ne 0 ]; then echo "softsim costs more than $limit times Eigen"; fi
exit $failed
