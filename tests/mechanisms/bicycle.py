"""The bicycle model of a car whose axles are known from their rig: steady turns without a simulation.

Each axle has the tyres' own forces at the loads and cambers that its wheels have in the turn (Pacejka, Tire and Vehicle Dynamics,
2012, sec. 1.3: effective axle cornering characteristics): roll and load transfer from the rates in roll, roll steer and roll camber,
lateral force and aligning torque compliance from the rig's slopes.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, fsolve

G, LITTLE = 9.81, 1e-9


@dataclass(frozen=True)
class Car:
    """What no rig tells: masses, kg, where they are over the road and beside the axles, m, and the wheels' spin inertia, kg m^2."""

    mass: float
    height: float
    body_mass: float
    body_height: float
    to_front: float
    to_rear: float
    spin_inertia: float


class AxleOnRig:
    """Slopes of an axle per metre, newton and newton metre, of angles in rad: steer to the left, camber with the top to the right.

    `load` is that of a wheel at rest, N, with its centre `radius` over the road, m, and `lift` above the place of its rig, m.
    """

    def __init__(self, found, track, tyre, load, radius, lift):
        def slope(case, channel, unit):
            return found.sweeps[case].slope(f"left.{channel}") / unit

        def in_roll(channel):
            """At the lifted place: the bump curve tells how slopes change."""
            bump = found.sweeps["bump"]
            curve = CubicSpline(1e-3 * bump.abscissa, bump.channels[f"left.{channel}"])(np.array([0, lift]), 1)
            return slope("roll", channel, 1e-3) + curve[1] - curve[0]

        self.track, self.tyre, self.load, self.radius, self.lift = track, tyre, load, radius, lift
        bump = found.sweeps["bump"]
        self.toe = CubicSpline(1e-3 * bump.abscissa, np.radians(bump.channels["left.toe"]))
        self.rate, self.jacking = in_roll("load"), slope("lateral_parallel", "load", 1e3)
        self.centre = 1e-3 * in_roll("lateral") * track / 2  # height of the roll centre
        self.aside = 1e-3 * slope("lateral_parallel", "lateral", 1e3)
        self.roll_steer, self.roll_camber = (-np.radians(in_roll(channel)) for channel in ("toe", "camber"))
        self.force_steer, self.torque_steer, self.force_camber = (
            -np.radians(slope(case, channel, unit))
            for case, channel, unit in (
                ("lateral_parallel", "toe", 1e3), ("aligning_parallel", "toe", 1), ("lateral_parallel", "camber", 1e3)
            )
        )  # fmt: skip

    def shifted(self, roll, force, overturning):
        """Load that goes from the left wheel to the right one, N, and the left wheel's travel, m.

        Parameters
        ----------
        roll : float
            Of the body, rad.
        force, overturning : float
            Lateral force, N, and overturning torque, N m, of both wheels.
        """
        pushed = self.jacking * force / 2 - self.roll_camber * overturning / 2
        change = (pushed - self.rate * roll * self.track / 2) / (1 + self.rate / self.of_tyre("VERTICAL_STIFFNESS"))
        return -change, -roll * self.track / 2 - change / self.of_tyre("VERTICAL_STIFFNESS")

    def of_tyre(self, name):
        """A coefficient."""
        return self.tyre.coefficients[name]

    def overturning(self, force, gyroscopic):
        """Of the tyres, and of the spin of both wheels, N m."""
        lever = self.of_tyre("UNLOADED_RADIUS") * self.of_tyre("QSX3") * self.load / self.of_tyre("FNOMIN")
        return lever * force + 2 * gyroscopic / self.radius

    def turn(self, roll, force, gyroscopic, speed):
        """What an axle does in a turn.

        Returns
        -------
        angle, steer : float
            Slip angle, and steer angle by roll and compliance, rad.
        forces : ndarray, shape (2,)
            Of the left and the right tyre, N.
        torque : float
            Aligning torques, and the yawing moment of the rolling resistances, N m.
        shifted : float
        """
        shifted, travel = self.shifted(roll, force, self.overturning(force, gyroscopic))
        camber = roll + self.roll_camber * travel + self.force_camber * force / 2
        apart = (
            float(self.toe(self.lift + travel) + self.toe(self.lift - travel)) / 2
        )  # slip angle of the left wheel, by toe
        loads = np.array([self.load - shifted, self.load + shifted])

        def of(angle):
            return self.tyre.wrench(
                loads, slip_angle=np.array([angle + apart, angle - apart]), camber=camber, speed=speed
            )

        angle = brentq(lambda alpha: np.sum(of(alpha)["lateral"]) - force, -0.3, 0.3, xtol=LITTLE)
        forces, torques = of(angle)["lateral"], of(angle)["aligning"]
        steer = self.roll_steer * travel + self.force_steer * force / 2 + self.torque_steer * np.mean(torques)
        drag = self.of_tyre("QSY1") * self.of_tyre("UNLOADED_RADIUS") / self.radius
        return angle, steer, forces, np.sum(torques) - drag * shifted * self.track, shifted


def turning(car, front, rear, acceleration, radius):
    """The steer angle of the front wheels, rad, that the rack has to give in a steady turn to the left, and the roll angle, rad."""
    speed, wheelbase = np.sqrt(acceleration * radius), car.to_front + car.to_rear
    gyroscopic, axles = car.spin_inertia * acceleration, (front, rear)

    def in_turn(roll, share):
        forces = car.mass * acceleration * np.array([share, 1 - share])
        return forces, [axle.turn(roll, force, gyroscopic, speed) for axle, force in zip(axles, forces, strict=True)]

    def left_over(unknown):
        roll, share = unknown
        forces, (ahead, behind) = in_turn(roll, share)
        moved = front.track * ahead[4] + rear.track * behind[4]
        overturning = sum(axle.overturning(force, gyroscopic) for axle, force in zip(axles, forces, strict=True))
        axis = (front.centre * car.to_rear + rear.centre * car.to_front) / wheelbase
        aside = np.mean([axle.aside * force / 2 for axle, force in zip(axles, forces, strict=True)])
        tilt = car.body_mass * G * ((car.body_height - axis) * roll + aside)
        inclined = wheelbase / radius * (ahead[2][0] - ahead[2][1]) * front.track / 2
        yaw = car.to_front * forces[0] - car.to_rear * forces[1] + ahead[3] + behind[3] + inclined
        return [car.mass * acceleration * car.height + tilt + overturning - moved, yaw]

    roll, share = fsolve(left_over, [0.0, car.to_rear / wheelbase], xtol=LITTLE)
    _, (ahead, behind) = in_turn(roll, share)
    return wheelbase / radius - ahead[0] + behind[0] - ahead[1] + behind[1], roll
