"""Verified runs: bars hold the true error, and what is in doubt is said."""

import itertools
import json
import time
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs import Body, Marker, Model, Prismatic, SpringDamper
from stiffmbs.analyses import rerun
from stiffmbs.commands.main import main
from stiffmbs.results.error_bars import between, error_bar
from stiffmbs.show.force_table import with_bar
from tests.bench.error_bars import PROBLEMS, measured

from ..conftest import EXAMPLE_SCENES, EXAMPLES

TOLERANCES = (1e-4, 1e-6, 1e-8)
AROUND = (0.7, 1.0, 1.4)
"""Times each of them, where runs at neighbouring tolerances scatter."""
NEARLY_ALL, SMALLEST = 0.98, 0.3
"""A peak in a thousand may be outside, as two runs have its error by accident: one of the 83 of a half car at times."""
IN_DOUBT = {
    "cam_follower": ("error bars of peaks",), "chain": ("between the output",),
    "car": ("use a smaller output",),
    "robot_arm": ("use a smaller output",),
}  # fmt: skip
"""Examples that are no clean scenes: impacts that magnify all errors, whips, elastic vibrations and small parts on
bushings between output instants."""


def oscillator():
    model = Model()
    body = model.add("block", Body(mass=2, inertia=0.1, position=(1.3, 0)))
    model.add("rail", Prismatic(i="block", j="ground"))
    model.add(
        "spring", SpringDamper(i=body.at(0, 0), j=Marker(body="ground", point=(-1, 0)), stiffness=50, free_length=2)
    )
    return model


def example(name, *changes):
    return stiffmbs.load_scene(EXAMPLES / f"{name}.yaml", list(changes))


@pytest.mark.sampled(8)
@pytest.mark.long
@pytest.mark.parametrize(
    "problem", ["cart_pendulum", "half_car", "heavy_top", "spatial_slider_crank", "rolling_disc", "stick_slip"]
)
def test_bars_hold_the_true_error_and_are_not_far_from_it(problem):
    """Half of the runs have bars of less than 6 errors for half of their peaks.

    Not each of them: where friction sticks and slips, slips of two runs may be nearer to each other than to the truth by
    luck.  dop853 on stick_slip at rtol 0.7e-4 to 1.4e-4 has medians between 2.4 and 3300, bdf 2.0, so more runs are made of it.
    """
    medians = []
    factors = AROUND if problem == "stick_slip" else (1.0,)
    for solver, rtol, found in measured(PROBLEMS[problem], [k * rtol for rtol in TOLERANCES for k in factors]):
        for parts in (found.reported, found.peaks, found.over_time):
            assert np.mean(parts >= 1) >= NEARLY_ALL, (solver, rtol)
            assert parts.min() > SMALLEST, (solver, rtol)
        medians.append(np.median(found.reported))
    assert np.median(medians) < 6


@pytest.mark.long
@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_peaks_of_an_oscillator_lie_within_their_bars(solver):
    """1 m +- 0.3 m at 5 rad/s: every peak is known in closed form."""
    half = {"block.x": (1.3, 0.7), "block.vx": (1.5, -1.5), "block.ax": (7.5, -7.5), "energy.kinetic": (2.25, 0.0)}
    for rtol in TOLERANCES:
        found = stiffmbs.verify(oscillator(), duration=5.0, solver=solver, rtol=rtol, points=601)
        for name, (greatest, least) in half.items():
            bar = found.errors[name]
            assert abs(found[name].max() - greatest) <= bar.greatest + 1e-14
            assert abs(found[name].min() - least) <= bar.least + 1e-14


def test_a_peak_that_two_runs_have_alike_by_accident_is_judged_by_a_third():
    """The errors of the first two are 0.01, that of the third nothing."""
    t = np.linspace(0, np.pi, 101)
    alike, third = 1.01 * np.sin(t), np.sin(t)
    one, two = (error_bar(alike, others, None, 0.0) for others in ([alike + 1e-6], [alike + 1e-6, third]))
    assert one.greatest == pytest.approx(2e-6)
    assert two.greatest == pytest.approx(0.02)


@pytest.mark.parametrize("beside", [1e-2, 1e-5])
@pytest.mark.parametrize("top", [2.99, 2.97, 2.9502])
def test_a_peak_between_instants_counts_though_another_is_higher_at_all_of_them(top, beside):
    """The first of two peaks is at an instant; the other, a little higher, between one and a pair of close ones."""
    instants = np.linspace(0, 4, 41)
    t = np.union1d(instants, 3 + beside)
    values = np.where(t < 2, 1 - 4 * (t - 1) ** 2, 1.001 - 4 * (t - top) ** 2)
    reported = np.flatnonzero(np.isin(t, instants))
    missed = 1.001 - values[reported].max()
    assert missed <= between(t, values[None], reported)[0] < 2.1 * (missed + 4 * 0.05**2)


@pytest.mark.parametrize("sense", [-1, 1])
def test_a_jump_between_instants_is_no_peak(sense):
    """The side of a jump with the higher values is continued up to the jump by its slope, not by a parabola over it."""
    t = np.union1d(np.linspace(0, 4, 41), 2 + sense * np.array([1e-6, 2e-6]))
    values = np.where(sense * (t - 2) > 0, 1 - 0.1 * np.abs(t - 2), -1.0)
    reported = np.flatnonzero(np.isin(t, np.linspace(0, 4, 41)))
    restart = np.array([2.0 + 1e-9 * sense])
    assert between(t, values[None], reported)[0] > 0.4
    assert 0.01 - 1e-9 <= between(t, values[None], reported, restart)[0] < 0.012


def test_the_reference_that_bars_are_held_against_is_that_of_the_equations_of_motion(cart_pendulum_reference):
    exact = stiffmbs.run(example("cart_pendulum"), solver="projected", scheme="dop853", rtol=1e-13, points=2001)
    np.testing.assert_allclose(exact["cart.x"], cart_pendulum_reference(exact.time)[0], atol=1e-12)


@pytest.mark.long
def test_the_error_over_time_holds_what_a_closed_form_says():
    for rtol in (1e-4, 1e-7):
        found = stiffmbs.verify(oscillator(), duration=5.0, rtol=rtol)
        error = np.max(np.abs(found["block.x"] - (1.0 + 0.3 * np.cos(5 * found.time))))
        assert error < found.errors["block.x"].over_time < 5 * error


@pytest.mark.parametrize("scheme", ["euler_cromer", "rk4"])
def test_fixed_steps_are_halved(scheme):
    found = stiffmbs.verify(oscillator(), duration=2.0, solver="projected", scheme=scheme, step=4e-3, points=101)
    assert "steps of 0.002 s" in found.verification[0]
    error = np.max(np.abs(found["block.x"] - (1.0 + 0.3 * np.cos(5 * found.time))))
    assert error <= found.errors["block.x"].over_time < 5 * error


def test_a_kinematic_run_says_that_it_is_exact():
    found = stiffmbs.verify(example("crank_slider"))
    assert "exact" in found.verification[0]
    assert found.errors["crank.angle"].over_time < 1e-12
    assert not any("certain" in note for note in found.notes)


@pytest.mark.long
def test_a_stiff_force_at_a_loose_tolerance_is_told(tmp_path):
    """The cushioned parallelogram of the guide, stiffer still: the peak is a tenth too large."""
    text = (EXAMPLES.parent / "docs" / "guide" / "bushings.md").read_text(encoding="utf-8")
    scene, softer = (
        stiffmbs.read_scene(text.split("```yaml\n")[1].split("```")[0], [("k_b", k)]) for k in ("1e10 N/m", "1e9 N/m")
    )
    exact = np.abs(stiffmbs.run(scene, rtol=1e-10)["head3.fx"]).max()
    found = stiffmbs.verify(scene, rtol=1e-4)
    wrong = abs(np.abs(found["head3.fx"]).max() - exact)
    assert wrong > 0.05 * exact
    (told,) = [note for note in found.notes if "error bars of peaks" in note]
    assert "3.f" in told
    assert max(found.errors["head3.fx"].least, found.errors["head3.fx"].greatest) > wrong
    tight = stiffmbs.verify(softer, rtol=1e-9)
    assert not any("certain" in note for note in tight.notes)


def double_pendulum():
    return stiffmbs.read_scene(
        """
        gravity: [0, -9.81]
        bodies:
          upper: {mass: 1, inertia: 1/12, position: [0, 0.5], angle: 90 deg, omega: 0.1}
          lower: {mass: 1, inertia: 1/12, position: [0, 1.5], angle: 90 deg}
        joints:
          top: {type: revolute, i: {body: upper, point: [-0.5, 0]}, j: ground}
          middle: {type: revolute, i: {body: upper, point: [0.5, 0]}, j: {body: lower, point: [-0.5, 0]}}
        run: {duration: 30 s, points: 1501, rtol: 1e-6}
        """
    )


@pytest.mark.long
def test_a_chaotic_motion_is_told_with_the_time_from_which_it_is_not_known():
    scene = double_pendulum()
    found = stiffmbs.verify(scene)
    (told,) = [note for note in found.notes if "chaotic" in note]
    parted = float(told.split("from t = ")[1].split(" s")[0])
    exact = stiffmbs.run(scene, solver="projected", scheme="dop853", rtol=1e-12)
    apart = np.hypot(found["lower.x"] - exact["lower.x"], found["lower.y"] - exact["lower.y"])
    assert np.all(apart[found.time < parted - 1] < 0.2)
    assert np.max(apart[(found.time > parted) & (found.time < parted + 3)]) > 0.1


def nearly_a_parallelogram():
    """A four-bar whose coupler is a micron too long: at the flat pose a loose tolerance doesn't see it, a tight one does."""
    text = (EXAMPLES / "four_bars.yaml").read_text(encoding="utf-8")
    text = text.replace("N: 2, L: 1 m", "N: 1, L: 1 m").replace(
        "right: {point: [L/2, 0]}", "right: {point: [L/2 + 1e-6, 0]}"
    )
    return stiffmbs.read_scene(text)


@pytest.mark.long
def test_another_branch_after_a_singular_pose_is_told_with_time_pose_and_remedy(monkeypatch):
    monkeypatch.setattr(rerun, "DRIFTED", np.inf)  # exact constraints see the micron at any tolerance
    found = stiffmbs.verify(nearly_a_parallelogram(), duration=3.0, rtol=1e-5)
    (told,) = [note for note in found.notes if "another branch" in note]
    flat = found.time[np.argmax(np.abs(np.sin(found["v0.angle"])) < 0.2)]
    assert float(told.split("at t = ")[1].split(" s")[0]) == pytest.approx(flat, abs=0.1)
    for part in ("singular", "v0 at", "left1", "Remedy"):
        assert part in told


LONG = (
    "bricard", "bushing_axle", "car", "formula_student", "governor", "hatchback", "leaf_sprung_car", "motorcycle", "quarter_car",
    "rotor", "spatial_chain", "truck",
)  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, marks=pytest.mark.sampled(5 if path.stem in LONG else 2), id=path.stem)
        for path in EXAMPLE_SCENES.values()
    ],
)
def test_clean_scenes_give_no_warning(path):
    scene = stiffmbs.load_scene(path)
    before = stiffmbs.run(scene).notes
    warned = [note for note in stiffmbs.verify(scene).notes if note not in before]
    expected = IN_DOUBT.get(path.stem, ())
    assert len(warned) >= len(expected)
    assert bool(warned) == bool(expected), warned
    for part in expected:
        assert any(part in note for note in warned), warned


@pytest.mark.long
def test_reactions_without_a_unique_value_have_no_bars():
    text = (EXAMPLES.parent / "docs" / "guide" / "four_bar.md").read_text(encoding="utf-8")
    scene = stiffmbs.read_scene("# parallelogram" + text.split("# parallelogram")[1].split("```")[0])
    found = stiffmbs.verify(scene)
    assert found.not_unique
    assert not set(found.not_unique) & found.errors.keys()
    assert "beam.x" in found.errors


@pytest.mark.long
def test_few_output_instants_over_singular_poses_are_no_obstacle():
    found = stiffmbs.verify(example("four_bars"), points=3)
    assert any("between the output times" in note for note in found.notes)
    assert any("singular" in told for told in found.verification)


def test_where_nothing_tighter_is_to_be_had_a_looser_run_shows_the_error():
    found = stiffmbs.verify(oscillator(), duration=1.0, rtol=1e-14)
    assert "rtol 1e-13" in found.verification[0]
    assert found.errors["block.x"].over_time > 1e-13


def test_a_short_run_of_hardly_any_motion_is_clean():
    assert stiffmbs.verify(example("cart_pendulum"), duration=1e-6).notes == ()


@pytest.mark.long
def test_an_impact_between_output_instants_is_seen():
    scene = example("bouncing_ball")
    coarse = stiffmbs.verify(scene, points=61)
    peak = stiffmbs.run(scene, rtol=1e-9, points=30001)["floor.fy"].max()
    assert coarse["floor.fy"].max() < 0.8 * peak
    assert coarse["floor.fy"].max() + coarse.errors["floor.fy"].greatest > 0.95 * peak
    assert any("between the output times" in note for note in coarse.notes)


@pytest.mark.long
def test_what_is_done_does_not_depend_on_the_clock(monkeypatch):
    """On a machine so busy that each look at the clock is a minute after the one before, the same is found."""
    scene = example("governor")
    found = stiffmbs.verify(scene, duration=0.5)
    minutes = itertools.count()
    monkeypatch.setattr(time, "perf_counter", lambda: 60.0 * next(minutes))
    busy = stiffmbs.verify(scene, duration=0.5)
    assert (busy.verification, busy.notes, busy.errors) == (found.verification, found.notes, found.errors)


def test_what_takes_too_long_is_given_up_and_said(monkeypatch):
    from stiffmbs.tuning import parameters_of
    from stiffmbs.verification import verify

    none = replace(parameters_of(verify.VERIFICATION), most_effort=0, effort_allowed=0)
    monkeypatch.setattr(verify, "VERIFICATION", none)
    found = stiffmbs.verify(example("cart_pendulum"))
    assert len(found.time) == 1001
    assert any("limit of evaluations" in told or "aborted" in told for told in found.verification)
    assert np.isnan(found.errors["cart.x"].over_time)


@pytest.mark.long
def test_command_shows_bars_and_json_gains_errors(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = str(EXAMPLES / "cart_pendulum.yaml")
    shown = CliRunner().invoke(main, ["run", path, "--verify"])
    assert shown.exit_code == 0 and "±" in shown.output and "\nverified     rerun with" in shown.output
    cells = json.loads(CliRunner().invoke(main, ["run", path, "--verify", "--json"]).output)["channels"]
    keys = {"first", "last", "min", "max", "t_min", "t_max", "error", "min_error", "max_error"}
    assert all(cell.keys() == keys for cell in cells.values())
    assert 0 < cells["rail.fy"]["max_error"] < 1e-2
    assert cells["constraint.position"]["error"] is None


@pytest.mark.parametrize(
    ("value", "half", "text"),
    [
        (12.34567, 0.0018, "12.3457 ± 0.0018"),
        (12.34567, 0.0071, "12.346 ± 0.008"),
        (-0.5, 0.3, "-0.5 ± 0.3"),
        (123456.7, 430.0, "123500 ± 500"),
        (1.5e-7, 2.2e-9, "1.50e-07 ± 3e-09"),
        (2.0, 0.0, "2.00000000 ± 0.00000000"),
        (12.34567, float("nan"), "12.346 (not known how well)"),
    ],
)
def test_digits_are_those_that_are_known(value, half, text):
    assert with_bar(value, half) == text
