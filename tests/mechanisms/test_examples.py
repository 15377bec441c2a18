"""Every scene in the examples runs, and shows what it is about."""

import numpy as np
import pytest

import stiffmbs

from ..conftest import EXAMPLE_SCENES, EXAMPLES

OVERCONSTRAINED = ("bricard", "door")
LONG = ("bushing_axle", "formula_student", "hatchback", "leaf_sprung_car", "motorcycle", "quarter_car", "truck")
"""Their kinds take seconds to compile; `car` and `front_axle` stand for them."""


@pytest.mark.parametrize(
    "path",
    [pytest.param(path, marks=pytest.mark.long if path.stem in LONG else ()) for path in EXAMPLE_SCENES.values()],
    ids=lambda path: path.stem,
)
def test_scene_runs_and_has_what_its_figure_shows(path):
    scene = stiffmbs.load_scene(path)
    solution = stiffmbs.run(scene, duration=min(scene.run.duration, 0.2))
    assert solution.outcome.name == "DONE", solution.message
    assert (solution.not_unique != ()) == (path.stem in OVERCONSTRAINED)
    if scene.figure:
        shown = (*scene.figure.y, *([] if scene.figure.x == "time" else [scene.figure.x]))
        for channel in (*shown, *([scene.figure.z] if scene.figure.z else [])):
            assert np.all(np.isfinite(solution[channel]))


@pytest.fixture(scope="module")
def solved():
    return lambda name, *changes, **settings: stiffmbs.run(
        stiffmbs.load_scene(EXAMPLES / f"{name}.yaml", list(changes)), **settings
    )


def test_a_bouncing_ball_keeps_its_time_of_flight(solved):
    """Between impacts the ball falls freely: from its top to the floor in sqrt(2 h / g)."""
    solution = solved("bouncing_ball", rtol=1e-9)
    height = solution["ball.y"] - 0.05
    first_top = np.max(height[(solution.time > 0.5) & (solution.time < 1.1)])
    closed = solution.time[solution["floor.fy"] > 0]
    impacts = closed[np.concatenate([[True], np.diff(closed) > 0.05])]
    assert impacts[0] == pytest.approx(np.sqrt(2 * 1.0 / 9.81), abs=2e-3)
    assert impacts[1] - impacts[0] == pytest.approx(2 * np.sqrt(2 * first_top / 9.81), abs=8e-3)


def test_the_integrator_shortens_its_step_through_an_impact_and_lengthens_it_again(solved):
    """GSTIFF's habit, read from the history of steps and orders."""
    solution = solved("bouncing_ball")
    steps = np.diff(np.concatenate([[0.0], solution.step_times]))
    ends = solution.step_times
    impact = np.sqrt(2 * 1.0 / 9.81)
    before = steps[ends < impact - 0.01].max()
    during = steps[(ends > impact) & (ends < impact + 2e-3)].max()
    after = steps[(ends > impact + 0.1) & (ends < impact + 0.6)].max()
    assert during < before / 20
    assert after > 20 * during
    assert len(solution.history.order) == len(ends)
    assert solution.history.order.max() >= 2


def test_a_block_sticks_and_slips(solved):
    """While it sticks it has the belt's speed; it slips when the spring pulls with static friction."""
    solution = solved("stick_slip", rtol=1e-7)
    speed = solution["block.vx"]
    sticking = np.abs(speed - 0.1) < 2e-3
    assert 0.4 < np.mean(sticking[solution.time > 1]) < 0.9
    assert speed.min() < -0.05
    assert solution["block.x"].max() == pytest.approx(0.4 * 9.81 / 100, rel=0.2)


def test_a_follower_lifts_off_only_when_the_cam_is_fast(solved):
    fast, slow = solved("cam_follower"), solved("cam_follower", ("rate", "20 rad/s"))
    assert fast["gap"].max() > 1e-4
    assert slow["gap"].max() < 1e-6
    assert slow["touch.fy"][1:].max() < 0  # at the start they touch without force


def test_a_crank_is_carried_through_its_dead_centres(solved):
    solution = solved("dead_centres")
    turns = (solution["crank.angle"][-1] - solution["crank.angle"][0]) / (2 * np.pi)
    assert turns > 3
    assert solution.energy_drift() < 1e-4 * solution["energy.total"][0]


def test_hoekens_tip_runs_nearly_straight_for_half_a_turn(solved):
    solution = solved("four_bar")
    x, y = solution["tip_x"], solution["tip_y"]
    straight = y < 0.404
    assert 0.45 < np.mean(straight) < 0.75
    assert np.ptp(x[straight]) > 0.3


def test_figures_are_drawn(solved, tmp_path):
    pytest.importorskip("matplotlib")
    from click.testing import CliRunner

    from stiffmbs.commands.main import main

    path = tmp_path / "figure.png"
    arguments = ["run", str(EXAMPLES / "four_bar.yaml"), "--figure", str(path), "--json"]
    assert CliRunner().invoke(main, arguments).exit_code == 0
    assert path.read_bytes()[:4] == b"\x89PNG"
    for wrong in ("figure.xyz", "nowhere/figure.png"):
        arguments[3] = str(tmp_path / wrong)
        assert CliRunner().invoke(main, arguments).exit_code == 2
