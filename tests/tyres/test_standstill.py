"""Tyres that stand, creep and run in reverse: derivatives by closed forms, equilibria of cambered wheels and on slopes."""

import math

import numpy as np
import pytest

import stiffmbs
from stiffmbs import SolverError
from stiffmbs.spatial import Body, Drive, FialaTyre, MagicFormulaTyre, Marker, Model, Orientation, Revolute

from .test_relaxation import FIALA, LENGTHS, SMALL, gliding
from .wheels import reported, wheel

MASS, WEIGHT = 400.0, 400 * 9.81
LOAD = 0.0195 * FIALA["stiffness"]
"""Of the wheel as described, N."""
ROLLING_ON = {
    **SMALL,
    "PHY1": 0.01,
    "PHY3": 0.03,
    "PVY3": -0.3,
    "PHX1": 0.002,
    "PVX1": 0.01,
    "QDZ6": 0.02,
    "QDZ8": -0.2,
}
"""A tyre with ply steer, conicity and camber thrust."""
SYMMETRIC = {name: x for name, x in SMALL.items() if name not in ("PHY1", "PVX1", "RVY1", "SSZ2", "QDZ6")}


def fiala(**fields):
    return FialaTyre(i="wheel", **FIALA, **fields)


def magic(transient, coefficients=ROLLING_ON):
    return MagicFormulaTyre(i="wheel", properties={"coefficients": coefficients}, transient=transient)


def of_a_file(transient):
    numbers = {"UNLOADED_RADIUS": 0.3, "WIDTH": 0.2, "VERTICAL_STIFFNESS": 2e5, "VERTICAL_DAMPING": 3000, "CSLIP": 8e4, "CALPHA": 6e4,
               "UMAX": 1.0, "UMIN": 0.8, "RELAX_LENGTH_X": LENGTHS[0], "RELAX_LENGTH_Y": LENGTHS[1]}  # fmt: skip
    return MagicFormulaTyre(i="wheel", properties={"coefficients": numbers, "version": "Fiala"}, transient=transient)


TYRES = {
    "file of fiala": of_a_file(False),
    "lagging file of fiala": of_a_file(True),
    "fiala": fiala(),
    "lagging fiala": fiala(relaxation=LENGTHS),
    "magic": magic(False),
    "lagging magic": magic(True),
}


def stiffnesses(name):
    """Slip and cornering stiffness, N and N/rad, and relaxation lengths, m, at the load of the wheel."""
    if name.endswith("fiala"):
        return FIALA["slip_stiffness"], FIALA["cornering_stiffness"], *LENGTHS
    dfz, nominal = LOAD / 4000 - 1, 4000
    along = LOAD * (1.9 + 0.2 * dfz) * math.exp(-0.5 * dfz) * 0.3 / nominal
    across = 1.8 * math.sin(2 * math.atan(LOAD / (1.9 * nominal))) * 0.3
    return LOAD * 20, 14 * nominal * math.sin(2 * math.atan(LOAD / (1.5 * nominal))), along, across


def standing(tyre, camber=0.0, gravity=(0, 0, -9.81)):
    """A wheel that turns on a fork with an axle that leans."""
    axle = (0, math.cos(camber), math.sin(camber))
    model = Model("standing", gravity=gravity)
    model.add("fork", Body(mass=380, inertia=(5, 6, 7), position=(0, 0, 0.2805)))
    model.add(
        "wheel",
        Body(mass=20, inertia=(0.7, 1.2, 0.7), position=(0, 0, 0.2805), orientation={"x": (1, 0, 0), "y": axle}),
    )
    model.add("upright", Orientation(i="fork", j="ground"))
    axis = Marker(body="wheel", orientation={"z": (0, 1, 0)})
    model.add("pin", Revolute(i=axis, j=Marker(body="fork", orientation={"z": axle, "x": (1, 0, 0)})))
    model.add("tyre", tyre)
    return model


@pytest.mark.sampled(10)
@pytest.mark.long
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.long if name == "lagging magic" else ()) for name in TYRES]
)
def test_sideways_motion_beside_a_standstill(name):
    """Without lengths a damper 2 C/slow, with lengths a spring C/sigma with 0.02 s of damping; slow is 1 m/s."""
    _, stiffness, _, length = stiffnesses(name)
    found = [value for mode in stiffmbs.modes(gliding(TYRES[name], 0.0)).modes for value in mode.eigenvalues]
    spring = stiffness / length / MASS
    expected = (
        -0.01 * spring + 1j * math.sqrt(spring - (0.01 * spring) ** 2) if "lagging" in name else -2 * stiffness / MASS
    )
    assert min(abs(value - expected) for value in found) < 1e-6 * abs(expected)


@pytest.mark.sampled(5)
@pytest.mark.long
@pytest.mark.parametrize("name", TYRES)
def test_motions_beside_creeping_are_those_beside_a_standstill(name):
    at_rest, *creeping = (
        sorted((value for mode in stiffmbs.modes(gliding(TYRES[name], speed)).modes for value in mode.eigenvalues), key=lambda x: (x.real, x.imag))
        for speed in (0.0, 1e-6, -1e-6)
    )  # fmt: skip
    for found in creeping:
        assert np.allclose(found, at_rest, rtol=1e-4, atol=1e-4)


@pytest.mark.sampled(5)
@pytest.mark.long
@pytest.mark.parametrize("name", TYRES)
def test_a_cambered_wheel_stands(name):
    """Camber thrust, ply steer and conicity are of rolling tyres: at rest nothing pushes the wheel aside."""
    model = standing(TYRES[name], camber=0.06)
    found = stiffmbs.equilibrium(model)
    assert found.channels["tyre.camber"] == pytest.approx(0.06)
    assert found.channels["tyre.load"] == pytest.approx(WEIGHT, rel=1e-12)
    run = model.run(start_from=found.solution, duration=5, output=1.0)
    assert np.ptp(run["fork.x"]) < 1e-9 and np.ptp(run["fork.y"]) < 1e-9
    assert abs(run["tyre.load"] / WEIGHT - 1).max() < 1e-9


@pytest.mark.long
def test_a_cambered_wheel_that_rolls_has_its_thrust():
    found = reported(wheel(magic(False), 0.3, 0.02, camber=0.06, spin=10 / 0.2933))
    assert found["lateral"] < -100


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("name", ["lagging fiala", "lagging file of fiala", "lagging magic"])
def test_a_blocked_wheel_is_in_equilibrium_on_a_slope_and_does_not_creep(name):
    model = standing(TYRES[name], camber=0.03, gravity=(1.5, 0.4, -9.7))
    model.add("blocked", Drive(joint="pin", velocity="0"))
    found = stiffmbs.equilibrium(model)
    assert found.channels["tyre.longitudinal"] == pytest.approx(-600, rel=1e-9)
    assert found.channels["tyre.lateral"] == pytest.approx(-160, rel=1e-9)
    assert found.channels["fork.y"] == pytest.approx(found.channels["tyre.deflection_y"], rel=1e-9)
    run = model.run(start_from=found.solution, duration=10, output=1.0)
    assert np.ptp(run["fork.x"]) < 1e-8 and np.ptp(run["fork.y"]) < 1e-8


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.long
@pytest.mark.parametrize("name", ["fiala", "file of fiala", "magic"])
def test_a_tyre_without_lengths_has_no_equilibrium_on_a_slope(name):
    model = standing(TYRES[name], gravity=(1.5, 0.4, -9.7))
    model.add("blocked", Drive(joint="pin", velocity="0"))
    with pytest.raises(SolverError, match=r"largest imbalance is .*fx .*expected forces that balance"):
        stiffmbs.equilibrium(model)


@pytest.mark.parametrize(
    "tyre", [fiala(width=0.2, rolling_resistance=0.005), of_a_file(False), magic(False, SYMMETRIC)]
)
def test_reverse_is_the_mirror_image_of_forward(tyre):
    """Mirrored in x: the trail lies on the other side, and forces along the road and the rolling torque turn round."""
    speed, angle, spin = 10.0, 0.04, 35.0
    forward = reported(wheel(tyre, 0.3, 0.02, angle, 0.02, speed, spin))
    backward = reported(wheel(tyre, 0.3, 0.02, angle, 0.02, -speed, -spin))
    assert forward["slip_angle"] == pytest.approx(backward["slip_angle"], rel=1e-12)
    assert abs(forward["aligning"]) > 1
    for name, sign in {"lateral": 1, "load": 1, "overturning": 1, "longitudinal": -1, "rolling": -1, "aligning": -1}.items():  # fmt: skip
        assert backward[name] == pytest.approx(sign * forward[name], rel=1e-9, abs=1e-9), name
