"""Jobs whose forces get other numbers: the same results as those of a model with these numbers from the beginning."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import stiffmbs
from stiffmbs import InputError
from stiffmbs.analyses.job import prepare
from stiffmbs.analyses.renumber import with_numbers

SETTINGS = {"duration": 0.5, "points": 11, "rtol": 1e-8}


def test_a_spring_changed_in_place_moves_as_one_given_at_first(examples):
    path = examples / "cart_pendulum.yaml"
    job = prepare(stiffmbs.load_scene(path), **SETTINGS)
    before = job.integrate().q.copy()
    for stiffness, free_length in ((900.0, 1.0), (900.0, 0.7), (270.0, 1.0)):
        job = with_numbers(job, "spring", stiffness=stiffness, free_length=free_length)
        changes = [("forces.spring.stiffness", str(stiffness)), ("forces.spring.free_length", str(free_length))]
        expected = prepare(stiffmbs.load_scene(path, changes), **SETTINGS)
        np.testing.assert_allclose(job.start.acceleration, expected.start.acceleration, rtol=1e-12, atol=1e-12)
        np.testing.assert_array_equal(job.integrate().q, expected.integrate().q)
    np.testing.assert_array_equal(job.integrate().q, before)


def ends(scene, stiffnesses):
    """Where runs with these springs end, one after the other in one job."""
    job, found = prepare(scene, **SETTINGS), []
    for stiffness in stiffnesses:
        job = with_numbers(job, "spring", stiffness=stiffness)
        found.append(job.integrate().q[-1])
    return np.array(found)


def test_runs_on_two_threads_are_those_on_one_to_the_last_bit(examples):
    scene = stiffmbs.load_scene(examples / "cart_pendulum.yaml")
    stiffnesses = np.linspace(200.0, 1e5, 20)
    with ThreadPoolExecutor(2) as threads:
        halves = list(threads.map(lambda part: ends(scene, part), (stiffnesses[10:], stiffnesses[9::-1])))
    np.testing.assert_array_equal(np.concatenate([halves[1][::-1], halves[0]]), ends(scene, stiffnesses))


def test_a_run_does_not_hang_on_those_before_it(examples):
    """Pivots, counters and steps are those of a first run, also where blocks are factored in a fixed order."""
    first, again = (prepare(stiffmbs.load_scene(examples / "andrews.yaml"), rtol=1e-6) for _ in range(2))
    before, expected = again.integrate(), first.integrate()
    repeated = again.integrate()
    assert "fixed order" in str(repeated.statistics["linear_solver"])
    for found in (before, repeated):
        np.testing.assert_array_equal(found.q, expected.q)
        assert {**found.statistics, "seconds": 0} == {**expected.statistics, "seconds": 0}
        np.testing.assert_array_equal(found.step_times, expected.step_times)


def test_one_spring_of_two_is_changed_and_presolved_models_too():
    scene = stiffmbs.read_scene(
        """
        bodies:
          a: {mass: 1, inertia: 1, position: [1, 0]}
          b: {mass: 2, inertia: 1, position: [1, 1]}
          lid: {mass: 1, inertia: 1, position: [1, 1.1]}
        joints:
          rail_a: {type: prismatic, i: a, j: ground}
          rail_b: {type: prismatic, i: b, j: {body: ground, point: [0, 1]}}
          bolt: {type: fixed, i: lid, j: b}
        forces:
          spring_a: {type: spring_damper, i: a, j: {body: ground, point: [-1, 0]}, stiffness: 10, free_length: 1.5}
          spring_b: {type: spring_damper, i: b, j: {body: ground, point: [-1, 1]}, stiffness: 10, free_length: 1.5}
        run: {duration: 1, points: 101, rtol: 1e-9}
        """
    )
    job = with_numbers(prepare(scene), "spring_b", stiffness=40.0)
    assert job.subsystems
    plain = with_numbers(prepare(scene, presolve=False), "spring_b", stiffness=40.0)
    t = plain.grid.times
    for found in (job.integrate().q, plain.integrate().q):
        np.testing.assert_allclose(found[:, 0], 0.5 + 0.5 * np.cos(np.sqrt(10 / 1) * t), atol=1e-7)
        np.testing.assert_allclose(found[:, 3], 0.5 + 0.5 * np.cos(np.sqrt(40 / 3) * t), atol=1e-7)


@pytest.mark.parametrize(
    ("name", "numbers", "sentence"),
    [
        ("damper", {"stiffness": 1.0}, "found no force 'damper', expected one of spring"),
        ("spring", {"stifness": 1.0}, "spring: SpringDamper: found the unknown key 'stifness'"),
        ("spring", {"stiffness": "soft"}, "stiffness: found 'soft'|stiffness: .*soft"),
        ("spring", {"free_length": -1.0}, "free_length"),
    ],
)
def test_what_cannot_be_changed_is_refused(examples, name, numbers, sentence):
    job = prepare(stiffmbs.load_scene(examples / "cart_pendulum.yaml"), **SETTINGS)
    with pytest.raises(InputError, match=sentence):
        with_numbers(job, name, **numbers)
