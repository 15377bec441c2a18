"""A car with hard points and a tyre of its own, through all analyses, and against the bicycle model of its axles."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import stiffmbs
from stiffmbs.tyres import TyreProperties

from ..conftest import EXAMPLES
from .bicycle import AxleOnRig, Car, turning
from .test_understeer import gradient

pytestmark = pytest.mark.long
DATA = EXAMPLES.parent / "tests" / "data"
TO_FRONT, TO_REAR, HEIGHT = 1.22, 1.50, 0.57
WHEELBASE, SPEED = TO_FRONT + TO_REAR, 80 / 3.6
AXLES = {"front": (1.55, 0.3118), "rear": (1.54, 0.3156)}  # track, and height of the wheels as described, m
NO_AIR = ("parts.air.parameters", "{drag_area: 0, side_area: 0, lift_area: 0}")
ON_BODY = ("parts.steering.compliance", "rigid")


def car(*changes):
    return stiffmbs.load_scene(DATA / "own_car.yaml", [NO_AIR, ON_BODY, *changes])


def on_circle(acceleration, radius=100.0):
    """Return lateral acceleration, radius, travel of the rack and roll angle of a steady turn."""
    circle = ("parts.driver.path", "course"), ("path", f"{{circle: {radius}}}"), ("joints", "{}")
    run = stiffmbs.run(car(("V", str(np.sqrt(acceleration * radius))), *circle), duration=16, output=0.5, rtol=1e-6)
    assert np.ptp(run["driver.travel"][-3:]) < 1e-6
    speed, rate = np.hypot(run["chassis.vx"][-1], run["chassis.vy"][-1]), run["chassis.wz"][-1]
    return speed * rate, speed / rate, run["driver.travel"][-1], run["vehicle.roll"][-1]


def by_axles():
    """The car for the bicycle model, its axles on their rig, and the steer angle of its wheels over the rack's travel."""
    scene = car(("V", "0"))
    rest = stiffmbs.equilibrium(scene).channels
    masses = {name: body.mass for name, body in scene.bodies.items()}
    whole = sum(masses.values())
    loads = [rest[f"{end}.{side}.tyre.fz"] for end in AXLES for side in ("left", "right")]
    assert sum(loads) == pytest.approx(9.81 * whole, rel=1e-9)
    assert rest["chassis.z"] == pytest.approx(HEIGHT, abs=2e-3)
    x, z = (sum(mass * rest[f"{name}.{axis}"] for name, mass in masses.items()) / whole for axis in "xz")
    assert loads[0] + loads[1] == pytest.approx(9.81 * whole * (TO_REAR + x) / WHEELBASE, rel=2e-3)
    tyre, axles = TyreProperties.from_file(DATA / "own_car.tir"), []
    for end, (track, described) in AXLES.items():
        rig = stiffmbs.kinematics_and_compliance(
            scene, end, bump=50, steer=10, lateral=0, brake=0, traction=0, aligning=0
        )
        wheel = rest[f"{end}.left.wheel.z"]
        lift = wheel - described - (rest["chassis.z"] - HEIGHT)
        axles.append(AxleOnRig(rig, track, tyre, rest[f"{end}.left.tyre.load"], wheel, lift=lift))
        if end == "front":
            sweep = rig.sweeps["steer"]
            mean = (sweep.channels["right.toe"] - sweep.channels["left.toe"]) / 2
            steer = CubicSpline(1e-3 * sweep.abscissa, np.radians(mean))
    return (
        Car(whole, z, masses["chassis"], rest["chassis.z"], TO_FRONT - x, TO_REAR + x, spin_inertia=1.1),
        axles,
        steer,
    )


ACCELERATIONS = np.array([0.5, 1, 1.5, 2, 2.5])


@pytest.mark.sampled(5)
@pytest.mark.parametrize(
    ("test", "radii"),
    [("constant_radius", np.full(5, 100.0)), ("constant_speed", SPEED**2 / ACCELERATIONS)],
    ids=["circle", "ramp"],
)
def test_both_tests_of_steady_cornering_have_the_gradients_of_its_axles(test, radii):
    """The slow ramp at 80 km/h and the circle of 100 m, without air: their turns differ in speed and radius alone."""
    vehicle, axles, steer = by_axles()
    found = stiffmbs.handling(car(), [test], workers=1)
    assert found.ratio == pytest.approx(float(steer(0.0, 1)), rel=0.01)
    turns = np.array([turning(vehicle, *axles, *turn) for turn in zip(ACCELERATIONS, radii, strict=True)])
    understeer, roll = (gradient(ACCELERATIONS, y) for y in (turns[:, 0] - WHEELBASE / radii, turns[:, 1]))
    assert found[test]["understeer gradient"] == pytest.approx(1e3 * understeer, rel=0.03)
    assert found[test]["roll gradient"] == pytest.approx(1e3 * roll, rel=0.03)


@pytest.mark.sampled(5)
def test_it_understeers_and_rolls_as_its_axles_do():
    vehicle, axles, steer = by_axles()
    accelerations, radii, racks, rolls = np.array([on_circle(a) for a in (0.5, 1, 1.5, 2, 2.5)]).T
    turns = np.array([turning(vehicle, *axles, *turn) for turn in zip(accelerations, radii, strict=True)])
    measured, expected = (gradient(accelerations, angle - WHEELBASE / radii) for angle in (steer(racks), turns[:, 0]))
    assert measured == pytest.approx(expected, rel=0.03)
    assert gradient(accelerations, rolls) == pytest.approx(gradient(accelerations, turns[:, 1]), rel=0.03)


@pytest.mark.sampled(5)
def test_all_handling_tests_have_results():
    found = stiffmbs.handling(DATA / "own_car.yaml", workers=1)
    assert found["lane_change"]["largest lateral error"] < 0.15
    assert found["lane_change"]["passed (1 yes, 0 no)"] == 1
    assert found["constant_radius"]["largest lateral error"] < 0.15
    step = found["step_steer"]
    assert step["lateral acceleration, steady"] == pytest.approx(4, rel=0.05)
