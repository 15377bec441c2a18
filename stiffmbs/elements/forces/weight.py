"""Weight: gravity on a body."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ...reading.marker import MarkerReference
from ...reading.units import si
from ..body import AnyBody
from ..element import Expr, Force, Symbolic


class Weight(Force):
    """Gravity force on one body; created by the model, not in scenes, hence without a kind.

    It acts at the centre of mass of the body of `i`, independent of the marker's position.
    """

    kind = ""
    spin_conditions = {"i": "body"}

    i: MarkerReference
    mass: si.Mass
    gravity: tuple[si.Acceleration, ...]

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Expr, Expr]]:
        return [(e.mass * g, x) for g, x in zip(e.gravity, e.i.body.origin, strict=True)]

    @staticmethod
    def potential(e: Symbolic) -> Expr:
        return -e.mass * sum(g * x for g, x in zip(e.gravity, e.i.body.origin, strict=True))


def weights(bodies: Mapping[str, AnyBody], gravity: tuple[float, ...]) -> Iterator[tuple[str, Weight]]:
    """Yield the weights of planar or spatial bodies with the bodies' names; none without gravity."""
    for name, body in bodies.items() if any(gravity) else ():
        marker = MarkerReference.model_construct(body=name)
        yield name, Weight.model_construct(i=marker, mass=body.mass, gravity=gravity)  # checked already
