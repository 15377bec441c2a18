"""All solvers in space: one motion from every engine, formulation and scheme, and what motions of free bodies conserve."""

import numpy as np
import pytest

import stiffmbs
from stiffmbs import spatial
from stiffmbs.elements.spatial.orientation import matrix
from stiffmbs.solve.error_control.error_test import CHOSEN, ErrorControl
from tests.bench.error_bars import PROBLEMS
from tests.bench.evenness import evenness

from ..spatial_closed_forms import matrices

TENSOR = [[0.3, 0.02, -0.05], [0.02, 0.4, 0.03], [-0.05, 0.03, 0.25]]
TURN = (0.8, 0.6, 0.0, 0.0)
RTOL = 1e-8
SETTINGS = {"duration": 1.0, "points": 41, "rtol": RTOL}


def tumbling():
    model = spatial.Model("a free body")
    model.add("body", spatial.Body(mass=2, inertia=TENSOR, omega=(1, 3, 0.5), velocity=(0.1, 0.2, -0.3)))
    return model


def top():
    model = spatial.Model("a spinning top", gravity=(0, 0, -9.81))
    tilted = {"euler": "zxz", "angles": [0, 0.6, 0]}
    body = {"mass": 1, "inertia": (0.06, 0.06, 0.04), "center_of_mass": (0, 0, 0.2), "orientation": tilted}
    model.add("top", spatial.Body(**body, omega=(0, 0, 20)))
    model.add("tip", spatial.Spherical(i="top", j="ground"))
    return model


def double_pendulum():
    """Two bodies with full tensors on hinges of any directions."""
    model = spatial.Model("a double pendulum", gravity=(1, -2, -9.81))
    upper, lower, elbow = np.array([0.3, 0.1, -0.2]), np.array([0.6, 0.5, -0.3]), np.array([0.3, 0.3, -0.2])
    model.add("upper", spatial.Body(mass=1, inertia=TENSOR, position=tuple(upper), orientation=TURN))
    model.add("lower", spatial.Body(mass=2, inertia=TENSOR, position=tuple(lower)))
    first, second, back = np.array([1.0, 2.0, -0.5]), np.array([-0.3, 0.4, 1.0]), matrix(TURN).T

    def marker(body, point, axis):
        return spatial.Marker(body=body, point=tuple(point), orientation={"z": tuple(axis)})

    model.add(
        "shoulder",
        spatial.Revolute(i=marker("upper", back @ -upper, back @ first), j=marker("ground", (0, 0, 0), first)),
    )
    on_upper, on_lower = marker("upper", back @ (elbow - upper), back @ second), marker("lower", elbow - lower, second)
    model.add("elbow", spatial.Revolute(i=on_lower, j=on_upper))
    return model


SCENES = {"tumbling": tumbling, "top": top, "double_pendulum": double_pendulum}
EXACT = {"solver": "projected", "scheme": "dop853", "rtol": 1e-13}


@pytest.fixture(scope="module")
def exact():
    return {name: stiffmbs.run(make(), **{**SETTINGS, **EXACT}) for name, make in SCENES.items()}


def off(found, expected):
    """Largest error of places and quaternions, and of the size of reactions."""
    assert found.outcome.name == "DONE"
    motion = [name for name in expected if name.endswith((".x", ".y", ".z", ".q0", ".q1", ".q2", ".q3"))]
    forces = [name for name in expected if name.endswith((".fx", ".fy", ".fz", ".tx", ".ty", ".tz"))]
    largest = max((np.max(np.abs(expected[name])) for name in forces), default=1.0)
    return tuple(
        max((np.max(np.abs(found[name] - expected[name])) for name in names), default=0.0) / size
        for names, size in ((motion, 1.0), (forces, largest))
    )


ERRORS = {"SI2": 4e-7, "SI2_exact": 4e-7, "SI1": 4e-7, "I3": 4e-4, "index1": 4e-7}


@pytest.mark.sampled(4)
@pytest.mark.parametrize("formulation", ERRORS)
@pytest.mark.parametrize("scene", SCENES)
def test_all_formulations_give_one_motion(scene, formulation, exact):
    found = stiffmbs.run(SCENES[scene](), **SETTINGS, formulation=formulation)
    motion, forces = off(found, exact[scene])
    assert motion < ERRORS[formulation]
    assert forces < 20 * ERRORS[formulation]


@pytest.mark.parametrize("settings", [
    {"solver": "projected", "scheme": "dopri5"}, {"solver": "projected", "scheme": "dop853"}, {"solver": "auto"},
    {"solver": "projected", "scheme": "dop853", "projection": False}, {"presolve": False},
], ids=str)  # fmt: skip
@pytest.mark.parametrize("scene", SCENES)
def test_all_schemes_give_one_motion(scene, settings, exact):
    motion, forces = off(stiffmbs.run(SCENES[scene](), **SETTINGS, **settings), exact[scene])
    assert motion < 4e-7
    assert forces < 4e-6


@pytest.mark.sampled(5)
@pytest.mark.parametrize("projection", [True, False])
@pytest.mark.parametrize(
    ("scheme", "order", "steps"), [("rk4", 4, (1 / 80, 1 / 160)), ("euler_cromer", 1, (1 / 400, 1 / 800))]
)
@pytest.mark.parametrize("scene", SCENES)
def test_schemes_of_fixed_steps_have_their_order(scene, scheme, order, steps, projection, exact):
    settings = {**SETTINGS, "solver": "projected", "scheme": scheme, "projection": projection}
    errors = [off(stiffmbs.run(SCENES[scene](), **settings, step=step), exact[scene])[0] for step in steps]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.35)


CONSERVED = {"bdf": 2e-6, "dop853": 1e-9, "rk4": 1e-9}


@pytest.mark.parametrize("solver", CONSERVED)
def test_a_free_body_keeps_its_energy_and_angular_momentum(solver):
    settings = {"duration": 20.0, "points": 201, "rtol": 1e-10}
    how = {} if solver == "bdf" else {"solver": "projected", "scheme": solver, "step": 2e-3}
    found = stiffmbs.run(tumbling(), **settings, **how)
    omega = np.stack([found[f"body.{name}"] for name in ("wx", "wy", "wz")])
    turned = matrices(np.stack([found[f"body.q{k}"] for k in range(4)]))
    momentum = np.einsum("nij,jn->in", turned, np.array(TENSOR) @ omega)
    drift = np.max(np.abs(momentum - momentum[:, :1])) / np.linalg.norm(momentum[:, 0])
    energy = np.max(np.abs(found["energy.kinetic"] / found["energy.kinetic"][0] - 1))
    assert max(drift, energy) < CONSERVED[solver]
    assert np.max(np.abs(omega - omega[:, :1])) > 1
    np.testing.assert_allclose(found["body.z"], -0.3 * found.time, atol=1e-12)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_quaternion_may_begin_with_either_sign(sign, exact):
    """It stays the one that was given, and the motion is the same."""
    model = spatial.Model("a free body")
    body = {"mass": 2, "inertia": TENSOR, "omega": (1, 3, 0.5), "velocity": (0.1, 0.2, -0.3)}
    model.add("body", spatial.Body(**body, orientation=(sign, 0, 0, 0)))
    found = stiffmbs.run(model, **SETTINGS)
    for k in range(4):
        np.testing.assert_allclose(found[f"body.q{k}"], sign * exact["tumbling"][f"body.q{k}"], atol=1e-7)


def driven_slider_crank(examples):
    """Of the examples, with a motor that speeds up, through several turns."""
    text = (examples / "spatial_slider_crank.yaml").read_text(encoding="utf-8")
    motor = "  motor: {type: drive, joint: shaft, position: rate*t + 0.3*t^2}"
    return stiffmbs.read_scene(text.replace("\nfigure:", f"{motor}\n\nfigure:"))


def test_a_mechanism_that_is_driven_moves_the_same_by_kinematics_and_by_dynamics(examples):
    scene = driven_slider_crank(examples)
    settings = {"duration": 3.0, "points": 101}
    kinematic = stiffmbs.run(scene, **settings, solver="kinematic")
    for how in ({"rtol": 1e-10}, {"solver": "projected", "scheme": "dop853", "rtol": 1e-11}):
        dynamic = stiffmbs.run(scene, **settings, **how)
        for name in ("slider.x", "crank.q0", "rod.q1", "rod.wx", "motor.tx", "ball.fy", "energy.total"):
            np.testing.assert_allclose(dynamic[name], kinematic[name], atol=1e-9)
    turned = np.unwrap(2 * np.arctan2(kinematic["crank.q1"], kinematic["crank.q0"]))
    np.testing.assert_allclose(turned, 6 * kinematic.time + 0.3 * kinematic.time**2, atol=1e-12)
    power = kinematic["motor.tx"] * kinematic["crank.wx"]
    work = np.sum((power[1:] + power[:-1]) / 2 * np.diff(kinematic.time))
    assert work == pytest.approx(kinematic["energy.total"][-1] - kinematic["energy.total"][0], abs=2e-3)


def bouncing_top():
    """A tumbling body on a floor that pushes its corner back, and a gust that begins and ends."""
    return stiffmbs.read_scene(
        """
        dimensions: 3
        gravity: [0, 0, -9.81]
        bodies:
          block:
            mass: 1
            inertia: [0.01, 0.02, 0.025]
            position: [0, 0, 0.5]
            omega: [3, 2, 5]
            markers: {corner: {point: [0.2, 0.1, -0.1]}}
        forces:
          floor: {type: force, i: block.corner, force: [0, 0, "max(0, -2000*dz(block.corner))"]}
          gust: {type: force, i: block, force: [0, "3*step(t, 0.2, 0, 0.21, 1)*step(t, 0.25, 1, 0.26, 0)", 0]}
        run: {duration: 1.0, points: 101, rtol: 1e-9}
        """
    )


@pytest.mark.long
def test_corners_in_time_and_state_are_met_in_space():
    exact = stiffmbs.run(bouncing_top(), solver="projected", scheme="dop853", rtol=1e-12)
    found = stiffmbs.run(bouncing_top())
    assert found.solver["events"] == exact.solver["events"] >= 4
    assert found.solver["breakpoints"] == exact.solver["breakpoints"] == 4
    motion, forces = off(found, exact)
    assert motion < 1e-6
    assert forces < 1e-5


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("name", ["heavy_top", "governor"])
def test_errors_fall_evenly_with_the_tolerance(name):
    """By rtol^(5/6), as order 5 has it, also in even motions, whose steps hardly change."""
    found, idas = (evenness(PROBLEMS[name], control) for control in (CHOSEN[3], ErrorControl(margin=0.15)))
    assert found.slope == pytest.approx(5 / 6, abs=0.1)
    assert found.scatter < 1.5 < idas.scatter
    assert found.risen <= 4 < idas.risen
    assert found.steps < idas.steps
