"""Joints that cannot be closed: the message has the gap as a length or an angle, with known values."""

from __future__ import annotations

import re
from functools import partial

from stiffmbs.analyses.run import run
from stiffmbs.errors import StiffmbsError
from stiffmbs.model.read_scene import read_scene

from ...case import Case, Outcome, Verdict, measured, told

PLANE = "gravity: [0, 0]\nbodies: {b: {mass: 1, inertia: 0.1}, c: {mass: 1, inertia: 0.1, position: [3, 0]}}\n"
SPACE = (
    "dimensions: 3\ngravity: [0, 0, 0]\n"
    "bodies: {b: {mass: 1, inertia: [0.1, 0.1, 0.1]}, c: {mass: 1, inertia: [0.1, 0.1, 0.1], position: [3, 0, 0]}}\n"
)
PINS = "pb: {type: revolute, i: b, j: ground}, pc: {type: revolute, i: c, j: {body: ground, point: [3, 0]}}"
FIXED = "fb: {type: fixed, i: b, j: ground}, fc: {type: fixed, i: c, j: {body: ground, point: [3, 0]}}"
FIXED_IN_SPACE = "fb: {type: fixed, i: b, j: ground}, fc: {type: fixed, i: c, j: {body: ground, point: [3, 0, 0]}}"
SCENES: dict[str, tuple[str, str, str, float, str]] = {
    "a short rod between fixed bodies": (PLANE, FIXED, "{type: distance, i: b, j: c, length: 0.5}", 2.5, "m"),
    "a long rod between fixed bodies": (PLANE, FIXED, "{type: distance, i: b, j: c, length: 40}", 37.0, "m"),
    "a short rod of a pinned body": (
        PLANE, PINS, "{type: distance, i: {body: b, point: [1, 0]}, j: {body: ground, point: [5.7, 0]}, length: 1}", 3.7, "m",
    ),
    "a rod of 1 mm": (PLANE, FIXED, "{type: distance, i: b, j: c, length: 0.001}", 2.999, "m"),
    "a short rod in space": (SPACE, FIXED_IN_SPACE, "{type: distance, i: b, j: c, length: 0.5}", 2.5, "m"),
    "a long rod in space": (SPACE, FIXED_IN_SPACE, "{type: distance, i: b, j: c, length: 9}", 6.0, "m"),
    "a pin between fixed bodies": (PLANE, FIXED, "{type: revolute, i: b, j: {body: c, point: [-2.8, 0]}}", 0.2, "m"),
    "a ball between fixed bodies": (SPACE, FIXED_IN_SPACE, "{type: spherical, i: b, j: {body: c, point: [-2.5, 0, 0]}}", 0.5, "m"),
    "a point beside a curve": (
        PLANE, FIXED, "{type: point_on_curve, i: b, j: c, y: {table: [[-9, 1], [0, 1], [9, 1]]}}", 1.0, "m",
    ),
    "a point off a circle": (
        PLANE, FIXED, "{type: point_on_curve, i: b, j: c, radius: {table: [[0, 2], [180 deg, 2], [360 deg, 2]], ends: periodic}}", 1.0, "m",
    ),
    "parallel axes at an angle": (
        SPACE, FIXED_IN_SPACE, "{type: perpendicular, i: {body: b, orientation: {z: [0, 0, 1]}}, j: {body: c, orientation: {z: [0.6, 0, 0.8]}}}",
        0.927295218, "rad",
    ),
    "a point above a plane": (SPACE, FIXED_IN_SPACE, "{type: point_on_plane, i: {body: b, point: [0, 0, 0.3]}, j: c}", 0.3, "m"),
}  # fmt: skip
"""Bodies, joints, the joint x that cannot be satisfied, and the gap with its unit."""


def _gap(base: str, joints: str, joint: str, expected: float, unit: str) -> Verdict:
    try:
        run(read_scene(f"{base}joints: {{{joints}, x: {joint}}}\n"), duration=0.1, points=2)
    except StiffmbsError as refusal:
        message = str(refusal)
        found = re.search(r"(?:by|equation [\w ]+,) ([\d.e+-]+) (m|rad)\b", message)
        if not found or found[2] != unit:
            return Verdict(Outcome.WRONG, detail=message)
        verdict = told(message, ("cannot be assembled",), abs(float(found[1]) / expected - 1), 0.01)
        return measured(verdict.error, verdict.allowed, message) if verdict.outcome is Outcome.WRONG else verdict
    return Verdict(Outcome.WRONG, detail="not refused")


CASES = tuple(
    Case(name, "the gap in the message against its closed form", partial(_gap, *SCENES[name]), expected=Outcome.TOLD)
    for name in SCENES
)
