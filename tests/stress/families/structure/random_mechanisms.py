"""Random mechanisms by the hundred: two integrators against each other, energy, and ranks in exact arithmetic."""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from stiffmbs.analyses.job import examined
from stiffmbs.analyses.run import run
from stiffmbs.elements.body import Body
from stiffmbs.elements.planar_kinds import JOINTS
from stiffmbs.errors import StiffmbsError
from stiffmbs.model.model import Model
from stiffmbs.reading.marker import Marker

from ...case import Case, Verdict, measured
from ...exact_rank import Guide, Pin, rank
from ...random_tree import random_tree

DURATION = 0.5


def _tree(seed: int) -> Model:
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 7))
    return random_tree(rng, count, gravity=True, grounded=True, springs=min(int(rng.integers(0, 4)), count))


def _worst(seeds: range, error) -> Verdict:
    errors = {seed: error(seed) for seed in seeds}
    seed = max(errors, key=lambda seed: errors[seed])
    return measured(errors[seed], 1.0, f"relative to what is allowed; worst is seed {seed}")


def _disagreement(seed: int) -> float:
    """Largest difference of bdf and dop853 in any coordinate or reaction, relative to 1e-5 of its size."""
    how: dict[str, Any] = {"duration": DURATION, "points": 11}
    bdf = run(_tree(seed), rtol=1e-9, solver="bdf", **how)
    explicit = run(_tree(seed), rtol=1e-11, solver="projected", scheme="dop853", **how)
    shared = [name for name in bdf if name.endswith((".x", ".y", ".angle", ".vx", ".omega", ".fx", ".torque"))]
    size = {name: 1 + np.max(np.abs(explicit[name])) for name in shared}
    return max(float(np.max(np.abs(bdf[name] - explicit[name])) / (1e-5 * size[name])) for name in shared)


def _energy_change(seed: int) -> float:
    """In parts of 1e-6 of the greatest kinetic energy and 1 J."""
    solution = run(_tree(seed), duration=DURATION, points=51, rtol=1e-9)
    return solution.energy_drift() / (1e-6 * (1 + float(np.max(solution["energy.kinetic"]))))


def web(seed: int) -> tuple[Model, list[tuple[Fraction, Fraction]], list[Pin | Guide]]:
    """Bodies with random joints between them that fit the pose drawn: often too many, in loops, at rational places."""
    rng = np.random.default_rng(seed)
    model = Model("Web")
    count = int(rng.integers(2, 7))
    centres = [_point(rng) for _ in range(count)]
    for k, (x, y) in enumerate(centres):
        model.add(f"b{k}", Body(mass=1, inertia=0.1, position=(float(x), float(y))))
    joints: list[Pin | Guide] = []
    for k in range(int(rng.integers(count, 2 * count + 2))):
        one, other = sorted(int(b) for b in rng.choice(np.arange(-1, count), 2, replace=False))[::-1]
        point, slides = _point(rng), rng.random() < 0.3
        joint = Guide(one, other, point, _direction(rng)) if slides else Pin(one, other, point)
        kind, direction = ("prismatic", joint.direction) if isinstance(joint, Guide) else ("revolute", (1, 0))
        angle = float(np.arctan2(float(direction[1]), float(direction[0])))
        i, j = (_marker(centres, body, point, angle) for body in (one, other))
        model.add(f"j{k}", JOINTS[kind](i=i, j=j))
        joints.append(joint)
    return model, centres, joints


def _point(rng: np.random.Generator) -> tuple[Fraction, Fraction]:
    x, y = rng.integers(-64, 65, 2)
    return Fraction(int(x), 32), Fraction(int(y), 32)


def _direction(rng: np.random.Generator) -> tuple[Fraction, Fraction]:
    """One of a few, so that guides are often parallel."""
    return [(Fraction(1), Fraction(0)), (Fraction(0), Fraction(1)), (Fraction(3), Fraction(4))][int(rng.integers(3))]


def _marker(
    centres: list[tuple[Fraction, Fraction]], body: int, point: tuple[Fraction, Fraction], angle: float
) -> Marker:
    if body < 0:
        return Marker(body="ground", point=(float(point[0]), float(point[1])), angle=angle)
    x, y = (float(p - c) for p, c in zip(point, centres[body], strict=True))
    return Marker(body=f"b{body}", point=(x, y), angle=angle)


def _ranks(seeds: range) -> Verdict:
    """How often the rank at the start differs from the exact one."""
    wrong, redundant, singular, detail = 0, 0, 0, ""
    for seed in seeds:
        model, centres, joints = web(seed)
        exact = rank(centres, joints)
        try:
            found = examined(model).redundancy
        except StiffmbsError as error:
            detail, wrong = f"seed {seed}: {error}", wrong + 1
            continue
        at_start = found.rank - found.extra_freedoms
        redundant += bool(found.redundant)
        singular += bool(found.extra_freedoms)
        if at_start != exact:
            detail, wrong = f"seed {seed}: found rank {at_start}, exact {exact}", wrong + 1
    counts = f"{redundant} of {len(seeds)} with redundant equations, {singular} in singular poses"
    return measured(wrong, 0, f"{detail}; {counts}" if detail else counts)


CASES = (
    Case(
        "20 trees: bdf against dop853",
        "coordinates, velocities, reactions after 0.5 s",
        partial(_worst, range(20), _disagreement),
    ),
    Case("20 trees: energy", "change over 0.5 s", partial(_worst, range(20), _energy_change)),
    Case("100 trees: bdf against dop853", "the same", partial(_worst, range(100), _disagreement), quick=False),
    Case("100 trees: energy", "the same", partial(_worst, range(100), _energy_change), quick=False),
    Case("100 webs: rank", "of J at the start against Gauss' elimination in fractions", partial(_ranks, range(100))),
    Case("1000 trees: bdf against dop853", "the same", partial(_worst, range(1000, 2000), _disagreement), quick=False),
    Case("1000 webs: rank", "the same", partial(_ranks, range(1000, 2000)), quick=False),
)
