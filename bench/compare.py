#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The softsim authors
# SPDX-License-Identifier: MIT
"""Tell a slowdown of the benchmarks from the noise of a shared machine.

    compare.py run PROGRAM... --out RESULT...   measures, several programs (say, of two commits) in turns
    compare.py check OLD NEW                    compares two results

Absolute times drift by tens of percent while neighbours come and go. So what is kept is the ratio to a reference
kernel, the plain loop of reference.hpp, that ran in the same process within the same second. Every ratio has a process
of its own that runs nothing but these two, in short repetitions in random order
(--benchmark_enable_random_interleaving), and takes the least time of each: neighbours can only slow things down, and not
alike, since vector code loses more to one on the same core than a plain loop does. All benchmarks interleaved in one
process would put minutes between the two times of a ratio, and Google Benchmark does not tell the order in which it ran
them; all benchmarks one after the other would put seconds between them. A round takes one ratio of every benchmark and
program: a disturbance of some seconds then falls on one ratio of a benchmark, which its median does not feel. Nor does
it feel where one process happened to have its memory.

Exit codes: 0; 1: slower by more than the limit in the median; 2: the input is not usable.
"""
import argparse
import datetime
import json
import math
import re
import statistics
import subprocess
import sys

LEAST_RATIOS = 5
NANOSECONDS = {"ns": 1, "us": 1e3, "ms": 1e6, "s": 1e9}
HEADLINES = "|".join((
    "^force/(svk|neo_hookean|stable_neo_hookean|mooney_rivlin)/(f|heml)/double/20250$",
    "^force/(neo_hookean/f/float|corotational/f/double|mass_spring/spring/double)/20250$",
    "^(hessian_product|assemble)/neo_hookean/(f|heml)/double/20250$",
    "^apply/neo_hookean/assembled/double/20250$",
    "^step/neo_hookean/[a-z_]*/double/4374$",
    "^frames/step/[a-z_]*/4/72/400/cg_50$"))


class BadInput(Exception):
    """One sentence for the user."""


def output_of(program, *options):
    try:
        done = subprocess.run([program, *options], capture_output=True, text=True, check=False)
    except OSError as error:
        raise BadInput(f"{program} does not run: {error.strerror}") from error
    if done.returncode != 0:
        last = (done.stderr.strip().splitlines() or ["without a word"])[-1]
        raise BadInput(f"{program} ended with exit code {done.returncode}: {last}")
    return done.stdout


def reference_of(name, names):
    """The plain kernel of the same law, scalar and size; where there is none, of Neo-Hookean; for names without law,
    scalar and size (frames) and for sizes without a kernel, the one in double at 20,250 tetrahedra."""
    _, law, _, scalar, size = name.split("/") if name.count("/") == 4 else [""] * 5
    for wanted in ((law, scalar, size), ("neo_hookean", scalar, size), ("neo_hookean", "double", "20250")):
        reference = "force/{}/reference/{}/{}".format(*wanted)
        if reference in names:
            return reference
    raise BadInput(f"there is no reference kernel for {name}")


def measure(program, name, reference, repetitions, min_time):
    """One ratio, and what Google Benchmark says about the machine and the build."""
    both = "|".join(re.sub(r"([^\w/:-])", r"\\\1", n) for n in (name, reference))
    text = output_of(program, f"--benchmark_filter=^({both})$", f"--benchmark_repetitions={repetitions}",
                     f"--benchmark_min_time={min_time}", "--benchmark_enable_random_interleaving=true",
                     "--benchmark_format=json")
    times = {name: [], reference: []}
    try:
        result = json.loads(text)
        for run in result["benchmarks"]:
            if run.get("error_occurred") or run.get("skipped"):
                raise BadInput(f"{run['name']} says: {run.get('error_message') or run.get('skip_message')}")
            if run.get("run_type") == "iteration":
                times[run["run_name"]].append(run["cpu_time"] * NANOSECONDS[run["time_unit"]])
        return min(times[name]) / min(times[reference]), result["context"]
    except (ValueError, KeyError, TypeError, ZeroDivisionError) as error:
        raise BadInput(f"{program} did not print times of {name} and {reference} in Google Benchmark's JSON") from error


def processor():
    """Virtual machines often give a name that is no more than the maker's."""
    fields = {}
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            for line in lines:
                key, _, value = line.partition(":")
                fields.setdefault(key.strip(), value.strip())
    except OSError:
        pass
    return "{}, family {}, model {}".format(*(fields.get(k, "?") for k in ("model name", "cpu family", "model")))


def run(args):
    if len(args.out) != len(args.program):
        raise BadInput(f"there are {len(args.program)} programs and {len(args.out)} names for results")
    if args.rounds < LEAST_RATIOS:
        raise BadInput(f"{args.rounds} rounds are too few, {LEAST_RATIOS} are needed")
    try:
        wanted = re.compile(args.filter)
    except re.error as error:
        raise BadInput(f"{args.filter} is no regular expression: {error}") from error
    references, contexts = [], {}
    for program in args.program:
        names = output_of(program, "--benchmark_list_tests=true").split()
        chosen = [n for n in names if wanted.search(n) and "/reference/" not in n]
        if not chosen:
            raise BadInput(f"{program} has no benchmark {args.filter}")
        references.append({n: reference_of(n, names) for n in chosen})
    ratios = [{n: [] for n in r} for r in references]
    for k in range(args.rounds):
        print(f"round {k + 1} of {args.rounds}", file=sys.stderr)
        for name in dict.fromkeys(n for r in references for n in r):
            for p, program in enumerate(args.program):
                if name in references[p]:
                    ratio, contexts[p] = measure(program, name, references[p][name], args.repetitions, args.min_time)
                    ratios[p][name].append(ratio)
    for p, path in enumerate(args.out):
        result = {"date": datetime.datetime.now().astimezone().isoformat(timespec="seconds"),
                  "machine": processor(),
                  **{key: contexts[p].get(key) for key in ("num_cpus", "mhz_per_cpu", "compiler", "flags")},
                  "benchmarks": []}
        for name, r in ratios[p].items():
            low, median, high = quartiles(r)
            result["benchmarks"].append({"name": name, "reference": references[p][name], "median": median,
                                         "quartiles": [low, high], "ratios": r})
        try:
            with open(path, "w", encoding="utf-8") as file:
                json.dump(result, file, indent=1)
                file.write("\n")
        except OSError as error:
            raise BadInput(f"{path} cannot be written: {error.strerror}") from error
    return 0


def quartiles(ratios):
    return statistics.quantiles(ratios, n=4, method="inclusive")


def read(path):
    """The result in a file, and its benchmarks by name."""
    try:
        with open(path, encoding="utf-8") as file:
            result = json.load(file)
    except OSError as error:
        raise BadInput(f"{path} cannot be read: {error.strerror}") from error
    except ValueError as error:
        raise BadInput(f"{path} is not JSON: {error}") from error
    try:
        benchmarks = {b["name"]: (b["reference"], [float(r) for r in b["ratios"]]) for b in result["benchmarks"]}
    except (KeyError, TypeError, ValueError) as error:
        raise BadInput(f"{path} is not a result of compare.py run") from error
    for name, (_, ratios) in benchmarks.items():
        if len(ratios) < LEAST_RATIOS:
            raise BadInput(f"{path} has {len(ratios)} ratios of {name}, {LEAST_RATIOS} are needed")
        if not all(0 < r < math.inf for r in ratios):
            raise BadInput(f"{path} has a ratio of {name} that is none")
    return result, benchmarks


def check(args):
    (old_result, old), (new_result, new) = read(args.old), read(args.new)
    common = [n for n in old if n in new]
    if not common:
        raise BadInput(f"{args.old} and {args.new} have no benchmark in common")
    for n in common:
        if old[n][0] != new[n][0]:
            raise BadInput(f"the ratios of {n} are to {old[n][0]} in {args.old}, to {new[n][0]} in {args.new}")
    for key in ("machine", "compiler", "flags"):
        if old_result.get(key) != new_result.get(key):
            print(f"compare.py: warning: the {key} differs: {old_result.get(key)} / {new_result.get(key)}",
                  file=sys.stderr)

    rows = []
    for n in common:
        a, b = quartiles(old[n][1]), quartiles(new[n][1])
        rows.append((b[1] / a[1] - 1, n, a, b))
    rows.sort(reverse=True)
    width = max(len(n) for n in common)
    print(f"{'ratio to the reference: median (quartiles)':{width}}  {'old':24}  {'new':24}  change")
    slower = 0
    for change, n, a, b in rows:
        spread = "{1:7.4f} ({0:.4f}-{2:.4f})"
        verdict = ""
        if change > args.limit:
            slower += 1
            # the rule is the median's: on a noisier machine no slowdown shall be let through
            verdict = "  SLOWER" if b[0] > a[2] else "  SLOWER, but the quartiles overlap: measure again"
        print(f"{n:{width}}  {spread.format(*a):24}  {spread.format(*b):24}  {100 * change:+5.1f} %{verdict}")
    for path, others in ((args.old, old.keys() - new.keys()), (args.new, new.keys() - old.keys())):
        for n in sorted(others):
            print(f"only in {path}: {n}")
    print(f"slower by more than {100 * args.limit:g} %: {slower} of {len(common)} benchmarks")
    return 1 if slower else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    one = commands.add_parser("run", help="measure")
    one.add_argument("program", nargs="+", help="program of Google Benchmark")
    one.add_argument("--out", nargs="+", required=True, help="JSON file for each program")
    one.add_argument("--filter", default=HEADLINES, help="regular expression of names (default: the headline ones)")
    one.add_argument("--rounds", type=int, default=15, help="ratios of each benchmark (default 15)")
    one.add_argument("--repetitions", type=int, default=12, help="times of which a ratio takes the least (default 12)")
    one.add_argument("--min-time", type=float, default=0.01, help="least duration of a time, s (default 0.01)")
    one.set_defaults(function=run)
    two = commands.add_parser("check", help="compare two results")
    two.add_argument("old")
    two.add_argument("new")
    two.add_argument("--limit", type=float, default=0.10, help="allowed slowdown (default 0.10)")
    two.set_defaults(function=check)
    args = parser.parse_args()
    try:
        return args.function(args)
    except BadInput as error:
        print(f"compare.py: {error}.", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
