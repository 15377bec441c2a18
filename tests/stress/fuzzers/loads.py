"""Compare `loads` of random blocks on rotated bushings under slow forces with an independent static solver."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from stiffmbs.analyses.equilibrium import quasi_static
from stiffmbs.elements.spatial.spatial_kinds import FORCES
from stiffmbs.errors import StiffmbsError
from stiffmbs.model.spatial_model import Body, Model
from stiffmbs.studies.suspension.road_loads import COMPONENTS, road_loads

from ..case import Verdict, measured, told
from ..statics.assembly import ElasticBushing, End, Part, Push, equilibria

WHAT = "Random blocks on rotated bushings under slow forces: `loads` (peaks in bushing axes) against an independent static solver."
POINTS = 3
MOST_BLOCKS = 3
BOUND = 1e-6
"""Allowed error of a component relative to the largest force or moment of its bushing."""
G = 9.81


def trial(seed: int) -> Verdict:
    """Load one chain of blocks in two cases."""
    rng = np.random.default_rng(seed)
    blocks = _Blocks(rng)
    try:
        runs = {case: quasi_static(blocks.model(case), duration=1.0, points=POINTS) for case in blocks.forces}
        found = road_loads(blocks.model("first"), runs)
    except StiffmbsError as refusal:
        return told(f"{refusal} [{blocks.words}]", ())
    expected = {case: blocks.expected(case) for case in blocks.forces}
    if any(each is None for each in expected.values()):
        return told(f"the force balance of the check does not converge [{blocks.words}]", ())
    worst, name = 0.0, ""
    for bushing in blocks.bushings:
        curves = {case: each[bushing] for case, each in expected.items() if each is not None}
        sizes = [
            max(np.max(np.abs(curve[:, part])) for curve in curves.values()) for part in (slice(0, 3), slice(3, 6))
        ]
        for k, component in enumerate(COMPONENTS):
            channel, size = f"{bushing}.{component}", max(sizes[k // 3], 1.0)
            peak = max((float(value) for curve in curves.values() for value in curve[:, k]), key=abs)
            errors = [np.max(np.abs(found.loads[case][channel] - curve[:, k])) for case, curve in curves.items()]
            errors.append(abs(abs(found.peaks[bushing][k].value) - abs(peak)))
            if (error := float(max(errors)) / size) > worst:
                worst, name = error, channel
    return measured(worst, BOUND, f"{name}, {blocks.words}")


class _Blocks:
    """Chain of blocks on bushings, as a model and as parts of the static solver."""

    def __init__(self, rng: np.random.Generator) -> None:
        count = int(rng.integers(1, MOST_BLOCKS + 1))
        self.places = {f"block{k}": rng.uniform(-0.5, 0.5, 3) + np.array([0.0, 0.0, 0.5 * k]) for k in range(count)}
        self.masses = {name: float(rng.uniform(1, 30)) for name in self.places}
        self.bushings: dict[str, ElasticBushing] = {}
        below = "ground"
        for name, place in self.places.items():
            for k in range(int(rng.integers(1, 4))):
                there = place + rng.uniform(-0.3, 0.3, 3)
                base = self.places.get(below, np.zeros(3))
                axes = Rotation.random(random_state=int(rng.integers(2**31))).as_matrix()
                stiffness = np.concatenate([10 ** rng.uniform(4, 7, 3), 10 ** rng.uniform(2.5, 4, 3)])
                ends = End(name, there - place, axes), End(below, there - base, axes)
                self.bushings[f"{name}.bush{k}".replace(".", "_")] = ElasticBushing(*ends, stiffness)
            below = name
        self.forces = {
            case: {name: (rng.uniform(-200, 200, 3), rng.uniform(-0.2, 0.2, 3)) for name in self.places}
            for case in ("first", "second")
        }
        self.words = f"{count} blocks, {len(self.bushings)} bushings"

    def model(self, case: str) -> Model:
        """Return the model with the forces of a load case, which grow in proportion to time."""
        model = Model("Blocks on bushings", (0, 0, -G))
        for name, place in self.places.items():
            mass = self.masses[name]
            model.add(name, Body(mass=mass, inertia=(0.1 * mass,) * 3, position=tuple(place.tolist())))
        for name, bushing in self.bushings.items():
            ends = {"i": _marker(bushing.i), "j": _marker(bushing.j)}
            model.add(name, FORCES["bushing"](**ends, stiffness=tuple(bushing.stiffness.tolist())))
        for name, (force, at) in self.forces[case].items():
            formulas = tuple(f"{float(value)!r}*t" for value in force)
            model.add(f"{name}_push", FORCES["force"](i={"body": name, "point": at.tolist()}, force=formulas))
        return model

    def expected(self, case: str) -> dict[str, np.ndarray] | None:
        """Return the loads of each bushing at the output instants, shape (n, 6), or None if the check does not converge."""
        weights: list[Part] = [
            Push(End(name, np.zeros(3)), np.array([0.0, 0.0, -mass * G]), constant=True)
            for name, mass in self.masses.items()
        ]
        pushes: list[Part] = [Push(End(name, at), force) for name, (force, at) in self.forces[case].items()]
        solved = equilibria(self.places, [*self.bushings.values(), *weights, *pushes], np.linspace(0, 1, POINTS))
        if solved is None:
            return None
        return {name: np.array([each.load(poses) for poses, _ in solved]) for name, each in self.bushings.items()}


def _marker(end: End) -> dict[str, Any]:
    x, y, z, w = Rotation.from_matrix(end.axes).as_quat()
    return {"body": end.body, "point": end.point.tolist(), "orientation": [w, x, y, z]}
