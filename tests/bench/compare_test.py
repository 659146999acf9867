#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The softsim authors
# SPDX-License-Identifier: MIT
"""bench/compare.py on made-up results, and on a program that prints what Google Benchmark prints."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

COMPARE = pathlib.Path(__file__).resolve().parents[2] / "bench" / "compare.py"
FORCE = "force/svk/f/double/20250"
KERNEL = "force/svk/reference/double/20250"
NEO_HOOKEAN = "force/neo_hookean/reference/double/20250"

# A machine that drifts: every process of it runs at one of two speeds. Arguments: times in us by name, speeds in turns,
# and what its processes are counted in.
PROGRAM = '''#!{python}
import json, pathlib, re, sys
times, speeds, unit, count = {times!r}, {speeds!r}, {unit!r}, pathlib.Path({count!r})
options = dict(a.partition("=")[::2] for a in sys.argv[1:])
if "--benchmark_list_tests" in options:
    print("\\n".join(times))
    sys.exit()
k = len(count.read_text()) if count.exists() else 0
count.write_text("." * (k + 1))
with open({log!r}, "a") as log:
    log.write({who!r} + " " + options["--benchmark_filter"] + "\\n")
runs = []
for name, us in times.items():
    if re.search(options["--benchmark_filter"], name):
        scale = 1 if unit == "us" or name.startswith("force") else 1e-3
        for i in range(int(options["--benchmark_repetitions"])):
            noise = 3 if i % 4 and "/reference/" not in name else 1  # neighbours leave little time
            runs.append(dict(name=name, run_name=name, run_type="iteration", real_time=0,
                             cpu_time=us * speeds[k % len(speeds)] * noise * scale, time_unit="us" if scale == 1 else unit))
        for what in ("mean", "median", "stddev"):
            runs.append(dict(name=f"{{name}}_{{what}}", run_name=name, run_type="aggregate", cpu_time=1e-9, time_unit="us"))
{extra}
print(json.dumps(dict(context=dict(num_cpus=2, mhz_per_cpu=1, compiler="GNU 1", flags="-O3"), benchmarks=runs)))
'''


class Compare(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def compare(self, *arguments):
        return subprocess.run([sys.executable, "-B", str(COMPARE), *map(str, arguments)], capture_output=True,
                              text=True, check=False)

    def assert_refused(self, done, words):
        """Exit code 2 and one sentence that has these words."""
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertIn(words, done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)


class Check(Compare):
    def result(self, file, reference=KERNEL, machine="M", flags="-O3", **ratios):
        path = self.folder / file
        benchmarks = [{"name": n, "reference": reference, "ratios": r} for n, r in ratios.items()]
        path.write_text(json.dumps({"machine": machine, "compiler": "C", "flags": flags, "benchmarks": benchmarks}))
        return path

    def check(self, old, new, *more):
        """Checks two lists of ratios of one benchmark."""
        return self.compare("check", self.result("old.json", a=old), self.result("new.json", a=new), *more)

    NINE = [0.396, 0.397, 0.398, 0.399, 0.400, 0.401, 0.402, 0.403, 0.404]

    def test_eleven_percent_slower_is_reported(self):
        done = self.check(self.NINE, [1.11 * r for r in self.NINE])
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stdout, r"\+11\.0 %  SLOWER\n")
        self.assertIn("slower by more than 10 %: 1 of 1 benchmarks", done.stdout)

    def test_nine_percent_slower_is_not(self):
        done = self.check(self.NINE, [1.09 * r for r in self.NINE])
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stdout, r"\+9\.0 %\n")
        self.assertEqual(self.check(self.NINE, [1.09 * r for r in self.NINE], "--limit", "0.08").returncode, 1)

    def test_one_outlier_of_nine_does_not_matter(self):
        self.assertEqual(self.check(self.NINE, [4.0] + self.NINE[1:]).returncode, 0)
        self.assertEqual(self.check([0.01] + self.NINE[1:], self.NINE).returncode, 0)

    def test_four_slow_ratios_of_nine_do_not_matter_and_five_do(self):
        slow = [1.5 * r for r in self.NINE]
        self.assertEqual(self.check(self.NINE, self.NINE[:5] + slow[5:]).returncode, 0)
        self.assertEqual(self.check(self.NINE, self.NINE[:4] + slow[4:]).returncode, 1)

    def test_faster_is_not_reported(self):
        done = self.check(self.NINE, [0.5 * r for r in self.NINE])
        self.assertEqual(done.returncode, 0)
        self.assertNotIn("SLOWER", done.stdout)
        self.assertIn("-50.0 %", done.stdout)

    def test_spread_is_printed_and_an_overlap_said(self):
        done = self.check([0.1, 0.2, 0.4, 0.5, 0.6], [0.1, 0.3, 0.5, 0.7, 0.9])
        self.assertEqual(done.returncode, 1)
        self.assertIn(" 0.4000 (0.2000-0.5000)", done.stdout)
        self.assertIn(" 0.5000 (0.3000-0.7000)", done.stdout)
        self.assertIn("quartiles overlap", done.stdout)

    def test_table_is_sorted_and_names_what_is_in_one_file_only(self):
        old = self.result("old.json", a=self.NINE, b=self.NINE, c=self.NINE, gone=self.NINE)
        new = self.result("new.json", a=self.NINE, b=[1.05 * r for r in self.NINE], c=[0.9 * r for r in self.NINE],
                          added=self.NINE)
        done = self.compare("check", old, new)
        self.assertEqual(done.returncode, 0)
        self.assertEqual([line[0] for line in done.stdout.splitlines()[1:4]], ["b", "a", "c"])
        self.assertIn(f"only in {old}: gone\n", done.stdout)
        self.assertIn(f"only in {new}: added\n", done.stdout)

    def test_fewer_than_five_ratios_are_refused(self):
        self.assertEqual(self.check(self.NINE, self.NINE[:5]).returncode, 0)
        self.assert_refused(self.check(self.NINE, self.NINE[:4]), "has 4 ratios of a, 5 are needed")

    def test_bad_input_is_refused(self):
        good, bad = self.result("good.json", a=self.NINE), self.folder / "bad.json"
        self.assert_refused(self.compare("check", good, self.folder / "none.json"), "cannot be read")
        for text, words in (('{"benchmarks": [', "is not JSON"), ("[1, 2]", "is not a result"),
                            ('{"benchmarks": [{"name": "a"}]}', "is not a result"), ("\0\xff", "is not JSON")):
            bad.write_text(text, encoding="latin-1")
            self.assert_refused(self.compare("check", good, bad), words)
        self.assert_refused(self.check(self.NINE, [0.0] * 9), "a ratio of a that is none")
        self.assert_refused(self.check(self.NINE, [float("nan")] * 9), "a ratio of a that is none")

    def test_no_common_benchmark_is_refused(self):
        self.assert_refused(self.compare("check", self.result("old.json", a=self.NINE),
                                         self.result("new.json", b=self.NINE)), "no benchmark in common")

    def test_another_reference_is_refused(self):
        self.assert_refused(self.compare("check", self.result("old.json", a=self.NINE),
                                         self.result("new.json", reference=NEO_HOOKEAN, a=self.NINE)), NEO_HOOKEAN)

    def test_another_machine_or_other_flags_are_a_warning(self):
        old = self.result("old.json", a=self.NINE)
        for key, other in (("machine", "N"), ("flags", "-O2")):
            done = self.compare("check", old, self.result("new.json", a=self.NINE, **{key: other}))
            self.assertEqual(done.returncode, 0)
            self.assertRegex(done.stderr, rf"^compare.py: warning: the {key} differs: .*{other}\n$")
        self.assertEqual(self.compare("check", old, old).stderr, "")


class Run(Compare):
    def program(self, times, speeds=(1,), unit="us", extra="", who="A"):
        path = self.folder / who
        path.write_text(PROGRAM.format(python=sys.executable, times=times, speeds=speeds, unit=unit, extra=extra, who=who,
                                       count=str(path) + ".count", log=str(self.folder / "log")))
        path.chmod(0o755)
        return path

    def ratios(self, file):
        return {b["name"]: b for b in json.loads((self.folder / file).read_text())["benchmarks"]}

    def run_one(self, program, *more):
        return self.compare("run", program, "--out", self.folder / "r.json", "--filter", ".", *more)

    def test_drift_between_processes_does_not_change_the_ratios(self):
        program = self.program({FORCE: 10, KERNEL: 40, NEO_HOOKEAN: 50}, speeds=(1, 2, 1.3))
        done = self.run_one(program)
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads((self.folder / "r.json").read_text())
        self.assertEqual((result["compiler"], result["flags"], result["num_cpus"]), ("GNU 1", "-O3", 2))
        self.assertIn("family", result["machine"])
        row = self.ratios("r.json")
        self.assertEqual(list(row), [FORCE])  # the reference kernel is no benchmark of its own
        self.assertEqual(row[FORCE]["reference"], KERNEL)
        self.assertEqual(len(row[FORCE]["ratios"]), 15)
        for ratio in row[FORCE]["ratios"] + [row[FORCE]["median"]] + row[FORCE]["quartiles"]:
            self.assertAlmostEqual(ratio, 0.25, 12)

    def test_reference_is_the_nearest_kernel_and_units_are_heeded(self):
        times = {"frames/step/assembled/4/72/400/cg_50": 500, "apply/ogden/f/double/20250": 5,
                 "step/svk/f/float/4374": 5, NEO_HOOKEAN: 50, KERNEL: 40,
                 "force/neo_hookean/reference/float/4374": 10}
        self.assertEqual(self.run_one(self.program(times, unit="ms")).returncode, 0)
        row = self.ratios("r.json")
        self.assertEqual({n: (b["reference"], round(b["median"], 9)) for n, b in row.items()},
                         {"frames/step/assembled/4/72/400/cg_50": (NEO_HOOKEAN, 10),
                          "apply/ogden/f/double/20250": (NEO_HOOKEAN, 0.1),
                          "step/svk/f/float/4374": ("force/neo_hookean/reference/float/4374", 0.5)})

    def test_two_programs_run_in_turns(self):
        a = self.program({FORCE: 10, "x": 1, KERNEL: 40, NEO_HOOKEAN: 50}, who="A")
        b = self.program({FORCE: 12, "y": 1, KERNEL: 40, NEO_HOOKEAN: 50}, who="B")
        old, new = self.folder / "a.json", self.folder / "b.json"
        done = self.compare("run", a, b, "--out", old, new, "--filter", "^(force|x|y)", "--rounds", 5)
        self.assertEqual(done.returncode, 0, done.stderr)
        log = (self.folder / "log").read_text().splitlines()
        turns = [f"A ^({FORCE}|{KERNEL})$", f"B ^({FORCE}|{KERNEL})$", f"A ^(x|{NEO_HOOKEAN})$", f"B ^(y|{NEO_HOOKEAN})$"]
        self.assertEqual(log, 5 * turns)
        done = self.compare("check", old, new)
        self.assertEqual(done.returncode, 1)
        self.assertIn("+20.0 %", done.stdout)
        self.assertEqual(self.compare("check", new, old).returncode, 0)

    def test_what_cannot_be_measured_is_refused(self):
        good = self.program({FORCE: 10, KERNEL: 40})
        self.assert_refused(self.run_one(good, "--rounds", 4), "4 rounds are too few")
        self.assert_refused(self.run_one(good, "--filter", "["), "no regular expression")
        self.assert_refused(self.run_one(good, "--filter", "none"), "has no benchmark none")
        self.assert_refused(self.compare("run", good, good, "--out", self.folder / "r.json"), "2 programs and 1 names")
        self.assert_refused(self.run_one(self.folder / "none"), "does not run")
        self.assert_refused(self.run_one(self.program({FORCE: 10})), "no reference kernel")

    def test_what_a_program_says_is_passed_on(self):
        times = {FORCE: 10, KERNEL: 40}
        for extra, words in (("runs[0].update(error_occurred=True, error_message='is wrong')", "says: is wrong"),
                             ("sys.exit('no memory')", "exit code 1: no memory"),
                             ("runs = []", "did not print times"), ("print('{')", "did not print times")):
            done = self.run_one(self.program(times, extra=extra))
            self.assertEqual(done.returncode, 2)
            self.assertIn(words, done.stderr)


if __name__ == "__main__":
    unittest.main()
