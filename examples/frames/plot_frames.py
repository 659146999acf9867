#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The softsim authors
# SPDX-License-Identifier: MIT
"""Draw what the example `frames` wrote: samples coloured by J, frames as triads of axes, rest shape pale.

Reads BODY_samples.pvd, BODY_frames.pvd and BODY.json of each body and writes DIR/EXAMPLE.png. Needs numpy and
matplotlib. Exit code 2: the input is not usable; 3: numpy or matplotlib is missing.
"""
import argparse
import json
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

try:
    import numpy as np
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt
    from matplotlib.collections import LineCollection
    from matplotlib.colors import LinearSegmentedColormap
    from matplotlib.lines import Line2D
except ImportError as error:
    print(f"plot_frames.py needs numpy and matplotlib, and one is missing: {error}.", file=sys.stderr)
    sys.exit(3)

AXES = ("axis_x", "axis_y", "axis_z")
AXIS_COLOURS = ("#c62828", "#2e7d32", "#1565c0")
PALE = "0.80"
DPI = 160


class BadInput(Exception):
    """One sentence for the user."""


def read_points(path):
    """All arrays of 8-byte numbers of a .vtu file as softsim writes it, by name."""
    head, tag, tail = path.read_bytes().partition(b"<AppendedData")
    data = tail.partition(b"_")[2]
    root = ElementTree.fromstring(head + b"</VTKFile>")
    order = ">" if root.get("byte_order") == "BigEndian" else "<"
    arrays = {}
    for node in root.iter("DataArray"):
        if node.get("type") != "Float64":
            continue
        offset, components = int(node.attrib["offset"]), int(node.attrib["NumberOfComponents"])
        size = int(np.frombuffer(data, order + "u8", 1, offset)[0])
        values = np.frombuffer(data, order + "f8", size // 8, offset + 8)
        arrays[node.attrib["Name"]] = values.reshape(-1, components) if components > 1 else values
    return arrays


def last_of_series(pvd):
    data_set = ElementTree.parse(pvd).getroot().findall("./Collection/DataSet")[-1]
    return read_points(pvd.parent / data_set.attrib["file"])


class Body:
    """The last state of one body."""

    def __init__(self, folder, name):
        try:
            self.samples = last_of_series(folder / f"{name}_samples.pvd")
            self.frames = last_of_series(folder / f"{name}_frames.pvd")
            self.summary = json.loads((folder / f"{name}.json").read_text())
            self.x, self.J = self.samples["Points"], self.samples["J"]
            self.rest = self.x - self.samples["displacement"]
            self.origins = self.frames["Points"]
            self.rest_origins = self.origins - self.frames["displacement"]
            self.axes = [self.frames[axis] for axis in AXES]
            self.along = np.unique(self.rest_origins[:, 0].round(9)).size  # frames along the length
        except OSError as error:
            raise BadInput(f"{error.filename} cannot be read: {error.strerror}") from None
        except (ElementTree.ParseError, IndexError, KeyError, ValueError) as error:
            raise BadInput(f"{folder}: the results of {name} are not those of frames ({error!r})") from None

    def young(self):
        return f"{self.summary['young'] / 1000:g} kPa"


def camera(azimuth, elevation):
    """Rows: right and up on the page, and toward the viewer, for angles in degrees."""
    a, e = np.radians(azimuth), np.radians(elevation)
    return np.array([[-np.sin(a), np.cos(a), 0], [-np.sin(e) * np.cos(a), -np.sin(e) * np.sin(a), np.cos(e)],
                     [np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)]])


FROM_THE_SIDE = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])  # x to the right, z up


def triads(ax, view, origins, axes, length, width=1.0):
    """Axes as short lines, the nearest to the viewer last."""
    order = np.argsort(origins @ view[2])
    for axis, colour in zip(axes, AXIS_COLOURS):
        ends = np.stack([origins, origins + length * axis], axis=1)[order] @ view[:2].T
        ax.add_collection(LineCollection(ends, colors=colour, linewidths=width, capstyle="round", zorder=4))


def dots(ax, view, x, size, **style):
    order = np.argsort(x @ view[2])
    flat = x[order] @ view[:2].T
    if not np.isscalar(style.get("c", "")):
        style["c"] = style["c"][order]
    return ax.scatter(flat[:, 0], flat[:, 1], s=size, linewidths=0, **style)


def key(place, colour, axes="xyz", more=(), **style):
    """What the marks are."""
    marks = [Line2D([], [], marker="o", ls="", ms=5, color=colour, label="sample, coloured by J"),
             Line2D([], [], marker="o", ls="", ms=5, color=PALE, label="sample at rest")]
    marks += [Line2D([], [], color=AXIS_COLOURS["xyz".index(n)], lw=2, label=f"frame, {n}-axis") for n in axes]
    place.legend(handles=[*marks, *more], frameon=False, fontsize=9, **style)


def colours_of_j(values):
    """From orange (shrunk) over grey (1) to purple (grown), all of them dark enough on white."""
    reach = max(np.abs(np.concatenate(values) - 1).max(), 1e-6)
    colours = LinearSegmentedColormap.from_list("J", ["#e66101", "#fdae61", "#6b6b6b", "#998ec3", "#542788"])
    return plt.Normalize(1 - reach, 1 + reach), colours


def bar_of_j(figure, norm, colours, rectangle, **style):
    bar = figure.colorbar(matplotlib.cm.ScalarMappable(norm, colours), cax=figure.add_axes(rectangle), **style)
    bar.set_label("volume ratio J = det F [-]")
    bar.ax.tick_params(labelsize=9)


def equal(ax, points, margin):
    """Equal scales, with all points in sight."""
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    ax.set_xlim(low[0], high[0])
    ax.set_ylim(low[1], high[1])
    ax.set_aspect("equal")


def grid_lines(ax, view, points, along, **style):
    """Lines through neighbours in a grid of points whose first index is the fastest."""
    flat = (points @ view[:2].T).reshape(-1, along, 2)
    lines = list(flat) + list(flat.transpose(1, 0, 2))
    ax.add_collection(LineCollection(lines, **style))


def box_axes(ax, view, low, high, steps, names="xyz"):
    """The floor of a box and the axes along its left, front and right edges, for views from the front."""
    x, y = [low[0], high[0], high[0], low[0], low[0]], [low[1], low[1], high[1], high[1], low[1]]
    floor = np.column_stack([x, y, np.full(5, low[2])]) @ view[:2].T
    ax.fill(*floor.T, color="0.97", zorder=-2)
    ax.plot(*floor.T, color="0.8", lw=0.8, zorder=-1)
    edges = ((0, [0, low[1], low[2]], (0, -1)),  # axis, a point of the edge, and outward on the page
             (1, [high[0], 0, low[2]], (1, -0.5)),
             (2, [low[0], low[1], 0], (-1, 0)))
    for axis, at, outward in edges[:len(names)]:
        ends = np.array([at, at], float)
        ends[:, axis] = low[axis], high[axis]
        flat = ends @ view[:2].T
        ax.plot(*flat.T, color="0.4", lw=0.8, zorder=-1)
        align = {"ha": ("right", "center", "left")[int(np.sign(outward[0])) + 1],
                 "va": "top" if axis < 2 else "center"}
        first, last = np.ceil(low[axis] / steps[axis] - 1e-9), np.floor(high[axis] / steps[axis] + 1e-9)
        for value in np.arange(first, last + 1) * steps[axis]:
            at[axis] = value
            text = f"{value + 0.0:g}".replace("-", "\N{MINUS SIGN}")
            ax.annotate(text, np.array(at) @ view[:2].T, textcoords="offset points",
                        xytext=5 * np.array(outward), fontsize=9, color="0.25", **align)
        ax.annotate(f"{'xyz'[axis]} [m]", flat.mean(axis=0), textcoords="offset points",
                    xytext=(28 if axis < 2 else 36) * np.array(outward), fontsize=10.5, color="0.25", **align)


def draw_beams(bodies):
    view = FROM_THE_SIDE
    norm, colours = colours_of_j([b.J for b in bodies])
    seen = np.concatenate([b.x for b in bodies] + [b.origins for b in bodies] + [bodies[0].rest_origins])
    panel = 4.4 if len(bodies) > 1 else 7.0
    width = panel * len(bodies) + 4.2
    figure = plt.figure(figsize=(width, 4.9), dpi=DPI)
    for k, body in enumerate(bodies):
        ax = figure.add_axes([(0.7 + panel * k) / width, 0.1, (panel - 0.2) / width, 0.72])
        equal(ax, seen @ view[:2].T, 0.6)
        ax.set_anchor("N")
        near = np.isclose(body.rest_origins[:, 1], body.rest_origins[:, 1].min())
        dots(ax, view, body.rest, 3, c=PALE, zorder=1)
        grid_lines(ax, view, body.origins[near], body.along, colors="0.7", linewidths=0.5, zorder=2)
        dots(ax, view, body.x, 5, c=body.J, norm=norm, cmap=colours, zorder=3)
        triads(ax, view, body.origins, body.axes, 0.35, 0.9)
        ax.set_title(f"({'abcdefgh'[k]})  E = {body.young()}: the end sinks by "
                     f"{body.summary['tip_deflection']:.2f} m", fontsize=10)
        ax.set_xlabel("x [m]")
        if k == 0:
            ax.set_ylabel("z [m]")
        else:
            ax.tick_params(labelleft=False)
        ax.grid(color="0.94")
        ax.set_axisbelow(True)

    body = bodies[0]
    side = width - 3.0
    ax = figure.add_axes([side / width, 0.53, 1.6 / width, 1.6 / 4.9])
    section = body.rest_origins[:, 0] == 0
    first = np.isclose(body.rest[:, 0], body.rest[:, 0].min())
    ax.plot(*body.rest[first][:, 1:].T, "o", ms=3, color="#ef8a17", label=f"{first.sum()} samples")
    ax.plot(*body.rest_origins[section][:, 1:].T, "s", ms=4, color="0.15", label=f"{section.sum()} frames")
    ax.set_aspect("equal")
    ax.set_xlabel("y [m]", labelpad=1)
    ax.set_ylabel("z [m]", labelpad=0)
    ax.tick_params(labelsize=8)
    ax.set_title("a slice at rest", fontsize=10)
    ax.legend(frameon=False, fontsize=9, loc="center left", bbox_to_anchor=(1.0, 0.5), handletextpad=0)
    key_ax = figure.add_axes([(side - 0.4) / width, 0.06, 1.9 / width, 0.32])
    key_ax.axis("off")
    key(key_ax, "#6b6b6b", "xz", loc="center left")
    bar_of_j(figure, norm, colours, [(width - 1.1) / width, 0.08, 0.14 / width, 0.33])
    s, size = body.summary, " x ".join(f"{extent:g}" for extent in np.ptp(body.rest_origins, axis=0))
    name, pause = ("A cantilever", "\n") if len(bodies) == 1 else ("Cantilevers", " ")
    figure.text(0.5, 0.975, f"{name} {size} m of {s['frames']} frames and {s['samples']} samples under "
                f"{'its' if pause != ' ' else 'their'} own weight ({s['mass']:g} kg),{pause}"
                f"$\\nu$ = {s['poisson']:g}, seen from the side", ha="center", va="top", fontsize=12.5)
    return figure


def draw_sheet(bodies):
    body, = bodies
    view = camera(-65, 22)
    norm, colours = colours_of_j([body.J])
    low, high = body.rest_origins.min(axis=0), body.rest_origins.max(axis=0)
    low[2] = np.floor(body.x[:, 2].min() / 0.5 - 0.2) * 0.5
    box = np.stack(np.meshgrid(*np.transpose([low, high]), indexing="ij"), axis=-1).reshape(-1, 3)
    figure = plt.figure(figsize=(12, 6.6), dpi=DPI)
    ax = figure.add_axes([0.02, 0.03, 0.78, 0.86])
    equal(ax, np.concatenate([box, body.x, body.origins + 0.2 * body.axes[2]]) @ view[:2].T, 0.45)
    ax.axis("off")
    box_axes(ax, view, low, high, (0.5, 0.5, 0.5))
    dots(ax, view, body.rest, 4, c=PALE, zorder=1)
    grid_lines(ax, view, body.origins, body.along, colors="0.6", linewidths=0.6, zorder=2)
    dots(ax, view, body.x, 10, c=body.J, norm=norm, cmap=colours, zorder=3)
    triads(ax, view, body.origins, body.axes, 0.14, 1.2)
    s = body.summary
    middle = (low + high)[:2] / 2
    nearest = np.argsort(np.abs(body.rest_origins[:, :2] - middle).max(axis=1), kind="stable")
    at = body.origins[nearest[:int(s["loaded_frames"])]] @ view[:2].T
    ax.scatter(*at.T, s=26, facecolors="white", edgecolors="black", linewidths=1.2, zorder=5)
    key_ax = figure.add_axes([0.79, 0.56, 0.2, 0.3])
    key_ax.axis("off")
    loaded_mark = Line2D([], [], marker="o", ls="", ms=5, mfc="white", mec="black", label="frame with load")
    key(key_ax, "#6b6b6b", more=[loaded_mark], loc="center left")
    bar_of_j(figure, norm, colours, [0.84, 0.1, 0.014, 0.4])
    size = " x ".join(f"{extent:g}" for extent in (*np.ptp(body.rest_origins, axis=0)[:2], s["thickness"]))
    figure.text(0.5, 0.97, f"Sheet {size} m of {s['frames']} frames and {s['samples']} samples, E = {body.young()}, "
                f"$\\nu$ = {s['poisson']:g}, left and right sides fixed,\n{s['force']:g} N downward "
                f"on {s['loaded_frames']:g} frames: it sinks by {s['max_displacement']:.3f} m",
                ha="center", va="top", fontsize=12.5)
    return figure


def draw_line(bodies):
    body, = bodies
    s = body.summary
    view = camera(-72, 22)
    norm, colours = colours_of_j([body.J])
    reach = 3 * s["radius"]
    x, ends = body.origins[:, 0], body.origins[[0, -1]]
    low, high = ends.min(axis=0) - [0, reach, 1.5 * reach], ends.max(axis=0) + [0, reach, 0]
    figure = plt.figure(figsize=(12, 7.4), dpi=DPI)
    ax = figure.add_axes([0.01, 0.41, 0.83, 0.51])
    corners = np.stack(np.meshgrid(*np.transpose([low, high]), indexing="ij"), axis=-1).reshape(-1, 3)
    equal(ax, np.concatenate([corners, body.origins + reach * body.axes[2]]) @ view[:2].T, 0.6)
    ax.axis("off")
    box_axes(ax, view, low, high, (1 if x.size < 16 else 10, 0.5), "xy")
    ring = np.linspace(0, 2 * np.pi, 33)
    for origin, y, z in zip(body.origins, body.axes[1], body.axes[2]):
        circle = origin + s["radius"] * (np.outer(np.cos(ring), y) + np.outer(np.sin(ring), z))
        ax.fill(*(circle @ view[:2].T).T, facecolor="0.95", edgecolor="0.6", lw=0.8, zorder=0)
    dots(ax, view, body.rest, 14, c=PALE, zorder=1)
    dots(ax, view, body.x, 20, c=body.J, norm=norm, cmap=colours, zorder=3)
    triads(ax, view, body.origins, body.axes, 2.2 * s["radius"], 1.8)
    key_ax = figure.add_axes([0.82, 0.62, 0.17, 0.26])
    key_ax.axis("off")
    section = Line2D([], [], marker="o", ls="", ms=8, mfc="0.95", mec="0.6", label="section of a frame")
    key(key_ax, "#e66101", more=[section], loc="center left")

    turned = np.degrees(np.unwrap(np.arctan2(body.axes[1][:, 2], body.axes[1][:, 1])))
    ax = figure.add_axes([0.07, 0.08, 0.34, 0.27])
    ax.plot(x, turned, "o-", color="0.3", ms=4.5, lw=1)
    ax.set_yticks(np.linspace(0, s["turn"], 5))
    ax.set_xlabel("x [m]")
    ax.set_ylabel("turned by [degrees]")
    least, largest = s["least_twist_per_gap"], s["largest_twist_per_gap"]
    span = f"{least:.6g}" if f"{least:.6g}" == f"{largest:.6g}" else f"{least:.6g} to {largest:.6g}"
    ax.set_title(f"frames: {span} degrees a gap", fontsize=10)
    ax.grid(color="0.92")

    ax = figure.add_axes([0.52, 0.08, 0.34, 0.27])
    limit = np.cos(np.radians(largest / 2)) ** 2
    t = np.linspace(0, 1, 41)
    for left, right, theta in zip(x[:-1], x[1:], np.radians(np.diff(turned))):
        ax.plot(left + t * (right - left), 1 - 4 * t * (1 - t) * np.sin(theta / 2) ** 2, color="0.6",
                lw=1, zorder=1, label="blend of two frames on the axis" if left == x[0] else None)
    ax.axhline(limit, color="black", ls="--", lw=1, label=f"cos\u00b2({largest:.4g}\u00b0/2) = {limit:.5f}")
    ax.scatter(body.rest[:, 0], body.J, s=16, c=body.J, norm=norm, cmap=colours, zorder=3, label="samples")
    ax.set_ylim(1 - 1.6 * (1 - limit) - 1e-6, 1 + 0.15 * (1 - limit) + 1e-6)
    ax.set_xlabel("x [m]")
    ax.set_ylabel("J [-]")
    ax.set_title("sections shrink between frames", fontsize=10)
    ax.grid(color="0.92")
    ax.legend(fontsize=8.5, loc="lower center", ncol=2, frameon=False)
    bar_of_j(figure, norm, colours, [0.9, 0.08, 0.014, 0.27])
    figure.text(0.5, 0.975, f"A line of {s['frames']} frames and {s['samples']} samples, its right end "
                f"turned by {s['turn']:g} degrees (E = {body.young()}, $\\nu$ = {s['poisson']:g})",
                ha="center", va="top", fontsize=12.5)
    return figure


def main():
    parser = argparse.ArgumentParser(description="Draw the results of the example `frames`.")
    parser.add_argument("example", choices=("beam", "sheet", "line"))
    parser.add_argument("directory", metavar="DIR", type=pathlib.Path, help="folder of the results")
    parser.add_argument("bodies", metavar="BODY", nargs="+", help="as in BODY_samples.pvd")
    arguments = parser.parse_args()
    draw = {"beam": draw_beams, "sheet": draw_sheet, "line": draw_line}[arguments.example]
    output = arguments.directory / f"{arguments.example}.png"
    try:
        figure = draw([Body(arguments.directory, name) for name in arguments.bodies])
        figure.savefig(output)
    except BadInput as error:
        print(f"plot_frames.py: {error}.", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"plot_frames.py: {output} cannot be written: {error.strerror}.", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
