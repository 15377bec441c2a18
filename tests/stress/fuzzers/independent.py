"""Compare starts in motion, modes and frequency responses of random scenes with independent equations of motion."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from stiffmbs.analyses.equilibrium import equilibrium
from stiffmbs.analyses.linearised.modes import modes
from stiffmbs.analyses.linearised.transfer import transfer
from stiffmbs.analyses.run import run
from stiffmbs.compile.bodies import BODY_KINDS
from stiffmbs.errors import StiffmbsError
from stiffmbs.linear_analysis.modes import Mode
from stiffmbs.model.read_scene import read_scene
from tests.oracle.elements import State
from tests.oracle.linear import linear
from tests.oracle.scenes import FEATURES, FORCES, random_content
from tests.oracle.system import System

from ..case import Outcome, Verdict, measured
from ..random_scenes import forces

WHAT = "channels at starts in motion, and modes and frequency responses about equilibria, against equations of motion in NumPy alone"
IN_REST = replace(FEATURES, time=False, velocities=False)
HELD = (*FORCES, *(forces.add_bushing,) * 4)
"""Elements of scenes at rest: mostly bushings, so that there are equilibria."""
ALLOWED = 1e-6
"""Allowed relative error of channels, 1 in SI units at the least."""
ALLOWED_LINEAR = 1e-4
"""Allowed error of eigenvalues and responses, relative to each."""
NOISE = 1e-4
"""Smallest size of a response, relative to the largest one, and 1e-6 in SI units."""
CANCELLED = 1e-5
"""Smallest size of a response, relative to its terms: the derivatives of outputs by the state are differences."""
REACTION = 1e-4
"""Smallest size of a reaction to a unit load: components that cancel are rounding, amplified by differences."""
POLYNOMIAL = 1e-9
"""Allowed error of the characteristic polynomial, where multiple eigenvalues make single ones uncertain."""
TURNED = 2.5
"""Rotation from the described pose, rad, above which the whole turns of an angle are not known here."""
OUTPUTS, INPUTS, FREQUENCIES = 8, 2, 4


def trial(seed: int) -> Verdict:
    """Test one scene: every second one in motion, otherwise about its equilibrium."""
    rng = np.random.default_rng(seed)
    try:
        return _in_motion(rng) if seed % 2 else _at_rest(rng)
    except StiffmbsError as refusal:
        return Verdict(Outcome.TOLD, detail=str(refusal))


def _in_motion(rng: np.random.Generator) -> Verdict:
    """Compare all channels at the start, with accelerations and reactions."""
    content = random_content(rng, FEATURES)
    found = run(read_scene(json.dumps(content)), duration=1e-6, points=2, solver="bdf", rtol=1e-6, presolve=False)
    channels = {name: float(found[name][0]) for name in found}
    system = System(content)
    expected = system.channels(system.state_of(channels), 0.0)
    errors = {
        name: abs(channels[name] - value) / max(1.0, abs(value))
        for name, value in expected.items()
        if name in channels and name not in found.not_unique
    }
    worst = max(errors, key=lambda name: errors[name])
    return measured(errors[worst], ALLOWED, f"{worst} = {channels[worst]:.9g} of {expected[worst]:.9g}")


def _at_rest(rng: np.random.Generator) -> Verdict:
    """Compare eigenvalues, and responses of random channels to random loads."""
    content = random_content(rng, IN_REST, forces_of=HELD)
    scene = read_scene(json.dumps(content))
    rest = equilibrium(scene)
    system = System(content)
    state = system.settled(system.state_of(rest.channels))
    if _turned(system, state) > TURNED:
        return Verdict(Outcome.TOLD, detail="the equilibrium is more than half a turn away")
    imbalance = float(np.abs(system.motion(state, 0.0).a).max())
    if imbalance > ALLOWED:
        return Verdict(Outcome.WRONG, imbalance, ALLOWED, "accelerations at an equilibrium")
    known = [
        name for name in system.channels(state, 0.0) if name in rest.channels and name not in rest.solution.not_unique
    ]
    outputs = [str(name) for name in rng.choice(known, min(OUTPUTS, len(known)), replace=False)]
    loads = _loads(rng, system)
    expected = linear(system, state, 0.0, list(loads.values()), outputs)
    frequencies = 10 ** rng.uniform(-1, 1.5, FREQUENCIES)
    off = _off_eigenvalues(np.linalg.eigvals(expected.a), modes(scene, start_from=rest.solution).modes)
    found = transfer(scene, list(loads), outputs, start_from=rest.solution).response(frequencies)
    exact = expected.response(frequencies)
    reactions = np.array([REACTION * (name.partition(".")[0] in content.get("joints", {})) for name in outputs])
    error = _off_responses(found, exact, np.maximum(CANCELLED * expected.terms(frequencies), reactions[:, None]))
    return measured(
        max(off, error),
        ALLOWED_LINEAR,
        f"eigenvalues {off:.1e}; {', '.join(loads)} to {', '.join(outputs)} {error:.1e}",
    )


def _turned(system: System, state: State) -> float:
    """Return the largest rotation of a body from its described pose, rad."""
    traces = [np.trace(before.T @ after) for before, after in zip(system.start.poses.A, state.poses.A, strict=True)]
    return float(np.arccos(np.clip((np.array(traces) - 1) / 2, -1, 1)).max())


def _loads(rng: np.random.Generator, system: System) -> dict[str, Any]:
    labels = BODY_KINDS[3 if system.in_space else 2].reactions
    places = range(6) if system.in_space else (0, 1, 5)
    found = {}
    for _ in range(INPUTS):
        body, k = int(rng.integers(system.n)), int(rng.integers(len(labels)))
        load = np.zeros((system.n + 1, 6))
        load[body, places[k]] = 1.0
        found[f"{system.names[body]}.{labels[k]}"] = load
    return found


def _off_eigenvalues(expected: np.ndarray, found: tuple[Mode, ...]) -> float:
    """Return the largest relative error of the eigenvalues, or infinity if their number differs."""
    values = np.array([value for mode in found for value in mode.eigenvalues])
    if len(values) != len(expected):
        return np.inf
    if not len(values):
        return 0.0
    largest = max(float(np.abs(expected).max()), 1.0)
    if np.abs(np.poly(values / largest) - np.poly(expected / largest)).max() < POLYNOMIAL:
        return 0.0
    apart = np.abs(expected[:, None] - values)
    one, other = linear_sum_assignment(apart)
    return float((apart[one, other] / np.maximum(np.abs(expected[one]), 1e-3 * largest)).max())


def _off_responses(found: np.ndarray, expected: np.ndarray, rounding: np.ndarray) -> float:
    sizes = np.abs(expected)
    of_output = sizes.max(axis=(0, 2), initial=0.0)[:, None]
    least = np.maximum(1e-3 * of_output, 1e-6 + NOISE * sizes.max(initial=0.0))
    least = np.maximum(least, rounding.max(axis=0))
    return float(np.max(np.abs(found - expected).max(axis=0) / np.maximum(sizes.max(axis=0), least), initial=0.0))
