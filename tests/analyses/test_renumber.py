"""Jobs whose numbers were changed in place give the very numbers of jobs prepared by themselves."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses.job import prepare
from stiffmbs.analyses.renumber import renumbered
from stiffmbs.analyses.run import solved

CHANGES = {
    "half_car.yaml": [("k_b", "3e6"), ("zeta", "0.3"), ("V", "9"), ("forces.front_spring.preload", "-9100")],
    "cart_pendulum.yaml": [("forces.spring.stiffness", "2000"), ("forces.spring.free_length", "0.8")],
    "bouncing_ball.yaml": [],
    "stick_slip.yaml": [],
    "governor.yaml": [],
    "vehicles/front_axle.yaml": [],
}


def times(value, factor):
    """A number, or several, times a factor; anything else as it is."""
    if isinstance(value, tuple):
        return tuple(times(part, factor) for part in value)
    return value * factor if isinstance(value, float | int) else value


def scaled(data, factor):
    """The model with every stiffness and damping times a factor."""
    forces = {}
    for name, force in data.forces.items():
        given = {field: getattr(force, field) for field in force.model_fields_set}
        forces[name] = type(force)(
            **{
                field: times(value, factor) if field in ("stiffness", "damping") else value
                for field, value in given.items()
            }
        )
    return data.model_copy(update={"forces": forces})


@pytest.mark.sampled(5)
@pytest.mark.long
@pytest.mark.parametrize("solver", ["bdf", "projected", "auto"])
@pytest.mark.parametrize("name", CHANGES)
def test_a_job_changed_in_place_gives_what_a_new_one_gives_to_the_last_bit(examples, name, solver):
    first = stiffmbs.load_scene(examples / name)
    other = scaled(stiffmbs.load_scene(examples / name, CHANGES[name]), 1.07)
    settings = {"duration": 0.8, "rtol": 1e-6, "solver": solver}
    job = prepare(first, **settings)
    before = solved(job)
    job = renumbered(job, other)
    assert job is not None
    fresh, found = solved(prepare(other, **settings)), solved(job)
    assert any(not np.array_equal(before[channel], fresh[channel]) for channel in fresh)
    for channel in fresh:
        np.testing.assert_array_equal(found[channel], fresh[channel], err_msg=channel)
    assert (found.message, found.notes) == (fresh.message, fresh.notes)
    again = solved(renumbered(job, first))
    for channel in before:
        np.testing.assert_array_equal(again[channel], before[channel], err_msg=channel)


def test_a_load_over_time_is_looked_through_anew():
    """A step at another time is a breakpoint that the first job's inputs did not have."""
    text = """
        parameters: {T: 0.3 s}
        bodies: {a: {mass: 1, inertia: 1}}
        joints: {rail: {type: prismatic, i: a, j: ground}}
        forces: {push: {type: force, i: a, force: ["100*step(t, T, 0, T + 1e-4, 1)*step(t, T + 2e-3, 1, T + 2.1e-3, 0)", 0]}}
        run: {duration: 1, points: 11}
    """
    job = prepare(stiffmbs.read_scene(text))
    job.integrate()
    later = stiffmbs.read_scene(text, [("T", "0.77")])
    found = solved(renumbered(job, later))
    np.testing.assert_array_equal(found["a.x"], solved(prepare(later))["a.x"])
    assert found["a.vx"][-1] == pytest.approx(0.2, rel=1e-5)


@pytest.mark.parametrize(
    "change",
    [
        ("bodies.bar.mass", "2"),
        ("forces.spring", "{type: spring_damper, i: bar, j: {body: ground, point: [-1, 0]}, stiffness: 1, free_length: 1}"),
        ("gravity", "[0, -1]"),
    ],
)  # fmt: skip
def test_another_structure_is_prepared_anew(examples, change):
    path = examples / "cart_pendulum.yaml"
    job = prepare(stiffmbs.load_scene(path))
    assert renumbered(job, stiffmbs.load_scene(path, [change])) is None


def test_a_force_that_makes_the_mechanism_larger_is_prepared_anew(examples):
    """Tolerances follow from the size of the mechanism."""
    path, far = examples / "cart_pendulum.yaml", "{body: ground, point: [-5 m, 0]}"
    job = prepare(stiffmbs.load_scene(path))
    assert renumbered(job, stiffmbs.load_scene(path, [("forces.spring.j", far)])) is None
