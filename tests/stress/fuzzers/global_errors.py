"""Notes of runs on accumulated errors, against the differences from runs with far smaller tolerances."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from stiffmbs.solve.error_control.accumulated_errors import ACCUMULATED

from stiffmbs.analyses.job import prepare
from stiffmbs.analyses.run import run
from stiffmbs.compile.system import System
from stiffmbs.errors import StiffmbsError
from stiffmbs.model.read_scene import read_scene
from stiffmbs.run_checks.growth import accumulated_errors_sentence
from stiffmbs.solve.trajectory import Outcome as Ending

from ..case import Outcome, Verdict, told
from ..random_scenes.scene import random_scene
from . import laws

WHAT = "notes on accumulated errors of random laws and random scenes: silent errors and false notes, against smaller tolerances"
FACTOR = 3.0
"""Accuracy of the estimates (`tests/solve/test_accumulated_errors.py`): errors nearer to the threshold may be noted or not."""
SMALLER, SMALLEST = 1e-3, 1e-11
"""Tolerance of the reference as a part of that of the run, and its least value."""
LONGER = 2.0
"""Decimal logarithm of the largest factor of a random scene's duration."""


def trial(seed: int) -> Verdict:
    """Compare one run with its reference, at the output times."""
    rng = np.random.default_rng(seed)
    scene, how = _law(rng) if rng.uniform() < 0.5 else _mechanism(rng)
    try:
        job = prepare(read_scene(json.dumps(scene)), **how)
        fine = prepare(
            read_scene(json.dumps(scene)), **how | {"rtol": max(SMALLER * how["rtol"], SMALLEST)}
        ).integrate()
        found = job.integrate()
    except StiffmbsError as refusal:
        return told(f"{refusal} [{how}]", ())
    if Ending.DONE is not found.outcome or Ending.DONE is not fine.outcome:
        return told(f"{found.message} {fine.message} [{how}]", ("t = ",))
    system, rows = job.dynamics.system, min(len(found.t), len(fine.t))
    far = np.max(np.abs(_differences(system, found.q[:rows], fine.q[:rows])), axis=0)
    errors = ACCUMULATED.in_tolerances(system, job.settings, far, found.q)
    error, limit = float(np.max(errors)), ACCUMULATED.tolerances
    notes = tuple(accumulated_errors_sentence(system, job.settings, found))
    detail = f"{how}: {' '.join(notes)}"
    if notes:
        if error < limit / FACTOR:
            return Verdict(Outcome.WRONG, error, limit, f"false note {detail}")
        return Verdict(Outcome.TOLD, error, limit, detail)
    if error < FACTOR * limit:
        return Verdict(Outcome.RIGHT, error, limit, detail)
    others = [note for note in run(read_scene(json.dumps(scene)), **how).notes if "rtol" in note or "resolved" in note]
    if others:
        return Verdict(Outcome.TOLD, error, limit, "; ".join(others))
    return Verdict(Outcome.WRONG, error, limit, f"silent {detail}")


def _law(rng: np.random.Generator) -> tuple[dict[str, Any], dict[str, Any]]:
    drawn = laws.drawn(rng)
    return drawn.scene, drawn.how | {"duration": drawn.duration, "points": 11}


def _mechanism(rng: np.random.Generator) -> tuple[dict[str, Any], dict[str, Any]]:
    how = laws.SOLVERS[rng.integers(len(laws.SOLVERS))] | {"rtol": float(10.0 ** -rng.integers(3, 8))}
    scene = random_scene(rng)
    return scene, how | {"duration": float(10.0 ** rng.uniform(0, LONGER)) * scene["run"]["duration"]}


def _differences(system: System, q: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return displacements along the velocities from one motion to another, shape (rows, n_u); rotations in body axes."""
    kind, bodies = system.of_body, len(system.bodies)
    a, b = (each[:, : system.n_pose].reshape(len(q), bodies, kind.n_q) for each in (q, other))
    linear, turned = b[..., : kind.linear] - a[..., : kind.linear], b[..., kind.linear :] - a[..., kind.linear :]
    if kind.dimensions == 3:
        p, r = a[..., kind.linear :], b[..., kind.linear :]
        vector = p[..., :1] * r[..., 1:] - r[..., :1] * p[..., 1:] - np.cross(p[..., 1:], r[..., 1:])
        turned = 2.0 * vector * np.sign(np.sum(p * r, axis=-1, keepdims=True))
    return np.concatenate([linear, turned], axis=-1).reshape(len(q), -1)
