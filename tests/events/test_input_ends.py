"""Inputs over time that end within a run: poles, and formulas that leave their domain."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import AppliedForce, Body, Drive, Model, Prismatic
from stiffmbs.model.settings import RunSettings
from stiffmbs.solve.trajectory import Outcome

SOLVERS = [
    {"solver": "bdf"}, {"solver": "auto"}, {"solver": "projected", "scheme": "dop853"}, {"solver": "projected", "scheme": "dopri5"},
    {"solver": "projected", "scheme": "rk4"}, {"solver": "projected", "scheme": "euler_cromer"},
]  # fmt: skip
ENDS = {
    "1/(t - 0.5)": 0.5, "tan(t)": np.pi / 2, "log(1 - t)": 1.0, "(1 - t)^-3": 1.0, "sqrt(1 - t)": 1.0, "(1 - t)^2.5": 1.0,
    "asin(2*t)": 0.5, "acos(1.5*t)": 2 / 3, "1/sin(3*t + 1)": (np.pi - 1) / 3, "abs(1 - t)^-0.5": 1.0, "1/(t - 1)^2 + 1/(t - 3)": 1.0,
    "branch(t - 1.5, 0, 0, 1/(1.9 - t))": 1.9,
}  # fmt: skip
HARMLESS = [
    "sin(t - 1)/(t - 1)", "1/(t^2 + 1)", "sqrt(1 - cos(3*t)^2)", "acos(cos(t))", "atan(1/(t - 5))", "sqrt(max(0, 1 - t))",
    "branch(t - 1, 1, 1, 2)/(t + 1)", "1/((t - 1)^2 + 1e-4)", "sqrt(t^2 + 2*t + 1)", "exp(-700*t)", "1/cosh((t - 1.2)/0.0013)",
]  # fmt: skip


def sled(**how):
    model = Model()
    model.add("sled", Body(mass=1, inertia=1))
    model.add("rail", Prismatic(i="sled", j="ground"))
    model.add(
        "push", Drive(joint="rail", **how) if "force" not in how else AppliedForce(i="sled", force=(how["force"], 0))
    )
    return model


@pytest.mark.sampled(9)
@pytest.mark.parametrize("law", ENDS)
@pytest.mark.parametrize("field", ["force", "position", pytest.param("velocity", marks=pytest.mark.long)])
def test_every_solver_says_where_an_input_ends(field, law):
    messages = set()
    for how in [*SOLVERS, *([{"solver": "kinematic"}] if field == "position" else [])]:
        solution = stiffmbs.run(sled(**{field: law}), duration=2.0, points=201, **how)
        assert solution.outcome is Outcome.STOPPED
        assert ENDS[law] - 0.05 < solution.time[-1] <= ENDS[law]
        assert solution.solver["steps"] < 5000
        messages.add(solution.message)
    (message,) = messages
    assert message.startswith(f"stopped at t = {ENDS[law]:.9g} s: 'push' has no finite value there")


@pytest.mark.sampled(3)
@pytest.mark.parametrize("law", HARMLESS)
def test_inputs_with_values_over_the_whole_run_are_followed_to_its_end(law):
    for how in SOLVERS[:2]:
        assert stiffmbs.run(sled(force=law), duration=2.0, points=21, **how).outcome is Outcome.DONE


def test_the_motion_before_a_pole_is_that_of_its_closed_form():
    solution = stiffmbs.run(sled(force="(1 - t)^-2"), duration=2.0, points=201, rtol=1e-8)
    np.testing.assert_allclose(solution["sled.x"], -solution.time - np.log1p(-solution.time), atol=1e-5)


def test_the_earliest_of_several_ends_is_told_for_independent_bodies():
    model = sled(force="1/(t - 1.5)")
    model.add("other", Body(mass=1, inertia=1))
    model.add("pull", AppliedForce(i="other", force=("sqrt(1.2 - t)", 0)))
    solution = stiffmbs.run(model, duration=2.0, points=201)
    assert "'pull' has no finite value there, as 'sqrt(1.2 - t)' has no value beyond" in solution.message
    assert "t = 1.2 s" in solution.message


def test_an_end_that_an_input_of_the_model_places_is_found():
    text = "{bodies: {b: {mass: 1, inertia: 1}}, inputs: {F: 1.2}, forces: {pull: {type: force, i: b, force: [sqrt(F - t), 0]}}}"
    solution = stiffmbs.run(stiffmbs.read_scene(text), duration=2.0, points=201)
    assert "t = 1.2 s: 'pull' has no finite value there, as 'sqrt(F - t)' has no value beyond" in solution.message


def test_steps_below_the_precision_of_time_end_the_run():
    """A force over the state and time with a pole: the explicit steps shrink until t + h = t."""
    for scheme in ("dop853", "dopri5"):
        solution = stiffmbs.run(
            sled(force="(sled.x + 1)/(t - 0.5)"), duration=2.0, points=21, solver="projected", scheme=scheme
        )
        assert solution.outcome is Outcome.STOPPED
        assert "t = 0.5 s" in solution.message
        assert solution.solver["steps"] < 1000


def test_output_points_that_numbers_cannot_tell_apart_are_refused():
    with pytest.raises(
        stiffmbs.errors.InputError, match=r"output points 0.01 s apart at t = 1e\+15 s, expected 20 s or more"
    ):
        stiffmbs.run(sled(force="1"), start=1e15, duration=10.0)


def test_a_run_much_shorter_than_its_output_spacing_has_both_ends():
    solution = stiffmbs.run(sled(force="1"), duration=1e-12, output=0.1)
    np.testing.assert_array_equal(solution.time, [0.0, 1e-12])


def test_a_duration_whose_steps_underflow_is_refused(examples):
    with pytest.raises(stiffmbs.errors.InputError, match=r"duration: found 1e-320 s, expected 1e-100 s or more"):
        stiffmbs.run(stiffmbs.load_scene(examples / "cart_pendulum.yaml"), duration=1e-320)


def test_a_duration_is_refused_below_a_size():
    RunSettings(duration=1.5e-100)
    with pytest.raises(stiffmbs.errors.InputError, match="expected 1e-100 s or more"):
        RunSettings(duration=0.7e-100)
