#!/bin/sh
# readme_shows_first_program.sh README PROGRAM: is the README's first C++ block the program, line by line?
# SPDX-License-Identifier: MIT
set -eu
awk '/^```cpp/ { inside = 1; next } inside && /^```/ { exit } inside' "$1" | diff - "$2"
