"""Errors by contacts that are touched for less than the error of a run, against closed forms.

A mass on a spring touches, at each of its maxima, a stop that pushes another mass: x = cos(w t), and a force k (x - c).
"""

from types import SimpleNamespace
from unittest.mock import patch

import numpy as np
import pytest

import stiffmbs
from stiffmbs.error_estimate import along_run, grazed

W, T = 200.0, 0.3
FORMULA, TABLE = "{k}*max(q.x - {c}, 0)", "law(q.x - {c})"


def run(force, k, c, **how):
    scene = """
        gravity: [0, 0]
        tables: {law: {table: [[-3, 0], [0, 0], [1, K]], lines: true}}
        bodies:
          q: {mass: 1, inertia: 1, position: [1, 0]}
          b: {mass: 1, inertia: 1, position: [0, 1]}
        forces:
          spring: {type: force, i: q, force: ["-W^2*q.x", 0]}
          push: {type: force, i: b, force: [FORCE, 0]}
        run: {duration: T, points: 31}
        """
    for name, value in {"FORCE": f'"{force.format(k=k, c=c)}"', "W": W, "K": k, "T": T}.items():
        scene = scene.replace(name, str(value))
    return stiffmbs.run(stiffmbs.read_scene(scene), errors=True, **how)


def pushed(k, c):
    """Return the position of the other mass at the end: each impulse moves it from then on, and half of one from the start."""
    reach = np.arccos(c) / W
    impulse = k * 2.0 * (np.sin(W * reach) / W - c * reach)
    later = k * (reach * np.sin(W * reach) / W + (np.cos(W * reach) - 1.0) / W**2 - 0.5 * c * reach**2)
    times = np.arange(1, int(T * W / (2.0 * np.pi)) + 1) * 2.0 * np.pi / W
    return impulse * (0.5 * T + (T - times).sum()) - later


def ratio(found, k, c):
    """Return the estimated error of the other mass relative to the true one, at the end."""
    return found.errors["b.x"].over_time / abs(found["b.x"][-1] - pushed(k, c))


@pytest.mark.parametrize("force", [FORMULA, TABLE])
@pytest.mark.parametrize(("solver", "rtol"), [("bdf", 1e-5), ("bdf", 1e-6), ("radau", 1e-4), ("radau", 1e-8)])
def test_a_contact_within_the_error_is_in_the_estimate(force, solver, rtol):
    k, c = 1e6, 0.99999
    assert 0.2 < ratio(run(force, k, c, solver=solver, rtol=rtol), k, c) < 5.0


def test_a_linear_estimate_misses_the_contact():
    k, c = 1e6, 0.99999
    with patch.object(along_run, "missed_forces", lambda dynamics, at, errors: (np.empty(0), np.empty((0, 0)))):
        found = run(FORMULA, k, c, solver="bdf", rtol=1e-5)
    assert ratio(found, k, c) < 1e-3


def test_a_contact_that_may_be_touched_is_in_the_estimate():
    """An error of 0.1 mm is not known to 0.1 um, by which a stop is reached or not."""
    k, c = 1e9, 0.9999999
    found = run(FORMULA, k, c, solver="bdf", rtol=1e-5)
    assert found.errors["b.x"].over_time > abs(found["b.x"][-1] - pushed(k, c))


@pytest.mark.parametrize("rtol", [1e-4, 1e-6])
def test_a_contact_beyond_the_errors_is_not(rtol):
    found = run(FORMULA, 1e9, 1.02, solver="bdf", rtol=rtol)
    assert found.errors["q.x"].over_time > 1e-6
    assert found.errors["b.x"].over_time == 0.0


def test_a_least_distance_within_the_rounding_of_times_is_found():
    """The search did not end where intervals of 1 ns, in a short contact, were to become shorter than the rounding of 1 s."""
    lowest, searches = 1.0 + 3e-10, iter(range(100))

    def distances(t, kinks, sides):
        next(searches)
        return (t - lowest) ** 2

    curves, kinks = SimpleNamespace(distances=distances), np.array([0])
    found, least = grazed._lowest(curves, np.array([1.0]), np.array([1.0 + 1e-9]), kinks, np.ones(1))
    assert abs(found[0] - lowest) < 1e-15
    assert least[0] < 1e-30


def test_errors_of_time_and_of_states_that_cancel_reach_no_contact():
    """A stop that is barely touched turns errors into a shift of time and its opposite in the states: 140 times the true error.

    Of two stops the motion touches one, and is 2 um away from the other.
    """
    scene = """
        gravity: [0, 0]
        parameters: {k: 32596.23, left: 0.9999882102, right: 1.0000021387}
        bodies: {q: {mass: 1, inertia: 1, position: [0.4115968762408526, 0], velocity: [34.125478586670525, 0]}}
        forces: {spring: {type: force, i: q, force: ["-1402.0769294634733*q.x - k*max(q.x - right, 0) + 17459.163*max(-q.x - left, 0)", 0]}}
        run: {duration: 1.5134552627746631, points: 1001}
        """
    found = {}
    for rtol in (2.8482707294149758e-06, 1e-11):
        found[rtol] = stiffmbs.run(stiffmbs.read_scene(scene), solver="bdf", rtol=rtol, errors=True)
    rough, fine = found.values()
    assert rough.errors["q.x"].over_time < 5.0 * np.abs(rough["q.x"] - fine["q.x"]).max()


DRIVEN = """
    gravity: [0, 0]
    bodies: {q: {mass: 1, inertia: 1, position: [C, 0]}, b: {mass: 1, inertia: 1, position: [0, 1]}}
    joints:
      rail: {type: prismatic, i: q, j: ground}
      motor: {type: drive, joint: rail, position: "cos(W*t + 0.3)"}
    forces: {push: {type: force, i: b, force: ["K*max(q.x - 0.9999912, 0)", 0]}}
    run: {duration: T, points: 11}
    """


@pytest.mark.parametrize("solver", ["bdf", "radau"])
@pytest.mark.parametrize("rtol", [1e-4, 1.4e-5, 1e-6])
def test_a_driven_body_that_touches_a_stop(solver, rtol):
    """A prescribed position has no error at the ends of steps; a run may miss the stop between them, but not without an error bar."""
    w, k, end, c = 14.466, 1.16e6, 5.0, 0.9999912
    values = {"C": np.cos(0.3), "W": w, "K": k, "T": end}
    scene = DRIVEN
    for name, value in values.items():
        scene = (
            scene.replace(f"[{name},", f"[{value},").replace(f"{name}*", f"{value}*").replace(f" {name},", f" {value},")
        )
    found = stiffmbs.run(stiffmbs.read_scene(scene), solver=solver, rtol=rtol, errors=True)
    reach = np.arccos(c) / w
    peaks = (2.0 * np.pi * np.arange(1, 12) - 0.3) / w
    pushed = 2.0 * k * (np.sin(w * reach) / w - c * reach) * (end - peaks).sum()
    error = abs(found["b.x"][-1] - pushed)
    assert 0.3 * error < found.errors["b.x"].over_time < 3.0 * error
    assert error < {1e-4: 0.5, 1.4e-5: 0.05, 1e-6: 1e-3}[rtol] * pushed


@pytest.mark.parametrize("rtol", [7.5e-4, 7.5e-5, 7.5e-7, 7.5e-8])
def test_stages_of_explicit_steps_that_end_at_a_stop_are_before_it(rtol):
    """Stages are far less accurate than the ends of long steps: a soft stop pushed before it was touched, at any tolerance."""
    w, k, end, c = np.sqrt(9.814945), 12.8855, 12.0, 0.99994533
    scene = """
        gravity: [0, 0]
        bodies: {q: {mass: 1, inertia: 1, position: [1, 0]}, b: {mass: 1, inertia: 1, position: [0, 1]}}
        forces:
          spring: {type: force, i: q, force: ["-9.814945*q.x", 0]}
          push: {type: force, i: b, force: ["12.8855*max(q.x - 0.99994533, 0)", 0]}
        run: {duration: 12, points: 11}
        """
    found = stiffmbs.run(stiffmbs.read_scene(scene), solver="projected", scheme="dop853", rtol=rtol, errors=True)
    reach = np.arccos(c) / w
    later = k * (reach * np.sin(w * reach) / w + (np.cos(w * reach) - 1.0) / w**2 - 0.5 * c * reach**2)
    times = 2.0 * np.pi * np.arange(1, int(end * w / (2.0 * np.pi)) + 1) / w
    impulse = 2.0 * k * (np.sin(w * reach) / w - c * reach)
    error = abs(found["b.x"][-1] - (impulse * (0.5 * end + (end - times).sum()) - later))
    assert error < rtol
    assert 0.5 * error < found.errors["b.x"].over_time < 2.0 * error


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8])
def test_a_driven_arm_in_space_that_touches_a_stop(rtol):
    """`radau` prescribes quaternions at its nodes; between them, they are closed onto the drive."""
    w, k, end, c = 14.466, 1.16e6, 5.0, 0.9999912
    turned = "orientation: {x: [0.955336489125606, 0.29552020666133955, 0], z: [0, 0, 1]}"
    scene = f"""
        dimensions: 3
        gravity: [0, 0, 0]
        bodies:
          arm: {{mass: 1, inertia: [1, 1, 1], {turned}, markers: {{tip: {{point: [1, 0, 0]}}}}}}
          b: {{mass: 1, inertia: [1, 1, 1], position: [0, 1, 0]}}
        joints:
          hinge: {{type: revolute, i: arm, j: {{body: ground, {turned}}}}}
          motor: {{type: drive, joint: hinge, position: "{w}*t"}}
        forces: {{push: {{type: force, i: b, force: ["{k}*max(dx(arm.tip) - {c}, 0)", 0, 0]}}}}
        run: {{duration: {end}, points: 11}}
        """
    found = stiffmbs.run(stiffmbs.read_scene(scene), solver="radau", rtol=rtol, errors=True)
    reach = np.arccos(c) / w
    pushed = 2.0 * k * (np.sin(w * reach) / w - c * reach) * (end - (2.0 * np.pi * np.arange(1, 12) - 0.3) / w).sum()
    error = abs(found["b.x"][-1] - pushed)
    assert error < 1e-2 * pushed * np.sqrt(rtol)
    assert 0.3 * error < found.errors["b.x"].over_time < 3.0 * error
