"""Examples at different output points: the state at the end is the same."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np

from stiffmbs.analyses.load_scene import load_scene
from stiffmbs.analyses.run import run
from stiffmbs.elements.turns import TURN
from stiffmbs.results.scales import PLACES, kind_of
from stiffmbs.results.solution import Solution
from stiffmbs.solve.trajectory import Outcome as Ending

from ...case import Case, Verdict, measured, told
from ...simulation import ANY_STOP

EXAMPLES = Path(__file__).parents[4] / "examples"
SCENES = sorted(path for path in EXAMPLES.rglob("*.yaml") if path.parent.name != "parts")
LONG = {"rotor", "flexible_slider_crank", "robot_arm", "quarter_car", "car", "leaf_sprung_car", "truck", "hatchback"}
"""Examples with many steps or unknowns."""
STIFF = {"leaf_spring", "rotor", "car"}
"""Examples that explicit steps do not reach the end of in a minute."""
POINTS: tuple[int | Literal["steps"], ...] = 2, 3, 6, 11, 101, 1001, "steps"
SOLVERS: dict[str, dict[str, Any]] = {
    "bdf": {"solver": "bdf"},
    "radau": {"solver": "radau"},
    "dop853": {"solver": "projected", "scheme": "dop853"},
    "auto": {"solver": "auto"},
}
TOLERANCES = 1e-3, 1e-5
ALLOWED = 10.0
"""Largest difference of the ends, in tolerances: the relative tolerance times 1 and the size of the channel."""
STATES = (*PLACES, "velocity", "angular velocity")
UNCERTAIN = "the revolutions of"
"""Begin of the note that angles of joints are known up to full turns only."""


def apart(ends: Solution, other: Solution, rtol: float) -> tuple[float, str]:
    """Return the largest difference of two states at the end in tolerances, and its channel."""
    uncertain = any(note.startswith(UNCERTAIN) for note in (*ends.notes, *other.notes))
    worst, channel = abs(float(ends.time[-1] - other.time[-1])) / rtol, "time"
    for name, values in ends.channels.items():
        if kind_of(name) not in STATES:
            continue
        difference = float(values[-1] - other[name][-1])
        if uncertain and kind_of(name) == "angle":
            difference -= TURN * round(difference / TURN)
        size = max(float(np.nanmax(np.abs(values))), float(np.nanmax(np.abs(other[name]))))
        if not abs(difference) <= worst * rtol * (1.0 + size):
            worst, channel = abs(difference) / (rtol * (1.0 + size)), name
    return worst, channel


def same_ends(scene: Path, how: dict[str, Any], rtol: float) -> Verdict:
    """Compare the states at the end of runs with different output points."""
    described, found = load_scene(scene), []
    for points in POINTS:
        solution = run(described, points=points, rtol=rtol, errors=False, **how)
        if solution.outcome is not Ending.DONE:
            return told(solution.message, ANY_STOP)
        found.append(solution)
    (worst, channel), most = max(
        (apart(found[0], other, rtol), str(points)) for other, points in zip(found[1:], POINTS[1:], strict=True)
    )
    steps = "/".join(str(solution.solver["steps"]) for solution in found)
    return measured(worst, ALLOWED, f"{channel} with {most} points; steps {steps}")


CASES = tuple(
    Case(
        f"{scene.stem}, {name}, {rtol:g}", "states at the end of runs with 2 to 1001 output points, and at each step",
        partial(same_ends, scene, how, rtol), quick=scene.stem not in LONG,
    )
    for scene in SCENES for name, how in SOLVERS.items() for rtol in TOLERANCES
    if name != "dop853" or scene.stem not in STIFF
)  # fmt: skip
