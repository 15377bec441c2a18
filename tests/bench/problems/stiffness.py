"""bdf and projected at an equal error over the stiffness of a bushing: the half car of ``examples/half_car.yaml``."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from stiffmbs.model.read_scene import read_scene

from ..benchmark import Row
from ..by_hand import half_car as hand
from ..contestant import Contestant, bdf, by_hand, dop853
from ..problem import Problem
from ..sweep import at_target_rows
from .half_car import SCENE, TIMES, ZETA, reference

STIFFNESSES = tuple(10.0**k for k in range(4, 11))
ROUNDS = 5


@dataclass(frozen=True)
class OverStiffness:
    """Times at an error of 1e-6, a row for each integrator and stiffness, N/m."""

    stiffnesses: tuple[float, ...] = STIFFNESSES

    @property
    def name(self) -> str:
        return "stiffness"

    def measured(self) -> list[Row]:
        """Read from sweeps over tolerances."""
        return [_at(row, k) for k in self.stiffnesses for row in at_target_rows(_problem(k).measured())]

    def glanced(self) -> list[Row]:
        """The softest and the stiffest at one tolerance."""
        return [_at(row, k) for k in self.stiffnesses[:: len(self.stiffnesses) - 1] for row in _problem(k).glanced()]


def contestants(k_b: float) -> list[Contestant]:
    """The implicit and the explicit integrator, and IDA by hand."""
    scene = read_scene(SCENE.replace("STIFFNESS", f"{k_b:g}"))
    return [bdf(scene), dop853(scene), by_hand(hand.si2(k_b, ZETA), TIMES)]


def _problem(k_b: float) -> Problem:
    return Problem(f"{k_b:.0e} N/m", partial(reference, k_b), partial(contestants, k_b), (1e-2, 1e-10), rounds=ROUNDS)


def _at(row: Row, k_b: float) -> Row:
    return Row(row.solver, f"{k_b:.0e} N/m", row.error, row.seconds, row.peer)


BENCHMARKS = (OverStiffness(),)
