"""Bushings up to 1e14 N/m, against closed forms of the oscillator and of the rigid limit."""

from __future__ import annotations

from functools import partial

import numpy as np

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.model.model import Model
from stiffmbs.results.solution import Solution

from ...mechanisms.pendulum import GRAVITY, bar_rate, swing
from ...simulation import simulation

STIFFNESSES = (1e4, 1e6, 1e8, 1e10, 1e12, 1e14)
WEIGHT = 2 * GRAVITY


def mass_on_bushing(stiffness: float, ratio: float) -> Model:
    """2 kg let go from the unloaded bushing, damped by a ratio of the critical damping."""
    model = Model("Mass on a bushing", gravity=(0, -GRAVITY))
    model.add("mass", Body(mass=2, inertia=1))
    damping = 2 * ratio * np.sqrt(2 * stiffness)
    model.add(
        "bushing", FORCES["bushing"](i="mass", j="ground", stiffness=[stiffness] * 3, damping=[damping] * 3)
    )  # fmt: skip
    return model


def _settled(solution: Solution, stiffness: float) -> float:
    """Of the second half, when the damped oscillation is over: displacement against m g/k, force against m g."""
    half = len(solution.t) // 2
    sag = np.abs(solution["mass.y"][half:] * stiffness / WEIGHT + 1)
    return float(np.max(np.maximum(sag, np.abs(solution["bushing.fy"][half:] / WEIGHT - 1))))


def bar_on_bushing(stiffness: float) -> Model:
    """A bar of 1 m and 1 kg on a stiff bushing at its end, let go from the horizontal: a pendulum in the limit."""
    model = Model("Bar on a stiff bushing", gravity=(0, -GRAVITY))
    bar = model.add("bar", Body(mass=1, inertia=1 / 12, position=(0.5, 0)))
    damping = 2 * np.sqrt(stiffness)
    model.add(
        "bearing",
        FORCES["bushing"](
            i=bar.at(-0.5, 0), j="ground", stiffness=[stiffness, stiffness, 0], damping=[damping, damping, 0]
        ),
    )
    return model


def _as_a_pendulum(solution: Solution) -> float:
    expected = swing(solution.t, np.pi / 2, bar_rate(1.0))
    return float(np.max(np.abs(solution["bar.angle"] + np.pi / 2 - expected)))


def _force_of_a_pendulum(solution: Solution) -> float:
    """The bearing's force, in weights, from the second instant on, against that of a hinge: 5/2 m g cos(phi) along the bar."""
    phi = swing(solution.t, np.pi / 2, bar_rate(1.0))
    along, across = 2.5 * np.cos(phi), 0.25 * np.sin(phi)
    fy = along * np.cos(phi) + across * np.sin(phi)
    return float(np.max(np.abs(solution["bearing.fy"] / GRAVITY - fy)[len(phi) // 4 :]))


def cart_with_stiff_spring(stiffness: float) -> Model:
    """A cart of 1 kg on a rail, held by an undamped spring that starts 1 mm stretched."""
    model = Model("Cart on a spring")
    model.add("cart", Body(mass=1, inertia=1, position=(1e-3, 0)))
    model.add("rail", JOINTS["prismatic"](i="cart", j="ground"))
    bushing = FORCES["bushing"](i="cart", j="ground", stiffness=[stiffness, 0, 0])
    model.add("spring", bushing)
    return model


def _oscillation(solution: Solution, stiffness: float) -> float:
    expected = 1e-3 * np.cos(np.sqrt(stiffness) * solution.t)
    return float(np.max(np.abs(solution["cart.x"] - expected))) / 1e-3


CASES = (
    *(
        simulation(
            f"mass on {k:.0e} N/m, damped",
            "sag and force after the oscillation, against m g/k and m g",
            partial(mass_on_bushing, k, 1.0), partial(_settled, stiffness=k), 1e-4,
            duration=1.0, points=101, rtol=1e-6,
        )
        for k in STIFFNESSES
    ),
    *(
        simulation(
            f"mass on {k:.0e} N/m, undamped, 20 oscillations",
            "the whole oscillation against its closed form, relative to its size",
            partial(cart_with_stiff_spring, k), partial(_oscillation, stiffness=k), 1e-2,
            duration=40 * np.pi / np.sqrt(k), points=201, rtol=1e-8, atol=1e-12,
        )
        for k in STIFFNESSES
    ),
    *(
        simulation(
            f"rigid limit: bar on {k:.0e} N/m",
            "angle against the pendulum's elliptic functions",
            partial(bar_on_bushing, k), _as_a_pendulum, 2e-3, duration=2.0, points=201, rtol=1e-6,
        )
        for k in STIFFNESSES[2:]
    ),
    *(
        simulation(
            f"rigid limit: force of the bearing of {k:.0e} N/m",
            "force in weights, against the pendulum's hinge",
            partial(bar_on_bushing, k), _force_of_a_pendulum, 1e-2, duration=2.0, points=201, rtol=1e-6,
        )
        for k in STIFFNESSES[2:]
    ),
)  # fmt: skip
