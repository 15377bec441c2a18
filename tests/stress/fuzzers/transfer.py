"""Compare random transfer functions with starts under a load, and with starts from perturbed states."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from stiffmbs.analyses.linearised.modes import modes
from stiffmbs.analyses.linearised.transfer import transfer
from stiffmbs.analyses.run import run
from stiffmbs.compile.bodies import BODY_KINDS
from stiffmbs.elements.element import Force
from stiffmbs.elements.planar_kinds import FORCES
from stiffmbs.elements.spatial.orientation import conjugate, matrix, product
from stiffmbs.elements.spatial.spatial_kinds import FORCES as SPATIAL_FORCES
from stiffmbs.errors import StiffmbsError
from stiffmbs.linear_analysis.state_space import StateMatrix
from stiffmbs.linear_analysis.transfer import Transfer
from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene
from stiffmbs.results.saved_state import SavedState

from ..case import Outcome, Verdict, measured
from ..random_scenes.features import SMOOTH
from ..random_scenes.scene import random_scene

WHAT = (
    "Transfer functions of random scenes in motion: columns against starts under a load, rows against perturbed starts."
)
INPUTS, OUTPUTS = 2, 6
BESIDE = 1e-5, 1e-4
"""Variations of velocities and poses, SI units: the first, and one for outputs that rounding governs."""
ALLOWED = 3e-5
"""Allowed error relative to the largest entry of a kind, or to 1."""


def trial(seed: int) -> Verdict:
    """Test one random scene in motion, with random inputs and outputs."""
    rng = np.random.default_rng(seed)
    content = random_scene(rng, features=replace(SMOOTH, time=False, states=bool(rng.random() < 0.4)))
    scene = read_scene(json.dumps(content))
    try:
        state = modes(scene).state
        before = _start(scene)
        start = before.channels
        inputs = _inputs(rng, scene)
        outputs = [str(name) for name in rng.choice(sorted(set(start) - _over_time(start)), OUTPUTS)]
        found = transfer(scene, list(inputs), outputs)
        errors = {
            "columns": _columns(found, state, inputs, scene, start), "rows": _rows(rng, found, state, scene, before),
        }  # fmt: skip
    except StiffmbsError as refusal:
        return Verdict(Outcome.TOLD, detail=str(refusal))
    worst = max(errors, key=lambda name: errors[name])
    return measured(errors[worst], ALLOWED, f"{worst}; {', '.join(inputs)} to {', '.join(outputs)}")


def _start(scene: Scene, state: SavedState | None = None) -> SavedState:
    """Return the channels at the start of a run."""
    return run(scene, start_from=state, duration=1e-6, points=2, solver="bdf", rtol=1e-6).state(at=0.0)


def _over_time(start: Mapping[str, float]) -> set[str]:
    """Return the channels that are not functions of the state."""
    return {name for name in start if name.startswith(("energy.", "constraint."))}


def _inputs(rng: np.random.Generator, scene: Scene) -> dict[str, Force]:
    """Return random loads by name, each as an element with a unit load."""
    in_space = scene.dimensions == 3
    labels, kinds = BODY_KINDS[scene.dimensions].reactions, SPATIAL_FORCES if in_space else FORCES
    found: dict[str, Force] = {}
    for _ in range(INPUTS):
        body, k = str(rng.choice(list(scene.bodies))), int(rng.integers(len(labels)))
        marker: dict[str, Any] = {"body": body}
        if in_space:
            marker["point"] = scene.bodies[body].center_of_mass
        unit = [float(k % 3 == axis) for axis in range(scene.dimensions)]
        name = f"{body}.{labels[k]}"
        if k < scene.dimensions:
            found[name] = kinds["force"](i=marker, force=unit)
        else:
            found[name] = kinds["torque"](i=marker, torque=unit if in_space else 1.0)
    return found


def _columns(
    found: Transfer, state: StateMatrix, inputs: Mapping[str, Force], scene: Scene, start: Mapping[str, float]
) -> float:
    """Compare D with differences of starts under a load, and B with their accelerations."""
    worst, labels = 0.0, BODY_KINDS[scene.dimensions].accelerations[: scene.dimensions]
    for column, element in enumerate(inputs.values()):
        loaded = _start(scene.model_copy(update={"forces": {**scene.forces, "load_of_input": element}})).channels
        through = np.array([loaded[name] - start[name] for name in found.outputs])
        linear = (state.velocities @ found.b[:, column]).reshape(len(scene.bodies), -1)[:, : scene.dimensions]
        got = [[loaded[f"{body}.{axis}"] - start[f"{body}.{axis}"] for axis in labels] for body in scene.bodies]
        worst = max(worst, _off(through, found.d[:, column]), _off(np.array(got), linear))
    return worst


def _rows(rng: np.random.Generator, found: Transfer, state: StateMatrix, scene: Scene, before: SavedState) -> float:
    """Compare C with differences of starts from perturbed states, after assembly."""
    labels = (*"xyz"[: scene.dimensions], *BODY_KINDS[scene.dimensions].velocities)
    change = {f"{body}.{label}": float(rng.standard_normal()) for body in scene.bodies for label in labels}
    off, again = (_beside(size, change, found, state, scene, before) for size in BESIDE)
    return 0.0 if off is None else off if again is None else min(off, again)


def _beside(
    size: float, change: Mapping[str, float], found: Transfer, state: StateMatrix, scene: Scene, before: SavedState
) -> float | None:
    """Compare C with the difference of two starts, from states that differ from the given one by a size; None where states do not
    follow from poses and velocities."""
    sides = []
    for sign in (-size, size):
        channels = {name: value + sign * change.get(name, 0.0) for name, value in before.channels.items()}
        sides.append(_start(scene, replace(before, channels=channels)).channels)
    x, v = _variation(scene, sides, before.channels)
    own = np.array([sides[1][name] - sides[0][name] for name in scene.state_values()])
    known = np.concatenate([x, v])
    z = np.linalg.lstsq(np.vstack([state.poses, state.velocities]), known, rcond=1e-12)[0]
    left = float(np.abs(np.vstack([state.poses, state.velocities]) @ z - known).max())
    if own.any() or state.n_states or left > ALLOWED * size:
        return None
    changed = np.array([sides[1][name] - sides[0][name] for name in found.outputs])
    return _off(changed / size, found.c @ z / size)


def _variation(
    scene: Scene, sides: Sequence[Mapping[str, float]], start: Mapping[str, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Return the difference of two states as displacements and rotations in ground axes, and their rates."""
    of_body, x, v = BODY_KINDS[scene.dimensions], [], []
    for body in scene.bodies:
        (q, u), (other, faster) = (
            [
                np.array([side[f"{body}.{label}"] for label in labels])
                for labels in (of_body.positions, of_body.velocities)
            ]
            for side in sides
        )
        if scene.dimensions == 2:
            x.append(other - q)
            v.append(faster - u)
            continue
        turned = 2 * np.asarray(product(other[3:].tolist(), conjugate(q[3:].tolist())))[1:]
        axes = matrix([start[f"{body}.q{k}"] for k in range(4)])
        x.append(np.concatenate([other[:3] - q[:3], turned]))
        v.append(np.concatenate([faster[:3] - u[:3], axes @ (faster[3:] - u[3:])]))
    return np.concatenate(x), np.concatenate(v)


def _off(got: np.ndarray, expected: np.ndarray) -> float:
    return float(np.max(np.abs(got - expected)) / max(1.0, float(np.max(np.abs(expected)))))
