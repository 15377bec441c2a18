"""A car on leaf springs over a bumpy road, 3 s: balances of momentum and energy from its channels, and another integrator."""

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson

import stiffmbs
from stiffmbs.compile.quaternions import rotated
from stiffmbs.reading.marker import GROUND
from stiffmbs.results.marker_motion import Measures
from stiffmbs.tyres import Tyre

from ..conftest import EXAMPLES

SCENE = EXAMPLES / "vehicles" / "leaf_sprung_car.yaml"
GRAVITY = np.array([0, 0, -9.81])


@pytest.fixture(scope="module")
def run():
    return stiffmbs.run(SCENE, output=5e-4, rtol=1e-8)


@pytest.fixture(scope="module")
def scene():
    return stiffmbs.load_scene(SCENE)


def vector(run, owner, names):
    return np.stack([run[f"{owner}.{name}"] for name in names.split()], axis=1)


def rotation(run, body):
    """Angular velocity in ground axes."""
    return rotated(vector(run, body, "q0 q1 q2 q3"), vector(run, body, "wx wy wz"))


def velocity_at(run, body, place):
    if body == GROUND:
        return np.zeros(place.shape)
    arm = place - vector(run, body, "x y z")
    return vector(run, body, "vx vy vz") + np.cross(rotation(run, body), arm)


def impulse(run, rates):
    return cumulative_simpson(rates, x=run.time, axis=0, initial=0)


def wrench(scene, run, name):
    """Force, torque about the place where it acts, and that place, in ground axes."""
    force = scene.forces[name]
    return (
        vector(run, name, "fx fy fz"),
        vector(run, name, "tx ty tz"),
        np.stack(Measures(scene, run.__getitem__, {}.__getitem__, np).marker(force.i).point, axis=1),
    )


@pytest.mark.long
def test_momentum_and_angular_momentum_change_by_what_tyres_and_gravity_do(scene, run):
    mass = sum(body.mass for body in scene.bodies.values())
    momentum = sum(body.mass * vector(run, name, "vx vy vz") for name, body in scene.bodies.items())
    angular, pull = np.zeros(momentum.shape), np.zeros(momentum.shape)
    for name, body in scene.bodies.items():
        place = vector(run, name, "x y z")
        angular += np.cross(place, body.mass * vector(run, name, "vx vy vz"))
        own = vector(run, name, "wx wy wz") @ np.array(body.inertia)
        angular += rotated(vector(run, name, "q0 q1 q2 q3"), own)
        pull += np.cross(place, body.mass * GRAVITY)
    tyres = [wrench(scene, run, name) for name, force in scene.forces.items() if isinstance(force, Tyre)]
    force = mass * GRAVITY + sum(force for force, _, _ in tyres)
    torque = pull + sum(np.cross(place, force) + torque for force, torque, place in tyres)
    assert momentum - momentum[0] == pytest.approx(impulse(run, force), abs=2e-6 * np.max(np.abs(momentum)))
    assert angular - angular[0] == pytest.approx(impulse(run, torque), abs=1e-6 * np.max(np.abs(angular)))


@pytest.mark.long
def test_energy_changes_by_the_work_of_all_forces(scene, run):
    """Ideal joints do no work: kinetic energy and that of gravity change by what springs, bushings, dampers and tyres do."""
    height = sum(body.mass * run[f"{name}.z"] for name, body in scene.bodies.items())
    energy = run["energy.kinetic"] + 9.81 * height
    power = 0.0
    for name, force in scene.forces.items():
        acting, torque, place = wrench(scene, run, name)
        ends = [force.i.body, force.j.body if force.j is not None else GROUND]
        (v, u), (w, r) = (
            [velocity_at(run, body, place) for body in ends],
            [np.zeros(place.shape) if body == GROUND else rotation(run, body) for body in ends],
        )
        power = power + np.sum(acting * (v - u) + torque * (w - r), axis=1)
    work = impulse(run, power)
    assert np.ptp(work) > 1e3
    assert energy - energy[0] == pytest.approx(work, abs=1e-6 * np.max(energy))


@pytest.mark.long
def test_an_explicit_integrator_agrees(run):
    tight = stiffmbs.run(SCENE, output=5e-4, solver="projected", scheme="dop853", rtol=1e-10)
    for name in ("chassis.x", "chassis.y", "chassis.z", "front.axle.z", "rear.left_wheel.z"):
        assert run[name] == pytest.approx(tight[name], abs=2e-9), name
    usual = stiffmbs.run(SCENE, output=5e-4)
    assert np.max(np.abs(usual["chassis.z"] - tight["chassis.z"])) < 1e-7
    loads = [f"{name}.tyre.load" for name in ("front.left", "front.right", "rear.left", "rear.right")]
    assert min(tight[name].min() for name in loads) < 2500 < 4500 < max(tight[name].max() for name in loads)
