"""Without SUNDIALS' own libraries IDA runs through scikit-sundae's callbacks, says so, and gives the same motion."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.solve import integrator


@pytest.fixture
def without_libraries(monkeypatch):
    monkeypatch.setattr(integrator, "available", lambda: (False, "found SUNDIALS 6, expected 7"))


@pytest.mark.parametrize("name", ["cart_pendulum", "bouncing_ball", "half_car", "dead_centres"])
def test_both_ways_give_the_same_motion(examples, name, request):
    scene = stiffmbs.load_scene(examples / f"{name}.yaml")
    native = stiffmbs.run(scene, duration=1.0, points=51, rtol=1e-9)
    request.getfixturevalue("without_libraries")
    slower = stiffmbs.run(scene, duration=1.0, points=51, rtol=1e-9)
    assert any("found SUNDIALS 6, expected 7" in note for note in slower.notes)
    assert not any("callbacks" in note for note in native.notes)
    assert (slower.solver["events"], slower.solver["breakpoints"]) == (
        native.solver["events"],
        native.solver["breakpoints"],
    )
    for channel in slower:
        if channel.endswith((".x", ".y", ".angle")):
            np.testing.assert_allclose(slower[channel], native[channel], atol=2e-6)


def test_own_steps_and_early_stops_work_there_too(examples, without_libraries):
    scene = stiffmbs.load_scene(examples / "four_bars.yaml")
    steps = stiffmbs.run(scene, points="steps", duration=0.5)
    assert len(steps.time) == steps.solver["steps"] + 1
    stopped = stiffmbs.run(scene, rtol=1e-10, formulation="SI2_exact", points=101)
    assert stopped.outcome.name == "STOPPED"
    assert "t = 0.71" in stopped.message


def test_interruption_keeps_the_rows_of_an_unfinished_block(examples, without_libraries, monkeypatch):
    """Output times are handed over by twenties; an interruption in the middle of one loses none of them."""
    from stiffmbs.solve.ida.sundae import SundaeEngine

    init = SundaeEngine.__init__

    def interrupted(self, *arguments):
        init(self, *arguments)
        step, self._ida = self._ida.step, type("Interrupted", (), {"init_step": self._ida.init_step})()

        def until_half_a_second(t, **options):
            if t > 0.505:
                raise KeyboardInterrupt
            return step(t, **options)

        self._ida.step = until_half_a_second

    monkeypatch.setattr(SundaeEngine, "__init__", interrupted)
    scene = stiffmbs.load_scene(examples / "cart_pendulum.yaml")
    solution = stiffmbs.run(scene, duration=1.0, points=101)
    assert solution.outcome.name == "INTERRUPTED"
    np.testing.assert_allclose(solution.time, np.arange(51) / 100, atol=1e-12)
