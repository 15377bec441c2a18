"""Bushings of little damping, on whose vibrations the BDF formulas of order 3 to 5 are not stable: motion and steps."""

from __future__ import annotations

from functools import partial

import numpy as np

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.model.model import Model
from stiffmbs.reading.marker import Marker
from stiffmbs.results.solution import Solution

from ...mechanisms.pendulum import GRAVITY, bar_rate, swing
from ...simulation import simulation


def slider_on_bushing(stiffness: float, ratio: float) -> Model:
    """A pendulum of 1 kg on a block of 1 kg, which a stiff bushing of little damping holds; let go from 60 degrees."""
    model = Model("Pendulum on a stiff bushing", gravity=(0, -GRAVITY))
    model.add("block", Body(mass=1, inertia=1))
    angle = -np.pi / 2 + np.pi / 3
    bar = model.add(
        "bar", Body(mass=1, inertia=1 / 12, position=(0.5 * np.cos(angle), 0.5 * np.sin(angle)), angle=angle)
    )
    model.add("hinge", JOINTS["revolute"](i=bar.at(-0.5, 0), j="block"))
    damping = 2 * ratio * np.sqrt(2 * stiffness)
    sag = Marker(body="ground", point=(0, 2 * GRAVITY / stiffness))
    model.add(
        "bushing", FORCES["bushing"](i="block", j=sag, stiffness=[stiffness] * 3, damping=[damping, damping, damping])
    )  # fmt: skip
    return model


def _as_hinged(solution: Solution) -> float:
    """The block stays within some m g/k, the bar swings as from a fixed hinge but for as much."""
    expected = swing(solution.t, np.pi / 3, bar_rate(1.0))
    return float(np.max(np.abs(solution["bar.angle"] + np.pi / 2 - expected)))


CASES = tuple(
    simulation(
        f"bushing of {stiffness:.0e} N/m, damping ratio {ratio:g}, rtol {rtol:.0e}",
        "bar on it over 2 s against the hinged pendulum; the steps are shown",
        partial(slider_on_bushing, stiffness, ratio), _as_hinged, max(2e-3, 100 * rtol),
        duration=2.0, points=201, rtol=rtol, quick=stiffness <= 1e8 and rtol >= 1e-6,
    )
    for stiffness in (1e6, 1e8, 1e10) for ratio in (0.0, 1e-3, 1e-1, 1.0) for rtol in (1e-4, 1e-6, 1e-8)
)  # fmt: skip
