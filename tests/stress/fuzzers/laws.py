"""Random force laws over a displacement, an angle, a velocity or a state, against the integral of the law."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from stiffmbs.analyses.run import run
from stiffmbs.errors import StiffmbsError
from stiffmbs.model.read_scene import read_scene
from stiffmbs.solve.trajectory import Outcome as Ending

from ..case import Verdict, measured, told

WHAT = "force laws over a displacement, angle, velocity or state (windows, periods, starts on breakpoints), against their integrals"
SOLVERS: tuple[dict[str, Any], ...] = (
    {"solver": "bdf"}, {"solver": "radau"}, {"solver": "projected", "scheme": "dop853"}, {"solver": "projected", "scheme": "dopri5"}, {"solver": "auto"},
)  # fmt: skip
LEAST, OF_TOLERANCE, MOST = 2e-4, 200.0, 0.01
"""Error of an impulse or work that is right: the least one, in relative tolerances (or one for each step), and the most besides twice that."""
FASTER = 1.5
"""Times its speed at the start that a mass moves at most: its work is at most half of m v^2."""
OF_ESTIMATE = 2.0
"""Largest ratio of an error to the estimate of the run itself at which the run has reported it."""
REPORTED = "do not resolve it", "the estimated error of", "solution is lost"
"""Words of the notes on laws that change faster than steps are taken, and on estimated errors."""


class Moving(NamedTuple):
    """An argument that moves by itself at a constant rate: what it is called, where it begins, and what the scene needs for it."""

    name: str
    start: float
    rate: float
    scene: dict[str, Any]


class Drawn(NamedTuple):
    """A law in its scene: how it is run, and the channel, its value at the end or None for work, and the law's argument and factor."""

    scene: dict[str, Any]
    law: StateLaw
    duration: float
    how: dict[str, Any]
    channel: str
    expected: float | None
    name: str
    start: float = 0.0
    size: float = 1.0


def trial(seed: int) -> Verdict:
    """One random law: pushing a free mass while its argument moves by itself, or over the position of that mass."""
    return _judged(*drawn(np.random.default_rng(seed)))


def drawn(rng: np.random.Generator) -> Drawn:
    """Return a random law in its scene, and what its result is compared with."""
    how = SOLVERS[rng.integers(len(SOLVERS))] | {
        "rtol": float(10.0 ** -rng.integers(2, 10)),
        "points": int(rng.choice([2, 11, 200])),
    }
    return _own(rng, how) if rng.uniform() < 0.3 else _driven(rng, how)


def _driven(rng: np.random.Generator, how: dict[str, Any]) -> Drawn:
    """The impulse of a force on 1 kg at rest is the integral of the law over its argument, by the rate of that."""
    space = bool(rng.integers(2))
    duration = float(10.0 ** rng.uniform(-1, 2))
    moving = _MOVING[rng.integers(len(_MOVING))](rng, space, duration)
    length = moving.rate * duration
    law = (periodic if rng.uniform() < 0.6 else single_window)(rng, moving.start, length)
    size = moving.rate / law.integral(moving.start, moving.start + length)
    scene = _scene(law, moving.name, size, space, moving.scene)
    return Drawn(scene, law, duration, how, "b.vx", 1.0, moving.name)


def _own(rng: np.random.Generator, how: dict[str, Any]) -> Drawn:
    """A law over the own position does work on 1 kg that moves at 1 m/s."""
    space, duration, start = bool(rng.integers(2)), float(10.0 ** rng.uniform(-1, 2)), float(rng.choice([0.0, 0.3]))
    length = FASTER * duration
    law = (periodic if rng.uniform() < 0.6 else single_window)(rng, start, length)
    size = float(rng.uniform(0.05, 0.5)) / law.integral(start, start + length)
    zeros = [0.0] * (2 if space else 1)
    scene = _scene(law, "b.x", size, space, {})
    scene["bodies"]["b"] |= {"position": [start, *zeros], "velocity": [1.0, *zeros]}
    return Drawn(scene, law, duration, how, "b.vx", None, "b.x", start, size)


def _scene(law: StateLaw, name: str, size: float, space: bool, more: dict[str, Any]) -> dict[str, Any]:
    zeros = [0] * (2 if space else 1)
    body = {"mass": 1, "inertia": [1, 1, 1] if space else 1}
    found: dict[str, Any] = {
        "dimensions": 3 if space else 2, "gravity": [0, *zeros], "bodies": {"b": body, **more.get("bodies", {})},
        "parameters": law.parameters | {"size": size} | more.get("parameters", {}),
        "forces": {"f": {"type": "force", "i": "b", "force": [f"size*({law.text.replace('{s}', name)})", *zeros]}},
    }  # fmt: skip
    found["forces"] |= more.get("forces", {})
    found |= {key: more[key] for key in ("states", "joints") if key in more}
    return found | ({"tables": law.tables} if law.tables else {})


def _judged(
    scene: dict[str, Any], law: StateLaw, duration: float, how: dict[str, Any], channel: str, expected: float | None,
    name: str, start: float = 0.0, size: float = 1.0,
) -> Verdict:  # fmt: skip
    detail = f"{how}, {duration:.3g} s: {law.text.replace('{s}', name)} {json.dumps(scene['parameters'])}"
    try:
        solution = run(read_scene(json.dumps(scene)), duration=duration, **how)
    except StiffmbsError as refusal:
        return told(f"{refusal} [{detail}]", ())
    if solution.outcome is not Ending.DONE:
        return told(f"{solution.message} [{detail}]", ("t = ",))
    found = float(solution[channel][-1])
    if expected is None:
        work = size * law.integral(start, float(solution["b.x"][-1]))
        error, by_speed = abs(0.5 * found**2 - 0.5 - work) / max(work, 0.5), abs(found) / max(work, 0.5)
    else:
        error, by_speed = abs(found - expected), 1.0
    of_tolerance = max(OF_TOLERANCE, float(solution.solver["steps"])) * how["rtol"]
    allowed = LEAST + min(of_tolerance, MOST) + 2.0 * how["rtol"]
    if error > allowed and any(words in note for note in solution.notes for words in REPORTED):
        return told("; ".join(solution.notes), ())
    if error > allowed:
        assessed = run(read_scene(json.dumps(scene)), duration=duration, **how, errors=True)
        estimate, known = assessed.estimate, OF_ESTIMATE * by_speed * assessed.errors[channel].over_time
        if estimate and (estimate.status == "lost" or error <= known):
            return told(estimate.sentence, ())
    return measured(error, allowed, f"{solution.solver['steps']} steps, found {found:.6g}, {detail}")


def _displacement(rng: np.random.Generator, space: bool, duration: float) -> Moving:
    """A free body at a constant speed."""
    axis = int(rng.integers(3 if space else 2))
    speed, start = float(10.0 ** rng.uniform(-2, 2)), float(rng.choice([0.0, rng.uniform(-1, 1)]))
    position, velocity = [0.0, 1.0, 2.0][: 3 if space else 2], [0.0] * (3 if space else 2)
    position[axis], velocity[axis] = start, speed
    body = {"mass": 1, "inertia": [1, 1, 1] if space else 1, "position": position, "velocity": velocity}
    return Moving(f"w.{'xyz'[axis]}", start, speed, {"bodies": {"w": body}})


def _angle(rng: np.random.Generator, space: bool, duration: float) -> Moving:
    """A wheel."""
    omega = float(10.0 ** rng.uniform(-1, 1.5))
    if not space:
        start = float(rng.uniform(-1, 1))
        return Moving(
            "w.angle", start, omega,
            {"bodies": {"w": {"mass": 1, "inertia": 1, "position": [0, 1], "angle": start, "omega": omega}}},
        )  # fmt: skip
    body = {"mass": 1, "inertia": [1, 1, 1], "position": [0, 1, 0], "omega": [0, 0, omega]}
    joint = {"type": "revolute", "i": "w", "j": {"body": "ground", "point": [0, 1, 0]}}
    return Moving("az(w, ground)", 0.0, omega, {"bodies": {"w": body}, "joints": {"h": joint}})


def _state(rng: np.random.Generator, space: bool, duration: float) -> Moving:
    """A state with a constant rate."""
    rate, start = float(10.0 ** rng.uniform(-2, 2)), float(rng.uniform(-1, 1))
    states = {"p": {"rate": "speed", "start": start}}
    return Moving("p", start, rate, {"states": states, "parameters": {"speed": rate}})


def _velocity(rng: np.random.Generator, space: bool, duration: float) -> Moving:
    """The velocity of a body under a constant force."""
    rate, start = float(10.0 ** rng.uniform(-2, 2)), float(rng.choice([0.0, rng.uniform(-1, 1)]))
    zeros = [0.0] * (2 if space else 1)
    body = {
        "mass": 1,
        "inertia": [1, 1, 1] if space else 1,
        "position": [0.0, 1.0, *zeros[1:]],
        "velocity": [start, *zeros],
    }
    force = {"type": "force", "i": "w", "force": ["speed", *zeros]}
    return Moving("w.vx", start, rate, {"bodies": {"w": body}, "forces": {"g": force}, "parameters": {"speed": rate}})


_MOVING = (_displacement, _angle, _state, _velocity)


Function = Callable[[np.ndarray], np.ndarray]
NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)
SMOOTH_PARTS = np.concatenate([[0.0], np.geomspace(1e-5, 0.5, 40)])
"""Parts of a period, from a peak on, between which a smooth peak is a polynomial."""


@dataclass(frozen=True)
class StateLaw:
    """A law F(s) >= 0.

    Attributes
    ----------
    text : str
        With ``{s}`` for its argument.
    of : callable
        Of arrays of s.
    points : ndarray
        Where it bends, and some points within each feature.
    parameters, tables : dict
        As in a scene.
    """

    text: str
    of: Function
    points: np.ndarray
    parameters: dict[str, float]
    tables: dict[str, Any] = field(default_factory=dict)

    def integral(self, low: float, high: float) -> float:
        """The integral over s by Gauss's rule between all points."""
        edges = np.unique(np.clip(np.concatenate([[low, high], self.points]), min(low, high), max(low, high)))
        h = np.diff(edges)
        s = edges[:-1, None] + h[:, None] * (NODES + 1) / 2
        return float(np.sum(self.of(s) @ WEIGHTS * h / 2))


def single_window(rng: np.random.Generator, start: float, length: float) -> StateLaw:
    """One window over s, of which a third begin exactly at the start."""
    width = length * 10.0 ** rng.uniform(-4, -1)
    at_start = rng.uniform() < 1 / 3
    first = start if at_start else start + (length - width) * rng.uniform(0.02, 0.95)
    kind = str(rng.choice(list(WINDOWS) if at_start else [*WINDOWS, *PEAKS]))
    text, of, extent = {**WINDOWS, **PEAKS}[kind]
    # an edge of a feature is where its own formula has it: rounding decides on no side of it
    law = text.replace("z", "(({s} - first)/width)")
    offsets = np.linspace(-4.0, 5.0, 145) if kind in PEAKS else np.linspace(0.0, 1.0, 33)
    tails = np.geomspace(5.0, extent, 60) if extent > 5.0 else np.empty(0)
    points = first + width * np.concatenate([offsets, tails, -tails])
    tables = {kind: TABLES[kind]} if kind in TABLES else {}
    return StateLaw(law, lambda s: of((s - first) / width), points, {"first": first, "width": width}, tables)


def periodic(rng: np.random.Generator, start: float, length: float) -> StateLaw:
    """A law of sin(k s + phase), or a table that repeats."""
    count = 10.0 ** rng.uniform(0.5, 3)
    rate = 2 * np.pi * count / length
    phase = float(rng.uniform(0, 2 * np.pi))
    kind = str(rng.choice([*PERIODIC, "teeth"]))
    if kind == "teeth":
        period = length / count
        width = float(rng.uniform(0.01, 0.3))
        table = {"table": [[0, 0], [1 - width, 0], [1 - width / 2, 1], [1, 0]], "lines": True, "ends": "periodic"}
        bends = np.concatenate(
            [
                np.arange(np.floor(start / period) - 1, (start + length) / period + 2) + k
                for k in (0, 1 - width, 1 - width / 2)
            ]
        )
        of = lambda s: np.maximum(0.0, 1 - np.abs(np.mod(s / period, 1.0) - 1 + width / 2) / (width / 2))  # noqa: E731
        return StateLaw("teeth({s}/period)", of, bends * period, {"period": period}, {"teeth": table})
    level = 1 - 10.0 ** rng.uniform(-6, -0.3)
    if kind in SMOOTH:
        level = min(level, 1 - 1e-4)
    text, sine_law = PERIODIC[kind]
    centres = (
        np.arange(np.floor((rate * start + phase) / np.pi) - 1, (rate * (start + length) + phase) / np.pi + 2) + 0.5
    ) * np.pi
    edge = np.arccos([level, (1 + level) / 2, -level])
    offsets = (
        np.concatenate([edge, -edge])
        if kind not in SMOOTH
        else 2 * np.pi * np.concatenate([SMOOTH_PARTS, -SMOOTH_PARTS])
    )
    points = ((centres[:, None] + np.append(offsets, 0.0)).ravel() - phase) / rate
    zeros = (centres + 0.5 * np.pi - phase) / rate
    law = text.replace("y", "sin(rate*{s} + phase)")
    return StateLaw(
        law, lambda s: sine_law(np.sin(rate * s + phase), level), np.concatenate([points, zeros]),
        {"rate": rate, "phase": phase, "level": level},
    )  # fmt: skip


WINDOWS: dict[str, tuple[str, Function, float]] = {
    "parabola": ("max(z*(1 - z), 0)", lambda z: np.maximum(z * (1 - z), 0), 1.0),
    "triangle": ("max(0, 1 - abs(2*z - 1))", lambda z: np.maximum(0, 1 - np.abs(2 * z - 1)), 1.0),
    "box": ("branch(z, 0, 0, branch(z - 1, 1, 0, 0))", lambda z: ((z > 0) & (z < 1)) * 1.0, 1.0),
    "steps": ("step(z, 0, 0, 0.5, 1)*step(z, 0.5, 1, 1, 0)", lambda z: _step(2 * z) * (1 - _step(2 * z - 1)), 1.0),
    "step5": ("step5(z, 0, 0, 0.25, 1)*step5(z, 0.5, 1, 1, 0)", lambda z: _step5(4 * z) * (1 - _step5(2 * z - 1)), 1.0),
    "roof": ("roof(z)", lambda z: np.interp(z, [0, 0.25, 1], [0, 1, 0]), 1.0),
}
"""Windows over 0 < z < 1: text, function, and how far they reach."""
PEAKS: dict[str, tuple[str, Function, float]] = {
    "gauss": ("exp(-4*(z - 0.5)^2)", lambda z: np.exp(-4 * (z - 0.5) ** 2), 6.0),
    "lorentz": ("1/(1 + 16*(z - 0.5)^2)", lambda z: 1 / (1 + 16 * (z - 0.5) ** 2), 1e5),
    "tanh": ("(tanh(4*z) - tanh(4*z - 4))", lambda z: np.tanh(4 * z) - np.tanh(4 * z - 4), 9.0),
    "sech": ("1/cosh(6*(z - 0.5))", lambda z: 1 / np.cosh(np.clip(6 * (z - 0.5), -700, 700)), 9.0),
}
TABLES = {"roof": {"table": [[-1e6, 0], [0, 0], [0.25, 1], [1, 0], [1e6, 0]], "lines": True}}
PERIODIC: dict[str, tuple[str, Callable[[np.ndarray, float], np.ndarray]]] = {
    "max": ("max(y - level, 0)", lambda y, c: np.maximum(y - c, 0)),
    "branch": ("branch(y - level, 0, 0, 1)", lambda y, c: (y > c) * 1.0),
    "abs": ("max(0, abs(y) - level)", lambda y, c: np.maximum(np.abs(y) - c, 0)),
    "step": ("step(y, level, 0, (1 + level)/2, 1)", lambda y, c: _step((y - c) * 2 / (1 - c))),
    "exp": ("exp((y - 1)/(1 - level))", lambda y, c: np.exp((y - 1) / (1 - c))),
    "lorentz": ("1/(1 + (1 - y)/(1 - level))", lambda y, c: 1 / (1 + (1 - y) / (1 - c))),
    "power": ("y^40", lambda y, c: y**40),
    "square": ("y^2", lambda y, c: y**2),
}
"""Laws of a sine y."""
SMOOTH = ("exp", "lorentz", "power", "square")


def _step(z: np.ndarray) -> np.ndarray:
    z = np.clip(z, 0, 1)
    return z * z * (3 - 2 * z)


def _step5(z: np.ndarray) -> np.ndarray:
    z = np.clip(z, 0, 1)
    return z**3 * (10 - 15 * z + 6 * z * z)
