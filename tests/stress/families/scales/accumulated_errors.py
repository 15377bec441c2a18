"""Errors that many steps add up to: each motion is within a hundred tolerances of what is known of it, or reported."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from stiffmbs.analyses.run import run
from stiffmbs.model.read_scene import read_scene
from stiffmbs.results.solution import Solution

from ...case import Case, Outcome, Verdict, measured, told

TOLERANCES, RTOL = 100.0, 1e-6
SOLVERS: dict[str, dict[str, Any]] = {
    "bdf": {"solver": "bdf"},
    "dop853": {"solver": "projected"},
    "dopri5": {"solver": "projected", "scheme": "dopri5"},
    "auto": {"solver": "auto"},
}
CONVERGED: dict[str, Any] = {"solver": "projected", "rtol": 1e-12}
WHEELS = {"1 rev/s": (1.0, 1000), "50 rev/s": (50.0, 400), "500 rev/s": (500.0, 1000)}
PERIODS = {40: (), 3000: ("bdf", "dopri5")}
"""Of the force on a mass, with the solvers whose errors add up."""
SPRING = "-100*b.x"


def _wheel(rate: float, turns: int, in_space: bool) -> str:
    """A wheel 0.1 m off its hinge."""
    omega, zero = 2 * np.pi * rate, ", 0" if in_space else ""
    inertia, turning = ("[0.01, 0.01, 0.02]", f"[0, 0, {omega!r}]") if in_space else ("0.01", f"{omega!r}")
    counted = "\nrequests: {turn: 'az(w, ground)'}" if in_space else ""
    return (
        f"dimensions: {3 if in_space else 2}\ngravity: [0, 0{zero}]\n"
        f"bodies: {{w: {{mass: 1, inertia: {inertia}, position: [0.1, 0{zero}], velocity: [0, {0.1 * omega!r}{zero}], omega: {turning}}}}}\n"
        f"joints: {{h: {{type: revolute, i: {{body: w, point: [-0.1, 0{zero}]}}, j: ground}}}}{counted}\n"
        f"run: {{duration: {turns / rate!r}, points: 2}}"
    )


def _driven(periods: int, in_space: bool) -> str:
    """A mass under a force w sin(w t), displaced by 1 m."""
    rate, zero = 2 * np.pi * periods, ", 0" if in_space else ""
    return (
        f"dimensions: {3 if in_space else 2}\ngravity: [0, 0{zero}]\nbodies: {{b: {{mass: 1, inertia: {'[1, 1, 1]' if in_space else '1'}}}}}\n"
        f"forces: {{f: {{type: force, i: b, force: ['{rate!r}*sin({rate!r}*t)', 0{zero}]}}}}\nrun: {{duration: 1, points: 2}}"
    )


def _oscillator(force: str, duration: float) -> str:
    return (
        "gravity: [0, 0]\nbodies: {b: {mass: 1, inertia: 1, position: [0.1, 0]}}\n"
        f"forces: {{s: {{type: force, i: b, force: ['{force}', 0]}}}}\nrun: {{duration: {duration}, points: 1001}}"
    )


def _pendulum(angle: float, duration: float) -> str:
    return (
        f"gravity: [0, -9.81]\nbodies: {{b: {{mass: 1, inertia: 1/12, position: [0.5*sin({angle}), -0.5*cos({angle})], angle: {angle}}}}}\n"
        f"joints: {{h: {{type: revolute, i: {{body: b, point: [0, 0.5]}}, j: ground}}}}\nrun: {{duration: {duration}, points: 1001}}"
    )


def _known(channel: str, value: float) -> Callable[[Solution], dict[str, float]]:
    """Return what finds the error at the end, where it is known in closed form."""
    return lambda solution: {channel: float(abs(solution[channel][-1] - value))}


def _converged(text: str) -> Callable[[Solution], dict[str, float]]:
    """Return what finds the largest errors against a run at a far smaller tolerance by another method."""

    def errors(solution: Solution) -> dict[str, float]:
        reference = run(read_scene(text), **CONVERGED)
        return {name: float(np.max(np.abs(solution[name] - reference[name]))) for name in ("b.x", "b.y", "b.angle")}

    return errors


def _judged(text: str, errors: Callable[[Solution], dict[str, float]], how: dict[str, Any], silent: bool) -> Verdict:
    """Right within a hundred tolerances; beyond them reported, and a note must be true within a factor of ten."""
    solution = run(read_scene(text), errors=True, **how)
    notes = [note for note in solution.notes if "the estimated error of" in note or "solution is lost" in note]
    found = errors(solution)
    in_tolerances = {
        name: error / (RTOL * (1.0 if name.endswith("angle") or name == "turn" else 1.0 + float(np.max(np.abs(solution[name])))))
        for name, error in found.items()
    }  # fmt: skip
    worst = max(in_tolerances.values())
    if notes and (silent or worst < TOLERANCES / 10):
        return measured(np.inf, TOLERANCES, f"a false note: {notes[0]}; the error is {worst:.2g} tolerances")
    return told(notes[0], ("rtol",)) if notes else measured(worst, TOLERANCES)


def _case(
    name: str, text: str, errors: Callable[[Solution], dict[str, float]], solver: str, expected: Outcome = Outcome.RIGHT, silent: bool = False
) -> Case:  # fmt: skip
    what = "within 100 tolerances, without a note" if silent else "within 100 tolerances, or a note"
    return Case(f"{name}, {solver}", what, partial(_judged, text, errors, SOLVERS[solver], silent), expected)


def _turned(turns: int, in_space: bool) -> Callable[[Solution], dict[str, float]]:
    return _known("turn" if in_space else "w.angle", 2 * np.pi * turns)


FORGETTING = {
    "damped vibration": _oscillator(f"{SPRING} - b.vx", 100),
    "creep to rest": _oscillator(f"{SPRING} - 100*b.vx", 500),
    "forced and damped vibration": _oscillator(f"{SPRING} - 2*b.vx + 10*sin(7*t) + 5*cos(31*t)", 300),
}
KEEPING = {"vibration": _oscillator(SPRING, 30), "small pendulum": _pendulum(0.1, 100)}
"""Motions whose period does not depend on their amplitude."""
WIDE = _pendulum(1.5, 300)

CASES = (
    *(
        _case(f"wheel, {name}{' in space' if in_space else ''}", _wheel(*wheel, in_space), _turned(wheel[1], in_space), solver, Outcome.TOLD)
        for name, wheel in WHEELS.items() for in_space in (False, True) for solver in SOLVERS
    ),
    *(
        _case(
            f"mass driven over {periods} periods{' in space' if in_space else ''}", _driven(periods, in_space), _known("b.x", 1.0), solver,
            Outcome.TOLD if solver in adding_up else Outcome.RIGHT,
        )
        for periods, adding_up in PERIODS.items() for in_space in (False, True) for solver in SOLVERS
    ),
    *(_case(name, text, _converged(text), solver, silent=True) for name, text in FORGETTING.items() for solver in SOLVERS),
    *(_case(name, text, _converged(text), solver) for name, text in KEEPING.items() for solver in SOLVERS),
    _case("wide pendulum", WIDE, _converged(WIDE), "bdf", Outcome.TOLD),
)  # fmt: skip
