"""Random inputs over time, as forces on a free mass and as drives, against quadrature of the input."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from stiffmbs.analyses.run import run
from stiffmbs.errors import StiffmbsError
from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene
from stiffmbs.solve.trajectory import Outcome as Ending

from ..case import Outcome, Verdict, measured, told
from ..made_up_inputs import END, Made, made_up

WHAT = "Random inputs over time (tables under any argument, pulses, steps, products) against quadrature of the input."
POINTS = 21
"""Output points."""
MISSED = 3e-4
"""Error of momentum and way relative to the input's, from which on a feature counts as missed."""
GLOBAL = 300.0
"""Global error, relative to the tolerance, that steps may add up to."""
IMPULSE = 10.0
"""Of the absolute value of each input, N s: absolute tolerances then do not matter."""
NO_IMPULSE = 1e-9
"""Impulse, N s, of inputs of the size of 1 N that vanish but for rounding."""
DRIVE_ROUNDING = 1e-15
"""Of a drive, m: differences of numbers of the size of 1, as tanh(z) - tanh(z - 3) far from its rise."""
UNSEEN = 0.1
"""Part of a drive's change by which its peak may exceed what output points show without a word."""


def trial(seed: int) -> Verdict:
    """One random input, three of four times as a force, else as a drive."""
    rng = np.random.default_rng(seed)
    return _driven(rng) if rng.uniform() < 0.25 else _pushed(rng)


def _scene(text: str, made: Made, **of_body: Any) -> Scene:
    scene = {"gravity": [0, 0], "parameters": made.parameters, "bodies": {"b": {"mass": 1, "inertia": 1}}, **of_body}
    if made.tables:
        scene["tables"] = made.tables
    return read_scene(json.dumps(scene), source=f"'{text}'")


def _given(made: Made) -> str:
    return f"with {json.dumps(made.parameters)} and {json.dumps(made.tables)[:200]}"


def _pushed(rng: np.random.Generator) -> Verdict:
    """A force on 1 kg at rest: momentum and way at output points are integrals of the force."""
    made = made_up(rng)
    impulse = made.quadrature(0)[2]
    if impulse < NO_IMPULSE:
        return measured(0.0, MISSED, f"an input that is zero: {made.text}")
    size = IMPULSE / impulse
    made.parameters["size"] = size
    text = f"size*({made.text})"
    solver = str(rng.choice(["bdf", "radau", "auto", "dop853", "dopri5"]))
    how: dict[str, Any] = {"solver": "projected", "scheme": solver} if solver.startswith("dop") else {"solver": solver}
    rtol = float(10.0 ** rng.integers(-9, -4))
    detail = f"{solver}, rtol {rtol:.0e}: {text} {_given(made)}"
    forces = {"f": {"type": "force", "i": "b", "force": [text, 0]}}
    try:
        solution = run(_scene(text, made, forces=forces), duration=END, points=POINTS, rtol=rtol, **how)
    except StiffmbsError as refusal:
        return told(f"{refusal} [{detail}]", ())
    if solution.outcome is not Ending.DONE:
        return told(f"{solution.message} [{detail}]", ("t = ",))
    momentum, way, whole = made.quadrature(POINTS)
    v_error = np.max(np.abs(solution["b.vx"] - size * momentum)) / (size * whole)
    x_error = np.max(np.abs(solution["b.x"] - size * way)) / (size * whole * END)
    return measured(float(max(v_error, x_error)), MISSED + GLOBAL * rtol, f"{solution.solver['steps']} steps, {detail}")


def _driven(rng: np.random.Generator) -> Verdict:
    """A drive in a kinematic run: right at output points, and peaks between them are told."""
    made = made_up(rng, continuous=True)
    detail = f"kinematic: {made.text} {_given(made)}"
    joints = {
        "rail": {"type": "prismatic", "i": "b", "j": "ground"},
        "motor": {"type": "drive", "joint": "rail", "position": made.text},
    }
    try:
        solution = run(_scene(made.text, made, joints=joints), duration=END, points=POINTS, solver="kinematic")
    except StiffmbsError as refusal:
        return told(f"{refusal} [{detail}]", ())
    if solution.outcome is not Ending.DONE:
        return told(f"{solution.message} [{detail}]", ("t = ",))
    x = solution["b.x"]
    expected, everywhere = made.of(solution.time), made.of(made.mesh())
    change = float(np.ptp(everywhere))
    error = float(np.max(np.abs(x - expected))) / max(change, 1e-300)
    unseen = max(np.max(everywhere) - np.max(x), np.min(x) - np.min(everywhere)) - DRIVE_ROUNDING
    if unseen > UNSEEN * change and not any("between output times" in note for note in solution.notes):
        return Verdict(Outcome.WRONG, unseen / change, UNSEEN, f"a peak between output points is not told: {detail}")
    return measured(error, 1e-6 + DRIVE_ROUNDING / max(change, 1e-300), detail)
