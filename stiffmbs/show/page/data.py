"""Page of runs in motion, and its compact data: the drawing, poses, forces and channels."""

from __future__ import annotations

import base64
import gzip
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from typing import TYPE_CHECKING
from zlib import Z_BEST_COMPRESSION

import numpy as np

from ...reading.units.display import SI_UNITS
from ...results.displayed import displayed
from ...results.solution import Solution
from ..drawing.as_json import drawing_json
from ..drawing.painted import LONGEST_ARROW, largest_force
from ..drawing.poses import Poses, followed_body
from ..drawing.scene_graph import Anchor, Drawing
from ..escaped import page_text

if TYPE_CHECKING:
    from jinja2 import Environment

MOST_POSES = 1200
POSES_A_SECOND = 60
POSE_VALUES = 240_000
"""Largest number of values of poses and forces of all runs together."""
CHANNEL_VALUES = 450_000
"""Largest number of values of channels."""
MOST_INSTANTS = 2000
LEVELS = int(np.iinfo(np.uint16).max)


@dataclass
class Packed:
    """Numbers packed to 16 bits: each column as differences of its levels between its least and greatest value."""

    columns: list[np.ndarray] = field(default_factory=list)
    length: int = 0

    def add(self, values: np.ndarray) -> dict[str, float]:
        """Pack a column; return its start, length, least value and step.  A missing value has the last level."""
        known = np.isfinite(values)
        low, high = (float(values[known].min()), float(values[known].max())) if known.any() else (0.0, 0.0)
        step = (high - low) / (LEVELS - 1)
        levels = np.full(len(values), LEVELS, dtype=np.int64)
        levels[known] = np.round((values[known] - low) / step) if step > 0 else 0
        self.columns.append(np.diff(levels, prepend=0).astype(np.uint16))
        start, self.length = self.length, self.length + len(values)
        return {"start": start, "length": len(values), "low": low, "step": step}

    def text(self, level: int = Z_BEST_COMPRESSION) -> str:
        """Return all columns, compressed, as text."""
        content = np.concatenate(self.columns) if self.columns else np.zeros(0, dtype=np.uint16)
        return packed_text(content.astype("<u2").tobytes(), level)


def packed_text(content: bytes, level: int = Z_BEST_COMPRESSION) -> str:
    """Return bytes, compressed, as text that is harmless in a page."""
    return base64.b64encode(gzip.compress(content, level, mtime=0)).decode("ascii")


def page_data(
    drawing: Drawing, runs: Mapping[str, Poses], solution: Solution | None = None, shown: Sequence[str] = (),
    traces: Sequence[Anchor] = (), only: Sequence[str] | None = None, level: int = Z_BEST_COMPRESSION, choose: str = "",
) -> dict[str, str]:  # fmt: skip
    """Return the two texts of a page: ``head``, JSON, and ``numbers``, both compressed.

    The runs, by their names in the legend, are drawn over each other, the first one in full colors. The channels of the
    solution can be plotted in their display units, and those of `shown` are plotted first. The paths of the points `traces` are drawn first.
    `only` names the channels whose values are included, by default all; of the others only names and units are.

    The level of compression is 1 (fast) to 9 (small). `choose` is the label of a choice of one run that is shown and
    repeated; empty to show all runs over each other.
    """
    packed = Packed()
    width = sum(7 * len(poses.points) + 3 * len(poses.forces) for poses in runs.values()) or 1
    most = max(50, min(MOST_POSES, POSE_VALUES // width))
    first = next(iter(runs.values()))
    unit, factor = (solution.display if solution else SI_UNITS).of("N")
    head: dict[str, object] = {
        "drawing": drawing_json(drawing),
        "longest": {
            "force": largest_force(drawing, first),
            "length": LONGEST_ARROW * drawing.size,
            "unit": unit,
            "factor": factor,
        },
        "runs": [{"name": name, **_motion(poses, packed, most)} for name, poses in runs.items()],
        "choose": choose,
        "follow": followed_body(drawing, first),
        "traces": [{"body": anchor.body, "point": anchor.point.tolist()} for anchor in traces],
        "channels": _channels(displayed(solution), packed, shown, only) if solution is not None else None,
    }
    return {"head": packed_text(json.dumps(head, allow_nan=False).encode(), level), "numbers": packed.text(level)}


def _motion(poses: Poses, packed: Packed, most: int) -> dict[str, object]:
    """Return a run at equal time steps, as many as a film needs."""
    start, end = float(poses.time[0]), float(poses.time[-1])
    count = int(np.clip((end - start) * POSES_A_SECOND, min(len(poses.time), most), most))
    sample = poses.resampled(np.linspace(start, end, max(count, 2)))
    return {
        "start": start, "end": end, "count": len(sample.time),
        "bodies": {
            name: [packed.add(column) for column in (*sample.points[name].T, *_continuous(sample.orientations[name]).T)]
            for name in sample.points
        },
        "forces": {name: [packed.add(column) for column in values.T] for name, values in sample.forces.items()},
    }  # fmt: skip


def _continuous(p: np.ndarray) -> np.ndarray:
    """Return quaternions with signs that do not jump between instants."""
    turns = np.cumprod(np.concatenate([[1.0], np.where(np.sum(p[1:] * p[:-1], axis=1) < 0, -1.0, 1.0)]))
    return p * turns[:, None]


def _channels(
    solution: Solution, packed: Packed, shown: Sequence[str], only: Sequence[str] | None
) -> dict[str, object]:
    """Return every channel, at few enough output instants to keep the page small."""
    included = solution.channels if only is None else only
    most = max(100, min(MOST_INSTANTS, CHANNEL_VALUES // max(len(included), 1)))
    rows = np.unique(np.linspace(0, len(solution.time) - 1, min(len(solution.time), most)).astype(int))
    return {
        "time": solution.time[rows].tolist(), "thinned": len(rows) < len(solution.time), "of": len(solution.time),
        "shown": [name for name in shown if name in solution.channels],
        "columns": [
            {
                "name": name, "unit": solution.unit(name), "unique": name not in solution.not_unique,
                **(packed.add(values[rows]) if name in included else {}),
            }
            for name, values in solution.channels.items()
        ],
    }  # fmt: skip


PARTS = {"three": "three.min.js", "viewer": "viewer.js", "style": "viewer.css"}


def page_parts() -> dict[str, str]:
    """Return the scripts and styles of a page with a moving mechanism."""
    return {name: page_file(file) for name, file in PARTS.items()}


def page_file(name: str) -> str:
    """Return the text of a file of pages: a template, a script or a style."""
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


def moving_page(title: str, data: dict[str, str]) -> str:
    """Return the page as HTML; it needs no network. `data`: result of `stiffmbs.show.page.data.page_data`."""
    template = environment().from_string(page_file("moving.html"))
    return template.render(title=title or "Mechanism", **data, **page_parts())


def environment() -> Environment:
    """Return the environment of templates, which escapes text for HTML and as in `stiffmbs.show.escaped`."""
    from jinja2 import Environment

    return Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True, finalize=page_text)
