"""Inputs over time with short features: tables under any argument, smooth pulses, ringing splines; against their integrals."""

from __future__ import annotations

import json
from functools import partial
from typing import Any

import numpy as np

from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene
from stiffmbs.results.solution import Solution

from ...case import Outcome
from ...simulation import simulation

RUN = {"duration": 10.0, "points": 11, "rtol": 1e-6}
PULSE = {"p": {"table": [[0, 0], [8, 0], [8.05, 1000], [8.1, 0], [10, 0]], "lines": True}}
"""A triangle of 50 N s."""
TIMES = np.arange(0, 10.001, 0.002)
SHOCK = np.where((TIMES > 7.999) & (TIMES < 8.011), 1000 * np.sin(np.pi * (TIMES - 8) / 0.011), 0.0)
"""A half sine of 11 ms, sampled each 2 ms."""


def scene(force: str, tables: dict[str, Any] | None = None) -> Scene:
    """1 kg at rest under a force over time."""
    found: dict[str, Any] = {
        "gravity": [0, 0],
        "bodies": {"b": {"mass": 1, "inertia": 1}},
        "forces": {"f": {"type": "force", "i": "b", "force": [force, 0]}},
    }
    return read_scene(json.dumps(found | ({"tables": tables} if tables else {})))


def led(position: str) -> Scene:
    """2 kg that a drive leads along a rail."""
    joints = {"rail": {"type": "prismatic", "i": "b", "j": "ground"}}
    joints["motor"] = {"type": "drive", "joint": "rail", "position": position}
    bodies = {"b": {"mass": 2, "inertia": 1}}
    return read_scene(json.dumps({"gravity": [0, 0], "bodies": bodies, "joints": joints}))


def _speed(solution: Solution, impulse: float) -> float:
    return float(abs(solution["b.vx"][-1] / impulse - 1))


def _seen(
    name: str, force: str, impulse: float, tables: dict[str, Any] | None = None, allowed: float = 1e-4, **how: Any
) -> tuple[Any, ...]:
    """By both integrators, and by `auto`, which is not quick."""
    solvers: dict[str, dict[str, Any]] = {
        "bdf": {"solver": "bdf"},
        "auto": {"solver": "auto", "quick": False},
        "dopri5": {"solver": "projected", "scheme": "dopri5"},
    }
    return tuple(
        simulation(
            f"{name}, {solver}", f"force {force}; speed at the end against its integral",
            partial(scene, force, tables), partial(_speed, impulse=impulse), allowed, **{**RUN, **settings, **how},
        )
        for solver, settings in solvers.items()
    )  # fmt: skip


def _table(values: np.ndarray, **how: Any) -> dict[str, Any]:
    return {"p": {"table": np.column_stack([TIMES, values]).tolist(), **how}}


def _spline_integral(values: np.ndarray) -> float:
    """Of the natural spline through the samples: its second derivatives M solve a tridiagonal system (de Boor, ch. IV)."""
    h, n = TIMES[1] - TIMES[0], len(values)
    right = 6 * np.diff(values, 2) / h**2
    diagonal, M = np.full(n - 2, 4.0), np.zeros(n)
    for k in range(1, n - 2):
        diagonal[k] -= 1 / diagonal[k - 1]
        right[k] -= right[k - 1] / diagonal[k - 1]
    for k in range(n - 3, -1, -1):
        M[k + 1] = (right[k] - M[k + 2]) / diagonal[k]
    return float(np.sum(h / 2 * (values[1:] + values[:-1]) - h**3 / 24 * (M[1:] + M[:-1])))


NOISE = 1e-6 * np.random.default_rng(0).standard_normal(len(TIMES))
GAUSS = 0.5 * np.sqrt(np.pi)

CASES = (
    *_seen("table under min", "p(min(t, 9))", 50.0, PULSE),
    *_seen("table under max", "p(max(t - 1, 0))", 50.0, PULSE),
    *_seen("table under branch", "p(branch(t - 3, 0, 3, t))", 50.0, PULSE),
    *_seen("table of a table", "p(q(t))", 25.0, {**PULSE, "q": {"table": [[0, 0], [5, 10]], "lines": True}}),
    *_seen("table times a function of time", "2*p(t)*step(t, 1, 0, 2, 1)", 100.0, PULSE),
    *_seen("table of a sine", "p(10*sin(pi*t/20))*cos(pi*t/20)", 50 * 2 / np.pi, PULSE),
    *_seen("Gaussian of 0.5 ms", "1000*exp(-((t - 8)/0.5 ms)^2)", GAUSS),
    *_seen("Gaussian beside the state", "b.x*0 + 1000*exp(-((t - 8)/0.5 ms)^2)", GAUSS),
    *_seen("Gaussian of 1 us in 1000 s", "1e6*exp(-((t - 812.34)/1e-6)^2)", 2 * GAUSS, duration=1000.0),
    *_seen("difference of two tanh", "1000*(tanh((t - 8)/1e-3) - tanh((t - 8.002)/1e-3))", 4.0),
    *_seen("root of a square", "sqrt((t - 8)^2)", 34.0),
    *_seen("Lorentzian", "1000/(1 + ((t - 8)/1e-3)^2)", np.arctan(2000) + np.arctan(8000)),
    *_seen("sech", "1000/cosh((t - 8)/1e-3)", np.pi),
    *_seen("power of a sine", "1000*exp(-1e6*(1 - cos(t - 3)))", 2000 * GAUSS * np.sqrt(2e-6) * (1 + 1e-6 / 8) * 2),
    *_seen("half sine in a spline", "p(t)", _spline_integral(SHOCK), _table(SHOCK, spline=True)),
    *_seen("half sine in a spline with noise", "p(t)", _spline_integral(SHOCK + NOISE), _table(SHOCK + NOISE, spline=True), quick=False),
    *_seen("flat zero of a step", "1000*max(0, step(abs(t - 8.0005), 0, 1, 0.0005, 0))", 0.5),
    *_seen("flat zero of max", "1e6*abs(max(0, 0.0005 - abs(t - 8)))", 0.25),
    *_seen("sine of 1 kHz beside a constant", "1 + sin(2000*pi*t)", 10.0, allowed=1e-3),
    simulation(
        "peak of a drive between output points", "told by a kinematic run; positions against the drive",
        partial(led, "1e-3*exp(-((t - 0.505)/1 ms)^2)"),
        lambda solution: float(np.max(np.abs(solution["b.x"] - 1e-3 * np.exp(-(((solution.t - 0.505) / 1e-3) ** 2))))), 1e-9,
        noted=("shorter than the 0.01 s between output times", "t = 0.5"), expected=Outcome.TOLD, duration=1.0, points=101, solver="kinematic",
    ),
    simulation(
        "fixed steps over a short pulse", "told", partial(scene, "exp(-((t - 0.5)/1e-4)^2)"), lambda solution: 0.0, 1.0,
        noted=("shorter than the steps of 0.001 s that rk4 takes",), expected=Outcome.TOLD, duration=1.0, points=11, solver="projected", scheme="rk4",
    ),
)  # fmt: skip
