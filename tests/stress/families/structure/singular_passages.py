"""Motions that pass singular poses, or close by: what chance decides is told, and what is resolved is not."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from stiffmbs.analyses.run import run
from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import JOINTS
from stiffmbs.model.model import Model
from stiffmbs.reading.marker import Marker
from stiffmbs.results.solution import Solution

from ...case import Case, Outcome, Verdict, measured
from ...simulation import simulation

SPEED, INERTIA = 2.0, 0.5
"""Of the slider, m/s, and of its guide, kg m^2; the slider has 1 kg."""
CRANK = -12.0
"""rad/s."""
ALLOWED = 1e-4
"""m."""
NEAR = "a singular pose near t = "
CHANCE = ("passes a singular pose near t = ", "more than one motion may follow")
HOW: dict[str, Any] = {"duration": 1.8, "points": 181, "rtol": 1e-8}


def slider(miss: float) -> Model:
    """A slider moves along a line that passes the hinge of its turning guide at a distance `miss`, m, from 1 m before it on."""
    model = Model("Slider on a guide", gravity=(0, 0))
    guide = model.add(
        "guide",
        Body(mass=1, inertia=INERTIA, angle=float(np.arctan2(-miss, 1.0)), omega=-miss * SPEED / (1 + miss * miss)),
    )
    block = model.add("block", Body(mass=1, inertia=0.2, position=(-1, miss), velocity=(SPEED, 0)))
    model.add("hinge", JOINTS["revolute"](i=guide, j="ground"))
    model.add("rail", JOINTS["point_on_line"](i=block, j=guide))
    model.add("line", JOINTS["prismatic"](i=block, j=Marker(body="ground", point=(0, miss))))
    return model


def four_bar(rocker: float, base: float, crank: float = 0.5, coupler: float = 1.0) -> Model:
    """A four-bar linkage whose crank turns downwards through the pose in which all links lie on one line."""
    model = Model("Four-bar linkage", gravity=(0, 0))
    top = crank * np.array([np.cos(1.0), np.sin(1.0)])
    across = np.array([base, 0.0]) - top
    apart = float(np.hypot(*across))
    along = (coupler**2 - rocker**2 + apart**2) / (2 * apart)
    beside = np.sqrt(coupler**2 - along**2)
    x, y = across / apart
    end = top + along * np.array([x, y]) + beside * np.array([-y, x])
    ends = {"crank": (np.zeros(2), top), "coupler": (top, end), "rocker": (end, np.array([base, 0.0]))}
    turning: dict[str, Any] = {
        "mass": 100.0,
        "inertia": 10.0,
        "omega": CRANK,
        "velocity": (-CRANK * top[1] / 2, CRANK * top[0] / 2),
    }
    for name, (first, last) in ends.items():
        angle = float(np.arctan2(*(last - first)[::-1]))
        own: dict[str, Any] = turning if name == "crank" else {"mass": 1.0, "inertia": 0.05}
        model.add(name, Body(position=tuple((first + last) / 2), angle=angle, **own))
    pins = {
        "a": (("crank", -crank), ("ground", 0)),
        "b": (("crank", crank), ("coupler", -coupler)),
        "c": (("coupler", coupler), ("rocker", -rocker)),
        "d": (("rocker", rocker), ("ground", 2 * base)),
    }
    for name, joined in pins.items():
        i, j = (Marker(body=body, point=(length / 2, 0)) for body, length in joined)
        model.add(name, JOINTS["revolute"](i=i, j=j))
    return model


def lateness(miss: float, solution: Solution) -> float:
    """Largest error of the instants at which the slider is where it is, times its speed, m.

    Its velocity follows from the energy, (1 + I h^2) v^2 constant with h = miss/(x^2 + miss^2), the guide's turn for a way.
    """
    from scipy.integrate import quad

    def delay(s: float) -> float:
        x, h = miss * np.sinh(s), 1 / (miss * np.cosh(s) ** 2)
        return float(np.sqrt(1 + INERTIA * h * h) * np.hypot(x, miss))

    first = np.arcsinh(-1 / miss)
    initial = SPEED * np.sqrt(1 + INERTIA * (miss / (1 + miss * miss)) ** 2)
    late = [
        t - quad(delay, first, np.arcsinh(x / miss), limit=500)[0] / initial
        for t, x in zip(solution.t, solution["block.x"], strict=True)
    ]
    return SPEED * float(np.max(np.abs(late)))


def resolved(miss: float, how: dict[str, Any]) -> Verdict:
    """The motion is right, and nothing is said of singular poses."""
    solution = run(slider(miss), **how)
    if any(NEAR in note for note in solution.notes):
        return Verdict(Outcome.WRONG, detail=f"a note on a passage that is resolved: {'; '.join(solution.notes)}")
    return measured(lateness(miss, solution), ALLOWED)


FOUR_BARS = {
    "parallelogram": lambda off: four_bar(0.5, 1.0 + off),
    "kite": lambda off: four_bar(1.0 + off, 0.5),
    "links of 0.5, 1, 0.7 and 1.2 m": lambda off: four_bar(0.7, 1.2 + off),
}
CASES = (
    *(
        Case(
            f"slider passes its guide's hinge at {miss:.0e} m, {solver}", "way against the quadrature of its energy",
            partial(resolved, miss, {"solver": solver, **HOW}),
        )
        for miss in (1e-1, 1e-2, 1e-3) for solver in ("bdf", "auto", "projected")
    ),
    *(
        simulation(
            f"slider passes its guide's hinge at {miss:.0e} m, {solver}", "the note on what chance decides",
            partial(slider, miss), lambda _: 0.0, 1.0, noted=noted, expected=Outcome.TOLD, solver=solver, **HOW,
        )
        for miss, noted in ((1e-5, (NEAR,)), (1e-8, (NEAR,)), (1e-11, CHANCE)) for solver in ("bdf", "auto", "projected")
    ),
    *(
        simulation(
            f"{name} that misses its flat pose by {off:.0e} m, {solver}", "the note on what chance decides",
            partial(made, off), lambda _: 0.0, 1.0, noted=(NEAR,), expected=Outcome.TOLD, solver=solver,
            duration=1.0, points=points, rtol=1e-8,
        )
        for name, made in FOUR_BARS.items() for off, points in ((0.0, 201), (1e-9, 41)) for solver in ("bdf", "projected")
    ),
)  # fmt: skip
