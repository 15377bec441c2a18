"""No bodies, one, and ten thousand."""

from __future__ import annotations

from functools import partial

import numpy as np

from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import JOINTS
from stiffmbs.model.model import Model
from stiffmbs.reading.marker import Marker
from stiffmbs.results.solution import Solution

from ...mechanisms.pendulum import GRAVITY, bar_rate, swing
from ...simulation import refusal, simulation


def stones(count: int) -> Model:
    """Bodies that nothing connects, thrown at speeds of their own."""
    model = Model("Stones", gravity=(0, -GRAVITY))
    for k in range(count):
        model.add(f"stone{k}", Body(mass=1 + k, inertia=1, velocity=(k / count, 1), omega=k / count))
    return model


def _parabolas(solution: Solution) -> float:
    t = solution.t
    names = [name[:-2] for name in solution if name.endswith(".x")]
    return max(
        float(max(
            np.max(np.abs(solution[f"{name}.x"] - k / len(names) * t)),
            np.max(np.abs(solution[f"{name}.y"] - t + GRAVITY / 2 * t**2)),
            np.max(np.abs(solution[f"{name}.angle"] - k / len(names) * t)),
        ))
        for k, name in enumerate(names)
    )  # fmt: skip


def pendulums(count: int) -> Model:
    """As many pendulums side by side, let go from the horizontal."""
    model = Model("Pendulums", gravity=(0, -GRAVITY))
    for k in range(count):
        bar = model.add(f"bar{k}", Body(mass=1, inertia=1 / 12, position=(k + 0.5, 0)))
        model.add(f"hinge{k}", JOINTS["revolute"](i=bar.at(-0.5, 0), j=Marker(body="ground", point=(k, 0))))
    return model


def _swings(solution: Solution) -> float:
    expected = swing(solution.t, np.pi / 2, bar_rate(1.0)) - np.pi / 2
    return max(float(np.max(np.abs(solution[name] - expected))) for name in solution if name.endswith(".angle"))


def chain(count: int) -> Model:
    """A chain of rods, let go from the horizontal."""
    model = Model("Chain", gravity=(0, -GRAVITY))
    end: Marker | str = "ground"
    for k in range(count):
        rod = model.add(f"rod{k}", Body(mass=0.1, inertia=0.1 / 1200, position=(0.1 * k + 0.05, 0)))
        model.add(f"pin{k}", JOINTS["revolute"](i=rod.at(-0.05, 0), j=end))
        end = rod.at(0.05, 0)
    return model


def _chain_energy(solution: Solution) -> float:
    """Change of the energy relative to the greatest kinetic energy."""
    kinetic = float(np.max(solution["energy.kinetic"]))
    return solution.energy_drift() / kinetic if kinetic else np.inf


CASES = (
    refusal("0 bodies", "an empty model", partial(Model, "Empty"), ("found no body",)),
    simulation("1 body", "against its parabola", partial(stones, 1), _parabolas, 1e-6, duration=1.0, points=11),
    simulation(
        "100 bodies not connected to anything", "against their parabolas", partial(stones, 100), _parabolas, 1e-6,
        duration=1.0, points=11,
    ),
    simulation(
        "10 000 bodies not connected to anything", "against their parabolas", partial(stones, 10_000), _parabolas, 1e-6,
        duration=1.0, points=3, quick=False,
    ),
    simulation(
        "100 pendulums", "against elliptic functions", partial(pendulums, 100), _swings, 1e-4,
        duration=1.0, points=11, rtol=1e-7,
    ),
    simulation(
        "10 000 pendulums", "against elliptic functions", partial(pendulums, 10_000), _swings, 1e-3,
        duration=0.2, points=3, rtol=1e-5, quick=False,
    ),
    simulation(
        "chain of 1000 rods, dop853", "change of energy relative to the kinetic energy", partial(chain, 1000), _chain_energy, 1e-4,
        duration=0.5, points=11, rtol=1e-6, solver="projected", scheme="dop853", quick=False,
    ),
    simulation(
        "chain of 10 000 rods", "change of energy relative to the kinetic energy", partial(chain, 10_000), _chain_energy, 1e-2,
        duration=0.05, points=3, rtol=1e-5, quick=False,
    ),
)  # fmt: skip
