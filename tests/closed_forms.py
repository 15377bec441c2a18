"""Closed forms and conserved quantities that tests compare with."""

from __future__ import annotations

import numpy as np

from stiffmbs import Body, Marker, Model


def oscillation(t, start, omega, zeta=0.0):
    """Free motion of x'' + 2 zeta omega x' + omega^2 x = 0 from rest."""
    damped = omega * np.sqrt(1 - zeta**2)
    return start * np.exp(-zeta * omega * t) * (np.cos(damped * t) + zeta * omega / damped * np.sin(damped * t))


def momenta(model, solution):
    """Linear and angular momentum of all bodies about the origin, over time."""
    px = sum(body.mass * solution[f"{name}.vx"] for name, body in model.bodies.items())
    py = sum(body.mass * solution[f"{name}.vy"] for name, body in model.bodies.items())
    spin = sum(
        body.inertia * solution[f"{name}.omega"]
        + body.mass * (solution[f"{name}.x"] * solution[f"{name}.vy"] - solution[f"{name}.y"] * solution[f"{name}.vx"])
        for name, body in model.bodies.items()
    )
    return px, py, spin


def two_bodies(element, **fields):
    """Two free bodies in motion with an element between points off their centres."""
    model = Model()
    model.add("a", Body(mass=1, inertia=0.2, position=(0.1, 0.3), angle=0.4, velocity=(0.3, -0.2), omega=2))
    model.add("b", Body(mass=2, inertia=0.3, position=(0.5, -0.2), angle=-0.7, velocity=(-0.1, 0.4), omega=-1))
    i, j = Marker(body="a", point=(0.2, -0.1), angle=0.3), Marker(body="b", point=(-0.3, 0.2), angle=1.1)
    model.add("element", element(i=i, j=j, **fields))
    return model
