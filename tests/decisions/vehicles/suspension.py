"""Decisions on suspensions and curves of tyres."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np

from stiffmbs.studies import tyre_curves
from stiffmbs.studies.suspension import axle, characteristics, kinematics_and_compliance, tangent
from tests.decisions.common import BELOW, Record, nothing, reach, reached, refused
from tests.solve.test_parameter_thresholds import DOUBLES, count_while


def least_component_along_y():
    def accepts(y):
        wheel = Record(axis=[np.sqrt(max(1 - y**2, 0.0)), y, 0.0], side="wheel", carrier="a")
        return not refused(lambda: axle._check([wheel], ""))

    return count_while(accepts, 1.5 * BELOW)


def largest_angle_of_roll_paths():
    def meet(sine):
        hubs = [
            Record(contact=np.array([0.0, y, 0.0]), path=path) for y, path in ((1.0, (1.0, 0.0)), (-1.0, (1.0, sine)))
        ]
        pose = Record(hubs=hubs, contact_velocity=lambda hub, _: np.array([0.0, *hub.path]), setup=Record(plane=0.0))
        return np.isfinite(characteristics._roll_centre(pose, None)["roll_centre_height"])

    return count_while(meet, BELOW)


def amplitude_of_a_rotated_joint():
    with patch.object(kinematics_and_compliance, "replace", lambda _, **changes: changes["amplitude"]):
        return kinematics_and_compliance._case(Record(name="steer"), True)


def largest_compared_value():
    def is_compared(value):
        channels = {"left.a": np.array([value]), "right.a": np.zeros(1)}
        found = Record(sweeps={"s": Record(case=Record(opposite=False), channels=channels)})
        asymmetry = kinematics_and_compliance.KinematicsAndCompliance.asymmetry
        return (asymmetry.fget if isinstance(asymmetry, property) else asymmetry)(found) > 0.0

    return count_while(lambda value: is_compared(1e3 * value), DOUBLES)


def has_an_axis(*omega):
    twist = Record(omega=np.array(omega), v=np.zeros(3))
    return tangent.steering_axis(twist, None, None) is not None


def least_stiffness():
    eye = np.eye(1)
    found = Record(_scale=np.ones(1), _jacobian=eye, _reactions=eye, _stiffness=eye)
    with patch.multiple(tangent, Constraints=lambda _: Record(null_space=eye), _inverse=lambda _, least: reach(least)):
        return reached(lambda: tangent.Changes(found, np.array([0]), np.zeros((0, 1))))


def largest_violation():
    def accepts(violation):
        found = Record(_jacobian=np.eye(1), _scale=np.ones(1), row=lambda _: 0, size=1)
        changes = Record(
            _tangent=found, _rows=np.array([0]), _locked=np.zeros((0, 1)), _with_free=nothing,
            _constraints=Record(smallest=lambda right: right + violation),
        )  # fmt: skip
        return not refused(lambda: tangent.Changes.moved(changes, "j"))

    return count_while(lambda violation: accepts(1e-9 * violation), DOUBLES)


def loads_of_a_tyre():
    tyre = Record(has_pressure=False, nominal_load=1.0, nominal_pressure=None)
    with patch.object(tyre_curves, "_curve", lambda _tyre, load, *_: load):
        return sum(tyre_curves.tyre_curves(tyre, Record(pressure=None, load=None)))


def ends_of_curves(function):
    """Return the ends of slip and slip angle of curves of a tyre."""
    ends = []

    def within(_tyre, _name, end):
        ends.append(end)
        return -end, end

    tyre = Record(steady_state=lambda *_: reach(ends))
    with patch.object(tyre_curves, "_within", within):
        return reached(lambda: function(tyre, 1.0, None, Record(points=3, camber=0.0, speed=1.0)))


def directions_of_an_ellipse():
    tyre = Record(steady_state=lambda _load, kappa, *_: reach(len(kappa)))
    with patch.object(tyre_curves, "_within", lambda *_: (-1.0, 1.0)):
        return reached(lambda: tyre_curves._ellipse(tyre, 1.0, None, Record(points=3, camber=0.0, speed=1.0)))


DECISIONS = {
    "studies.suspension.axle:AXIS_ALONG_Y": least_component_along_y,
    "studies.suspension.characteristics:STRAIGHT": lambda: count_while(
        lambda angle: np.isfinite(characteristics._ackermann([angle, angle], 0.5, 2.0)["turning_radius"]), BELOW
    ),
    "studies.suspension.characteristics:PARALLEL": largest_angle_of_roll_paths,
    "studies.suspension.kinematics_and_compliance:STEER_ANGLE": amplitude_of_a_rotated_joint,
    "studies.suspension.kinematics_and_compliance:NEARLY_STRAIGHT": largest_compared_value,
    "studies.suspension.tangent:STILL": lambda: count_while(lambda rate: has_an_axis(0.0, 0.0, rate), BELOW),
    "studies.suspension.tangent:LEVEL": lambda: count_while(lambda up: has_an_axis(1.0, 0.0, up), BELOW),
    "studies.suspension.tangent:IDLE": least_stiffness,
    "studies.suspension.tangent:UNMET": largest_violation,
    "studies.tyre_curves:PARTS_OF_LOAD": loads_of_a_tyre,
    "studies.tyre_curves:SLIP": lambda: ends_of_curves(tyre_curves._curve)[0],
    "studies.tyre_curves:ANGLE": lambda: ends_of_curves(tyre_curves._curve)[1],
    "studies.tyre_curves:FAR_SLIP": lambda: ends_of_curves(tyre_curves._ellipse)[0],
    "studies.tyre_curves:FAR_ANGLE": lambda: ends_of_curves(tyre_curves._ellipse)[1],
    "studies.tyre_curves:DIRECTIONS": directions_of_an_ellipse,
}  # fmt: skip
EXPECTED = {
    "studies.suspension.axle:AXIS_ALONG_Y": 4, "studies.suspension.characteristics:STRAIGHT": 26,
    "studies.suspension.characteristics:PARALLEL": 159, "studies.suspension.kinematics_and_compliance:STEER_ANGLE": 10.0,
    "studies.suspension.kinematics_and_compliance:NEARLY_STRAIGHT": 27, "studies.suspension.tangent:STILL": 119,
    "studies.suspension.tangent:LEVEL": 80, "studies.suspension.tangent:IDLE": 1e-12,
    "studies.suspension.tangent:UNMET": 27, "studies.tyre_curves:PARTS_OF_LOAD": 3.0, "studies.tyre_curves:SLIP": 0.3,
    "studies.tyre_curves:ANGLE": 0.2617993877991494, "studies.tyre_curves:FAR_SLIP": 1.0,
    "studies.tyre_curves:FAR_ANGLE": 0.6981317007977318, "studies.tyre_curves:DIRECTIONS": 73,
}  # fmt: skip
