#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The softsim authors
# SPDX-License-Identifier: MIT
"""Draws FOLDER/CHART.png of each FOLDER/CHART.csv that chart wrote: error against time to solution, or against time per
simulated second.

usage: plot_chart.py FOLDER (CHART TITLE ERROR REFERENCE)...
REFERENCE is the own error of the reference: below it nothing can be told.
"""
import csv
import pathlib
import sys

# Okabe & Ito's colours, by what the name of a solver (of those that reduce a model) or of a model begins with; the first
# that fits.
REDUCED = [("modes", "modes", "#666666", "1"), ("warped_modes", "warped modes", "#666666", "2"), ("pod", "POD", "#666666", "p")]
PEERS = [("calculix", "CalculiX", "#000000", "$C$"), ("getfem", "GetFEM", "#000000", "$G$"), ("bullet", "Bullet", "#000000", "$B$")]
FAMILIES = PEERS + [("springs", "springs", "#999999", "x"), ("mass_tensor", "mass tensors", "#F0E442", "P"),
                    ("heml", "HEML", "#E69F00", "D"), ("tet4_corotational", "corotational", "#56B4E9", "v"),
                    ("hex8_corotational", "corotational", "#56B4E9", "v"),
                    ("tet4_nodal_volume", "averaged volumes", "#CC79A7", "h"), ("tet4_linear", "small strain", "#000000", "+"),
                    ("tet4", "tetrahedra", "#0072B2", "o"), ("tet10", "ten-node tetrahedra", "#D55E00", "^"),
                    ("hex8", "hexahedra", "#009E73", "s"), ("frames", "frames", "#8B1A1A", "*"), ("", "others", "#666666", ".")]


def family(row):
    for f in REDUCED:
        if row["solver"].startswith(f[0]) or row["integrator"].startswith("modal"):
            return f
    return next(f for f in FAMILIES if row["model"].startswith(f[0]))


def name(row, moves):
    """What is written beside a point."""
    reduced = row["solver"] if any(row["solver"].startswith(f[0]) for f in REDUCED) else ""
    return row["integrator"] if moves else row["model"] + (", " + reduced if reduced else "")


def comparable(row):
    """Not those that have seen the load before, or have another law than the scene."""
    return row["solver"] != "pod" and not row["model"].endswith("_own_law")


def front(rows, floor):
    """Those that no other is both faster and (by more than 2 %) more accurate than, by time; below the floor, the own error
    of the reference, all are as good."""
    best, result = float("inf"), []
    for r in sorted((r for r in rows if comparable(r)), key=lambda r: (r["seconds"], r["error"])):
        error = max(r["error"], floor)
        if error < 0.98 * best:
            best = error
            result.append(r)
    return result


def draw(folder, scene, title, error, floor):
    import matplotlib  # not at the top: pages.py needs the rest only

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    with open(folder / f"{scene}.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    moves = any(r["seconds_per_simulated_second"] for r in rows)
    for r in rows:
        if moves:
            r["seconds"] = r["seconds_per_simulated_second"]
        for key in ("error", "seconds"):
            r[key] = float(r[key]) if r[key] else float("nan")
    good = [r for r in rows if r["status"] == "converged" and r["error"] < 10]
    failed = [r for r in rows if r["status"] != "converged" or r["error"] >= 10]  # and what ended ten times as far off as the answer is large
    if not good:
        print(f"plot_chart: no method solved {scene}", file=sys.stderr)
        return
    best = front(good, floor)
    figure, axes = plt.subplots(figsize=(9, 5.6), layout="constrained")
    labels = {}
    for r in good:
        _, label, colour, marker = family(r)
        on_front = r in best
        mark = axes.scatter(r["seconds"], max(r["error"], 1e-10), s=44 if on_front else 18, marker=marker, color=colour,
                            alpha=1 if on_front else 0.3, linewidths=1, zorder=3 if on_front else 2,
                            edgecolors="none" if marker not in "x+12" and not on_front else None)
        if on_front or label not in labels:
            labels[label] = mark
    axes.step([r["seconds"] for r in best], [max(r["error"], 1e-10) for r in best], where="post", color="0.35", lw=0.9,
              zorder=1)
    axes.set(xscale="log", yscale="log", xlabel="time per simulated second, one core (s)" if moves else "time to solution, one core (s)",
             ylabel=error)
    top = max(1.0, max(r["error"] for r in good)) * 3
    for r in failed:
        _, label, colour, marker = family(r)
        axes.scatter(r["seconds"], top, marker=marker, color=colour, alpha=0.5, s=18, clip_on=False)
    if failed:
        axes.annotate(f"failed: {len(failed)}", (0.99, top), xycoords=("axes fraction", "data"), ha="right", va="bottom",
                      fontsize=8)
    axes.set_ylim(top=top * 2)
    if floor > axes.get_ylim()[0]:
        axes.axhspan(axes.get_ylim()[0], floor, color="0.93", lw=0, zorder=0)
        axes.annotate("own error of the reference", (0.99, floor), xycoords=("axes fraction", "data"), ha="right", va="top",
                      fontsize=7, color="0.4")
    for seconds, text in ((1, "real time"),) if moves else ((1e-3, "1 kHz"), (0.04, "25 Hz")):
        axes.axvline(seconds, color="0.6", lw=0.8, ls=":")
        axes.annotate(text, (seconds, 0.01), xycoords=("data", "axes fraction"), fontsize=8, rotation=90, ha="right",
                      va="bottom", color="0.4")
    shown = {}
    for r in best:  # the name of every model (and integrator) where it is first on the front
        words = name(r, moves)
        if words not in shown:
            shown[words] = True
            axes.annotate(words, (r["seconds"], max(r["error"], 1e-10)), textcoords="offset points", xytext=(5, 4),
                          fontsize=7.5)
    axes.legend(labels.values(), labels.keys(), fontsize=8, loc="upper left", bbox_to_anchor=(1.005, 1), frameon=False)
    axes.grid(alpha=0.25)
    axes.set_title(title, fontsize=11)
    figure.savefig(folder / f"{scene}.png", dpi=130)
    plt.close(figure)
    print(folder / f"{scene}.png")


if __name__ == "__main__":
    words = sys.argv[2:]
    if not words or len(words) % 4:
        sys.exit(__doc__)
    for k in range(0, len(words), 4):
        draw(pathlib.Path(sys.argv[1]), *words[k:k + 3], float(words[k + 3]))
