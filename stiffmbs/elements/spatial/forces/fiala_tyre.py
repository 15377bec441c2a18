"""Fiala tyre."""

from __future__ import annotations

from pydantic import Field

from ....reading.units import si
from ...element import Expr, Symbolic
from ...roads.road import above_zero, clipped, magnitude
from ..relaxation import DEFLECTIONS
from ..tyre import Rolling, Tyre

TINY = 1e-30
"""Offset of forces in divisors, for a wheel without contact."""


class FialaTyre(Tyre):
    """Fiala tyre: constant slip stiffnesses, and a friction coefficient that decreases with the total slip.

    With S = min(1, sqrt(kappa^2 + tan(alpha)^2)) and U = mu_static + (mu_sliding - mu_static) S, on a load N:

    - Fx = C_kappa kappa up to abs(kappa) = U N/(2 C_kappa), beyond sign(kappa) (U N - (U N)^2/(4 C_kappa abs(kappa)));
    - Fy = -U N (1 - H^3) sign(alpha), H = max(0, 1 - C_alpha abs(tan(alpha))/(3 U N));
    - Mz = U N width (1 - H) H^3 sign(alpha) forward, and My = -rolling_resistance N forward.

    forward is 1, in reverse -1, at rest 0. Relaxation lengths give a lag of the slips. Camber has no effect on the
    forces. Fiala, Seitenkräfte am rollenden Luftreifen, VDI-Zeitschrift 96 (1954) 973-979; MSC Adams/Tire, Fiala tire
    model.
    """

    kind = "fiala_tyre"
    forms = ({}, {"relaxation": (0.3, 0.5)})

    radius: si.PositiveLength = Field(description="unloaded radius, m")
    stiffness: si.Stiffness = Field(description="radial stiffness, N/m")
    damping: si.Damping = Field(0.0, description="radial damping, N s/m")
    slip_stiffness: si.PositiveForce = Field(description="C_kappa: longitudinal force over slip, N")
    cornering_stiffness: si.PositiveForce = Field(description="C_alpha: lateral force over slip angle, N/rad")
    mu_static: si.PositiveNumber = Field(description="coefficient of friction without slip")
    mu_sliding: si.NumberOrZero = Field(description="coefficient of friction at full slip")
    width: si.LengthOrZero = Field(0.0, description="width of the tyre, for the aligning torque, m")
    rolling_resistance: si.LengthOrZero = Field(0.0, description="rolling resistance torque over load, m")
    relaxation: tuple[si.PositiveLength, si.PositiveLength] | None = Field(
        None, description="longitudinal and lateral relaxation length, m; steady-state slips by default"
    )

    def own_states(self) -> tuple[str, ...]:
        return DEFLECTIONS if self.relaxation else ()

    @classmethod
    def relaxation_lengths(cls, e: Symbolic, load: Expr, camber: Expr) -> tuple[Expr, Expr]:
        along, across = e.relaxation
        return along, across

    @staticmethod
    def law(e: Symbolic, rolling: Rolling) -> tuple[Expr, Expr, Expr, Expr, Expr]:
        """Return forces and moments by Fiala's formulas."""
        from sympy import Float, Rational, tan

        across, slip = e.named(tan(rolling.slip_angle)), rolling.slip
        whole = e.named(clipped(magnitude(slip, across)))
        mu = rolling.friction * (e.mu_static + (e.mu_sliding - e.mu_static) * whole)
        most = e.named(mu * rolling.load + Float(str(TINY)))
        critical = e.named(most / (2 * e.slip_stiffness))
        above = larger(e, slip, critical)
        below = e.named(critical * slip / above)
        fx = e.slip_stiffness * below + most * Rational(1, 2) * e.named(slip - below) / above
        sideways = e.named(e.cornering_stiffness * across / (3 * most))
        left = e.named(sideways / larger(e, sideways, 1))
        part = e.named(magnitude(left))
        fy = -most * left * (3 - 3 * part + part**2)
        mz = most * e.width * left * (1 - part) ** 3 * rolling.direction
        return fx, fy, 0, -e.rolling_resistance * rolling.load * rolling.direction, mz


def larger(e: Symbolic, x: Expr, least: Expr) -> Expr:
    """Return the absolute value of a number, at least `least`; smooth at zero, and without rounding."""
    return e.named(least + above_zero(e.named(magnitude(x) - least)))
