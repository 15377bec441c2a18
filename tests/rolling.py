"""Discs on a horizontal plane in Euler angles zxz (precession, nutation, spin), without constraint equations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .spatial_mechanisms import G, solved


@dataclass(frozen=True)
class Disc:
    """A thin disc on a plane; its axis is the body's z. Transverse and axial moments are about the centre of mass."""

    radius: float
    mass: float
    transverse: float
    axial: float

    def rolling(self, t, nutation, rates):
        """Motion without slipping (Routh, Advanced Rigid Dynamics, section 244; Appell 1900).

        Newton's and Euler's equations in the frame of the level diameter, the steepest diameter and the axis, in which
        the contact lies at -radius along the second; the contact's force is eliminated.

        Parameters
        ----------
        t : (n,) times (s).
        nutation : of the start (rad).
        rates : (3,) angular velocity of the start in that frame (rad/s).

        Returns
        -------
        (8, n) : precession, nutation, spin angle, the three rates, and the centre's x and y from the origin.
        """
        R, m, A, C = self.radius, self.mass, self.transverse, self.axial

        def slopes(_, y):
            heading, tilt, _, w1, w2, w3, _, _ = y
            sine, cosine = np.sin(tilt), np.cos(tilt)
            turning = w2 / sine
            level = np.array([np.cos(heading), np.sin(heading)])
            axis = sine * np.array([level[1], -level[0]])
            return [
                turning,
                w1,
                w3 - turning * cosine,
                (A * turning * cosine * w2 - (C + m * R**2) * w2 * w3 - m * G * R * cosine) / (A + m * R**2),
                (C * w1 * w3 - A * turning * cosine * w1) / A,
                m * R**2 * w1 * w2 / (C + m * R**2),
                *(R * (w1 * axis - w3 * level)),
            ]

        return solved(slopes, t, [0.0, nutation, 0.0, *rates, 0.0, 0.0])

    def rolling_energy(self, state):
        """Total energy (J) of what `rolling` gives."""
        _, tilt, _, w1, w2, w3, *_ = state
        turning = self.transverse * (w1**2 + w2**2) + self.axial * w3**2
        return (turning + self.mass * self.radius**2 * (w1**2 + w3**2)) / 2 + self.mass * G * self.radius * np.sin(tilt)

    def sliding(self, t, nutation, precession_rate, spin):
        """Motion on a plane without friction, let go where the nutation rests: precession, nutation, spin and its rate.

        The angular momenta about the vertical and about the axis are constant, and the centre only rises and sinks
        (Whittaker, Analytical Dynamics, section 75); `spin` is the angular velocity along the axis.
        """
        R, m, A, C = self.radius, self.mass, self.transverse, self.axial
        axis = C * spin
        upright = A * precession_rate * np.sin(nutation) ** 2 + axis * np.cos(nutation)

        def slopes(_, y):
            _, tilt, _, w = y
            sine, cosine = np.sin(tilt), np.cos(tilt)
            turning = (upright - axis * cosine) / (A * sine**2)
            gyration = turning * (A * turning * sine * cosine - axis * sine)
            bounce = m * R * (R * sine * cosine * w**2 - G * cosine)
            return [turning, w, spin - turning * cosine, (gyration + bounce) / (A + m * R**2 * cosine**2)]

        return solved(slopes, t, [0.0, nutation, 0.0, 0.0])
