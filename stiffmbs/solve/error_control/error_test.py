"""What IDA tests: which unknowns count in the error test and in Newton's, and how far each is taken."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...compile.equations import Equations
from ...describe.settings import RunSettings
from .tolerances import independent_tolerances


class ErrorControl(NamedTuple):
    """How a tolerance asked for becomes what IDA is given; the defaults are those of `bdf`, by `docs/error_control.md`.

    Attributes
    ----------
    margin : float
        Part of the tolerance asked for that IDA is given, as the errors of many steps add up.
    multipliers : float
        Absolute tolerance of multipliers.  A huge one takes them out of the error test, where index-2 problems would
        fail, and out of Newton's test.
    suppressed : bool
        Whether multipliers are left out of the error test by IDASetSuppressAlg, which leaves them in Newton's.
    newton : float or None
        Part of the tolerance that Newton's iteration may leave (IDASetNonlinConvCoef); None for one that follows from
        the stiffness of the scene (`stiffmbs.solve.error_control.newton`).
    renewal : float
        Change of cj at which the iteration matrix is made anew (IDASetDeltaCjLSetup) where that costs no more than a few residuals.
    growth : float
        Factor by which the error test must let a step grow before it is changed (IDASetEtaFixedStepBounds).  IDA's own, 2, leaves
        steps of even motions where the start has put them, anywhere between half of what the tolerance allows and all of it.
    predicted_residual : bool
        Whether the convergence rate of Newton's iteration is taken to worsen with the age of the iteration matrix, and short steps
        bear more (`stiffmbs.solve.native.iteration`); IDA's own test takes a rate that was measured where the matrix was new.
    """

    margin: float = 0.3
    multipliers: float = 1e15
    suppressed: bool = False
    newton: float | None = None
    renewal: float = 0.05
    growth: float = 2.0
    predicted_residual: bool = True

    def tolerances(self, equations: Equations, settings: RunSettings) -> tuple[float, np.ndarray]:
        """IDA's tolerances: its norm divides by all unknowns, the tolerance asked for counts those in the error test."""
        tested, of_independent = self._tested(equations), independent_tolerances(equations, settings)
        atol = np.full(equations.n, self.multipliers)
        atol[equations.independent[tested]] = of_independent[tested]
        correction = self.margin * np.sqrt(equations.n / max(int(tested.sum()), 1))
        return settings.rtol * correction, atol * correction

    def untested(self, equations: Equations) -> np.ndarray | None:
        """The unknowns that IDASetSuppressAlg is to leave out; None where it is not used."""
        if not self.suppressed:
            return None
        kept = np.zeros(equations.n, dtype=bool)
        kept[equations.independent[self._tested(equations)]] = True
        return ~kept

    @staticmethod
    def _tested(equations: Equations) -> np.ndarray:
        """Which of the independent coordinates and velocities the error test counts; algebraic states that follow multipliers
        are left out as these are."""
        independent, tested = equations.coordinates, equations.formulation.tested
        counted = np.repeat(
            ["q" in tested, "u" in tested], [independent.independent.sum(), independent.independent_u.sum()]
        )
        pressed = np.isin(np.flatnonzero(independent.independent), equations.system.following_reactions)
        counted[: len(pressed)] &= ~pressed
        return counted


CHOSEN = {2: ErrorControl(), 3: ErrorControl(margin=0.12, growth=1.6)}
"""That of every run, by the scene's dimensions.  In space the steps saved by the own convergence test pay for a smaller margin.
There motions are often so even that a step never changes: with IDA's growth the error then depends on the start more than on the
tolerance."""
