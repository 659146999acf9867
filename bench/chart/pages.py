#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The softsim authors
# SPDX-License-Identifier: MIT
"""Makes the pages on the charts: copies the pictures, and puts what the charts say in figures beside the conclusions,
which people wrote (conclusions.md).

usage: pages.py CHARTS PAGES
CHARTS is a folder that chart wrote, PAGES the folder for README.md, SCENE.md and their pictures.
"""
import csv
import math
import pathlib
import re
import shutil
import statistics
import sys

import plot_chart

GROUPS = {  # that are compared at equal error
    "linear tetrahedra": ("tet4", "heml"),
    "ten-node tetrahedra": ("tet10",),
    "hexahedra": ("hex8",),
    "frames": ("frames_hex8", "frames_hex8_linked", "frames_tet4", "frames_tet4_linked", "frames_shepard", "frames_least_squares"),
}


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    for r in rows:
        for key in ("error", "seconds", "seconds_per_simulated_second", "setup_seconds", "resolution"):
            if key in r:
                r[key] = float(r[key]) if r[key] else math.nan
    return rows


def good(rows):
    """Those that solved the scene, and may be compared."""
    return [r for r in rows if r["status"] == "converged" and math.isfinite(r["error"]) and plot_chart.comparable(r)]


def reduced(row):
    return row["solver"].startswith(("modes", "warped_modes", "pod")) or row["integrator"].startswith("modal")


def cost(row):
    return row["seconds_per_simulated_second"] if math.isfinite(row["seconds_per_simulated_second"]) else row["seconds"]


def figure(x):
    return f"{x:.2g}" if 0.001 <= x < 10000 else f"{x:.1e}"


def method(row):
    words = [row["model"]] if row["integrator"] == "static" else [row["model"], f"{row['integrator']} (step {row['step']} s)"]
    words += [w for w in (row["solver"], row["preconditioner"]) if w != "-"]
    return ", ".join(words + [row["scalar"], f"resolution {int(row['resolution'])}"])


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + " --- |" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(map(str, r)) + " |" for r in rows]) + "\n"


class Scene:
    def __init__(self, folder, row, conclusion):
        self.folder, self.name, self.title, self.conclusion = folder, row["scene"], row["title"], conclusion
        self.floor, self.budget, name = float(row["reference_error"]), row["budget"], self.name
        self.rows = read(folder / f"{name}.csv")
        self.good = good(self.rows)
        for r in self.good:
            r["cost"] = cost(r)
        self.moves = any(r["integrator"] != "static" for r in self.rows)
        self.unknowns = {(r["model"], float(r["resolution"])): int(r["unknowns"]) for r in read(folder / f"{name}_unknowns.csv")}
        self.charts = [name] + sorted(p.stem for p in folder.glob(f"{name}_*.csv") if not p.stem.endswith("_unknowns"))

    def front(self):
        rows = [dict(r, seconds=r["cost"]) for r in self.good]
        return plot_chart.front(rows, self.floor)

    def families(self):
        found = []
        for r in self.front():
            if (label := plot_chart.family(r)[1]) not in found:
                found.append(label)
        return found

    def page(self):
        unit = "s per simulated second" if self.moves else "s"
        text = f"# {self.title}\n\n{self.conclusion}\n\n"
        text += "\n".join(f"![{c}]({c}.png)" for c in self.charts) + "\n\n"
        text += "The front of the first picture:\n\n"
        text += table((f"time, {unit}", "error", "set-up, s", "method"),
                      [(figure(r["cost"]), figure(r["error"]), figure(r["setup_seconds"]), method(r)) for r in self.front()])
        failed = len([r for r in self.rows if r["status"] != "converged"])
        text += f"\n{len(self.rows)} methods and meshes were measured, {failed} of them failed.\n\n"
        return text + f"    build/release/bench/chart/chart {self.name} --budget {self.budget} --out out/one\n"

    def exactness(self):
        """Linear small strain, corotational, exact by deformation gradients and by edge lengths, on the finest mesh that all
        were measured on, each by its fastest solver."""
        models = ("tet4_linear", "tet4_corotational", "tet4", "heml")
        best = {}
        for r in self.good:
            if r["scalar"] == "double" and r["model"] in models and not reduced(r):
                key = (r["resolution"], r["step"])
                rows = best.setdefault(key, {})
                if r["model"] not in rows or r["cost"] < rows[r["model"]]["cost"]:
                    rows[r["model"]] = r
        common = [key for key, rows in best.items() if len(rows) == len(models)]
        if not common:
            return None
        key = max(common, key=lambda k: (k[0], -float(k[1] or 0)))
        rows = best[key]
        return [self.link(), int(key[0])] + [f"{figure(rows[m]['error'])} in {rows[m]['cost'] / rows['tet4']['cost']:.2f}"
                                             for m in models]

    def at_equal_error(self, target):
        """Least time and fewest unknowns that each group needs for an error."""
        result = {}
        for group, models in GROUPS.items():
            rows = [r for r in self.good if r["model"] in models and r["error"] <= target and not reduced(r)]
            if rows:
                result[group] = (min(r["cost"] for r in rows), min(self.unknowns[(r["model"], r["resolution"])] for r in rows))
        return result

    def link(self):
        return f"[{self.name}]({self.name}.md)"


def single_precision(scenes):
    times, worse, pairs = [], 0, 0
    for scene in scenes:
        by = {}
        for r in scene.good:
            key = tuple(r[k] for k in ("model", "integrator", "solver", "preconditioner", "step", "resolution"))
            by.setdefault(key, {})[r["scalar"]] = r
        for pair in by.values():
            if len(pair) == 2:
                pairs += 1
                times.append(pair["double"]["cost"] / pair["float"]["cost"])
                worse += pair["float"]["error"] > 1.1 * pair["double"]["error"] + 1e-3
    if len(times) < 2:
        return "No two methods were measured in both precisions.\n"
    quarter = statistics.quantiles(times, n=4)
    return (f"Of {pairs} methods and meshes that were measured in both, single precision takes {quarter[1]:.2f} times less time "
            f"(median; quartiles {quarter[0]:.2f} and {quarter[2]:.2f}), and is less accurate by more than a tenth and 1e-3 in {worse}. "
            "It ends where its forces round, at 1e-4 of them, double precision at 1e-7 (of motions 1e-6): a part of the gain is that.\n")


def overview(scenes, machine, claims):
    text = "# Speed against accuracy\n\n"
    text += f"{machine}\n\n    cmake --build build/release --target charts\n\n"
    text += "makes everything here again, but for the words (`bench/chart/conclusions.md`). How it is measured, and how a scene or " \
            "a method joins in, is told in [bench/chart](../../bench/chart/README.md).\n\n"
    text += table(("scene", "families on the front, from the fastest to the most accurate"),
                  [(s.link(), ", ".join(s.families())) for s in scenes])
    text += "\n## What exactness costs\n\nError, and time over that of `tet4`, on the same mesh, each by its fastest solver (or integrator):\n\n"
    names = ("scene", "resolution", "small strain", "corotational", "`tet4`, from F", "`heml`, from edge lengths")
    text += table(names, [row for s in scenes if (row := s.exactness())])
    text += "\n## Frames and tetrahedra at equal error\n\nLeast time, s, and fewest unknowns for an error of at most so much:\n\n"
    rows = []
    for s in scenes:
        for target in (0.1, 0.03, 0.01):
            found = s.at_equal_error(target)
            if "frames" in found and len(found) > 1:
                rows.append([s.link(), target] + [f"{figure(found[g][0])}, {found[g][1]}" if g in found else "" for g in GROUPS])
    text += table(("scene", "error") + tuple(GROUPS), rows)
    text += "\n## Single precision\n\n" + single_precision(scenes)
    return text + "\n## What the sources say, and what is seen here\n\n" + claims + "\n"


def sections(path):
    """The sections of a file by their titles."""
    parts = re.split(r"^## (.*)$", path.read_text(), flags=re.M)
    return {title.strip(): body.strip() for title, body in zip(parts[1::2], parts[2::2])}


def main(charts, pages):
    here = pathlib.Path(__file__).parent
    texts = sections(here / "conclusions.md")
    pages.mkdir(parents=True, exist_ok=True)
    scenes = []
    with open(charts / "scenes.csv", newline="") as file:
        for row in csv.DictReader(file, delimiter=";"):
            if row["scene"] not in texts:
                sys.exit(f"pages: conclusions.md has no section '{row['scene']}'")
            scenes.append(Scene(charts, row, texts[row["scene"]]))
    for scene in scenes:
        (pages / f"{scene.name}.md").write_text(scene.page())
        for chart in scene.charts:
            shutil.copy(charts / f"{chart}.png", pages)
    (pages / "README.md").write_text(overview(scenes, (charts / "machine.txt").read_text().strip(), texts["Claims"]))
    print(pages / "README.md")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
