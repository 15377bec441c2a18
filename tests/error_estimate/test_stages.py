"""Bars of runs in stages."""

import numpy as np

import stiffmbs
from tests.error_estimate.test_against_truth import PENDULUM


def test_stages_keep_bars():
    """They were dropped where the results of stages were joined."""
    scene = PENDULUM.format(duration=8).replace("run:", "unused:").replace("unused: {duration: 8, points: 101}", "")
    stages = (
        "stages: [{run: {duration: 1, points: 11}}, {run: {duration: 7, points: 71, solver: projected, rtol: 1e-4}}]"
    )
    found = stiffmbs.run(stiffmbs.read_scene(scene + stages))
    parts = [stiffmbs.run(stiffmbs.read_scene(PENDULUM.format(duration=1)), points=11)]
    parts.append(
        stiffmbs.run(
            stiffmbs.read_scene(PENDULUM.format(duration=7)),
            start_from=parts[0],
            points=71,
            solver="projected",
            rtol=1e-4,
        )
    )
    assert found.estimate.status == "estimated" and "of each run alone" in found.estimate.sentence
    for name in ("bob.x", "bob.angle", "pin.fy"):
        assert np.isclose(found.errors[name].over_time, max(part.errors[name].over_time for part in parts), rtol=0.1)
