"""Radau's steps that end at events: a mass that bounces on a spring, against the closed form."""

import math

import numpy as np

import stiffmbs
from stiffmbs import AppliedForce, Body, Model

STIFFNESS, HEIGHT, G = 1e4, 0.1, 9.81


def height(t):
    """Return the height of a mass of 1 kg that is dropped at rest above a spring that does not adhere."""
    fall, impact, omega = math.sqrt(2 * HEIGHT / G), math.sqrt(2 * G * HEIGHT), math.sqrt(STIFFNESS)
    rest = G / STIFFNESS
    contact = 2 * (math.pi - math.atan2(impact / omega, rest)) / omega
    since = (t + fall) % (2 * fall + contact)
    if since <= 2 * fall:
        return impact * since - 0.5 * G * since**2
    angle = omega * (since - 2 * fall)
    return rest * (math.cos(angle) - 1) - impact / omega * math.sin(angle)


def test_a_mass_that_bounces_on_a_spring_keeps_to_the_tolerance():
    """The error estimate of a step over the kink of the law does not bound the error of the state at the event."""
    model = Model(gravity=(0, -G))
    model.add("mass", Body(mass=1, inertia=1, position=(0, HEIGHT)))
    model.add("spring", AppliedForce(i="mass", force=("0", f"max(0, -{STIFFNESS}*mass.y)")))
    errors = []
    for rtol in np.logspace(-3, -9, 25):
        found = stiffmbs.run(model, duration=2.0, points=201, rtol=float(rtol), solver="radau")
        errors.append(np.abs(found["mass.y"] - [height(t) for t in found.t]).max() / rtol)
    assert np.median(errors) < 0.2
    assert np.max(errors) < 10
