"""Laws that start exactly on a breakpoint, or graze one so that the value rounds to zero."""

from __future__ import annotations

from functools import partial
from typing import Any, NamedTuple

import numpy as np

from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene
from stiffmbs.results.solution import Solution

from ...case import Case
from ...simulation import simulation
from .within_one_step import SOLVERS

DEPTH = 1e-3
"""Width of the windows, m, rad or s."""
TOLERANCES = {"bdf": 1e-3, "dop853": 1e-5, "dopri5": 1e-3, "auto": 1e-3}
"""Allowed relative error of the velocity at the default relative tolerance."""


class Start(NamedTuple):
    """Motion that starts on a breakpoint: its scene, the compared channel, and its value at the end."""

    scene: str
    channel: str
    value: float
    duration: float = 2.0


def _window(z: str, area: float) -> str:
    """Return a parabola over 0 < z < `DEPTH` with a given integral."""
    return f"{6 * area / DEPTH**3!r}*max(({z})*({DEPTH} - ({z})), 0)"


def _pushed(law: str, velocity: float = 1.0, body: str = "", **more: str) -> str:
    """Return a scene of 1 kg under a force along x."""
    others = "".join(f"\n{name}: {text}" for name, text in more.items())
    return (
        f"gravity: [0, 0]\nbodies: {{b: {{mass: 1, inertia: 1, velocity: [{velocity}, 0]{body}}}}}\n"
        f"forces: {{f: {{type: force, i: b, force: ['{law}', 0]}}}}{others}"
    )


def _turned(law: str) -> str:
    return (
        "gravity: [0, 0]\nbodies: {b: {mass: 1, inertia: 1, omega: 1}}\n"
        f"forces: {{f: {{type: torque, i: b, torque: '{law}'}}}}"
    )


def _in_space(law: str, body: str = "velocity: [0, 0, 1]", kind: str = "force") -> str:
    return (
        f"dimensions: 3\ngravity: [0, 0, 0]\nbodies: {{b: {{mass: 1, inertia: [1, 1, 1], {body}}}}}\n"
        f"forces: {{f: {{type: {kind}, i: b, {kind}: [0, 0, '{law}']}}}}"
    )


def _shallow(level: float, dimensions: int) -> str:
    """Return a scene with ten impulses of 1 N s from a wheel at one revolution per second, just below the maximum of a sine."""
    height = np.pi / np.arccos(level)
    law = f"branch(sin({{}}) - {level!r}, 0, 0, {float(height)!r})"
    if dimensions == 2:
        return (
            "gravity: [0, 0]\nbodies: {b: {mass: 1, inertia: 1}, w: {mass: 1, inertia: 1, position: [0, 1], omega: 2*pi}}\n"
            f"forces: {{f: {{type: force, i: b, force: ['{law.format('w.angle')}', 0]}}}}"
        )
    return (
        "dimensions: 3\ngravity: [0, 0, 0]\n"
        "bodies:\n  b: {mass: 1, inertia: [1, 1, 1]}\n  w: {mass: 1, inertia: [1, 1, 1], position: [0, 1, 0], omega: [0, 0, 2*pi]}\n"
        "joints: {h: {type: revolute, i: w, j: {body: ground, point: [0, 1, 0]}}}\n"
        f"forces: {{f: {{type: force, i: b, force: ['{law.format('az(w, ground)')}', 0, 0]}}}}"
    )


FASTER = float(np.sqrt(1.2))
"""Return the speed after a work of 0.1 J on 1 kg at 1 m/s."""
G = 9.81


def _fallen(t: float) -> float:
    """Return the velocity after a fall from rest over a window that adds 0.1 J; the time in the window follows by quadrature."""
    depths = DEPTH * np.linspace(0.0, 1.0, 200_001) ** 2
    work = 0.1 * (3 * (depths / DEPTH) ** 2 - 2 * (depths / DEPTH) ** 3)
    speed = np.sqrt(2 * (G * depths + work))
    middle = 0.5 * (speed[1:] + speed[:-1])
    return -float(speed[-1] + G * (t - np.sum(np.diff(depths) / middle)))


FALLEN = _fallen(0.5)
STARTS = {
    "parabola at zero": Start(_pushed(_window("b.x", 0.1)), "b.vx", FASTER),
    "parabola at 0.3 m": Start(_pushed(_window("b.x - 0.3", 0.1), body=", position: [0.3, 0]"), "b.vx", FASTER),
    "parabola passed backward": Start(_pushed("-" + _window("-b.x", 0.1), -1.0), "b.vx", -FASTER),
    "triangle": Start(_pushed(f"{0.4 / DEPTH}*max(0, 1 - abs(b.x - {DEPTH / 2})/{DEPTH / 2})*0.5"), "b.vx", FASTER),
    "branch": Start(_pushed(f"branch(b.x, 0, 0, branch(b.x - {DEPTH}, {0.1 / DEPTH}, 0, 0))"), "b.vx", FASTER),
    "steps": Start(
        _pushed(f"{0.2 / DEPTH}*step(b.x, 0, 0, {DEPTH / 2}, 1)*step(b.x, {DEPTH / 2}, 1, {DEPTH}, 0)"), "b.vx", FASTER
    ),
    "angle": Start(_turned(_window("b.angle", 0.1)), "b.omega", FASTER),
    "own state": Start(
        "gravity: [0, 0]\nbodies: {b: {mass: 1, inertia: 1}}\nstates: {p: {rate: 1, start: 0}}\n"
        f"forces: {{f: {{type: force, i: b, force: ['{_window('p', 0.1)}', 0]}}}}",
        "b.vx", 0.1,
    ),
    "other body": Start(
        "gravity: [0, 0]\nbodies: {b: {mass: 1, inertia: 1}, w: {mass: 1, inertia: 1, position: [0, 1], velocity: [1, 0]}}\n"
        f"forces: {{f: {{type: force, i: b, force: ['{_window('w.x', 0.1)}', 0]}}}}",
        "b.vx", 0.1,
    ),
    "fall from rest": Start(
        "gravity: [0, -9.81]\nbodies: {b: {mass: 1, inertia: 1, position: [0, 1]}}\n"
        f"forces: {{f: {{type: force, i: b, force: [0, '-{_window('1 - b.y', 0.1)}']}}}}",
        "b.vy", FALLEN, 0.5,
    ),
    "in space": Start(_in_space(_window("b.z", 0.1)), "b.vz", FASTER),
    "turn in space": Start(
        "dimensions: 3\ngravity: [0, 0, 0]\nbodies: {b: {mass: 1, inertia: [1, 1, 1], omega: [0, 0, 1]}}\n"
        "joints: {h: {type: revolute, i: b, j: ground}}\n"
        f"forces: {{f: {{type: torque, i: b, torque: [0, 0, '{_window('az(b, ground)', 0.1)}']}}}}",
        "b.wz", FASTER,
    ),
    "shallow windows 0.9999": Start(_shallow(0.9999, 2), "b.vx", 10.0, 10.0),
    "shallow windows 0.999999": Start(_shallow(0.999999, 2), "b.vx", 10.0, 10.0),
    "shallow windows in space": Start(_shallow(0.9999, 3), "b.vx", 10.0, 10.0),
}  # fmt: skip


JUMP = f"branch({{0}}, 0, 0, branch({{0}} - {DEPTH}, {0.1 / DEPTH}, 0, 0))"
_OTHER = "gravity: [0, 0]\nbodies: {{b: {{mass: 1, inertia: 1}}, w: {{mass: 1, inertia: 1, position: [{}, 1], velocity: [{}, 0]}}}}\n"
_WITH_JUMP = f"forces: {{{{f: {{{{type: force, i: b, force: ['{JUMP.format('{0}')}', 0]}}}}}}}}"
JUMPS = {
    "own position": STARTS["branch"],
    "own state": Start(
        "gravity: [0, 0]\nbodies: {b: {mass: 1, inertia: 1}}\nstates: {p: {rate: 1, start: 0.3}}\n" + _WITH_JUMP.format("(p - 0.3)"),
        "b.vx", 0.1,
    ),
    "other body": Start(_OTHER.format(0.7, 1) + _WITH_JUMP.format("(w.x - 0.7)"), "b.vx", 0.1),
    "velocity of another body": Start(
        _OTHER.format(0, 0.7) + _WITH_JUMP.format("(w.vx - 0.7)")[:-1] + ", g: {type: force, i: w, force: [1, 0]}}", "b.vx", 0.1
    ),
    "angle": Start(_turned(JUMP.format("b.angle")), "b.omega", FASTER),
    "in space": Start(_in_space(JUMP.format("b.z")), "b.vz", FASTER),
}  # fmt: skip
"""Laws that are discontinuous where the motion starts: the side that the motion enters applies."""


def _off(solution: Solution, start: Start) -> float:
    return float(abs(solution[start.channel][-1] / start.value - 1))


def _case(name: str, start: Start, solver: str, how: dict[str, Any]) -> Case:
    scene: partial[Scene] = partial(read_scene, start.scene)
    return simulation(
        f"{name}, {solver}", "velocity at the end against the work or impulse of the window", scene,
        partial(_off, start=start), TOLERANCES[solver], duration=start.duration, points=2, **how,
    )  # fmt: skip


CASES = (
    *(_case(name, start, solver, how) for name, start in STARTS.items() for solver, how in SOLVERS.items()),
    *(
        _case(f"jump in {name} at {rtol:.0e}", start, solver, SOLVERS[solver] | {"rtol": rtol})
        for name, start in JUMPS.items()
        for solver in ("dop853", "dopri5")
        for rtol in (1e-2, 1e-4)
    ),
)
