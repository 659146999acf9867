#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The softsim authors
# SPDX-License-Identifier: MIT
"""Draws what atlas_solvers and atlas_statics wrote: plot_solvers.py [folder], default out/stability."""
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

# distinct for every kind of colour vision (Okabe & Ito 2008)
COLOURS = ["#000000", "#E69F00", "#56B4E9", "#009E73", "#0072B2", "#D55E00", "#CC79A7", "#999999"]
MARKERS = "os^vDP*x"

plt.rcParams.update({
    "figure.dpi": 130, "figure.constrained_layout.use": True, "font.size": 10, "axes.grid": True, "grid.alpha": 0.3,
    "legend.frameon": False, "legend.fontsize": 8.5, "axes.spines.top": False, "axes.spines.right": False,
})


def table(folder, name):
    """Rows of a table, or none if it was not written."""
    path = folder / (name + ".csv")
    if not path.exists():
        return []
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def solvers(folder):
    """Time and iterations of one linear solve against the number of unknowns."""
    rows = table(folder, "solvers")
    if not rows:
        return
    names = list(dict.fromkeys(r["solver"] for r in rows))
    figure, axes = plt.subplots(2, 2, figsize=(10, 7.5), sharex=True)
    for column, problem in enumerate(["static", "dynamic"]):
        for k, name in enumerate(names):
            mine = [r for r in rows if r["solver"] == name and r["problem"] == problem]
            if not mine:
                continue
            n = [float(r["unknowns"]) for r in mine]
            style = {"color": COLOURS[k % 8], "marker": MARKERS[k % 8], "markersize": 4, "label": name}
            axes[0][column].loglog(n, [float(r["setup_ms"]) + float(r["solve_ms"]) for r in mine], **style)
            if name != "LDLT":
                axes[1][column].loglog(n, [float(r["iterations"]) for r in mine], **style)
        mine = [r for r in rows if r["solver"] == "CG multigrid" and r["problem"] == problem]
        if mine:
            n = [float(r["unknowns"]) for r in mine]
            first = float(mine[0]["setup_ms"]) + float(mine[0]["solve_ms"])
            axes[0][column].loglog(n, [first * (x / n[0]) ** 1.1 for x in n], color="0.5", lw=0.8, ls=":",
                                   label="n^1.1")
        axes[0][column].set_title(f"{problem}: " + ("stiffness alone" if problem == "static" else "backward Euler, 10 ms"))
        axes[1][column].set_xlabel("unknowns")
    axes[0][0].set_ylabel("set-up and solve to 1e-6, ms, one core")
    axes[1][0].set_ylabel("iterations")
    axes[0][1].legend(loc="upper left")
    figure.savefig(folder / "solvers.png")


def inner_iterations(folder):
    """Time to equilibrium of full and modified Newton against the inner iterations (d'Aulignac's tables 6.3, 6.4)."""
    rows = [r for r in table(folder, "inner_iterations") if r["converged"] == "1"]
    if not rows:
        return
    figure, axes = plt.subplots(1, 2, figsize=(10, 4))
    for k, inner in enumerate(dict.fromkeys(r["inner"] for r in rows)):
        for tangent, line in (("full", "-"), ("modified", "--")):
            mine = [r for r in rows if r["inner"] == inner and r["tangent"] == tangent]
            style = {"color": COLOURS[k + 3], "linestyle": line, "marker": MARKERS[k], "markersize": 4,
                     "label": f"{tangent} Newton, {inner}"}
            n = [float(r["inner_iterations"]) for r in mine]
            axes[0].loglog(n, [float(r["ms"]) for r in mine], **style)
            axes[1].loglog(n, [float(r["newton"]) for r in mine], **style)
    axes[0].set_ylabel("time to equilibrium, ms")
    axes[1].set_ylabel("Newton iterations")
    for axis in axes:
        axis.set_xlabel("inner iterations of a linear solve")
    axes[1].legend()
    figure.savefig(folder / "inner_iterations.png")


if __name__ == "__main__":
    where = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out/stability")
    solvers(where)
    inner_iterations(where)
