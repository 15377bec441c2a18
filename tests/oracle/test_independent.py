"""Starts in motion, modes and responses of random scenes by independent equations of motion, and derivatives of their runs."""

import json
from dataclasses import replace

import numpy as np
import pytest

import stiffmbs
from stiffmbs.model.read_scene import read_scene
from stiffmbs.solve.settings import changed as changed_settings
from stiffmbs.studies.sensitivities.parameters import Scenes
from stiffmbs.studies.sensitivities.sensitivities import differentiated
from tests.stress.case import Outcome
from tests.stress.fuzzers import independent
from tests.stress.fuzzers.sensitivities import changed, numbers_of

from . import system as own
from .scenes import FEATURES, random_content
from .system import System

END = 0.15
"""Duration of runs whose results are differentiated, s."""


@pytest.mark.long
@pytest.mark.sampled(4)
@pytest.mark.parametrize("seed", [2, 1, 5, 8])
def test_a_random_scene_has_the_accelerations_modes_and_responses_of_independent_equations(seed):
    verdict = independent.trial(seed)
    assert verdict.outcome is Outcome.RIGHT, verdict


@pytest.mark.long
@pytest.mark.parametrize("first", range(100, 180, 10))
@pytest.mark.sampled(17)
def test_eighty_random_scenes(first):
    verdicts = {seed: independent.trial(seed) for seed in range(first, first + 10)}
    assert {seed: v for seed, v in verdicts.items() if v.outcome is Outcome.WRONG} == {}
    assert sum(v.outcome is Outcome.RIGHT for v in verdicts.values()) > 3


@pytest.mark.sampled(2)
@pytest.mark.parametrize("seed", [3, 4])
def test_the_comparison_can_fail(seed, monkeypatch):
    """Other gravity and inertia by 1e-3 are seen."""
    made = System._bodies

    def heavier(self):
        made(self)
        self.inertia = [1.001 * tensor for tensor in self.inertia]
        self.gravity = self.gravity * 1.001

    monkeypatch.setattr(own.System, "_bodies", heavier)
    assert independent.trial(seed).outcome is not Outcome.RIGHT


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("solver", ["bdf", "radau"])
@pytest.mark.parametrize("seed", [0, 1, 2, 5])
def test_a_derivative_of_a_final_channel_is_that_of_independent_runs(seed, solver):
    rng = np.random.default_rng(seed)
    content = random_content(rng, replace(FEATURES, loops=seed % 2 == 0, redundant=False))
    content["run"]["duration"] = END
    paths = [path for path in numbers_of(content) if "run" not in path and "orientation" not in path]
    path = paths[rng.integers(len(paths))]
    value = content
    for key in path:
        value = value[key]

    def final(number):
        changed_content = changed(content, path, number)
        known = stiffmbs.run(
            read_scene(json.dumps(changed_content)), duration=1e-6, points=2, rtol=1e-6, presolve=False
        )
        system = System(changed_content)
        start = system.state_of({name: float(known[name][0]) for name in known})
        return system.channels(system.run(start, 0.0, np.array([END]))[-1], END), known.not_unique

    expected, not_unique = final(value)
    step = 1e-3 * max(abs(value), 0.05)
    near, far = (
        {name: (more - less) / (2 * k * step) for (name, more), less in zip(up.items(), down.values(), strict=True)}
        for k in (1, 2)
        for (up, _), (down, _) in [(final(value + k * step), final(value - k * step))]
    )
    name = ".".join(map(str, path))
    outputs = [
        k for k in expected if k.partition(".")[2] in ("x", "y", "vx", "vy", "ax", "ay", "fx") and k not in not_unique
    ]
    scenes = Scenes.of_model(read_scene(json.dumps(content)))
    settings = changed_settings(scenes.known.run, {"solver": solver})
    found = differentiated(scenes, [name], settings).sensitivities([f"final({output})" for output in outputs])
    for output, one in zip(outputs, found, strict=True):
        slope = (4 * near[output] - far[output]) / 3
        assert one.value == pytest.approx(expected[output], rel=1e-6, abs=1e-6)
        allowed = 1e-4 * abs(slope) + abs(near[output] - far[output]) + 1e-8 / step
        assert one.to[name] == pytest.approx(slope, abs=allowed), (name, output)
