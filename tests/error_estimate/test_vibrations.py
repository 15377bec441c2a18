"""Errors beside stiff springs that vibrate within a step: vibrations that steps leave out, and those that steps follow."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.error_estimate.vibrations import _followed
from tests.error_estimate.test_against_truth import ratio

HANGING = """
gravity: [0, -9.81]
bodies:
  a: {{mass: 1, inertia: 0.01, position: [1, 0]}}
  b: {{mass: 1, inertia: 0.02, position: [1.3, 0]}}
joints: {{h: {{type: revolute, i: {{body: b, point: [-0.3, 0]}}, j: a}}}}
forces:
  q: {{type: bushing, i: a, j: {{body: ground, point: [1, 0]}}, stiffness: [{k}, {k}, 1e3], damping: [{c}, {c}, 1]}}
run: {{duration: {duration}, points: 401}}
"""
FOUR_BAR = """
gravity: [0, -9.81]
parameters: {k: 1e12 N/m, c: 2*0.01*sqrt(k*1 kg)}
bodies:
  crank: {mass: 1, inertia: 0.01, position: [0, 0.1], angle: 90 deg, omega: -3, velocity: [0.3, 0]}
  coupler: {mass: 2, inertia: 0.05, position: [0.25, 0.3], angle: 0.380506377}
  rocker: {mass: 1.5, inertia: 0.03, position: [0.5, 0.2], angle: 90 deg}
joints:
  a: {type: revolute, i: {body: crank, point: [-0.1, 0]}, j: ground}
  b: {type: revolute, i: {body: coupler, point: [-0.26925824, 0]}, j: {body: crank, point: [0.1, 0]}}
  d: {type: revolute, i: {body: rocker, point: [-0.2, 0]}, j: {body: ground, point: [0.5, 0]}}
forces:
  bush: {type: bushing, i: {body: coupler, point: [0.26925824, 0]}, j: {body: rocker, point: [0.2, 0]}, stiffness: [k, k, 0], damping: [c, c, 0]}
run: {duration: 1 s, points: 201}
"""
CHAIN = """
gravity: [0, -9.81]
parameters: {k: 1e10, c: 2*0.005*sqrt(k*0.5)}
bodies:
  link{n}: {for: n in 1..4, mass: 0.5, inertia: 0.5*0.09/12, position: [(n - 0.5)*0.3, 0], markers: {left: {point: [-0.15, 0]}, right: {point: [0.15, 0]}}}
forces:
  pin1: {type: bushing, i: link1.left, j: ground, stiffness: [k, k, 0], damping: [c, c, 0]}
  pin{n}: {for: n in 2..4, type: bushing, i: "link{n}.left", j: "link{n-1}.right", stiffness: [k, k, 0], damping: [c, c, 0]}
run: {duration: 0.5 s, points: 201}
"""


def hanging(k, duration):
    """A body on a weakly damped spring that is not stretched at the start, with a pendulum on it."""
    return stiffmbs.read_scene(HANGING.format(k=k, c=0.01 * np.sqrt(k), duration=duration))


def read_chain(k, damping):
    return stiffmbs.read_scene(CHAIN.replace("1e10", k).replace("2*0.005", f"2*{damping}"))


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("k", "duration", "solver", "rtol"),
    [(1e11, 0.02, "radau", 1e-6), (1e9, 0.2, "radau", 1e-3), (1e9, 0.2, "bdf", 1e-5), (1e12, 0.02, "radau", 1e-6)],
)
def test_a_vibration_that_steps_leave_out_is_an_error(k, duration, solver, rtol):
    """Forces were wrong by half of their size; their bars were a thousandth of that, and there was no note."""
    found = stiffmbs.run(hanging(k, duration), solver=solver, rtol=rtol, errors=True)
    truth = stiffmbs.run(hanging(k, duration), solver="radau", rtol=1e-11, errors=False)
    for name in ("q.fy", "h.fy", "a.ay", "a.y", "a.vy"):
        assert 0.4 < ratio(found, name, truth[name]) < 2.5, name
    assert any(note.startswith("the estimated error of") for note in found.notes)


def test_states_at_steps_are_corrected_as_outputs_are():
    """Newton's remainder at steps, which outputs do not have, made bars of forces ten to 1e5 times too large."""
    found = stiffmbs.run(read_chain("1e8", 0.5), solver="bdf", rtol=1e-3, errors=True)
    truth = stiffmbs.run(read_chain("1e8", 0.5), solver="radau", rtol=1e-10, errors=False)
    for name in ("pin2.fx", "link2.ay", "link2.ax"):
        assert 0.2 < ratio(found, name, truth[name]) < 6, name


@pytest.mark.sampled(2)
@pytest.mark.parametrize(("k", "duration", "rtol"), [(1e11, 0.02, 1e-8), (1e9, 0.2, 1e-7)])
def test_a_vibration_that_steps_follow_until_it_has_decayed_is_none(k, duration, rtol):
    found = stiffmbs.run(hanging(k, duration), solver="radau", rtol=rtol, errors=True)
    truth = stiffmbs.run(hanging(k, duration), solver="radau", rtol=1e-11, errors=False)
    assert np.abs(truth["q.fy"]).max() > 15 and ratio(found, "q.fy", truth["q.fy"]) < 20
    told = [note.split()[4] for note in found.notes if note.startswith("the estimated error of")]
    assert all(0.4 < ratio(found, name, truth[name]) < 2.5 for name in told), told


def test_motions_that_a_method_follows():
    """The error of exp(i z) by the Radau method with three and nine stages is a few percent of its size there, or a tenth."""
    from stiffmbs.solve.radau.collocation import radau

    for stages in (3, 9):
        z = 1j * _followed(stages)
        weights = np.linalg.solve(radau(stages).derivative - z * np.eye(stages), z * np.ones(stages))
        assert 0.005 < abs(1.0 + weights[-1] - np.exp(z)) < 0.3


@pytest.mark.long
@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("text", "solver", "rtol", "names"),
    [
        (FOUR_BAR, "radau", 1e-6, ("a.fx", "b.fy", "d.angle", "rocker.omega", "bush.fx")),
        (CHAIN, "bdf", 1e-6, ("link3.angle", "link1.vx", "link4.omega", "link1.x")),
    ],
    ids=["four-bar", "chain"],
)
def test_stiff_forces_out_of_balance_are_no_kinks(text, solver, rtol, names):
    """Quadratures along curves that are not in balance gave up to 10 000 times the errors, and notes."""
    found = stiffmbs.run(stiffmbs.read_scene(text), solver=solver, rtol=rtol, errors=True)
    truth = stiffmbs.run(stiffmbs.read_scene(text), solver="radau", rtol=1e-10, errors=False)
    for name in names:
        assert 0.4 < ratio(found, name, truth[name]) < 2.5, name
