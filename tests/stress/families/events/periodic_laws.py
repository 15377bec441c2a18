"""Laws that are periodic in a displacement, angle, velocity or state and act in a small part of each period."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from stiffmbs.model.read_scene import read_scene
from stiffmbs.results.solution import Solution

from ...case import Case, Outcome
from ...simulation import simulation
from .within_one_step import SOLVERS

PERIODS, DURATION = 120, 2.0
EXPLICIT = {name: how for name, how in SOLVERS.items() if name != "bdf"}
COARSE = {f"bdf {rtol:.0e}": {"solver": "bdf", "rtol": rtol} for rtol in (1e-2, 1e-3, 1e-4)}
OFTEN = {
    f"bdf {rtol:.0e} with 401 outputs": {"solver": "bdf", "rtol": rtol, "points": 401} for rtol in (1e-2, 1e-3, 1e-4)
}
ALLOWED, OF_SMOOTH = (5e-4, 2e-2), (2e-3, 0.15)
"""Allowed error of explicit schemes at the default tolerance, and of bdf at coarse ones; smooth laws follow from the tolerance alone, and
errors of a thousand periods add up."""
SMOOTH = ("bump", "rational", "power", "square")
Function = Callable[[np.ndarray], np.ndarray]


class Periodic(NamedTuple):
    """Law of y = sin(a) for an argument a that grows linearly: its text and function, and the argument."""

    law: str
    of: Function
    argument: str


def _windowed(y: np.ndarray, level: float, width: float) -> np.ndarray:
    z = np.clip((y - level) / width, 0, 1)
    return z * z * (3 - 2 * z)


LAWS: dict[str, Periodic] = {
    "max over a displacement": Periodic("max(sin(A) - 0.9, 0)", lambda y: np.maximum(y - 0.9, 0), "displacement"),
    "narrow max over a displacement": Periodic("max(sin(A) - 0.9999, 0)", lambda y: np.maximum(y - 0.9999, 0), "displacement"),
    "max over a displacement in space": Periodic("max(sin(A) - 0.99, 0)", lambda y: np.maximum(y - 0.99, 0), "in space"),
    "branch over an angle": Periodic("branch(sin(A) - 0.999, 0, 0, 1)", lambda y: (y > 0.999) * 1.0, "angle"),
    "branch over an angle in space": Periodic("branch(sin(A) - 0.99, 0, 0, 1)", lambda y: (y > 0.99) * 1.0, "turn in space"),
    "abs over a state": Periodic("max(abs(sin(A)) - 0.99, 0)", lambda y: np.maximum(np.abs(y) - 0.99, 0), "state"),
    "branch over a state": Periodic("branch(sin(A) - 0.99999, 0, 0, 1)", lambda y: (y > 0.99999) * 1.0, "state"),
    "step over a velocity": Periodic("step(sin(A), 0.95, 0, 0.99, 1)", lambda y: _windowed(y, 0.95, 0.04), "velocity"),
    "step over a displacement": Periodic("step(sin(A), 0.99, 0, 0.999, 1)", lambda y: _windowed(y, 0.99, 0.009), "displacement"),
    "bump over a displacement": Periodic("exp(200*(sin(A) - 1))", lambda y: np.exp(200 * (y - 1)), "displacement"),
    "rational bump over a state": Periodic("1/(1 + 200*(1 - sin(A)))", lambda y: 1 / (1 + 200 * (1 - y)), "state"),
    "power over an angle": Periodic("sin(A)^40", lambda y: y**40, "angle"),
    "square over a displacement": Periodic("sin(A)^2", lambda y: y**2, "displacement"),
}  # fmt: skip
RATE = 2 * np.pi * PERIODS / DURATION


def _mean(of: Function) -> float:
    """Return the mean over a period, by midpoints that are denser near the peaks at pi/2 and 3 pi/2."""
    z = np.linspace(-1.0, 1.0, 200_001)
    offset = np.pi / 2 * z**3
    middle = 0.5 * (offset[1:] + offset[:-1])
    whole = sum(float(np.sum(of(np.sin(peak + middle)) * np.diff(offset))) for peak in (np.pi / 2, 3 * np.pi / 2))
    return whole / (2 * np.pi)


def _scene(periodic: Periodic) -> str:
    """Return a scene of 1 kg that is accelerated from rest to 1 m/s, and of a body that carries the argument."""
    speed = 1.5
    plane, space = "{mass: 1, inertia: 1, ", "{mass: 1, inertia: [1, 1, 1], "
    more, parameters, joints, forces = "", "", "", ""
    match periodic.argument:
        case "displacement":
            argument, body = f"{RATE / speed!r}*w.x", f"{plane}position: [0, 1], velocity: [{speed}, 0]}}"
        case "in space":
            argument, body = f"{RATE / speed!r}*w.z", f"{space}position: [0, 1, 0], velocity: [0, 0, {speed}]}}"
        case "angle":
            argument, body = f"{RATE / speed!r}*w.angle", f"{plane}position: [0, 1], omega: {speed}}}"
        case "turn in space":
            argument, body = f"{RATE / speed!r}*az(w, ground)", f"{space}position: [0, 1, 0], omega: [0, 0, {speed}]}}"
            joints = "\njoints: {h: {type: revolute, i: w, j: {body: ground, point: [0, 1, 0]}}}"
        case "velocity":
            argument, body = f"{RATE / speed!r}*w.vx", f"{plane}position: [0, 1]}}"
            forces = f", g: {{type: force, i: w, force: [{speed}, 0]}}"
        case _:
            argument, body = "p", f"{plane}position: [0, 1]}}"
            more = f"\nstates: {{p: {{rate: {RATE!r}, start: 0}}}}"
    law = f"{1 / (_mean(periodic.of) * DURATION)!r}*{periodic.law.replace('A', argument)}"
    in_space = "space" in periodic.argument
    zeros, own = (", 0, 0", f"{space[:-2]}}}") if in_space else (", 0", f"{plane[:-2]}}}")
    return (
        f"dimensions: {3 if in_space else 2}\ngravity: [0{zeros}]\nbodies: {{b: {own}, w: {body}}}{more}{parameters}{joints}\n"
        f"forces: {{f: {{type: force, i: b, force: ['{law}'{zeros}]}}{forces}}}"
    )


def _off(solution: Solution) -> float:
    return float(abs(solution["b.vx"][-1] - 1))


def _case(name: str, periodic: Periodic, solver: str, how: dict[str, Any], allowed: float) -> Case:
    return simulation(
        f"{name}, {solver}", f"velocity after {PERIODS} periods against the impulse of each", lambda: read_scene(_scene(periodic)),
        _off, allowed, duration=DURATION, **({"points": 2} | how),
    )  # fmt: skip


def _allowed(name: str) -> tuple[float, float]:
    return OF_SMOOTH if name.startswith(SMOOTH) else ALLOWED


FAST = "max(sin(1e9*w.x) - 0.9, 0)"
"""Law with 10^8 periods, which no solver can resolve."""
UNRESOLVED = tuple(
    simulation(
        f"too many periods, {solver}", "a note names the law", partial(
            read_scene,
            "gravity: [0, 0]\nbodies: {b: {mass: 1, inertia: 1}, w: {mass: 1, inertia: 1, position: [0, 1], velocity: [1, 0]}}\n"
            f"forces: {{fast: {{type: force, i: b, force: ['{FAST}', 0]}}}}",
        ), lambda solution: 0.0, 1.0, names=("fast",), noted=("fast", "do not resolve it"), expected=Outcome.TOLD, duration=1.0, points=2, **how,
    )
    for solver, how in SOLVERS.items()
)  # fmt: skip


def _bump(sharpness: float) -> Function:
    return lambda y: np.exp(sharpness * (y - 1))


NARROW = tuple(
    _case(
        f"narrow bump {sharpness} over a velocity at {rtol:.0e}",
        Periodic(f"exp({sharpness}*(sin(A) - 1))", _bump(sharpness), "velocity"),
        solver, EXPLICIT[solver] | {"rtol": rtol}, ALLOWED[0],
    )
    for sharpness in (2079, 4000) for solver in ("dopri5", "dop853") for rtol in (1e-4, 1e-5, 1e-6, 1e-7)
)  # fmt: skip
"""Cases with steps that begin just before a bump and end after it."""

CASES = (
    *(
        _case(name, law, solver, how, _allowed(name)[0])
        for name, law in LAWS.items()
        for solver, how in EXPLICIT.items()
    ),
    *(
        _case(name, law, solver, how, _allowed(name)[1])
        for name, law in LAWS.items()
        for solver, how in {**COARSE, **OFTEN}.items()
    ),
    *NARROW,
    *UNRESOLVED,
)
