"""Modes of bodies that roll while they move: fewer free velocities than poses."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs.linear_analysis.modes import Motion
from tests.stress.families.analyses.rolling_modes import SKATE, TRAILER
from tests.stress.mechanisms.bicycle import bicycle, published

pytestmark = pytest.mark.long  # kernels that no other test compiles, or many scenes


@pytest.mark.sampled(15)
@pytest.mark.parametrize("speed", range(11))
def test_the_benchmark_bicycle_has_its_published_eigenvalues(speed):
    """Weave, capsize and castering, and rolling on as the only rigid body motion."""
    found = stiffmbs.modes(bicycle(float(speed)))
    values = np.array([value for mode in found.modes for value in mode.eigenvalues])
    assert found.degrees_of_freedom == len(found.modes) == 3
    assert found.modes[0].motion is Motion.RIGID and not np.any(values[:2])
    np.testing.assert_allclose(np.sort_complex(values[2:]), np.sort_complex(published(speed)), rtol=1e-11, atol=1e-11)


def test_the_published_table_at_five_metres_per_second():
    """Table 2 of Meijaard et al. (2007)."""
    table = [-0.77534188219585 + 4.46486771378823j, -0.32286642900409, -14.07838969279822]
    for value in table:
        assert np.min(np.abs(published(5.0) - value)) < 1e-12


def test_rolling_on_turns_the_wheels_of_a_bicycle():
    found = stiffmbs.modes(bicycle(5.0))
    rear, front = (6 * found.about.dynamics.system.bodies.index(name) for name in ("rear", "front"))
    shape = found.modes[0].shape.real
    assert shape[rear + 4] / shape[rear] == pytest.approx(-1 / 0.3)
    assert shape[front + 4] / shape[rear] == pytest.approx(-1 / 0.35)
    weave = next(number for number, mode in enumerate(found.modes, 1) if mode.motion is Motion.OSCILLATING)
    assert np.ptp(found.shape(weave, amplitude=0.01)["frame.q1"]) > 1e-3


def test_an_eigenvalue_of_a_pose_alone_stands_alone():
    """A skate steered by its sideways place: s^3 + 2 s^2 / I + 3 V / I = 0; its way ahead stays a rigid body motion."""
    scene = stiffmbs.read_scene(SKATE.format(speed=1.0, ahead=0, spring=3, damping=2, centring=0))
    found = stiffmbs.modes(scene)
    assert [len(mode.eigenvalues) for mode in found.modes] == [2, 2, 1]
    assert found.modes[0].motion is Motion.RIGID
    alone = stiffmbs.modes(stiffmbs.read_scene(TRAILER.format(speed=2.0)))
    assert [mode.eigenvalues for mode in alone.modes] == [(pytest.approx(-2.5),)]
    assert alone.degrees_of_freedom == 0 and "0 degrees of freedom" in alone.table()


def test_dampers_that_end_two_motions_of_what_rolls_are_two_modes():
    """Two driven skates whose turning is damped: each heading is free, and neither is a rigid body motion."""
    one = """
  {name}: {{mass: 1, inertia: 1, position: [0, {y}], velocity: [1, 0]}}"""
    grip = """
  {name}_grip: {{type: velocity_equation, zero: "vy({name})*cos(az({name})) - vx({name})*sin(az({name}))"}}
  {name}_drive: {{type: velocity_equation, zero: "vx({name})*cos(az({name})) + vy({name})*sin(az({name})) - 1"}}"""
    damper = """
  {name}_damper: {{type: torque, i: {name}, torque: "-{rate}*{name}.omega"}}"""
    names = (("left", 0, 2), ("right", 1, 5))
    parts = ("".join(text.format(name=name, y=y, rate=rate) for name, y, rate in names) for text in (one, grip, damper))
    found = stiffmbs.modes(stiffmbs.read_scene("bodies:{}\njoints:{}\nforces:{}".format(*parts)))
    values = sorted(tuple(value.real for value in mode.eigenvalues) for mode in found.modes)
    np.testing.assert_allclose(values, [(-5, 0), (-2, 0)], atol=1e-12)
