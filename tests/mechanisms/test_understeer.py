"""The understeer gradient of the example car on a circle, against the bicycle model whose axles are measured on their rig."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import stiffmbs
from stiffmbs.tyres import TyreProperties

from ..conftest import EXAMPLES
from .bicycle import AxleOnRig, Car, turning

WHEELBASE, TRACK = 2.7, 1.52
RADIUS, ACCELERATIONS = 100.0, (0.5, 1.0, 1.5, 2.0, 2.5)


def car(word, *changes):
    """The car without air; its rack slides on the body, where the driver's drive holds it."""
    air = ("parts.air.parameters", "{drag_area: 0, side_area: 0, lift_area: 0}")
    rack = ("parts.steering.compliance", "rigid")
    return stiffmbs.load_scene(EXAMPLES / "car.yaml", [("choose.compliance", word), air, rack, *changes])


def on_circle(word):
    """Lateral acceleration, radius and travel of the rack of steady turns, shape (n,)."""
    found = []
    for acceleration in ACCELERATIONS:
        speed = np.sqrt(acceleration * RADIUS)
        circle = ("R", str(RADIUS)), ("choose.manoeuvre", "circle")
        run = stiffmbs.run(car(word, ("V", str(speed)), *circle), duration=20, output=0.5, rtol=1e-6)
        assert np.ptp(run["rack_travel"][-3:]) < 1e-6
        speed, rate = np.hypot(run["chassis.vx"][-1], run["chassis.vy"][-1]), run["chassis.wz"][-1]
        found.append((speed * rate, speed / rate, run["rack_travel"][-1]))
    return np.array(found).T


def by_axles(word):
    """The car for the bicycle model, and its steer angle of the wheels over the travel of the rack, rad and m."""
    scene = car(word, ("V", "0"))
    rest = stiffmbs.equilibrium(scene).channels
    masses = {name: body.mass for name, body in scene.bodies.items()}
    whole = sum(masses.values())
    x, z = (sum(mass * rest[f"{name}.{axis}"] for name, mass in masses.items()) / whole for axis in "xz")
    tyre, axles, steer = TyreProperties.from_file(EXAMPLES / "car.tir"), [], None
    for name in ("front", "rear"):
        rig = stiffmbs.kinematics_and_compliance(
            scene, name, bump=50, steer=10, lateral=0, brake=0, traction=0, aligning=0
        )
        wheel, load = rest[f"{name}.left.wheel.z"], rest[f"{name}.left.tyre.load"]
        axles.append(AxleOnRig(rig, TRACK, tyre, load, wheel, lift=wheel - 0.30 - (rest["chassis.z"] - 0.55)))
        if name == "front":
            sweep = rig.sweeps["steer"]
            mean = (sweep.channels["right.toe"] - sweep.channels["left.toe"]) / 2
            steer = CubicSpline(1e-3 * sweep.abscissa, np.radians(mean))
    chassis = masses["chassis"], rest["chassis.z"]
    return Car(whole, z, *chassis, to_front=1.25 - x, to_rear=1.45 + x, spin_inertia=1.1), axles, steer


def gradient(accelerations, angles):
    """The slope at no lateral acceleration."""
    powers = np.stack([accelerations**k for k in range(4)], axis=1)
    return np.linalg.lstsq(powers, angles, rcond=None)[0][1]


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("word", ["rigid", "bushing"])
def test_the_understeer_gradient_is_that_of_the_axles(word):
    accelerations, radii, racks = on_circle(word)
    vehicle, axles, steer = by_axles(word)
    turns = [turning(vehicle, *axles, a, radius)[0] for a, radius in zip(accelerations, radii, strict=True)]
    measured, expected = (
        gradient(accelerations, angle - WHEELBASE / radii) for angle in (steer(racks), np.array(turns))
    )
    assert measured == pytest.approx(expected, rel=0.05)
    by_tyres = [
        vehicle.mass * share / WHEELBASE / 2 / stiffness(axle)
        for axle, share in zip(axles, (vehicle.to_rear, vehicle.to_front), strict=True)
    ]
    assert by_tyres[0] - by_tyres[1] < 0.5 * measured, "slip alone is less than half of it"


def stiffness(axle, step=1e-5):
    """Cornering stiffness of a tyre, N/rad."""
    sides = (float(axle.tyre.wrench(axle.load, slip_angle=sign * step)["lateral"]) for sign in (-1, 1))
    return -np.subtract(*reversed(list(sides))) / (2 * step)
