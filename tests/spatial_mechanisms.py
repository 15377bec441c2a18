"""Mechanisms with closed loops and rolling bodies, each in its fewest coordinates and without constraint equations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from .minimal_coordinates import Link, accelerations, cross, mass_matrix, poses, potential, slope

G = 9.81


def solved(rates, t, start, rtol=1e-12):
    """States (len(start), len(t)) by DOP853."""
    return solve_ivp(rates, (0, t[-1]), start, "DOP853", t_eval=t, rtol=rtol, atol=rtol * 1e-2).y


def rod(direction, length, mass, width):
    """Centre and inertia tensor of a square rod from its hinge along a unit direction."""
    d = np.array(direction, float)
    along, across = mass * width**2 / 6, mass * (length**2 + width**2) / 12
    return tuple(length / 2 * d), across * np.eye(3) + (along - across) * np.outer(d, d)


@dataclass(frozen=True)
class Bricard:
    """Bricard's mechanism (IFToMM library of computational benchmark problems, A04): six rods along edges of a cube.

    Neighbouring hinges are at right angles, and alternate ones turn alike: theta and phi, from the straight pose, obey
    (1 + cos theta) (1 + cos phi) = 1 (Chen, You and Tarnai, Int. J. Solids and Structures 42, 2005, with 90 degrees).
    One rod is the ground. The start is theta = phi = -90 degrees, at rest, with gravity along -y.
    """

    length: float = 1.0
    mass: float = 1.0
    width: float = 0.1

    @property
    def links(self):
        """The five moving rods."""
        x, y, z = np.eye(3)
        ways, axes = (x, -y, z, -x, y), (y, z, x, y, z)
        links = []
        for k, (way, axis) in enumerate(zip(ways, axes, strict=True)):
            center, inertia = rod(way, self.length, self.mass, self.width)
            offset = tuple(self.length * ways[k - 1]) if k else (0, 0, 0)
            links.append(Link(tuple(axis), offset, center, self.mass, inertia, k - 1))
        return links

    def hinges(self, angles):
        """Angles of the five hinges from the start, of theta and phi."""
        return np.array([angles[0], angles[1]] * 3)[:5] + np.pi / 2

    def along(self, angles):
        """Direction in which theta and phi move: along the curve that the closure draws, never zero."""
        (ct, cp), (st, sp) = np.cos(angles), np.sin(angles)
        return np.array([sp * (1 + ct), -st * (1 + cp)])

    def energies(self, angles):
        """Inertia of the one quasi-velocity, and potential energy."""
        at = poses(self.links, self.hinges(angles))
        rates = np.resize(self.along(angles), 5)
        return np.array([rates @ mass_matrix(self.links, at) @ rates, potential(self.links, at, (0, -G, 0))])

    def motion(self, t):
        """theta, phi and the quasi-velocity over time, (3, len(t))."""

        def rates(_, y):
            angles, speed = y[:2], y[2]
            way = self.along(angles)
            inertia, _ = self.energies(angles)
            swell, pull = slope(self.energies, angles, way)
            return [*(speed * way), -(swell * speed**2 / 2 + pull) / inertia]

        return solved(rates, t, [-np.pi / 2, -np.pi / 2, 0.0], rtol=1e-11)

    def corners(self, angles):
        """The ends of the five moving rods, (5, 3)."""
        at = poses(self.links, self.hinges(angles))
        return np.array([2 * pose.center - pose.hinge for pose in at])


@dataclass(frozen=True)
class SliderCrank:
    """Spatial slider-crank (Haug, Computer Aided Kinematics and Dynamics I, 1989, section 12.2; IFToMM benchmark).

    The crank turns about x, its shaft at (0, y, z); the slider moves along x; the rod has a spherical joint at the crank
    and a universal one at the slider, whose arms are the slide and the normal to slide and rod. The crank stands
    upright at the start and turns at 6 rad/s; gravity along -z.
    """

    crank: float = 0.08
    rod: float = 0.3
    shaft: tuple = (0.1, 0.12)
    masses: tuple = (0.12, 0.5, 2.0)
    crank_inertia: float = 1e-4
    rod_inertia: tuple = (4e-4, 4e-3)

    def pin(self, angle):
        """Crank pin and its rate at unit speed; angle from upright."""
        y, z = self.shaft
        s, c = np.sin(angle), np.cos(angle)
        zero = 0 * s
        return np.array([zero, y - self.crank * s, z + self.crank * c]), self.crank * np.array([zero, -c, -s])

    def slider(self, angle):
        """Place of the slider and its rate at unit speed of the crank."""
        (_, y, z), (_, vy, vz) = self.pin(angle)
        x = np.sqrt(self.rod**2 - y**2 - z**2)
        return x, -(y * vy + z * vz) / x

    def rod_axes(self, angle):
        """The rod's axes: along it from the crank, the arm of the cross, and the third, as columns."""
        (pin, _), (x, _) = self.pin(angle), self.slider(angle)
        d = (np.array([x, 0, 0]) - pin) / self.rod
        arm = np.array([0, -d[2], d[1]]) / np.sqrt(d[1] ** 2 + d[2] ** 2)
        return np.stack([d, arm, cross(d, arm)], axis=1)

    def rod_rate(self, angle):
        """Angular velocity of the rod at unit speed of the crank: it has no part along the normal to the two arms."""
        (pin, pin_v), (x, v) = self.pin(angle), self.slider(angle)
        along, velocity = np.array([x, 0, 0]) - pin, np.array([v, 0, 0]) - pin_v
        across = cross(along, velocity) / self.rod**2
        normal = cross(np.array([1, 0, 0]), self.rod_axes(angle)[:, 1])
        return across - along * (across @ normal) / (along @ normal)

    def energies(self, angle):
        """Inertia of the crank's angle, and potential energy."""
        (pin, pin_v), (_, v), w = self.pin(angle), self.slider(angle), self.rod_rate(angle)
        middle = (pin_v + np.array([v, 0, 0])) / 2
        twist = w @ self.rod_axes(angle)[:, 0]
        spin, across = self.rod_inertia
        rod_part = self.masses[1] * middle @ middle + across * (w @ w) + (spin - across) * twist**2
        return np.array([[self.crank_inertia + rod_part + self.masses[2] * v**2]]), self.masses[1] * G * pin[2] / 2

    def motion(self, t, speed=6.0):
        """Angle and speed of the crank over time, (2, len(t))."""

        def rates(_, y):
            pull = accelerations(lambda q: self.energies(q[0])[0], lambda q: self.energies(q[0])[1], y[:1], y[1:])
            return [y[1], pull[0]]

        return solved(rates, t, [0.0, speed])


@dataclass(frozen=True)
class Governor:
    """Stiff flyball governor (IFToMM library of computational benchmark problems, A05).

    Two rods with a ball at the end hang by hinges from the top of an upright shaft; stiff spring-dampers join their
    middles to a slider on the shaft. Three coordinates: the shaft's angle, the rods' angle below the horizontal (alike
    by symmetry) and the slider's height; the angular momentum about the shaft is constant.
    """

    height: float = 1.0
    arm: float = 0.05
    length: float = 1.0
    width: float = 0.01
    rod_mass: float = 0.3
    ball: float = 5.0
    slider_mass: float = 3.0
    side: float = 0.1
    shaft_inertia: float = 0.3 * 0.01**2 / 6
    stiffness: float = 8e5
    damping: float = 4e4
    free_length: float = 0.5

    @property
    def center(self):
        """Distance of a rod's centre of mass, with its ball, from the hinge."""
        return (self.rod_mass / 2 + self.ball) * self.length / (self.rod_mass + self.ball)

    @property
    def rod_inertia(self):
        """Moments of inertia of a rod with its ball about their centre of mass, along and across."""
        c = self.center
        across = self.rod_mass * (self.length**2 + self.width**2) / 12
        across += self.rod_mass * (c - self.length / 2) ** 2 + self.ball * (self.length - c) ** 2
        return self.rod_mass * self.width**2 / 6, across

    def turning(self, angle):
        """Moment of inertia about the shaft."""
        along, across = self.rod_inertia
        reach = self.arm + self.center * np.cos(angle)
        mass = self.rod_mass + self.ball
        each = mass * reach**2 + along * np.sin(angle) ** 2 + across * np.cos(angle) ** 2
        return self.shaft_inertia + self.slider_mass * self.side**2 / 6 + 2 * each

    def spring(self, angle, height):
        """From the slider to the middle of a rod, outwards and upwards."""
        half = self.length / 2
        return np.array([self.arm - self.side / 2 + half * np.cos(angle), self.height - half * np.sin(angle) - height])

    def energies(self, angle, height, speeds):
        """Kinetic and potential energy (J); speeds of the shaft, the rods and the slider."""
        spin, w, v = speeds
        mass, (_, across) = self.rod_mass + self.ball, self.rod_inertia
        swinging = 2 * (across + mass * self.center**2) * w**2
        stretch = np.sqrt((self.spring(angle, height) ** 2).sum(axis=0)) - self.free_length
        lifted = G * (self.slider_mass * height - 2 * mass * self.center * np.sin(angle))
        kinetic = (self.turning(angle) * spin**2 + swinging + self.slider_mass * v**2) / 2
        return kinetic, lifted + self.stiffness * stretch**2

    def rates(self, y, momentum):
        """Rates of the state that `motion` gives."""
        _, angle, height, w, v = y
        mass, half = self.rod_mass + self.ball, self.length / 2
        sine, cosine = np.sin(angle), np.cos(angle)
        along, across = self.rod_inertia
        gap = self.spring(angle, height)
        length = np.sqrt(gap @ gap)
        outwards, upwards = gap / length
        by_angle = -half * (outwards * sine + upwards * cosine)
        pull = self.stiffness * (length - self.free_length) + self.damping * (by_angle * w - upwards * v)
        spin = momentum / self.turning(angle)
        fling = (along - across) * sine * cosine - mass * (self.arm + self.center * cosine) * self.center * sine
        swing = fling * spin**2 + mass * G * self.center * cosine - pull * by_angle
        lift = 2 * pull * upwards / self.slider_mass - G
        return np.array([spin, w, v, swing / (across + mass * self.center**2), lift])

    def motion(self, t, angle=np.pi / 6, height=0.5, speed=2 * np.pi, rtol=1e-10):
        """Shaft's angle, rods' angle, slider's height, and the rates of the last two, (5, len(t)).

        Radau IIA with the Jacobian by the complex step: the slider's damping has a time constant of 0.1 ms.
        """
        momentum = self.turning(angle) * speed

        def slopes(_, y):
            return self.rates(y, momentum)

        def jacobian(_, y):
            return np.column_stack([slope(lambda y: self.rates(y, momentum), y, way) for way in np.eye(5)])

        start = [0.0, angle, height, 0.0, 0.0]
        return solve_ivp(slopes, (0, t[-1]), start, "Radau", t_eval=t, rtol=rtol, atol=rtol, jac=jacobian).y
