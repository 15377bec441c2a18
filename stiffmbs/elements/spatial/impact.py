"""Base of contacts by Adams' IMPACT function, with smoothed Coulomb friction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar, Self

from pydantic import Field, model_validator

from ...reading.fields import Measured
from ...reading.units import si
from ..element import Expr, Force, Matrix, Symbolic, sp
from ..forces.friction import AT_REST
from ..loads import length
from .marker import Marker
from .wrench import Pairs, velocity


@dataclass(frozen=True)
class Touch:
    """Possible contact of two solids, in ground axes.

    `gap`: distance of the surfaces, m; negative for a penetration. `point`: contact point, m. `normal`: unit vector
    towards the solid of marker i.
    """

    gap: Expr
    point: Matrix
    normal: Matrix


class Impact(Force):
    """Base of contacts by IMPACT; scenes use its subclasses, which define the contact points.

    For a gap g < 0 the normal force is N = max(0, k (-g)^e - c g' step(g, -d, 1, 0, 0)). The friction force is mu(v) N,
    opposite to the sliding velocity v at the contact point. mu rises from 0 to mu_s at the stiction velocity, and
    changes to mu_d at the friction velocity, each by a cubic. Without damping and friction there is the potential k
    (-g)^(e+1)/(e+1).

    MSC Adams/Solver, CONTACT statement and IMPACT function.
    """

    forms: ClassVar[tuple[Mapping[str, object], ...]] = ({}, {"friction": 0.2, "static_friction": 0.3})

    i: Marker
    j: Marker
    stiffness: si.PositiveValue = Field(description="k, N/m^e")
    exponent: Annotated[float, Measured("number", at_least=1)] = Field(
        1.5, description="e, exponent of the penetration"
    )
    damping: si.Damping = Field(0.0, description="c, N s/m")
    depth: si.PositiveLength = Field(1e-4, description="d, penetration above which the full damping acts, m")
    static_friction: si.NumberOrZero | None = Field(None, description="mu_s, static coefficient of friction")
    friction: si.NumberOrZero | None = Field(None, description="mu_d, dynamic coefficient of friction")
    stiction_velocity: si.PositiveVelocity = Field(0.01, description="sliding speed at which mu reaches mu_s, m/s")
    friction_velocity: si.PositiveVelocity = Field(0.1, description="sliding speed above which mu is mu_d, m/s")

    @model_validator(mode="after")
    def _has_both_coefficients(self) -> Self:
        if (self.static_friction is None) != (self.friction is None):
            raise ValueError("found one of friction and static_friction, expected both or neither")
        if self.friction is not None and not self.stiction_velocity < self.friction_velocity:
            raise ValueError(
                f"found a friction_velocity of {self.friction_velocity:g} m/s, expected more than the stiction_velocity, "
                f"{self.stiction_velocity:g} m/s"
            )
        return self

    @classmethod
    def touches(cls, e: Symbolic) -> list[Touch]:
        """Return all possible contacts, each with its own force."""
        raise NotImplementedError

    @classmethod
    def powers(cls, e: Symbolic) -> Pairs:
        """Return each force on the relative velocity of the points in contact."""
        pairs: Pairs = []
        for touch in cls.touches(e):
            n, point = e.named(touch.normal), e.named(touch.point)
            v = e.named(velocity(e, e.i, point) - velocity(e, e.j, point))
            rate = e.named(v.dot(n))
            pressure = e.named(_pressure(e, e.named(touch.gap), rate))
            pairs.append((pressure, rate))
            if e.friction is not None:
                sliding = e.named(v - rate * n)
                drag = e.named(-_per_speed(e, sliding) * pressure)
                pairs += [(drag * part, along) for part, along in zip(sliding, v, strict=True)]
        return pairs

    @classmethod
    def potential(cls, e: Symbolic) -> Expr:
        """Return the sum of k (-g)^(e+1)/(e+1) over all penetrations."""
        power = e.exponent + 1
        gaps = [e.named(touch.gap) for touch in cls.touches(e)]
        return sum(sp.Piecewise((e.stiffness * (-gap) ** power / power, gap < 0), (0, True)) for gap in gaps)

    @classmethod
    def event_functions(cls, e: Symbolic) -> Sequence[Expr]:
        """Return each gap, and an expression that is positive while N > 0; damping can interrupt N."""
        found = []
        for touch in cls.touches(e):
            gap, n, point = e.named(touch.gap), e.named(touch.normal), e.named(touch.point)
            rate = (velocity(e, e.i, point) - velocity(e, e.j, point)).dot(n)
            found += [gap, sp.Min(-gap, _push(e, sp.Max(-gap, 0), rate))]
        return tuple(found)


def _pressure(e: Symbolic, gap: Expr, rate: Expr) -> Expr:
    force = e.named(_push(e, -gap, rate))
    return sp.Piecewise((sp.Piecewise((force, force > 0), (0, True)), gap < 0), (0, True))


def _push(e: Symbolic, depth: Expr, rate: Expr) -> Expr:
    """Return the force at a penetration, N; negative if damping exceeds the elastic force."""
    return e.stiffness * depth**e.exponent - e.damping * rate * _rising(depth / e.depth)


def _per_speed(e: Symbolic, sliding: Expr) -> Expr:
    speed = e.named(length(*sliding, tiny=(AT_REST * e.stiction_velocity) ** 2))
    up = e.static_friction * (2 * _rising((speed / e.stiction_velocity + 1) / 2) - 1)
    down = _rising((speed - e.stiction_velocity) / (e.friction_velocity - e.stiction_velocity))
    return (up + (e.friction - e.static_friction) * down) / speed


def _rising(x: Expr) -> Expr:
    """Return Adams' STEP from 0 at 0 to 1 at 1."""
    z = sp.Min(sp.Max(x, 0), 1)
    return z**2 * (3 - 2 * z)
