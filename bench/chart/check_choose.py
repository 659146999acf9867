#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The softsim authors
# SPDX-License-Identifier: MIT
"""Asks choose for every scene, and measures each answer again by a run of chart on its own: how often does it meet the
tolerance and the rate, and how long did choose take?

usage: check_choose.py FOLDER [TOLERANCE:RATE]...
FOLDER holds the programs; wishes are 0.05:25, 0.05:1 and 0.02:5 unless given. Exit status 1 if, of the scenes that choose
had an answer for, less than nine tenths are met for some wish.
"""
import csv
import io
import pathlib
import re
import subprocess
import sys
import time


def run(*words):
    return subprocess.run(list(map(str, words)), capture_output=True, text=True)


def scenes(folder):
    listed = run(folder / "chart", "--list").stdout.split("\nmodels")[0].splitlines()[1:]
    return [line.split()[0] for line in listed]


def meets(row, tolerance, rate):
    if row["status"] != "converged" or not float(row["error"]) <= tolerance:
        return False
    if row["seconds_per_simulated_second"]:
        return float(row["seconds_per_simulated_second"]) <= 1 and float(row["step"]) * rate <= 1 + 1e-9
    return float(row["seconds"]) * rate <= 1


def main(folder, wishes):
    enough = True
    for wish in wishes:
        tolerance, rate = map(float, wish.split(":"))
        met = asked = 0
        slowest = 0.0
        for scene in scenes(folder):
            begin = time.monotonic()
            answer = run(folder / "choose", scene, "--tolerance", tolerance, "--rate", rate)
            took = time.monotonic() - begin
            slowest = max(slowest, took)
            found = re.search(r"measured again by: chart (\S+) --only (\S+)", answer.stdout)
            if not found:
                print(f"{scene}, {tolerance:g} at {rate:g} Hz: {took:.0f} s: {answer.stderr.strip()}", flush=True)
                continue
            again = run(folder / "chart", scene, "--only", found[2])
            row = next(csv.DictReader(io.StringIO(again.stdout)))
            good = meets(row, tolerance, rate)
            asked += 1
            met += good
            print(f"{scene}, {tolerance:g} at {rate:g} Hz: {took:.0f} s: {found[2]}: error {row['error']}, "
                  f"{row['seconds_per_simulated_second'] or row['seconds']} s: {'met' if good else 'MISSED'}", flush=True)
        print(f"{tolerance:g} at {rate:g} Hz: {met} of {asked} answers met when measured again; the slowest took {slowest:.0f} s")
        enough = enough and met >= 0.9 * asked
    sys.exit(0 if enough else 1)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]), sys.argv[2:] or ["0.05:25", "0.05:1", "0.02:5"])
