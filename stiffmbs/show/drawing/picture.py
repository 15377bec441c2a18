"""Drawings as pictures of matplotlib: .svg, .png, .pdf."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..style import new_sheet
from .painted import Patch, extent, largest_force, painted
from .poses import Poses
from .scene_graph import EDGES, LOAD, MARKS, PAPER, RAMP, Drawing
from .view import View

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.collections import Collection
    from matplotlib.figure import Figure as Sheet

WIDTH, HEIGHT, NARROWEST = 8.0, 6.0, 3.4
"""Largest width and height of a picture, so that it fits on a screen, and least width, inch."""
MOST_NAMES = 60
"""Number of names above which elements are not named."""
MANY_NAMES, SMALLEST = 15, 0.6
"""Number of names above which they are written smaller, and the smallest relative size."""
MARK_WORDS = {"redundant": "redundant equations", "not unique": "force not unique"}


@dataclass(frozen=True)
class Shown:
    """Options of a picture in addition to bodies and symbols.

    `forces`: true for arrows of the forces of joints and force elements, to scale; by default in the plane alone. `clock`: true
    for the time in a film.
    """

    names: bool = True
    forces: bool | None = None
    clock: bool = True

    def longest(self, drawing: Drawing, poses: Poses) -> float:
        """Return the force of the longest arrow, N; zero without arrows."""
        wanted = drawing.dimensions == 2 if self.forces is None else self.forces
        return largest_force(drawing, poses) if wanted else 0.0


def picture(drawing: Drawing, poses: Poses, view: View, shown: Shown, on_screen: bool = False) -> Sheet:
    """Return a sheet with the mechanism at the first instant; on screen, a figure of pyplot."""
    largest = shown.longest(drawing, poses.at(np.array([0])))
    low, high = framed(drawing, poses.at(np.array([0])), view, largest)
    sheet, axes = empty_sheet(low, high, on_screen)
    paint(axes, painted(drawing, poses, 0, view, largest))
    if shown.names:
        write_names(axes, drawing, poses, 0, view)
    if drawing.name:
        axes.set_title(drawing.name, fontsize=11, parse_math=False)
    explain(axes, drawing, largest)
    return sheet


def empty_sheet(low: np.ndarray, high: np.ndarray, on_screen: bool = False) -> tuple[Sheet, Axes]:
    """Return a sheet with the aspect ratio of the drawing, and its axes without ticks."""
    width, height = (high - low) * min(WIDTH / (high - low)[0], HEIGHT / (high - low)[1])
    sheet = new_sheet((max(width, NARROWEST), max(height, 2.0) + 0.5), on_screen)
    axes = sheet.add_subplot()
    prepare(axes, low, high)
    return sheet, axes


def framed(drawing: Drawing, poses: Poses, view: View, largest: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners of the picture, with a margin for names and arrows."""
    low, high = extent(drawing, poses, view, largest)
    margin = 0.08 * max(float(np.linalg.norm(high - low)), 1e-9)
    return widened(low - margin, high + margin)


def widened(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners of a frame that is at least about a third as wide as high, and as high as wide."""
    middle, half = (low + high) / 2, (high - low) / 2
    half = np.maximum(half, 0.35 * half.max())
    return middle - half, middle + half


def prepare(axes: Axes, low: np.ndarray, high: np.ndarray) -> None:
    """Remove the ticks of axes, and set one scale for both."""
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect("equal")
    axes.set_axis_off()


def paint(axes: Axes, patches: Sequence[Patch], faint: float = 1.0) -> list[Artist]:
    """Put patches on axes; return the artists, so that a film can remove them."""
    from matplotlib.collections import LineCollection, PolyCollection

    artists: list[Artist] = []
    for is_face, group in _runs(patches):
        points = [patch.points for patch in group]
        if is_face:
            made: Collection = PolyCollection(
                points,
                facecolors=[_faded(patch.face, faint * patch.opacity) for patch in group],
                edgecolors="face",
                linewidths=0.3 if faint == 1.0 else 0.0,
            )
        else:
            made = LineCollection(
                points, colors=[_faded(patch.edge, faint) for patch in group], linewidths=[patch.width for patch in group],
                linestyles=[(0, (6, 2, 1, 2)) if patch.dashed else "solid" for patch in group], capstyle="round",
            )  # fmt: skip
        made.set_zorder(2 + len(artists) * 1e-3)
        axes.add_collection(made, autolim=False)
        artists.append(made)
    return artists


def _faded(color: str, opacity: float) -> tuple[float, float, float, float]:
    r, g, b = (int(color[k : k + 2], 16) / 255 for k in (1, 3, 5))
    return r, g, b, opacity


def _runs(patches: Iterable[Patch]) -> Iterable[tuple[bool, list[Patch]]]:
    """Yield groups of consecutive patches of one type."""
    run: list[Patch] = []
    for patch in patches:
        if run and bool(run[-1].face) != bool(patch.face):
            yield bool(run[-1].face), run
            run = []
        run.append(patch)
    if run:
        yield bool(run[-1].face), run


def write_names(axes: Axes, drawing: Drawing, poses: Poses, k: int, view: View) -> Sequence[Artist]:
    """Write names next to their points, with the least overlap."""
    names = drawing.names if len(drawing.names) <= MOST_NAMES else [n for n in drawing.names if n.role == "body"]
    taken: list[np.ndarray] = []
    artists = []
    smaller = max(SMALLEST, min(1.0, (MANY_NAMES / len(names)) ** 0.5)) if names else 1.0
    sheet: Any = axes.get_figure()
    unit = 0.128 * smaller * float(np.diff(axes.get_xlim())[0]) / sheet.get_figwidth()
    for name in sorted(names, key=lambda name: name.role != "body"):
        origin, turned = poses.pose(name.anchor.body, k)
        point = view.seen((origin + turned @ name.anchor.point)[None])[0][:2]
        box = np.array([0.72 * len(name.text) + 0.6, 1.5]) * unit
        place = _free_place(point, box, taken, unit)
        taken.append(np.array([place - box / 2, place + box / 2]))
        color = MARKS[drawing.marks[name.text]] if name.text in drawing.marks else EDGES[name.role]
        artists.append(
            axes.text(
                place[0], place[1], name.text, ha="center", va="center", fontsize=7.5 * smaller, color=color, parse_math=False, zorder=9,
                style="normal" if name.role == "body" else "italic", weight="bold" if name.role == "body" else "normal",
                bbox={"boxstyle": "round,pad=0.1", "facecolor": PAPER, "alpha": 0.72, "edgecolor": "none"}, clip_on=False,
            )
        )  # fmt: skip
    return artists


def _free_place(point: np.ndarray, box: np.ndarray, taken: Sequence[np.ndarray], unit: float) -> np.ndarray:
    """Return the place next to a point with the least overlap with the names written so far."""
    directions = [
        (1, 0.8),
        (-1, 0.8),
        (1, -0.8),
        (-1, -0.8),
        (0, 1.6),
        (0, -1.6),
        (1.4, 2.4),
        (-1.4, 2.4),
        (1.4, -2.4),
        (-1.4, -2.4),
    ]
    places = [point + np.array([x * (box[0] / 2 + unit), y * (box[1] / 2 + unit)]) for x, y in directions]
    return min(places, key=lambda place: sum(_overlap(place, box, other) for other in taken))


def _overlap(place: np.ndarray, box: np.ndarray, other: np.ndarray) -> float:
    low, high = np.maximum(place - box / 2, other[0]), np.minimum(place + box / 2, other[1])
    return float(np.prod(np.maximum(high - low, 0)))


def explain(axes: Axes, drawing: Drawing, largest: float) -> None:
    """Add a legend below the picture for its colors and arrows."""
    from matplotlib.lines import Line2D

    entries = []
    if largest > 0:
        entries.append(
            Line2D([], [], color=LOAD, lw=2.2, label=f"force on an element's first body, longest {largest:.4g} N")
        )
    for mark in dict.fromkeys(drawing.marks.values()):
        entries.append(Line2D([], [], color=MARKS[mark], lw=4, label=MARK_WORDS[mark]))
    for body, scale in drawing.deformations.items():
        entries.append(Line2D([], [], linestyle="none", label=f"{body}: deformation x {scale:g}"))
    if drawing.stress > 0:
        _stress_scale(axes, drawing.stress)
    if entries:
        axes.legend(handles=entries, loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=2, frameon=False, fontsize=8)


def _stress_scale(axes: Axes, largest: float) -> None:
    """Add the scale of stress colors at the right."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LinearSegmentedColormap, Normalize

    factor, unit = (1e6, "MPa") if largest >= 1e5 else (1e3, "kPa") if largest >= 1e2 else (1.0, "Pa")
    colors = ScalarMappable(Normalize(0.0, largest / factor), LinearSegmentedColormap.from_list("stress", RAMP))
    bar = axes.figure.colorbar(colors, ax=axes, shrink=0.7, aspect=30, pad=0.01)
    bar.set_label(f"von Mises stress ({unit})", fontsize=8)
    bar.ax.tick_params(labelsize=7)
