#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The softsim authors
# SPDX-License-Identifier: MIT
"""Draw a deformed body beside its rest shape, from the last .vtu of a .pvd series.

The points of the .vtu are the deformed positions and its point field `displacement` leads there from rest,
both in metres. Left panel: rest; right panel: deformed, coloured by the length of the displacement. Both have
the same view, limits and scale. Needs numpy and matplotlib. Exit code 2: the input is not usable; 3: numpy or
matplotlib is missing.
"""
import argparse
import math
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

try:
    import numpy as np
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.ticker import MaxNLocator
except ImportError as error:
    print(f"plot_deform.py needs numpy and matplotlib, and one is missing: {error}.", file=sys.stderr)
    sys.exit(3)

NUMPY_TYPES = {"Float32": "f4", "Float64": "f8", "Int8": "i1", "UInt8": "u1", "Int16": "i2", "UInt16": "u2",
               "Int32": "i4", "UInt32": "u4", "Int64": "i8", "UInt64": "u8"}
NODES_PER_TETRAHEDRON = {10: 4, 24: 10}  # VTK cell types, linear and quadratic; corners come first
OUTWARD_FACES = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]]
TISSUE = np.array([0.86, 0.66, 0.59])
DPI = 180
LARGEST_PANEL, SMALLEST_PANEL = np.array([5.3, 4.0]), np.array([3.3, 1.7])  # inches, width and height
TICK_SIZE, LABEL_SIZE = 8.5, 10.5  # points


class BadInput(Exception):
    """One sentence for the user."""


def last_of_series(pvd):
    """Path and time of the last data set that a .pvd file lists."""
    try:
        sets = ElementTree.parse(pvd).getroot().findall("./Collection/DataSet")
        return pvd.parent / sets[-1].attrib["file"], float(sets[-1].get("timestep", 0))
    except OSError as error:
        raise BadInput(f"{pvd} cannot be read: {error.strerror}") from None
    except (ElementTree.ParseError, IndexError, KeyError, ValueError):
        raise BadInput(f"{pvd} is not a .pvd file with at least one data set") from None


def read_vtu(path):
    """Points, displacement and four-node tetrahedra of a .vtu file with appended raw arrays."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise BadInput(f"{path} cannot be read: {error.strerror}") from None
    head, tag, tail = content.partition(b"<AppendedData")
    attributes, _, data = tail.partition(b"_")
    if not tag or b'encoding="raw"' not in attributes:
        raise BadInput(f"{path} has no raw appended data")
    try:
        root = ElementTree.fromstring(head + b"</VTKFile>")
    except ElementTree.ParseError as error:
        raise BadInput(f"{path} is not a .vtu file: {error}") from None
    if root.get("compressor"):
        raise BadInput(f"{path} is compressed, which is not supported")
    if len(root.findall("./UnstructuredGrid/Piece")) != 1:
        raise BadInput(f"{path} must hold one piece of an unstructured grid")
    order = ">" if root.get("byte_order") == "BigEndian" else "<"
    count_type = np.dtype(order + NUMPY_TYPES.get(root.get("header_type", "UInt32"), "u4"))

    def array(where, required_components):
        node = root.find(f"./UnstructuredGrid/Piece/{where}")
        if node is None:
            raise BadInput(f"{path} has no array {where}")
        components = int(node.get("NumberOfComponents") or 1)
        usable = node.get("format") == "appended" and node.get("type") in NUMPY_TYPES
        if not usable or components != required_components:
            raise BadInput(f"{path}: {where} must be appended, numeric, {required_components} per tuple")
        try:
            offset = int(node.attrib["offset"])
            size = int(np.frombuffer(data, count_type, 1, offset)[0])
            dtype = np.dtype(order + NUMPY_TYPES[node.get("type")])
            values = np.frombuffer(data, dtype, size // dtype.itemsize, offset + count_type.itemsize)
            return values.reshape(-1, components) if components > 1 else values
        except (KeyError, ValueError):
            raise BadInput(f"{path}: array {where} is cut off") from None

    points = array("Points/DataArray", 3).astype(float)
    displacement = array("PointData/DataArray[@Name='displacement']", 3).astype(float)
    connectivity = array("Cells/DataArray[@Name='connectivity']", 1).astype(np.int64)
    types = array("Cells/DataArray[@Name='types']", 1)
    kind = int(types[0]) if types.size else 0
    if kind not in NODES_PER_TETRAHEDRON or np.any(types != kind):
        raise BadInput(f"{path} must hold tetrahedra, all linear or all quadratic")
    nodes = NODES_PER_TETRAHEDRON[kind]
    if connectivity.size != nodes * types.size or connectivity.min() < 0 or connectivity.max() >= len(points):
        raise BadInput(f"{path}: the connectivity does not fit {types.size} cells and {len(points)} points")
    tetrahedra = connectivity.reshape(-1, nodes)[:, :4]
    if displacement.shape != points.shape:
        raise BadInput(f"{path}: {len(displacement)} displacements for {len(points)} points")
    if not (np.isfinite(points).all() and np.isfinite(displacement).all()):
        raise BadInput(f"{path}: a position or displacement is not finite")
    return points, displacement, tetrahedra


def boundary_triangles(rest, tetrahedra):
    """Faces that belong to one tetrahedron only, turned outward in the rest shape."""
    a, b, c, d = (rest[tetrahedra[:, i]] for i in range(4))
    turned = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) < 0
    tetrahedra = tetrahedra.copy()
    tetrahedra[turned] = tetrahedra[turned][:, [0, 1, 3, 2]]
    faces = tetrahedra[:, OUTWARD_FACES].reshape(-1, 3)
    key = np.sort(faces, axis=1)
    order = np.lexsort(key.T)
    key = key[order]
    same_as_next = np.zeros(len(key) + 1, bool)
    same_as_next[1:-1] = (key[1:] == key[:-1]).all(axis=1)
    return faces[order[~(same_as_next[1:] | same_as_next[:-1])]]


def area_vectors(x, faces):
    a, b, c = (x[faces[:, i]] for i in range(3))
    return np.cross(b - a, c - a) / 2


def camera(azimuth, elevation):
    """Rows: right, up and toward the viewer, for angles in degrees; z points up in the picture."""
    ca, sa = math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth))
    ce, se = math.cos(math.radians(elevation)), math.sin(math.radians(elevation))
    return np.array([[-sa, ca, 0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]])


def choose_camera(rest, deformed, displacement, faces):
    """The oblique view that best shows the body's extent, its motion, and the faces that move most."""
    used = np.unique(faces)
    both = np.concatenate([rest[used], deformed[used]])
    shape = np.cov(both.T)
    u = displacement[used]
    motion = u.T @ u / max(np.sum(u * u), 1e-300)
    area = area_vectors(rest, faces)
    weight = np.linalg.norm(displacement[faces].mean(axis=1), axis=1)
    weighted_area = area * weight[:, None]
    total = np.linalg.norm(weighted_area, axis=1).sum()
    scored = []
    for elevation in (20, 28, 36):
        for azimuth in (a for a in range(-180, 180, 5) if 20 <= a % 90 <= 70):
            view = camera(azimuth, elevation)
            seen = view[:2]
            extent = math.sqrt(max(np.linalg.det(seen @ shape @ seen.T), 0))
            moved = np.trace(seen @ motion @ seen.T)
            facing = np.maximum(weighted_area @ view[2], 0).sum() / total if total > 0 else 0
            # Prefers x running to the right and a modest elevation when little else decides.
            habit = 0.1 * (azimuth < 0) - 0.1 * abs(elevation - 20) / 16
            scored.append((extent, moved + facing + habit, view))
    largest = max(max(s[0] for s in scored), 1e-300)
    return max(scored, key=lambda s: s[0] / largest + s[1])[2]


def shaded(colours, normals, view):
    """Lambert shading by a lamp at the viewer's upper left; each face is lit on the side that is seen."""
    lamp = np.array([-0.45, 0.6, 0.75]) @ view
    lamp /= np.linalg.norm(lamp)
    n = normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    n = n * np.where(n @ view[2] < 0, -1, 1)[:, None]
    lit = np.maximum(n @ lamp, 0)[:, None]
    return np.clip(colours * (0.6 + 0.4 * lit) + 0.1 * lit * lit, 0, 1)


def power_of_thousand(largest):
    """Exponent that keeps printed numbers short: 0 for ordinary sizes, else a multiple of three."""
    return 0 if largest == 0 or 0.02 <= largest < 1e5 else 3 * math.floor(math.log10(largest) / 3)


def metres(exponent):
    return "[m]" if exponent == 0 else rf"[$10^{{{exponent}}}$ m]"


def corners_of(low, high):
    return np.stack(np.meshgrid(*np.transpose([low, high]), indexing="ij"), axis=-1).reshape(-1, 3)


class Panel:
    """A 2D axes that shows faces in orthographic projection inside a box with ticks that never overlap."""

    def __init__(self, figure, rectangle, view, low, high):
        self.ax = figure.add_axes(rectangle)
        self.ax.axis("off")
        self.figure, self.view, self.limits = figure, view, np.array([low, high])
        self.centre = (low + high) / 2
        self.exponent = power_of_thousand(np.abs(self.limits).max())
        self.pad = np.full((2, 2), 30.0)  # points of text beyond the box: (left, bottom), (right, top)
        for _ in range(3):
            self.set_scale()
            for text in list(self.ax.texts):
                text.remove()
            self.draw_box_text()
        self.draw_box()

    def project(self, x):
        return (x - self.centre) @ self.view[:2].T

    def corner(self, near):
        """Box corner on the viewer's side along each axis where `near` is true."""
        toward = self.view[2] > 0
        return np.array([self.limits[int(toward[i] == near[i]), i] for i in range(3)])

    def set_scale(self):
        flat = self.project(corners_of(*self.limits))
        self.box = np.array([flat.min(axis=0), flat.max(axis=0)])
        window = self.ax.get_window_extent()
        size = np.array([window.width, window.height]) * 72 / self.figure.dpi
        self.per_point = ((self.box[1] - self.box[0]) / np.maximum(size - self.pad.sum(axis=0), 40)).max()
        slack = (size - self.pad.sum(axis=0)) * self.per_point - (self.box[1] - self.box[0])
        low = self.box[0] - self.pad[0] * self.per_point - slack / 2
        self.ax.set_xlim(low[0], low[0] + size[0] * self.per_point)
        self.ax.set_ylim(low[1], low[1] + size[1] * self.per_point)

    def edges(self):
        """The three box edges that carry ticks: axis, its two ends, and the outward direction on the page."""
        front_floor = self.corner([True, True, False])
        sides = [self.corner([True, False, False]), self.corner([False, True, False])]
        left = min(sides, key=lambda p: self.project(p)[0])
        for axis, start in ((0, front_floor), (1, front_floor), (2, left)):
            a, b = start.copy(), start.copy()
            a[axis], b[axis] = self.limits[:, axis]
            along = self.project(b) - self.project(a)
            outward = np.array([along[1], -along[0]]) / max(np.linalg.norm(along), 1e-300)
            middle = (self.project(a) + self.project(b)) / 2
            if outward @ middle < 0:
                outward = -outward
            yield axis, a, b, outward

    def ticks(self, axis, most):
        """At most about `most` round values within the limits, in metres, and how to print them."""
        scale = 10.0 ** self.exponent
        low, high = self.limits[:, axis] / scale
        values = MaxNLocator(nbins=most, steps=[1, 2, 5, 10], min_n_ticks=1).tick_values(low, high)
        digits = max(0, -math.floor(math.log10(values[1] - values[0]) + 1e-9))
        slack = 1e-9 * (high - low)
        inside = values[(low - slack <= values) & (values <= high + slack)]
        return [(v * scale, f"{v + 0.0:.{digits}f}".replace("-", "\N{MINUS SIGN}")) for v in inside]

    def place(self, text, at, outward, distance, size):
        side = "right" if outward[0] < -0.4 else "left" if outward[0] > 0.4 else "center"
        level = "center" if abs(outward[1]) < 0.5 else "top" if outward[1] < 0 else "bottom"
        return self.ax.annotate(text, at, xytext=outward * distance, textcoords="offset points", ha=side,
                                va=level, fontsize=size, color="0.25", annotation_clip=False)

    def draw_box_text(self):
        """Tick and axis labels; sets `pad` to the room that they take beyond the box."""
        renderer = self.figure.canvas.get_renderer()
        taken = []

        def free(text, margin):
            extent = text.get_window_extent(renderer).padded(margin * self.figure.dpi / 72)
            return not any(extent.overlaps(other) for other in taken)

        names, self.tick_values = [], {}
        for axis, a, b, outward in self.edges():
            for most in (6, 5, 4, 3, 2, 1, 0):
                placed, before = [], len(taken)
                ticks = self.ticks(axis, most or 2)
                for value, label in ticks:
                    at = a.copy()
                    at[axis] = value
                    text = self.place(label, self.project(at), outward, 5, TICK_SIZE)
                    if free(text, 3):
                        placed.append((value, text))
                        taken.append(text.get_window_extent(renderer))
                    else:
                        text.remove()
                if most == 0 or 0 < len(placed) == len(ticks):  # at 0, the last resort, gaps are accepted
                    break
                del taken[before:]
                for _, text in placed:
                    text.remove()
            self.tick_values[axis] = [value for value, _ in placed]
            sizes = [extent.size * 72 / self.figure.dpi for extent in taken[before:]]
            reach = max((np.abs(outward) @ size for size in sizes), default=0)
            names.append((axis, self.project((a + b) / 2), outward, reach))
        for axis, middle, outward, reach in names:
            name, distance = f"{'xyz'[axis]} {metres(self.exponent)}", 8 + reach
            while True:
                text = self.place(name, middle, outward, distance, LABEL_SIZE)
                if free(text, 2) or distance > 150:
                    break
                text.remove()
                distance += 3
            taken.append(text.get_window_extent(renderer))
        box = self.ax.transData.transform(self.box)
        low, high = np.min([t.min for t in taken], axis=0), np.max([t.max for t in taken], axis=0)
        self.pad = np.maximum(np.array([box[0] - low, high - box[1]]), 0) * 72 / self.figure.dpi + 2

    def draw_box(self):
        lines = []
        for axis in range(3):  # the pane that lies behind the body along this axis, with its grid
            u, v = [i for i in range(3) if i != axis]
            far = self.corner([False] * 3)
            pane = np.repeat(far[None], 4, axis=0)
            pane[:, u], pane[:, v] = self.limits[[0, 1, 1, 0], u], self.limits[[0, 0, 1, 1], v]
            self.ax.add_collection(PolyCollection([self.project(pane)], facecolor="0.965", edgecolor="0.8",
                                                  lw=0.7, zorder=1))
            for tick_axis in (u, v):
                across = v if tick_axis == u else u
                for value in self.tick_values[tick_axis]:
                    line = np.repeat(far[None], 2, axis=0)
                    line[:, tick_axis], line[:, across] = value, self.limits[:, across]
                    lines.append(self.project(line))
        self.ax.add_collection(LineCollection(lines, color="0.88", lw=0.6, zorder=2))
        for axis, a, b, outward in self.edges():
            marks = [self.project(np.array([a, b]))]
            for value in self.tick_values[axis]:
                at = a.copy()
                at[axis] = value
                marks.append(self.project(at) + np.outer([0, 3 * self.per_point], outward))
            self.ax.add_collection(LineCollection(marks, color="0.45", lw=0.8, zorder=3))

    def draw_faces(self, x, faces, colours):
        normals = area_vectors(x, faces)
        colours = shaded(colours, normals, self.view)
        # Back faces first: front faces cover them wherever the surface is closed.
        order = np.lexsort([x[faces].mean(axis=1) @ self.view[2], normals @ self.view[2] > 0])
        flat = self.project(x)[faces[order]]
        edge_brightness = 0.8 if len(faces) < 6000 else 1.0  # a fine mesh would drown in dark edges
        self.ax.add_collection(PolyCollection(flat, facecolors=colours[order], lw=0.25, joinstyle="round",
                                              edgecolors=colours[order] * edge_brightness, zorder=4),
                               autolim=False)


def panel_inches(view, low, high):
    """Width and height of the panel that a box and its labels fill when they grow to the largest panel."""
    trial = plt.figure(figsize=LARGEST_PANEL, dpi=DPI)
    labels = Panel(trial, [0, 0, 1, 1], view, low, high).pad.sum(axis=0) / 72
    plt.close(trial)
    size = np.ptp(corners_of(low, high) @ view[:2].T, axis=0)
    scale = ((LARGEST_PANEL - labels) / size).min()
    return np.maximum(scale * size + labels, SMALLEST_PANEL)


def draw(points, displacement, tetrahedra, time, title, output):
    rest = points - displacement
    faces = boundary_triangles(rest, tetrahedra)
    used = np.unique(faces)
    view = choose_camera(rest, points, displacement, faces)
    both = np.concatenate([rest[used], points[used]])
    low, high = both.min(axis=0), both.max(axis=0)
    longest = (high - low).max()
    if not longest > 0:
        raise BadInput("all points lie in one place")
    margin = np.maximum(0.03 * longest, (0.05 * longest - (high - low)) / 2)
    low, high = low - margin, high + margin

    length = np.linalg.norm(displacement, axis=1)
    largest = length.max()
    exponent = power_of_thousand(largest) if largest < 2e-3 or largest >= 1e5 else 0
    norm = matplotlib.colors.Normalize(0, largest / 10.0**exponent if largest > 0 else 1)
    colour_map = matplotlib.colormaps["viridis"]

    panel = panel_inches(view, low, high)
    foot, head = 0.45, 0.8 if title else 0.45  # inches around the panels
    side, gap, bar_room = 0.1, 0.15, 1.1
    width, height = 2 * panel[0] + gap + side + bar_room, panel[1] + foot + head
    figure = plt.figure(figsize=(width, height), dpi=DPI)

    def rectangle(x, y, w, h):
        return [x / width, y / height, w / width, h / height]

    def write(text, x, y, **style):
        drawn = figure.text(x / width, y / height, text, ha="center", **style)
        needed = drawn.get_window_extent(figure.canvas.get_renderer()).width / figure.dpi
        drawn.set_fontsize(drawn.get_fontsize() * min(1, 1.96 * min(x, width - x) / needed))

    rest_panel = Panel(figure, rectangle(side, foot, *panel), view, low, high)
    deformed_panel = Panel(figure, rectangle(side + panel[0] + gap, foot, *panel), view, low, high)
    rest_panel.draw_faces(rest, faces, np.repeat(TISSUE[None], len(faces), axis=0))
    per_face = length[faces].mean(axis=1) / 10.0**exponent
    deformed_panel.draw_faces(points, faces, colour_map(norm(per_face))[:, :3])

    deformed_name = f"deformed, t = {time:.4g} s" if time > 0 else "deformed"
    for name, x in (("rest", side + panel[0] / 2), (deformed_name, side + gap + 1.5 * panel[0])):
        write(name, x, height - head + 0.1, va="bottom", fontsize=12.5)
    middle = (width - bar_room + side + gap) / 2
    if title:
        write(title, middle, height - 0.1, va="top", fontsize=14, weight="bold")
    counts = f"{len(tetrahedra):,} tetrahedra, {len(points):,} nodes"
    write(f"max displacement {largest:.3g} m    |    {counts}", middle, 0.12, va="bottom", fontsize=10,
          color="0.25")

    bar_height = 0.8 * panel[1]
    bar_axes = figure.add_axes(rectangle(width - bar_room + 0.2, foot + 0.1 * panel[1], 0.15, bar_height))
    bar = figure.colorbar(matplotlib.cm.ScalarMappable(norm, colour_map), cax=bar_axes)
    ticks = MaxNLocator(max(3, int(2 * bar_height)), steps=[1, 2, 2.5, 5, 10]).tick_values(0, norm.vmax)
    bar.set_ticks(ticks[ticks <= norm.vmax * (1 + 1e-9)] if largest > 0 else [0])
    bar.set_label(f"displacement {metres(exponent)}", fontsize=LABEL_SIZE)
    bar.ax.tick_params(labelsize=TICK_SIZE)
    try:
        figure.savefig(output)
    except (OSError, ValueError) as error:
        raise BadInput(f"{output} cannot be written: {error}") from None


def main():
    parser = argparse.ArgumentParser(description="Draw the rest and the last deformed shape of a series.")
    parser.add_argument("directory", metavar="DIR", type=pathlib.Path, help="folder with the .pvd file")
    parser.add_argument("--output", metavar="FILE", type=pathlib.Path, help="default: DIR/deform.png")
    parser.add_argument("--series", metavar="NAME", default="deform", help="the .pvd file without its ending")
    parser.add_argument("--static", action="store_true", help="the times of the series are not seconds: do not show them")
    parser.add_argument("--title", metavar="TEXT", help="heading of the picture")
    arguments = parser.parse_args()
    try:
        path, time = last_of_series(arguments.directory / f"{arguments.series}.pvd")
        draw(*read_vtu(path), 0 if arguments.static else time, arguments.title, arguments.output or arguments.directory / "deform.png")
    except BadInput as error:
        print(f"plot_deform.py: {error}.", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
