"""Time that runs backward is no run: it is refused; motion thrown back retraces itself."""

from __future__ import annotations

from functools import partial
from typing import Literal

import numpy as np

from stiffmbs.analyses.run import run
from stiffmbs.model.model import Model

from ...case import Case, Verdict, measured
from ...mechanisms.double_pendulum import double_pendulum
from ...simulation import refusal


def _retraced(solver: Literal["bdf", "projected"]) -> Verdict:
    """A double pendulum solved for 2 s, its velocities turned round, and solved for 2 s again: it is where it began."""
    model = double_pendulum()
    there = run(model, duration=2.0, points=2, rtol=1e-10, solver=solver)
    back = run(_thrown_back(model, there), duration=2.0, points=2, rtol=1e-10, solver=solver)
    error = max(float(np.abs(back[f"{name}.angle"][-1])) for name in ("inner", "outer"))
    return measured(error, 1e-6, f"{there.solver['steps'] + back.solver['steps']} steps")


def _thrown_back(model: Model, end) -> Model:
    turned = double_pendulum()
    for name, body in model.bodies.items():
        last = {channel: float(end[f"{name}.{channel}"][-1]) for channel in ("x", "y", "angle", "vx", "vy", "omega")}
        turned.bodies[name] = body.model_copy(
            update={
                "position": (last["x"], last["y"]), "angle": last["angle"],
                "velocity": (-last["vx"], -last["vy"]), "omega": -last["omega"],
            }
        )  # fmt: skip
    return turned


CASES = (
    refusal("a duration below zero", "-1 s", double_pendulum, ("duration", "-1"), duration=-1.0),
    refusal("an output spacing below zero", "-0.1 s", double_pendulum, ("output", "-0.1"), output=-0.1),
    *(
        Case(f"there and back, {solver}", "angles against those of the start", partial(_retraced, solver))
        for solver in ("bdf", "projected")
    ),
)
