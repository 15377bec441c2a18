"""Forces by Python functions: the same motion as by formulas with every solver, and exceptions that are told."""

import itertools
import sys

import numpy as np
import pytest

import stiffmbs
from stiffmbs import AppliedForce, Body, InputError, Marker, Model, PythonForce, PythonFunction, spatial
from stiffmbs.errors import AssemblyError

OF = ("ball.x", "ball.vx", "ball.vy")


def law(x):
    return -50 * x[0] - 2 * x[1], -(x[2] ** 3), 0.5 * x[1]


def model(function=law, **fields):
    made = Model(gravity=(0, -9.81))
    made.add("ball", Body(mass=1, inertia=0.1, position=(0.3, 0), velocity=(0, 1)))
    made.add("post", Body(mass=5, inertia=1, position=(1, 0)))
    made.add("pull", PythonForce(i="ball", of=OF, function=function, **fields))
    return made


def by_formulas(**fields):
    made = Model(gravity=(0, -9.81))
    made.add("ball", Body(mass=1, inertia=0.1, position=(0.3, 0), velocity=(0, 1)))
    made.add("post", Body(mass=5, inertia=1, position=(1, 0)))
    made.add("pull", AppliedForce(i="ball", force=("-50*ball.x - 2*ball.vx", "-ball.vy^3"), **fields))
    made.add("turn", stiffmbs.AppliedTorque(i="ball", torque="0.5*ball.vx", **fields))
    return made


@pytest.mark.long
@pytest.mark.sampled(5)
@pytest.mark.parametrize("fields", [{}, {"j": "post"}], ids=["on one body", "between two"])
@pytest.mark.parametrize(
    "settings",
    [{"solver": "bdf"}, {"solver": "projected", "scheme": "dop853"}, {"solver": "auto"}],
    ids=["bdf", "dop853", "auto"],
)
def test_the_motion_is_that_of_formulas(settings, fields):
    expected, found = (
        stiffmbs.run(made, duration=1.0, rtol=1e-8, **settings) for made in (by_formulas(**fields), model(**fields))
    )
    assert found.outcome.name == "DONE"
    for channel in ("ball.x", "ball.y", "ball.angle", "post.angle"):
        np.testing.assert_allclose(found[channel], expected[channel], atol=1e-6)
    np.testing.assert_allclose(found["pull.torque"], expected["turn.torque"], atol=1e-5)


@pytest.mark.long
def test_the_motion_is_the_same_in_space():
    plane, space = (
        stiffmbs.run(model(j="post"), duration=0.5, rtol=1e-8),
        stiffmbs.run(spatial.in_space(model(j="post")), duration=0.5, rtol=1e-8),
    )
    np.testing.assert_allclose(space["ball.x"], plane["ball.x"], atol=1e-6)
    np.testing.assert_allclose(space["ball.wz"], plane["ball.omega"], atol=1e-5)


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize(("way", "words"), [("differences", "central differences"), ("complex_step", "a complex step")])
def test_a_note_tells_how_derivatives_are_computed(way, words):
    solution = stiffmbs.run(model(PythonFunction(law, way)), duration=0.1)
    (note,) = [note for note in solution.notes if "Python" in note]
    assert (
        note.startswith("the law of 'pull' is the Python function law (") and f"its derivatives are by {words}" in note
    )


def failing(x):
    if x[0] < 0.2:
        raise ZeroDivisionError("too near")
    return law(x)


@pytest.mark.parametrize("settings", [{"solver": "bdf"}, {"solver": "projected"}, {"solver": "projected", "scheme": "dop853"}, {"solver": "auto"}])  # fmt: skip
def test_an_exception_ends_the_run_and_keeps_what_was_computed(settings):
    solution = stiffmbs.run(model(failing), duration=1.0, **settings)
    assert solution.outcome.name == "STOPPED"
    assert "the Python function failing of 'pull' (python_force) raised ZeroDivisionError: too near" in solution.message
    assert len(solution.time) > 10 and 0.2 < solution["ball.x"][-1] < 0.28
    assert all(np.isfinite(values).all() for values in solution.values())


@pytest.mark.long
def test_a_function_is_called_again_in_the_next_run():
    made, limit = model(lambda x: law(x) if x[0] > limit[0] else 1 / 0), [0.2]
    assert stiffmbs.run(made, duration=1.0).outcome.name == "STOPPED"
    limit[0] = -1e9
    assert stiffmbs.run(made, duration=1.0).outcome.name == "DONE"


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize(("solver", "calls"), [("bdf", range(20, 400, 29)), ("projected", range(10, 60, 3))])
def test_an_exception_at_any_call_leaves_no_wrong_number(solver, calls):
    """Also where the stages of an explicit step's interpolant fail: then nothing within that step is reported."""
    whole = stiffmbs.run(model(), duration=1.0, solver=solver)
    for last in calls:
        count = itertools.count()

        def failing_once(x, count=count, last=last):
            if next(count) == last:
                raise ValueError("no value")
            return law(x)

        found = stiffmbs.run(model(failing_once), duration=1.0, solver=solver)
        assert found.outcome.name == "STOPPED" and "raised ValueError: no value" in found.message
        for name, values in found.items():
            np.testing.assert_allclose(values, whole[name][: len(found.time)], atol=1e-9, err_msg=f"{name}, {last}")


def test_ctrl_c_in_the_function_interrupts_the_run():
    def interrupted(x):
        if x[0] < 0.2:
            raise KeyboardInterrupt
        return law(x)

    solution = stiffmbs.run(model(interrupted), duration=1.0)
    assert solution.outcome.name == "INTERRUPTED" and len(solution.time) > 10


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("solver", ["bdf", "projected"])
def test_ctrl_c_before_the_function_interrupts_the_run_and_no_number_is_wrong(solver):
    """ctypes drops what is raised at the first instruction of what it calls."""
    calls = itertools.count()

    def interrupt(frame, event, _):
        if event == "call" and frame.f_code.co_name == "_called" and next(calls) == 300:
            sys.setprofile(None)
            raise KeyboardInterrupt

    whole = stiffmbs.run(model(), duration=1.0, solver=solver)
    sys.setprofile(interrupt)
    try:
        found = stiffmbs.run(model(), duration=1.0, solver=solver)
    finally:
        sys.setprofile(None)
    assert found.outcome.name == "INTERRUPTED" and 1 < len(found.time) < len(whole.time)
    for name, values in found.items():
        np.testing.assert_allclose(values, whole[name][: len(found.time)], rtol=1e-6, atol=1e-9)
    assert stiffmbs.run(model(), duration=1.0, solver=solver).outcome.name == "DONE"


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (lambda x: x[0], r"raised ValueError: found 1 numbers, expected 3"),
        (lambda x: (np.nan, 0, 0), r"raised ValueError: found nan, expected finite numbers"),
        (lambda x: "three", r"raised ValueError: "),
        (lambda: 0, r"raised TypeError: "),
    ],
)
def test_a_function_that_gives_something_else_is_named(function, words):
    with pytest.raises(AssemblyError, match=rf"the Python function .* of 'pull' \(python_force\) {words}"):
        stiffmbs.run(model(function))


def test_only_functions_are_taken():
    with pytest.raises(InputError, match=r"PythonForce: function: found 3, expected a Python function"):
        model(3)


class Tyre(stiffmbs.Force):
    """A user's own force whose law is a Python function."""

    kind = "tyre"
    i: Marker
    law: PythonFunction

    @staticmethod
    def efforts(e):
        y = e.i.point[1]
        return [(e.law(y, e.rate(y)), y)]


def own(function):
    made = Model(gravity=(0, -9.81))
    made.add("a", Body(mass=1, inertia=1))
    made.add("tyre", Tyre(i="a", law=function))
    return made


@pytest.mark.long
def test_own_classes_call_functions_too():
    solution = stiffmbs.run(own(lambda x: -100 * x[0] - 4 * x[1]), duration=1.0, rtol=1e-9)
    w, d = np.sqrt(100 - 4), 2.0
    t, depth = solution.time, 9.81 / 100
    expected = -depth * (1 - np.exp(-d * t) * (np.cos(w * t) + d / w * np.sin(w * t)))
    np.testing.assert_allclose(solution["a.y"], expected, atol=1e-7)


def test_constraints_cannot_be_python_functions():
    class Bent(stiffmbs.Joint):
        kind = "bent"
        equations = ("y",)
        i: Marker
        law: PythonFunction

        @staticmethod
        def position(e):
            return [e.i.point[1] - e.law(e.i.point[0])]

    made = Model()
    made.add("a", Body(mass=1, inertia=1))
    made.add("x", Bent(i="a", law=lambda x: x[0]))
    with pytest.raises(InputError, match=r"x: .*found a second derivative of a Python function"):
        stiffmbs.run(made)
