#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The softsim authors
# SPDX-License-Identifier: MIT
"""Draws <name>.png next to every <name>.csv of a study that it knows. Needs matplotlib.

Usage: plot_studies.py [folder], default out/studies. A study is a function of its name, which takes the rows
of its table (a list of dictionaries, numbers as float) and returns a figure; add it above the last block.
"""
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

# distinct for every kind of colour vision (Okabe & Ito 2008)
BLUE, ORANGE, GREEN, RED, PURPLE, SKY = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9"

plt.rcParams.update({
    "figure.dpi": 130, "figure.constrained_layout.use": True, "font.size": 10, "axes.titlesize": 10.5,
    "axes.grid": True, "grid.alpha": 0.3, "legend.frameon": False, "legend.fontsize": 8.5,
    "axes.spines.top": False, "axes.spines.right": False,
})

STUDIES = {}


def study(function):
    """Makes a function draw the table of its name."""
    STUDIES[function.__name__] = function
    return function


def pick(rows, **columns):
    """Rows that have the given values."""
    return [r for r in rows if all(r[k] == v for k, v in columns.items())]


def column(rows, name):
    """One column of the rows."""
    return [r[name] for r in rows]


def number(text):
    """Text, or the number that it stands for."""
    try:
        return float(text)
    except ValueError:
        return text


@study
def uniaxial(rows):
    """Like Fig. 6 of Goulette & Chen 2015, and the lateral stretch."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.4), width_ratios=(3, 2))
    laws = [("st_venant_kirchhoff", "St. Venant-Kirchhoff", BLUE), ("neo_hookean", "Neo-Hookean", RED),
            ("mooney_rivlin", "Mooney-Rivlin", GREEN)]
    for law, label, colour in laws:
        for route, marker, face, size in (("elastic", "o", "none", 6), ("heml", "x", colour, 4)):
            of = sorted(pick(rows, law=law, route=route), key=lambda r: r["stretch"])
            if route == "elastic":
                left.plot(column(of, "stretch"), column(of, "closed_form"), color=colour, lw=1.4, label=label)
            shown = [r for r in of if abs(r["stretch"] * 20 - round(r["stretch"] * 20)) < 1e-6]
            for axes, what in ((left, "force"), (right, "lateral")):
                axes.plot(column(shown, "stretch"), column(shown, what), marker, mfc=face, color=colour,
                          ms=size, mew=0.9)
            if route == "elastic":
                right.plot(column(of, "stretch"), column(of, "lateral"), color=colour, lw=0.8)
    left.plot([], [], "o", mfc="none", color="black", ms=6, label="elastic()")
    left.plot([], [], "x", color="black", ms=4, label="heml()")
    left.axvline(3**-0.5, color="grey", lw=0.9, ls=":")
    left.annotate("$1/\\sqrt{3}$: St. Venant-Kirchhoff\nsoftens to the left", (3**-0.5, 8.2), (6, 0),
                  color="0.3", textcoords="offset points", fontsize=8.5, va="center")
    worst = max(column(rows, "relative_error"))
    left.set(xlabel="stretch", ylabel="force on 1 m² (N)",
             title=f"Curves: closed form. Points: computed, relative error at most {worst:.0e}")
    left.legend(loc="lower right")
    right.set(xlabel="stretch", ylabel="lateral stretch", title="Free sides, ν = 0.3, E = 10 Pa")
    return figure


@study
def prony_steps(rows):
    """Largest error over one second against the step, log-log."""
    figure, panels = plt.subplots(1, 3, figsize=(11.5, 4.2), sharex=True, sharey=True)
    titles = {"relaxation": "Relaxation at a held stretch", "creep": "Creep under a held load",
              "cycle": "One cycle of stretching"}
    for axes, (load, title) in zip(panels, titles.items()):
        for update, colour in (("first_order", RED), ("exponential", BLUE)):
            for history, marker, size, line in (("nodes", "o", 7, "-"), ("elements", "x", 5, "--")):
                of = sorted(pick(rows, load=load, update=update, history=history), key=lambda r: r["step"])
                if of:
                    axes.loglog(column(of, "step"), column(of, "largest_error"), marker + line, color=colour,
                                mfc="none", ms=size, lw=1.1)
        for update, order in (("first_order", 1), ("exponential", 2)):
            y = pick(rows, load=load, update=update, history="nodes", step=0.02)[0]["largest_error"] / 3
            if y > 1e-10:
                axes.loglog([2e-3, 2e-2], [y * 0.1**order, y], color="grey", lw=0.9, ls=":")
                axes.annotate(f"slope {order}", (2e-2, y), (3, -4), color="0.3",
                              textcoords="offset points", fontsize=8.5)
        axes.set(title=title, xlabel="step (s)")
    panels[0].annotate("exact but for rounding", (0.01, 3e-14), fontsize=8.5, color=BLUE, ha="center")
    panels[0].set(ylabel="largest relative error over 1 s")
    for label, style in (("first order (Goulette & Chen, Eq. 20)", {"color": RED}),
                         ("exponential", {"color": BLUE}),
                         ("history at nodes", {"color": "black", "marker": "o", "mfc": "none", "ms": 7}),
                         ("history in elements", {"color": "black", "marker": "x", "ms": 5, "ls": "--"})):
        panels[1].plot([], [], label=label, **{"lw": 1.1, **style})
    panels[1].legend(loc="lower left", bbox_to_anchor=(0.0, 0.02))
    return figure


@study
def near_incompressible(rows):
    """Answers over the reference against Poisson's ratio."""
    figure, panels = plt.subplots(1, 2, figsize=(10, 4.2))
    titles = {"cook": "Cook's membrane: displacement", "block": "Bonded block: force"}
    nus = sorted({r["nu"] for r in rows})
    for axes, (problem, title) in zip(panels, titles.items()):
        meshes = sorted({r["tetrahedra"] for r in pick(rows, problem=problem)})
        for method, label, colour in (("linear", "linear", RED), ("nodal_volume", "nodal volumes", BLUE)):
            for i, count in enumerate(meshes):
                of = pick(rows, problem=problem, method=method, tetrahedra=count)
                axes.plot([nus.index(r["nu"]) for r in of], column(of, "ratio"), "osD"[i] + "-", color=colour,
                          alpha=(0.4, 0.7, 1)[3 - len(meshes) + i], lw=1.2, ms=4,
                          label=f"{label}, {count:,.0f} tetrahedra")
        axes.axhline(1, color="black", lw=0.8)
        axes.set_xticks(range(len(nus)), [f"{nu:g}" for nu in nus])
        axes.set(title=title, xlabel="Poisson's ratio", ylabel="answer over mixed reference")
    panels[1].set_yscale("log")
    ticks = [1, 1.5, 2, 3, 5, 10]
    panels[1].set_yticks(ticks, [f"{t:g}" for t in ticks])
    panels[1].minorticks_off()
    panels[0].legend(loc="lower left")
    panels[1].legend(loc="upper left")
    return figure


@study
def organ_force_history(rows):
    """Like Fig. 8 of Goulette & Chen 2015: three nodes' motion, and how far two force routes are apart."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2))
    mesh = rows[0]["mesh"]
    for node, colour in zip(sorted({r["node"] for r in rows if r["mesh"] == mesh}), (BLUE, ORANGE, GREEN)):
        of = pick(rows, mesh=mesh, node=node)
        left.plot(column(of, "time"), [1e3 * d for d in column(of, "displacement")], color=colour,
                  label=f"node {node:.0f}")
        right.plot(column(of, "time"), [max(r["difference"], 1e-20) / max(r["displacement"], 1e-20) for r in of],
                   color=colour)
    left.set(title=f"Displacement, {mesh}", xlabel="time, s", ylabel="mm")
    left.legend()
    right.set(title="Edge lengths beside deformation gradient", xlabel="time, s",
              ylabel="difference over displacement", yscale="log")
    return figure


@study
def frame_statics(rows):
    """Like Figs 4.12 and 4.13 of Bosman 2015: error of the tip against unknowns, frames beside elements."""
    figure, panels = plt.subplots(1, 3, figsize=(12.5, 4.4), sharey=True)
    titles = {"steel_across": "Steel beam: cells across", "steel_along": "Steel beam: cells along",
              "soft": "Soft beam, large deflection"}
    methods = [("frames_8_whole_halfway", "frames, 8 neighbours", BLUE, "o-"),
               ("frames_8_whole_gauss", "the same, Gauss points", BLUE, "o:"),
               ("frames_8_half_gauss", "the same, half arms", SKY, "s:"),
               ("frames_4_whole", "frames, 4 neighbours", GREEN, "^-"),
               ("hexahedra", "hexahedra", ORANGE, "D--"), ("tetrahedra", "tetrahedra", RED, "v--")]
    for axes, (problem, title) in zip(panels, titles.items()):
        for method, label, colour, style in methods:
            of = pick(rows, problem=problem, method=method, quantity="uz")
            axes.loglog(column(of, "unknowns"), [100 * abs(r["relative_error"]) for r in of], style, color=colour,
                        lw=1.2, ms=5, mfc="none", label=label)
        axes.set(title=title, xlabel="unknowns")
    panels[0].set(ylabel="error of the deflection (%)")
    panels[0].legend(loc="lower left")
    return figure


@study
def frame_sampling(rows):
    """Error of the samples alone against how many there are, frames on the nodes of one mesh."""
    figure, panels = plt.subplots(1, 2, figsize=(9.5, 4.2), sharey=True)
    methods = [("gauss", "Gauss points", BLUE, "o-"), ("equal", "equal shares, lattice in each element", GREEN, "s-"),
               ("scattered_voronoi", "scattered, Voronoi shares", ORANGE, "^--"),
               ("scattered_equal", "scattered, equal shares", RED, "v--")]
    for axes, mesh in zip(panels, ("hexahedra", "tetrahedra")):
        for method, label, colour, style in methods:
            of = pick(rows, mesh=mesh, method=method)
            axes.loglog(column(of, "samples_per_element"), [max(r["error"], 1e-8) for r in of], style, color=colour,
                        lw=1.2, ms=5, mfc="none", label=label)
        axes.set(title=f"Soft beam, frames on {mesh}", xlabel="samples per element")
    panels[0].set(ylabel="error of the deflection (below 1e-8: drawn there)")
    panels[0].legend(loc="lower right")
    return figure


@study
def frame_rods(rows):
    """Distance of the tip from its reference over the length, against the number of frames."""
    problems = {"elastica_tip_4": "Elastica, tip load α = 4", "elastica_uniform_10": "Elastica, uniform load β = 10",
                "bend_45_force_600": "45° bend, F = 600", "roll_up": "Roll-up to a circle"}
    methods = [("linear_1_section", "linear, one section a gap", BLUE, "o-"),
               ("linear_2_sections", "linear, two sections a gap", BLUE, "o:"),
               ("linked_1_section", "linked, one", GREEN, "s-"), ("linked_2_sections", "linked, two", GREEN, "s:"),
               ("shepard_4_sections", "Shepard, four", RED, "v--")]
    figure, panels = plt.subplots(1, 4, figsize=(13.5, 4), sharey=True)
    for axes, (problem, title) in zip(panels, problems.items()):
        for method, label, colour, style in methods:
            of = pick(rows, problem=problem, method=method)
            axes.loglog(column(of, "frames"), column(of, "error"), style, color=colour, lw=1.2, ms=5, mfc="none",
                        label=label)
        axes.set(title=title, xlabel="frames")
        axes.set_xticks([5, 9, 17, 33, 65], ["5", "9", "17", "33", "65"])
        axes.minorticks_off()
    panels[0].set(ylabel="distance of the tip over the length")
    panels[0].set(ylim=(2e-5, None))
    panels[0].legend(loc="lower left", fontsize=7.5)
    return figure


@study
def frame_dynamics(rows):
    """Worst errors so far of energy and angular momentum of a body that tumbles and swings."""
    figure, panels = plt.subplots(1, 2, figsize=(10.5, 4.2))
    colours = {"semi_explicit_euler": RED, "velocity_verlet": ORANGE, "implicit_midpoint": BLUE,
               "newmark": GREEN, "generalised_alpha": PURPLE}
    steps = sorted({r["dt_s"] for r in rows})
    for axes, what, title in ((panels[0], "energy_error", "Energy"),
                              (panels[1], "angular_momentum_error", "Angular momentum")):
        for name, colour in colours.items():
            for dt, line in zip(steps, ("-", "--", ":")):
                worst, of = [], pick(rows, integrator=name, dt_s=dt)
                for r in of:
                    worst.append(max(abs(r[what]), worst[-1] if worst else 0))
                axes.semilogy(column(of, "time_s"), worst, line, color=colour, lw=1.2,
                              label=name.replace("_", " ") if dt == steps[0] else None)
        axes.set(title=title, xlabel="time (s)", ylabel="worst relative error so far")
    for dt, line in zip(steps, ("-", "--", ":")):
        panels[0].plot([], [], line, color="black", label=f"step {1e3 * dt:g} ms")
    panels[0].legend(ncols=2, loc="lower right")
    return figure


@study
def frame_tables(rows):
    """Bosman's times beside ours, and how the cost grows with samples and neighbours."""
    figure, panels = plt.subplots(1, 3, figsize=(12.5, 4.2))
    left, middle, right = panels
    for table, colour, marker in (("4.3", BLUE, "o"), ("4.5", GREEN, "s"), ("4.6", PURPLE, "^")):
        of = [r for r in rows if str(r["table"]) in (table, str(float(table))) and r["thesis_ms"] > 0]
        best = {}
        for r in of:
            key = (r["frames"], r["samples"], r["neighbours"])
            best[key] = min((r["ms"], r["thesis_ms"]), best.get(key, (1e300, 0)))
        left.loglog([t for _, t in best.values()], [m for m, _ in best.values()], marker, color=colour, mfc="none",
                    label=f"Table {table}")
    limits = [min(left.get_xlim()[0], 5), max(left.get_xlim()[1], 5000)]
    for factor in (1, 10, 100):
        left.loglog(limits, [x / factor for x in limits], ":", color="grey", lw=0.9)
        left.annotate(f"{factor} times" if factor > 1 else "equal", (limits[0] * 1.3, limits[0] * 1.3 / factor),
                      fontsize=8.5, color="0.3", rotation=35)
    left.set(xlabel="thesis, processor of 2010 (ms)", ylabel="one core today (ms)",
             title="One implicit step, the faster route")
    left.legend(loc="lower right")
    for what, colour, style in (("assembled", BLUE, "o-"), ("matrix_free", RED, "s-")):
        of = sorted((r for r in rows if r["table"] == "samples" and r["what"] == what), key=lambda r: r["samples"])
        middle.loglog(column(of, "samples"), column(of, "ms"), style, color=colour, mfc="none",
                      label=what.replace("_", "-"))
    middle.set(xlabel="samples (1,000 frames, 4 neighbours)", ylabel="step of 60 iterations (ms)",
               title="Cost against samples")
    middle.legend(loc="upper left")
    for what, colour, style in (("force", BLUE, "o-"), ("product", RED, "s-")):
        of = sorted((r for r in rows if r["table"] == "neighbours" and r["what"] == what),
                    key=lambda r: r["neighbours"])
        right.plot(column(of, "neighbours"), [1e6 * r["ms"] / r["samples"] for r in of], style, color=colour,
                   mfc="none", label=what)
    right.set(xlabel="neighbours a sample", ylabel="ns a sample", title="Cost against neighbours",
              ylim=(0, None))
    right.legend(loc="upper left")
    return figure


if __name__ == "__main__":
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out/studies")
    tables = [t for t in sorted(folder.glob("*.csv")) if t.stem in STUDIES]
    if len(sys.argv) > 2 or not tables:
        sys.exit(f"plot_studies: no table of a study in '{folder}'; usage: plot_studies.py [folder]")
    for table in tables:
        with open(table, newline="") as file:
            rows = [{k: number(v) for k, v in row.items()} for row in csv.DictReader(file)]
        figure = STUDIES[table.stem](rows)
        figure.savefig(table.with_suffix(".png"))
        plt.close(figure)
        print(table.with_suffix(".png"))
