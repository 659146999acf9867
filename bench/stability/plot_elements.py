#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The softsim authors
# SPDX-License-Identifier: MIT
"""Draws the tables of stability_elements as pictures next to them. Needs matplotlib.

Usage: plot_elements.py [folder], default out/stability.
"""
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

# distinct for every kind of colour vision (Okabe & Ito 2008)
BLUE, ORANGE, GREEN, RED, PURPLE, SKY = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9"
GREY = "#9a9a9a"

plt.rcParams.update({
    "figure.dpi": 130, "figure.constrained_layout.use": True, "font.size": 9.5, "axes.titlesize": 10.5,
    "axes.grid": True, "grid.alpha": 0.3, "legend.frameon": False, "legend.fontsize": 8.5,
    "axes.spines.top": False, "axes.spines.right": False,
})

TABLES = {}


def table(function):
    """Makes a function draw the table elements_<its name>."""
    TABLES["elements_" + function.__name__] = function
    return function


def number(text):
    """Text, or the number that it stands for."""
    try:
        return float(text)
    except ValueError:
        return text


def pick(rows, **columns):
    """Rows that have the given values."""
    return [r for r in rows if all(r[k] == v for k, v in columns.items())]


def matrix(axes, names, columns, cell):
    """Coloured cells with a text each; cell(name, column) gives (colour, text) or None."""
    for y, name in enumerate(names):
        for x, column in enumerate(columns):
            found = cell(name, column)
            if found is None:
                continue
            colour, text = found
            axes.add_patch(plt.Rectangle((x + 0.03, y + 0.06), 0.94, 0.88, color=colour, lw=0))
            axes.text(x + 0.5, y + 0.5, text, ha="center", va="center", fontsize=7.5)
    axes.set(xlim=(0, len(columns)), ylim=(len(names), 0))
    axes.set_yticks([y + 0.5 for y in range(len(names))], names)
    axes.grid(False)
    axes.tick_params(length=0)
    for side in axes.spines.values():
        side.set_visible(False)


def outcome(row):
    """Colour and text of one cell of the recovery table."""
    if row["recovered"] == row["runs"]:
        return "#8fd0b8", f"{row['newton_median']:.0f}"
    kinds = {"elsewhere": ("#f3c38a", "other"), "inside_out": ("#f2a490", "inverted"),
             "saddle": ("#d9b3e6", "saddle"),
             "not_converged": ("#c9c9c9", "no conv."), "not_finite": ("#e8e8e8", "refused")}
    worst = max(kinds, key=lambda k: row[k])
    colour, text = kinds[worst]
    if row["runs"] > 1 and row["recovered"] > 0:
        text = f"{100 * row['recovered'] / row['runs']:.0f} %"
    return colour, text


@table
def recovery(rows):
    """Every law from every start."""
    at = [r for r in rows if r["nu"] == 0.3 and not r["guided"] and r["body"] == "cube"]
    starts = ["random", "plane", "line", "point", "scaled", "reflected", "inflated"]
    columns = [("nodes", s, 0) for s in starts] + \
              [("components", s, n) for s in starts[1:] for n in ([0, 1e-6] if s in ("line", "point") else [0])]
    names, found = [], {}
    for r in at:
        name = r["law"] if r["discretisation"] == "elastic" else f"{r['law']}, {r['discretisation']}"
        if name not in names:
            names.append(name)
        # the table over Poisson's ratio repeats some cells with fewer seeds
        found.setdefault((name, r["support"], r["start"], r["noise"]), r)
    figure, axes = plt.subplots(figsize=(11, 0.27 * len(names) + 1.9))

    def cell(name, column):
        row = found.get((name, *column))
        return None if row is None else outcome(row)

    matrix(axes, names, columns, cell)
    labels = [s + (" 1e-6" if n > 0 else "") for _, s, n in columns]
    axes.set_xticks([x + 0.5 for x in range(len(columns))], labels, rotation=40, ha="left")
    axes.xaxis.tick_top()
    axes.axvline(len(starts), color="black", lw=1)
    axes.text(len(starts) / 2, len(names) + 0.8, "three nodes held", ha="center")
    axes.text((len(starts) + len(columns)) / 2, len(names) + 0.8, "six components held", ha="center")
    axes.set_title("Back to rest from tangled, flat and inverted starts. Green: always, with the median number of "
                   "Newton iterations.\nOrange: another equilibrium, red: one with inverted elements, which the status says. Purple: a saddle, which the"
                   " status says.\nGrey: not converged, or refused as not finite.",
                   loc="left", fontsize=9.5)
    return figure


@table
def poisson(rows):
    """Share of random starts that come back over Poisson's ratio."""
    figure, panels = plt.subplots(1, 2, figsize=(10, 4), sharey=True)
    laws = [("stable NH", BLUE, "o"), ("continued NH", RED, "s"), ("continued NH 0.9", ORANGE, "D"),
            ("corotational", GREEN, "^"), ("warped stiffness", PURPLE, "v"), ("neo-Hookean", GREY, "x")]
    nus = sorted({r["nu"] for r in rows})
    for axes, guided, title in zip(panels, (0, 1), ("As it is", "After a corotational solve, ν ≤ 0.3")):
        for i, (law, colour, marker) in enumerate(laws):
            of = {r["nu"]: r for r in pick(rows, law=law, guided=guided, discretisation="elastic", start="random",
                                           body="cube")}
            x = [nus.index(nu) + 0.05 * (i - 2.5) for nu in sorted(of)]
            axes.plot(x, [100 * of[nu]["recovered"] / of[nu]["runs"] for nu in sorted(of)], marker + "-", color=colour, lw=1.1,
                      ms=5, label=law)
        axes.set_xticks(range(len(nus)), [f"{nu:g}" for nu in nus])
        axes.set(title=title, xlabel="Poisson's ratio", ylim=(-5, 105))
    panels[0].set_ylabel("random starts back at rest, %")
    panels[1].legend(loc="lower left")
    return figure


@table
def slivers(rows):
    """Iterations, answer and forces over the smallest dihedral angle."""
    figure, panels = plt.subplots(1, 3, figsize=(11, 3.6))
    for route, colour, marker in (("elastic", BLUE, "o"), ("heml", RED, "x")):
        of = pick(rows, route=route)
        x = [r["degrees"] for r in of]
        for axes, what in zip(panels, ("linear", "force_error", "answer_change")):
            # the good mesh is its own reference
            axes.loglog(x, [r[what] if r[what] > 1e-6 or what != "answer_change" else float("nan") for r in of],
                        marker + "-", color=colour, mfc="none", label=route + "()")
    titles = ("Conjugate gradients, whole solve", "Force error, relative", "Answer against the good mesh, relative")
    for axes, title in zip(panels, titles):
        axes.set(title=title, xlabel="smallest dihedral angle, degrees")
        axes.invert_xaxis()
    panels[0].set_ylim(100, None)
    panels[1].legend()
    panels[2].set_ylim(1e-3, 1e-1)
    return figure


@table
def contrast(rows):
    """Iterations over stiffness ratio and Poisson's ratio."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4))
    for where, label, colour in (("below", "stiff below", BLUE), ("above", "stiff above", RED),
                                 ("inclusion", "stiff inclusion", GREEN)):
        of = pick(rows, what="stiffness ratio", where=where)
        left.loglog([r["value"] for r in of], [r["linear"] for r in of], "o-", color=colour, label=label + ", CG")
        left.loglog([r["value"] for r in of], [r["newton"] for r in of], "o:", color=colour, mfc="none",
                    label=label + ", Newton")
    of = pick(rows, what="Poisson's ratio")
    nus = sorted({r["value"] for r in of})
    styles = {"stable NH linear": (BLUE, "o"), "neo-Hookean linear": (RED, "s"),
              "stable NH nodal volume": (SKY, "D"), "neo-Hookean nodal volume": (ORANGE, "^")}
    for where, (colour, marker) in styles.items():
        some = pick(of, where=where)
        x = [nus.index(r["value"]) for r in some]
        right.semilogy(x, [r["linear"] for r in some], marker + "-", color=colour, label=where + ", CG")
        right.semilogy(x, [r["newton"] for r in some], marker + ":", color=colour, mfc="none")
        for i, r in zip(x, some):
            if not r["converged"]:
                right.plot(i, r["linear"], "x", color="black", ms=9)
    right.set_xticks(range(len(nus)), [f"{nu:g}" for nu in nus])
    left.set(title="Two stiffnesses in a loaded cube", xlabel="ratio of Young's moduli", ylabel="iterations of a solve")
    right.set(title="One material (dotted: Newton; ×: not converged)", xlabel="Poisson's ratio")
    left.legend(ncols=1)
    right.legend()
    return figure


@table
def extremes(rows):
    """Twist, stretch and compression of a bar."""
    names = list(dict.fromkeys(r["law"] for r in rows))
    columns = list(dict.fromkeys((r["kind"], r["steps"]) for r in rows))
    found = {(r["law"], r["kind"], r["steps"]): r for r in rows}
    figure, axes = plt.subplots(figsize=(12.5, 0.27 * len(names) + 1.7))

    def cell(name, column):
        r = found.get((name, *column))
        if r is None:
            return None
        reached = f"{r['reached_degrees']:.0f}°" if "turn" in column[0] else f"×{r['reached_stretch']:.2g}"
        if r["arrived"] and r["back"] and r["rest"] < 1e-6:
            return ("#8fd0b8", reached) if r["inverted"] == 0 else ("#d3e59b", f"{r['inverted']:.0f} inv.")
        if r["arrived"]:
            return "#f3c38a", "not back"
        return "#c9c9c9", f"to {reached}"

    matrix(axes, names, columns, cell)
    targets = {"one turn": "360°", "two turns": "720°", "stretch": "×10", "compression": "×0.05"}
    axes.set_xticks([x + 0.5 for x in range(len(columns))],
                    [f"{targets[kind]}\nin {steps:.0f}" for kind, steps in columns])
    axes.xaxis.tick_top()
    axes.set_title("Bar 1 x 1 x 4 with bonded ends: there and back. Green: yes; yellow: with inverted elements on the "
                   "way;\norange: back in another equilibrium; grey: how far it got.", loc="left", fontsize=9.5)
    return figure


if __name__ == "__main__":
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out/stability")
    read = {}
    for path in sorted(folder.glob("elements_*.csv")):
        with open(path, newline="") as file:
            read[path.stem] = [{k: number(v) for k, v in row.items()} for row in csv.DictReader(file)]
    if len(sys.argv) > 2 or not read:
        sys.exit(f"plot_elements: no table elements_*.csv in '{folder}'; usage: plot_elements.py [folder]")
    if "elements_recovery" in read:
        read["elements_poisson"] = read["elements_recovery"]
    for name, rows in read.items():
        if name not in TABLES:
            continue
        figure = TABLES[name](rows)
        figure.savefig(folder / f"{name}.png")
        plt.close(figure)
        print(folder / f"{name}.png")
