"""Solvers compared on a scene: errors against closed forms, the reference and its refusals, failures, interruptions."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses.job import prepare
from stiffmbs.comparison.plan import entries_of
from stiffmbs.comparison.reference import reference
from stiffmbs.model.settings import RunSettings

OSCILLATOR = """
bodies: {block: {mass: 2, inertia: 1, position: [0.1, 0]}}
joints: {rail: {type: prismatic, i: block, j: ground}}
forces:
  spring: {type: spring_damper, i: block, j: {body: ground, point: [-1, 0]}, stiffness: 50, free_length: 1}
run: {duration: 4, points: 81}
"""
DOUBLE_PENDULUM = [("N", "2"), ("run.duration", "12"), ("run.output", "0.02")]


@pytest.fixture(scope="module")
def oscillator():
    return stiffmbs.read_scene(OSCILLATOR)


def few(model, **options):
    """A comparison that takes little time."""
    return stiffmbs.compare(model, **{"tolerances": (1e-4, 1e-6, 1e-8), "repeats": 1, **options})


def test_errors_are_those_against_the_closed_form(oscillator):
    """x = 0.1 cos 5 t; the rows' errors are what the same runs differ from it by."""
    found = few(oscillator, solvers=("bdf", "dop853"))
    chosen = {"bdf": {"solver": "bdf"}, "dop853": {"solver": "projected", "scheme": "dop853"}}
    assert [(row.solver, row.setting) for row in found.rows] == [
        (name, f"rtol {rtol:g}") for name in chosen for rtol in (1e-4, 1e-6, 1e-8)
    ]
    for row in found.rows:
        run = stiffmbs.run(oscillator, rtol=float(row.setting.split()[1]), **chosen[row.solver])
        exact = {"positions": 0.1 * np.cos(5 * run.time), "velocities": -0.5 * np.sin(5 * run.time)}
        assert row.errors["positions"] == pytest.approx(
            np.abs(run["block.x"] - exact["positions"]).max(), rel=1e-3, abs=1e-11
        )
        assert row.errors["velocities"] == pytest.approx(
            np.abs(run["block.vx"] - exact["velocities"]).max(), rel=1e-3, abs=1e-10
        )
        assert row.errors["forces"] == pytest.approx(
            np.abs(run["spring.fx"] + 50 * exact["positions"]).max(), rel=1e-3, abs=1e-9
        )
        assert row.steps == run.solver["steps"]
        assert row.seconds > 0


def test_the_reference_is_good_to_what_it_says(oscillator):
    found = few(oscillator, solvers=("dop853",)).reference
    apart = np.abs(found.solution["block.x"] - 0.1 * np.cos(5 * found.solution.time)).max()
    assert apart < found.agreement["positions"] < 1e-9
    assert found.resolved("positions") >= 3 * found.agreement["positions"]
    assert found.names == ("bdf at rtol 1e-12", "dop853 at rtol 1e-12")


def test_fixed_steps_converge_with_their_order(oscillator):
    """Classical Runge-Kutta: a half step has a sixteenth of the error; Euler-Cromer: a half."""
    found = few(oscillator, solvers=("rk4", "euler_cromer"), steps=(1.25e-2, 6.25e-3))
    errors = {
        name: [row.errors["positions"] for row in found.rows if row.solver == name] for name in ("rk4", "euler_cromer")
    }
    assert errors["rk4"][0] / errors["rk4"][1] == pytest.approx(16, rel=0.1)
    assert errors["euler_cromer"][0] / errors["euler_cromer"][1] == pytest.approx(2, rel=0.15)


def test_each_formulation_is_an_entry_of_its_own(oscillator):
    found = few(oscillator, solvers=("bdf", "auto"), formulations=("SI2", "I3"), tolerances=(1e-5, 1e-7))
    assert list(dict.fromkeys(row.solver for row in found.rows)) == ["bdf SI2", "bdf I3", "auto"]
    assert [entry.implicit for entry in found.entries] == [True, True, False]
    assert [entry.chooses for entry in found.entries] == [False, False, True]


def test_absolute_tolerances_stay_in_proportion():
    (entry,) = entries_of(["bdf"], (), RunSettings())
    assert entry.at(RunSettings(rtol=1e-6, atol=1e-9), 1e-4).atol == pytest.approx(1e-7)
    assert entry.at(RunSettings(rtol=1e-6), 1e-4).atol is None


@pytest.mark.long
def test_a_chaotic_motion_has_no_reference(examples):
    scene = stiffmbs.load_scene(examples / "chain.yaml", DOUBLE_PENDULUM)
    with pytest.raises(
        stiffmbs.SolverError, match=r"no reference: bdf .* and dop853 .* disagree: link\d\.\w+ differs by"
    ) as told:
        stiffmbs.compare(scene)
    assert "chaotic" in str(told.value)
    until = float(str(told.value).rsplit("such as ", 1)[1].removesuffix(" s"))
    assert 1 < until < 15
    assert few(scene, duration=until, points=101, solvers=("dop853",)).rows


def test_a_motion_that_explicit_steps_do_not_finish_has_no_reference(examples):
    scene = stiffmbs.load_scene(examples / "half_car.yaml", [("k_b", "1e9"), ("run.duration", "1")])
    with pytest.raises(stiffmbs.SolverError, match=r"no reference: .*aborted at t = .*larger 'longest'"):
        stiffmbs.compare(scene, longest=1e-3)


def test_reactions_that_are_not_unique_are_left_out_and_named(examples):
    scene = stiffmbs.load_scene(examples / "door.yaml")
    found = few(scene, duration=0.5, points=51, solvers=("dop853",), measure="forces")
    assert "upper_hinge.fx" in found.reference.left_out
    assert {"upper_hinge.tz", "closer.tz"} < set(found.reference.channels["forces"])
    assert set(found.reference.channels["forces"]).isdisjoint(found.reference.left_out)
    assert "not compared, as rigid bodies do not determine them: upper_hinge.fx" in str(found)
    assert all(row.errors["forces"] < 1 for row in found.rows)


def test_orientations_in_space_are_compared_by_their_angle(examples):
    """A top's quaternion and its negative are one orientation."""
    scene = stiffmbs.load_scene(examples / "heavy_top.yaml")
    job = prepare(scene, duration=0.2, points=21)
    found = reference(scene, job.settings, 60.0, lambda line: None)
    (body,) = scene.bodies
    channels = dict(found.solution.channels)
    channels |= {f"{body}.q{k}": -channels[f"{body}.q{k}"] for k in range(4)}
    assert found.errors(channels)["positions"] < 1e-12
    turned, half = dict(channels), 0.5e-3
    cos, sin = np.cos(half), np.sin(half)
    q0, q1, q2, q3 = (channels[f"{body}.q{k}"] for k in range(4))
    turned |= {f"{body}.q0": cos * q0 - sin * q3, f"{body}.q3": cos * q3 + sin * q0}
    turned |= {f"{body}.q1": cos * q1 + sin * q2, f"{body}.q2": cos * q2 - sin * q1}
    assert found.errors(turned)["positions"] == pytest.approx(2 * half, rel=1e-6)


def test_failures_are_rows_with_their_message(oscillator):
    """The oscillator is free to move, so no drive prescribes its motion."""
    found = few(oscillator, solvers=("kinematic", "dop853"), tolerances=(1e-5, 1e-6))
    failed, *others = found.rows
    assert failed.solver == "kinematic"
    assert "block" in failed.message or "drive" in failed.message
    assert failed.as_dict("positions") == {
        "solver": "kinematic", "setting": "exact", "error": None, "seconds": None, "steps": 0, "message": failed.message,
    }  # fmt: skip
    assert all(not row.message for row in others)
    assert failed.message in str(found)


def test_where_all_are_exact_the_fastest_is_named_all_the_same(examples):
    scene = stiffmbs.load_scene(examples / "crank_slider.yaml")
    found = few(scene, solvers=("dop853", "kinematic"), tolerances=(1e-8, 1e-9))
    (at,) = found.at_errors
    assert set(at.better) == {"dop853", "kinematic"}
    assert "is the fastest" in found.conclusion or "equally fast" in found.conclusion


def test_a_mechanism_at_rest_has_a_reference_though_rounding_is_all_that_moves_it(examples):
    scene = stiffmbs.load_scene(examples / "cart_pendulum.yaml", [("start", "0")])
    assert few(scene, tolerances=(1e-6,)).reference.agreement["positions"] < 1e-11


class Impatient:
    """Presses Ctrl-C when a line is told."""

    def __init__(self, line):
        self.line = line

    def __call__(self, line):
        if line == self.line:
            raise KeyboardInterrupt


@pytest.mark.parametrize(("line", "rows"), [("bdf, rtol 1e-08", 2), ("timing, round 1 of 1", 3)])
def test_what_was_measured_before_an_interruption_is_kept(oscillator, line, rows):
    found = few(oscillator, solvers=("bdf",), tell=Impatient(line))
    assert found.interrupted
    assert len(found.rows) == rows
    assert "interrupted by the user" in str(found)


def test_an_interruption_before_there_is_anything_is_none_of_its_business(oscillator):
    with pytest.raises(KeyboardInterrupt):
        few(oscillator, tell=Impatient("reference: dop853 at rtol 1e-12"))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"solvers": ("bdf", "ode45")}, "solvers: found 'ode45', expected some of bdf, "),
        ({"solvers": "bdf"}, "solvers: found 'bdf', expected a list of solvers"),
        ({"formulations": "SI2"}, "formulations: found 'SI2', expected a list of formulations"),
        ({"solvers": ()}, "solvers: found '', expected some of bdf"),
        ({"formulations": ("SI4",)}, "formulations: found 'SI4' (did you mean 'SI2'?), expected some of SI2"),
        ({"solvers": ("dop853",), "formulations": ("SI2",)}, "without bdf, expected bdf among the solvers"),
        ({"measure": "energies"}, "measure: found 'energies', expected one of positions, velocities, forces"),
        ({"repeats": 0}, "repeats: found 0, expected a number, more than 0"),
        ({"repeats": "3"}, "repeats: found '3', expected a number"),
        ({"longest": "20 s"}, "longest: found '20 s', expected a number"),
        ({"tolerances": ()}, "tolerances: found no value"),
        ({"rtol": 1e-6}, "rtol: found a setting of one solver, expected it among"),
        ({"duration": -1.0}, "duration"),
    ],
)
def test_wrong_options_are_refused(oscillator, options, message):
    with pytest.raises(stiffmbs.InputError) as told:
        stiffmbs.compare(oscillator, **options)
    assert message in str(told.value)


def test_a_measure_without_channels_is_refused():
    free = stiffmbs.read_scene("{bodies: {a: {mass: 1, inertia: 1, velocity: [1, 0]}}, run: {duration: 1, points: 11}}")
    with pytest.raises(
        stiffmbs.InputError, match="'forces', of which nothing can be compared, expected one of positions"
    ):
        stiffmbs.compare(free, measure="forces")


def test_output_at_the_solvers_own_steps_becomes_common_instants(oscillator):
    found = few(oscillator, points="steps", duration=1.0, solvers=("dop853",), tolerances=(1e-6,))
    assert len(found.reference.solution.time) == 1001
