"""Modes and transfer functions at, near and away from breakpoints of forces."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from stiffmbs.analyses.linearised.modes import modes
from stiffmbs.analyses.linearised.transfer import transfer
from stiffmbs.errors import SolverError
from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene

from ...case import Case, Outcome, Verdict, measured, told

MASS, ALLOWED = 2.0, 1e-4
SLIDER = """
tables: {{curve: {{table: [[-1, -1], [{point}, 0], [1, 5]], lines: true}}}}
bodies: {{b: {{mass: 2, inertia: 1, velocity: [{speed}, 0]}}}}
joints: {{rail: {{type: prismatic, i: b, j: ground}}}}
forces: {{f: {{type: force, i: b, force: ["{law}", 0]}}}}
"""
BALL = """
dimensions: 3
bodies: {{b: {{mass: 2, inertia: [1, 1, 1], position: [0, 0, {height}]}}}}
joints: {{rail: {{type: prismatic, i: {{body: b, orientation: {{z: [0, 0, 1]}}}}, j: ground}}}}
forces:
  floor: {{type: sphere_contact, i: b, j: ground, radius: 0.1, stiffness: 200, exponent: 1}}
  hold: {{type: force, i: b, force: [0, 0, "-50*(b.z - {height})"]}}
"""


def slider(law: str, point: float = 0.0, speed: float = 0.0) -> Scene:
    """Return a slider under a force along its rail."""
    return read_scene(SLIDER.format(law=law, point=point, speed=speed))


def ball(height: float) -> Scene:
    """Return a sprung ball over a floor."""
    return read_scene(BALL.format(height=height))


def _bends(
    made: Callable[[], Scene], label: str, stiffness: tuple[float, float], damping: tuple[float, float]
) -> Verdict:
    """Check the note of `modes`, the matrices of both sides, and the refusal of `transfer`."""
    scene = made()
    found = modes(scene)
    try:
        transfer(scene, [f"b.f{label}"], [f"b.v{label}"])
    except SolverError as refusal:
        if "breakpoint" not in str(refusal):
            return Verdict(Outcome.WRONG, detail=str(refusal))
    else:
        return Verdict(Outcome.WRONG, detail="a transfer function of one side")
    if len(found.sides) != 2:
        return Verdict(Outcome.WRONG, detail=f"{len(found.sides)} sides")
    of_sides = [np.poly(np.linalg.eigvals(side.matrix))[1:].real for side in found.sides]
    closed = [np.array([d, k]) / MASS for k, d in zip(stiffness, damping, strict=True)]
    error = min(
        max(float(np.abs(one - other).max()) for one, other in zip(of_sides, order, strict=True))
        for order in (closed, closed[::-1])
    )
    return told("; ".join(found.notes), ("breakpoint of a force on b.v",), error, ALLOWED)


def _jumps(made: Callable[[], Scene]) -> Verdict:
    for analysis in (modes, partial(transfer, inputs=["b.fx"], outputs=["b.vx"])):
        try:
            analysis(made())
        except SolverError as refusal:
            found = str(refusal)
        else:
            return Verdict(Outcome.WRONG, detail="linearised at a discontinuity")
    return told(found, ("b.vx is discontinuous at the state",))


def _smooth(made: Callable[[], Scene], label: str, stiffness: float, damping: float) -> Verdict:
    scene = made()
    found = modes(scene)
    if found.sides:
        return Verdict(Outcome.WRONG, detail=f"a smooth law is reported as having a breakpoint: {found.notes}")
    response = transfer(scene, [f"b.f{label}"], [f"b.{label}"]).response(np.array([0.3]))[0, 0, 0]
    s = 2j * np.pi * 0.3
    return measured(abs(response * (MASS * s**2 + damping * s + stiffness) - 1), ALLOWED)


BENT = {
    "-20*max(b.vx, 0)": ((0, 0), (0, 20)), "-50*abs(b.x) - b.x": ((51, -49), (0, 0)), "-curve(b.x)": ((1, 5), (0, 0)),
    "-50*max(b.x - 1e-7, 0) - b.x": ((1, 51), (0, 0)), "-1e7*b.x - 20*max(b.vx, 0)": ((1e7, 1e7), (0, 20)),
    "-3*min(b.x, 0) - 4*b.x - b.vx": ((7, 4), (1, 1)),
}  # fmt: skip
JUMPING = ("-5*sign(b.vx)", "-5*sign(b.x) - b.x", "branch(b.x, -1, 0, 1)")
SMOOTH = {
    "-20*b.vx - b.x": (1, 20), "-50*max(b.x - 1e-3, 0) - b.x": (1, 0), "-b.x*abs(b.x) - b.x": (1, 0),
    "-5*tanh(b.vx/0.01) - b.x": (1, 500), "-50*max(b.x, 0)^2 - b.x": (1, 0),
}  # fmt: skip

CASES = (
    *(
        Case(
            f"bent: {law}",
            "both sides in closed form",
            partial(_bends, partial(slider, law), "x", *parts),
            Outcome.TOLD,
        )
        for law, parts in BENT.items()
    ),
    Case(
        "ball that just touches",
        "both sides",
        partial(_bends, partial(ball, 0.1), "z", (50, 250), (0, 0)),
        Outcome.TOLD,
    ),
    *(Case(f"jumping: {law}", "a refusal", partial(_jumps, partial(slider, law)), Outcome.TOLD) for law in JUMPING),
    *(
        Case(f"smooth: {law}", "the response in closed form", partial(_smooth, partial(slider, law), "x", *parts))
        for law, parts in SMOOTH.items()
    ),
    Case(
        "away from a point of a table",
        "the same",
        partial(_smooth, partial(slider, "-curve(b.x)", 0.1), "x", 1 / 1.1, 0.0),
    ),
    Case("ball over the floor", "the same", partial(_smooth, partial(ball, 0.11), "z", 50.0, 0.0)),
)
