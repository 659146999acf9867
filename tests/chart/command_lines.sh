#!/bin/sh
# What chart and choose say to wrong questions, and how they end: one sentence, 2 for a wrong question, 1 where there is no
# answer. Arguments: the two programs, a folder to write into.
# SPDX-License-Identifier: MIT
set -u
chart=$1
choose=$2
folder=$3
rm -rf "$folder"
mkdir -p "$folder"
failed=0

# expect STATUS TEXT COMMAND...: the command ends so, and says the text
expect() {
    status=$1
    text=$2
    shift 2
    said=$("$@" 2>&1)
    got=$?
    if [ "$got" -ne "$status" ] || ! printf '%s' "$said" | grep -qF -e "$text"; then
        printf '%s\n  ended with %s instead of %s, or did not say "%s":\n%s\n' "$*" "$got" "$status" "$text" "$said"
        failed=1
    fi
}
# errors are one sentence, on one line
expect_sentence() {
    expect "$@"
    if [ "$(printf '%s\n' "$said" | grep -c '^ch[a-z]*: ')" -ne 1 ] || [ "$(printf '%s\n' "$said" | wc -l)" -gt 2 ]; then
        printf 'more than a sentence:\n%s\n' "$said"
        failed=1
    fi
}

expect 0 'usage: chart' "$chart" --help
expect 0 'usage: choose' "$choose" --help
expect 0 'pulled_cube' "$chart" --list
expect_sentence 2 'no scene; chart --list names them' "$chart"
expect_sentence 2 "no scene 'cook'" "$chart" cook
expect_sentence 2 "unknown option '--fast'" "$chart" organ --fast
expect_sentence 2 "--budget '-3': must be a positive number" "$chart" organ --budget -3
expect_sentence 2 '--budget: a value is missing' "$chart" organ --budget
expect_sentence 1 'no.msh' "$chart" organ --mesh no.msh
expect_sentence 2 "--only 'tet4': no such method" "$chart" compressed_block --only tet4
expect_sentence 1 'is missing; chart --reference twisted_bar makes it' "$chart" twisted_bar --data "$folder" --out "$folder/none"
: >"$folder/file"
expect_sentence 1 'cannot write' "$chart" compressed_block --out "$folder/file"

expect_sentence 2 '--tolerance and --rate are needed' "$choose" organ
expect_sentence 2 'name one scene' "$choose" all --tolerance 0.1 --rate 1
expect_sentence 2 "--quantity 'colour': organ does not ask for it" "$choose" organ --tolerance 0.1 --rate 1 --quantity colour
expect_sentence 2 "tighter than the reference's own error; the nearest that can be told is" \
    "$choose" organ --tolerance 1e-6 --rate 1
expect_sentence 1 'is missing; chart --reference' "$choose" twisted_bar --tolerance 0.1 --rate 1 --data "$folder"
expect_sentence 1 'no method reaches an error of 1e-06 at 1e+09 Hz; accurate enough is' \
    "$choose" compressed_block --tolerance 1e-6 --rate 1e9 --budget 5

expect 0 'measured again by: chart compressed_block --only ' "$choose" compressed_block --tolerance 0.01 --rate 25 --budget 20
method=$(printf '%s' "$said" | sed -n 's/.*--only //p')
expect 0 "$method,converged," "$chart" compressed_block --only "$method"
expect 0 'the front of the force' "$chart" compressed_block --resolutions 1 --budget 3 --no-picture --out "$folder/out"
for file in compressed_block compressed_block_force compressed_block_energy; do
    expect 0 'model,integrator,solver,preconditioner,step,resolution,scalar,status,error,seconds,seconds_per_simulated_second,memory,setup_seconds' \
        cat "$folder/out/$file.csv"
done
expect 0 'tet10,1,' cat "$folder/out/compressed_block_unknowns.csv"
exit $failed
