#!/bin/sh
# readme_shows_first_program.sh README PROGRAM: is the README's C++ block the program, line by line?
# SPDX-License-Identifier: MIT
set -eu
awk '/^```cpp/ { inside = 1; next } /^```/ { inside = 0 } inside' "$1" | diff - "$2"
