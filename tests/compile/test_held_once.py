"""Jobs of equal structure hold their lists once."""

import gc
import weakref

import numpy as np
import pytest

import stiffmbs
from stiffmbs.analyses.job import prepare
from stiffmbs.compile.machine.layout import held_once

SCENE = """
bodies: {cart: {mass: 10, inertia: 1}, bar: {mass: 1, inertia: 0.03, position: [0, -0.3], angle: -90 deg}}
joints:
  rail: {type: prismatic, i: cart, j: ground}
  hinge: {type: revolute, i: cart, j: {body: bar, point: [-0.3, 0]}}
forces: {spring: {type: spring_damper, i: cart, j: {body: ground, point: [-1, 0]}, stiffness: 270, free_length: 1}}
run: {duration: 0.1, output: 10 ms}
"""


def test_equal_arrays_are_one():
    assert held_once(np.arange(5)) is held_once(np.arange(10)[:5])


@pytest.mark.parametrize("other", [np.arange(5, dtype=np.int32), np.arange(5.0), np.arange(6), np.arange(5)[:, None]])
def test_others_are_not(other):
    one, two = held_once(np.arange(5)), held_once(other)
    assert two is not one and two.dtype == other.dtype and np.array_equal(two, other)


def test_zeros_of_both_signs_are_not_equal():
    assert np.signbit(held_once(np.array([-0.0]))) and not np.signbit(held_once(np.array([0.0])))


def test_nobody_can_write_and_the_giver_keeps_a_copy_of_its_own():
    given = np.arange(5)
    held = held_once(given)
    given[0] = 7
    assert held[0] == 0
    with pytest.raises(ValueError, match="read-only"):
        held[0] = 7


def test_what_nobody_uses_is_let_go():
    seen = weakref.ref(held_once(np.arange(123)))
    gc.collect()
    assert seen() is None


def _lists(job):
    """What an integrator of the job reads anew with each evaluation, and where the values of its matrices stand."""
    first = job.dynamics._accelerations
    equations = first.equations
    return [
        *equations.pattern, equations._slot, equations._source, equations._constant, equations._cj, equations._r_row, equations._r_factor, *first.slots,
        *job.dynamics.system.term("acceleration", "J"),
    ]  # fmt: skip


def test_two_jobs_of_one_structure_hold_their_lists_once():
    scene = stiffmbs.read_scene(SCENE)
    jobs = [prepare(scene), prepare(scene, rtol=1e-8)]
    for one, other in zip(*map(_lists, jobs), strict=True):
        assert one is other


def test_jobs_that_share_lists_find_what_each_finds_alone():
    scene = stiffmbs.read_scene(SCENE)
    alone = stiffmbs.run(scene)["rail.fy"]
    jobs = [prepare(scene) for _ in range(3)]
    for job in jobs:
        assert np.array_equal(stiffmbs.run(scene)["rail.fy"], alone)
        job.integrate()
