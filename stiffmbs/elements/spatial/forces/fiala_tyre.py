"""Fiala tyre."""

from __future__ import annotations

from pydantic import Field

from ....reading.units import si
from ...element import Expr, Symbolic
from ..relaxation import DEFLECTIONS
from ..tyre import Rolling, Tyre


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
        """Return Fx, Fy, Mx, My, Mz of Fiala's tyre, N and N m."""
        from ...tyres.fiala import Constants, forces
        from ...tyres.magic_formula import Slip

        constants = Constants(
            e.slip_stiffness, e.cornering_stiffness, e.mu_static, e.mu_sliding, e.width, e.rolling_resistance
        )
        r = rolling
        slip = Slip(r.load, r.slip, r.slip_angle, r.camber, r.speed, r.direction, r.friction)
        return forces(constants, slip, e.named).wrench
