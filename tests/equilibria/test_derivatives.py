"""Derivatives of steady motions and of the balance of forces against central differences."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import SteadyMotion
from stiffmbs.analyses.run import prepare
from stiffmbs.analyses.steady import _motion
from stiffmbs.equilibria.equilibrium import find_equilibrium
from stiffmbs.equilibria.force_balance import _position_rates, balance_at, moved
from stiffmbs.equilibria.matrices import dense
from stiffmbs.equilibria.steady_motion import at_rest
from stiffmbs.tuning import in_use

from ..conftest import EXAMPLES

TWO_TOPS = """
dimensions: 3
gravity: [0.4, 0, -9.81]
bodies:
  arm: {mass: 2, inertia: [0.02, 0.05, 0.04], position: [0.3, 0.1, -0.4], orientation: {euler: zxz, angles: [0.2, 0.5, -0.3]}}
  top: {mass: 1, inertia: [0.02, 0.02, 0.03], position: [0.5, 0.2, -0.1], omega: [0, 0, 40]}
joints:
  hook: {type: spherical, i: {body: arm, point: [-0.3, -0.1, 0.4]}, j: ground}
  pin: {type: spherical, i: {body: top, point: [0, 0, -0.2]}, j: arm}
forces:
  spring: {type: spring_damper, i: top, j: {body: ground, point: [0, 1, 1]}, stiffness: 30, damping: 2, free_length: 0.4}
"""
PLANE = """
bodies:
  a: {mass: 2, inertia: 0.1, position: [1, 0.2]}
  b: {mass: 1, inertia: 0.3, position: [1.4, 0.5]}
joints: {pin: {type: revolute, i: a, j: b}}
forces: {spring: {type: spring_damper, i: b, j: ground, stiffness: 30, damping: 2, free_length: 0.4}}
"""
STEP = 1e-6


def disc() -> str:
    """Return a disc that rolls on a circle."""
    text = (EXAMPLES / "rolling_disc.yaml").read_text()
    return text.replace("position: [0, 0, R", "position: [0, -2, R")


CASES = {
    "two tops on a circle": (TWO_TOPS, SteadyMotion(rotation=(0.3, -0.2, 1.5), velocity=(0.5, 0.1, 0.2), rolling=("top",))),
    "rigid on a circle": (TWO_TOPS, SteadyMotion(rotation=(0.3, -0.2, 1.5), about=(0.1, 0.2, 0))),
    "rolling disc": (disc(), SteadyMotion(rotation=0.8, rolling=("disc",))),
    "plane": (PLANE, SteadyMotion(rotation=2.0, velocity=(0.5, 0.1))),
}  # fmt: skip


@pytest.fixture(params=[True, False], ids=["dense", "sparse"], scope="module")
def storage(request):
    """Matrices are dense, as in small systems, or sparse, as in large ones."""
    with in_use({} if request.param else {"matrices": {"dense_up_to": 0}}):
        yield


@pytest.fixture(params=CASES, scope="module")
def case(request, storage):
    text, described = CASES[request.param]
    job = prepare(stiffmbs.read_scene(text), presolve=False)
    dynamics = job.dynamics
    motion = _motion(job.data, dynamics, job.start, described)
    dynamics.state.q[:] = job.start.q
    return dynamics, motion, job.start.q.copy()


def differences(dynamics, q, value):
    """Return the derivatives of a function of the pose by moves, by central differences."""
    columns = []
    for k in range(dynamics.system.n_u):
        sides = []
        for size in (-STEP, STEP):
            dynamics.state.q[:] = moved(dynamics.system, q, size * np.eye(dynamics.system.n_u)[k])
            sides.append(value())
        columns.append((sides[1] - sides[0]) / (2 * STEP))
    dynamics.state.q[:] = q
    return np.array(columns).T


def test_velocities_and_accelerations_of_a_steady_motion(case):
    dynamics, motion, q = case

    def both():
        motion.put(dynamics, 0.0)
        return np.concatenate([dynamics.state.u.copy(), motion.acceleration(dynamics)])

    expected = differences(dynamics, q, both)
    motion.put(dynamics, 0.0)
    dynamics.state.evaluate("tangent", 0.0)
    found = np.vstack([dense(part) for part in motion.derivatives(dynamics, 0.0, _position_rates(dynamics))])
    np.testing.assert_allclose(found, expected, atol=1e-7 * max(1.0, np.abs(expected).max()))


def test_stiffness_of_the_balance(case):
    """The forces that are left, with the multipliers as they are, change by the stiffness."""
    dynamics, motion, q = case
    known = balance_at(dynamics, 0.0, motion)
    state, system = dynamics.state, dynamics.system

    def left():
        motion.put(dynamics, 0.0)
        state.evaluate("motion", 0.0)
        return (
            state.vector("motion", "f")
            - state.matrix("motion", "J").T @ known.lam
            - system.mass * motion.acceleration(dynamics)
        )

    expected = -differences(dynamics, q, left)
    np.testing.assert_allclose(
        dense(known.stiffness), expected, atol=1e-7 * max(1.0, np.abs(expected).max(), np.abs(known.lam).max(initial=0))
    )


def test_the_imbalance_is_relative_to_the_largest_force():
    """A body of 2 kg on a spring that is not stretched: its whole weight is left, 19.62 of 19.62 N; at half the deflection, half."""
    text = """
gravity: [0, -9.81]
bodies: {weight: {mass: 2, inertia: 1, position: [0, %r]}}
joints: {rail: {type: prismatic, i: {body: weight, angle: 90 deg}, j: {body: ground, angle: 90 deg}}}
forces: {spring: {type: force, i: weight, force: [0, "-100*weight.y"]}}
"""
    for part in (0.0, 0.5):
        job = prepare(stiffmbs.read_scene(text % (-part * 19.62 / 100)), presolve=False)
        job.dynamics.state.q[:] = job.start.q
        known = balance_at(job.dynamics, 0.0, _motion(job.data, job.dynamics, job.start, SteadyMotion()))
        assert known.largest == pytest.approx(19.62)
        assert known.imbalance == pytest.approx(1 - part)
        assert known.imbalance * known.largest == pytest.approx(np.abs(known.left).max())


def chain(count):
    """Return a hanging chain of equal links."""
    bodies = "\n".join(f"  b{k}: {{mass: 1, inertia: 0.1, position: [{k + 0.5}, 0]}}" for k in range(count))
    ends = ["ground", *(f"{{body: b{k}, point: [0.5, 0]}}" for k in range(count - 1))]
    joints = "\n".join(
        f"  j{k}: {{type: revolute, i: {{body: b{k}, point: [-0.5, 0]}}, j: {end}}}" for k, end in enumerate(ends)
    )
    return f"gravity: [0.3, -9.81]\nbodies:\n{bodies}\njoints:\n{joints}\n"


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("links", "most", "kept_dense"), [(70, 400, True), (70, 200, False), (90, 400, False), (90, 800, True)]
)
def test_matrices_are_dense_up_to_a_number_of_unknowns(links, most, kept_dense):
    """A link has three velocities and two equations: 350 or 450 unknowns, about the default limit of 400."""
    dynamics = prepare(stiffmbs.read_scene(chain(links)), presolve=False).dynamics
    with in_use({"matrices": {"dense_up_to": most}} if most != 400 else {}):
        known = balance_at(dynamics, 0.0, at_rest(2))
    assert isinstance(known.stiffness, np.ndarray) == kept_dense


@pytest.mark.long
def test_dense_and_sparse_matrices_lead_to_the_same_equilibrium():
    poses = []
    for most in (400, 0):
        job = prepare(stiffmbs.read_scene(chain(9)), presolve=False)
        with in_use({"matrices": {"dense_up_to": most}}):
            poses.append(find_equilibrium(job.dynamics, 0.0).q)
    np.testing.assert_allclose(poses[0], poses[1], atol=1e-9)
    assert np.arctan2(poses[0][1], poses[0][0]) == pytest.approx(np.arctan2(-9.81, 0.3))
