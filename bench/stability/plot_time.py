#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The softsim authors
# SPDX-License-Identifier: MIT
"""Draws the tables of the programs about time steps. Needs matplotlib and numpy.

Usage: plot_time.py [folder], default out/stability. A picture is a function of the name of its table, which takes
the rows (a list of dictionaries, numbers as float) and returns a figure.
"""
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

# distinct for every kind of colour vision (Okabe & Ito 2008)
BLUE, ORANGE, GREEN, RED, PURPLE, SKY = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9"
COLOURS = [BLUE, ORANGE, GREEN, RED, PURPLE, SKY, "black", "0.5"]

plt.rcParams.update({
    "figure.dpi": 130, "figure.constrained_layout.use": True, "font.size": 10, "axes.titlesize": 10,
    "axes.grid": True, "grid.alpha": 0.3, "legend.frameon": False, "legend.fontsize": 8,
    "axes.spines.top": False, "axes.spines.right": False,
})

PICTURES = {}


def picture(function):
    """Makes a function draw the table of its name."""
    PICTURES[function.__name__] = function
    return function


def number(text):
    """Text, or the number that it stands for."""
    try:
        return float(text)
    except ValueError:
        return text


def distinct(rows, key):
    """Values of a column in order of appearance."""
    return list(dict.fromkeys(r[key] for r in rows))


def pick(rows, **columns):
    """Rows that have the given values."""
    return [r for r in rows if all(r[k] == v for k, v in columns.items())]


@picture
def regions(rows):
    """Where an oscillator does not grow: simulated (filled) and predicted (line)."""
    methods = distinct(rows, "method")
    figure, panels = plt.subplots(3, 7, figsize=(15, 7), squeeze=False)
    for axes, method in zip(panels.flat, methods):
        of = pick(rows, method=method, kind="pair")
        x, y = sorted({r["re"] for r in of}), sorted({r["im"] for r in of})
        i, j = {v: k for k, v in enumerate(x)}, {v: k for k, v in enumerate(y)}
        grids = {name: np.full((len(y), len(x)), np.nan) for name in ("predicted", "measured")}
        for r in of:
            for name, grid in grids.items():
                grid[j[r["im"]], i[r["re"]]] = r[name]
        for grid in grids.values():
            grid[j[0.0], i[min(x, key=abs)]] = 1  # nothing happens in a step of no length
        # the border itself counts as stable; rounding must not decide
        axes.contourf(x, y, grids["measured"], [0, 1 + 1e-9], colors=[SKY], alpha=0.6)
        axes.contour(x, y, grids["predicted"], [0.25, 0.5, 0.75], colors="0.4", linewidths=0.5)
        if np.nanmax(grids["predicted"]) > 1 + 1e-9:
            axes.contour(x, y, grids["predicted"], [1 + 1e-9], colors=[RED], linewidths=1.3)
        axes.axvline(0, color="black", lw=0.6)
        axes.set(title=method, xlim=(x[0], max(x[-1], 0.04 * -x[0])), ylim=(0, y[-1]), aspect="equal")
    for axes in panels[-1]:
        axes.set_xlabel("Re z")
    for axes in panels[:, 0]:
        axes.set_ylabel("Im z")
    figure.suptitle("No growth in a step: simulated (blue) and predicted border (red); thin: growth 1/4, 1/2, 3/4",
                    fontsize=11)
    return figure


@picture
def table62(rows):
    """Predicted growth of the rows of Table 6.2, what was printed, and what became of the simulations."""
    rows = pick(rows, matched="eigenvalue")
    models = [(m, g) for m in distinct(rows, "model") for g in distinct(rows, "gravity")]
    first = pick(rows, model=models[0][0], gravity=models[0][1])
    figure, (top, below) = plt.subplots(2, 1, figsize=(11, 5.4), sharex=True, height_ratios=(3, 2))
    places = range(len(first))
    top.axhline(1, color="black", lw=0.8)
    for name, marker, label in (("growth_slow", "_", "slow root"), ("growth_fast", "_", "fast root")):
        top.plot(places, [r[name] for r in first], marker, ms=12, mew=2,
                 color=BLUE if name == "growth_slow" else ORANGE, label=f"predicted, {label}")
    top.plot(places, [r["printed"] for r in first], "x", color="black", ms=6, label="printed in the thesis")
    top.set(ylabel="growth in a step", title="d'Aulignac 2001, Table 6.2: explicit Euler at 280 Hz")
    top.legend(ncols=3)
    seen = [("thesis", [r["thesis_stable"] for r in first])]
    for model, g in models:
        of = pick(rows, model=model, gravity=g)
        if len(of) == len(first):
            weight = "full weight" if g > 1 else "tiny load"
            seen.append((f"{model.replace('_', ' ')}, {weight}", [r["simulated_stable"] for r in of]))
    for k, (_, stable) in enumerate(seen):
        for x, s in zip(places, stable):
            below.plot(x, -k, "o" if s else "X", color=GREEN if s else RED, ms=7)
    below.set_yticks([-k for k in range(len(seen))], [name for name, _ in seen])
    below.set_ylim(-len(seen) + 0.4, 0.6)
    below.set_xticks(list(places), [f"{r['case']} {r['k_lin']:g}, {r['d']:g}" for r in first], rotation=90,
                     fontsize=7.5)
    below.set_xlabel("case, k (N/mm), d (N s/mm); green: settles, red: does not")
    return figure


@picture
def largest_step(rows):
    """Observed over predicted largest steps: small motions, and finite ones."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.2), width_ratios=(3, 2))
    small = [r for r in rows if r["amplitude"] < 1e-6]
    names = distinct(small, "integrator")
    for k, name in enumerate(names):
        of = pick(small, integrator=name)
        spread = np.linspace(-0.3, 0.3, max(len(of), 2))
        left.plot([k + s for s in spread[:len(of)]], [r["observed_over_predicted"] for r in of], ".", ms=6,
                  color=COLOURS[k])
    left.axhspan(0.9, 1.1, color="0.92")
    left.axhline(1, color="black", lw=0.8)
    left.set_xticks(range(len(names)), names, rotation=20, ha="right")
    left.set(ylim=(0.85, 1.15), ylabel="observed / predicted largest step",
             title="Small motions: all laws, meshes and dampings")
    finite = [r for r in rows if r["amplitude"] >= 1e-6 and r["integrator"] == "velocity Verlet"]
    for colour, law in zip(COLOURS, distinct(finite, "law")):
        of = pick(finite, law=law)
        right.plot([r["amplitude"] for r in of], [r["observed_over_predicted"] for r in of], "o-", ms=4, color=colour,
                   label=law.replace("_", " "))
    right.set(xlabel="random displacement of nodes, over cell size", ylim=(0, 1.1),
              title="Finite motions, velocity Verlet (0: below 0.5)")
    right.axhline(1, color="black", lw=0.8)
    right.legend()
    return figure


@picture
def step_sizes(rows):
    """Outcome and energy against the step; error against time."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(13, 5.6), width_ratios=(1, 1))
    methods = distinct([dict(r, key=(r["method"], r["kind"])) for r in rows], "key")
    marks = {"converged": ("s", GREEN), "not converged": ("^", ORANGE), "diverged": ("x", "black")}
    for y, (method, kind) in enumerate(methods):
        for r in pick(rows, method=method, kind=kind):
            marker, shade = marks[r["outcome"]]
            left.plot(r["step"], -y, marker, ms=6, color=shade)
    left.set_yticks([-y for y in range(len(methods))],
                    [m if k == "explicit" else f"{m}, {k}" for m, k in methods], fontsize=8)
    left.set(xscale="log", xlabel="step, s", title="Stiff bar: square converged, triangle some step not, cross diverged")
    styles = {"explicit": "-", "linearised": "--", "Newton": "-"}
    names = distinct(rows, "method")
    colour = {m: plt.cm.tab20(i / 20) for i, m in enumerate(names)}
    for method, kind in methods:
        of = [r for r in pick(rows, method=method, kind=kind) if r["outcome"] == "converged" and r["error"] < 1.5]
        if kind == "linearised" or not of:
            continue
        right.plot([r["seconds_to_error"] for r in of], [r["error"] for r in of], styles[kind],
                   marker="^" if kind == "explicit" else "o", ms=4, lw=1.2, color=colour[method], label=method)
    right.set(xscale="log", yscale="log", xlabel="time to 0.25 s of motion, s", ylabel="relative error at 0.25 s",
              title="Error against time (triangles explicit, circles Newton)")
    right.legend(fontsize=7, ncols=2)
    return figure


@picture
def drift(rows):
    """Energy and momenta of a free body over many steps."""
    figure, panels = plt.subplots(1, 2, figsize=(10, 4))
    for colour, method in zip(COLOURS, distinct(rows, "method")):
        of = pick(rows, method=method)
        n = [r["steps"] for r in of]
        panels[0].plot(n, [max(abs(r["energy"]), 1e-17) for r in of], color=colour, label=method)
        panels[1].plot(n, [max(r["momentum"], r["angular_momentum"], 1e-17) for r in of], color=colour)
    panels[0].set(ylabel="|energy / start - 1|")
    panels[1].set(ylabel="momenta off their start")
    for axes in panels:
        axes.set(xscale="log", yscale="log", xlabel="steps")
    panels[0].legend()
    return figure


if __name__ == "__main__":
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out/stability")
    for table in sorted(folder.glob("*.csv")):
        if table.stem not in PICTURES:
            continue
        with open(table, newline="") as file:
            content = [{k: number(v) for k, v in row.items()} for row in csv.DictReader(file)]
        drawn = PICTURES[table.stem](content)
        drawn.savefig(table.with_suffix(".png"))
        plt.close(drawn)
        print(table.with_suffix(".png"))
