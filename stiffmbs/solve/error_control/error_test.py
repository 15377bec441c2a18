"""Settings of IDA's error test and of its Newton iteration."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...compile.equations import Equations
from ...model.settings import RunSettings
from ...tuning import tuned
from .native.parameters import EXCLUDED
from .tolerances import independent_tolerances


@dataclass(frozen=True)
class ErrorControl:
    """Settings of IDA for a requested tolerance; the defaults are those of `bdf` (`docs/error_control.md`).

    - `margin`: part of the requested tolerance that IDA is given, because the errors of the steps accumulate.
    - `multipliers`: absolute tolerance of multipliers.  A huge one excludes them from the error test, which fails for
      index-2 problems, and from Newton's convergence test.
    - `newton`: coefficient of Newton's convergence test (IDASetNonlinConvCoef); None to choose it by the stiffness of
      the scene (`stiffmbs.solve.error_control.newton`).
    - `renewal`: relative change x of cj that causes a linear solver setup: the ratio of cj to that of the last setup
      leaves the interval from (1 - x)/(1 + x) to (1 + x)/(1 - x) (IDASetDeltaCjLSetup).
    - `growth`: least factor by which a step is enlarged (IDASetEtaFixedStepBounds).  With IDA's default 2, the steps of
      an even motion keep the size that the start has given them.
    - `predicted_residual`: if True, use the convergence test of `stiffmbs.solve.ida.native.iteration`: the convergence
      rate worsens with the age of the iteration matrix, and short steps may leave a larger residual.
    - `relaxation`: factor of the relaxations of constraints (`stiffmbs.solve.error_control.relaxation`).
    """

    margin: float = 0.3
    multipliers: float = EXCLUDED
    newton: float | None = None
    renewal: float = 0.05
    growth: float = 2.0
    predicted_residual: bool = True
    relaxation: float = 1.0

    by_step: ClassVar[tuple[str, ...]] = ()
    """Unknowns that are tested times the step if the formulation does not test them; they have negative absolute tolerances."""

    def tolerances(self, equations: Equations, settings: RunSettings) -> tuple[float, np.ndarray]:
        """Return IDA's relative and absolute tolerances, corrected for its norm, which divides by all unknowns."""
        named = equations.formulation.tested
        by_step = tuple(name for name in self.by_step if name not in named)
        tested, of_independent = _among(equations, (*named, *by_step)), independent_tolerances(equations, settings)
        if by_step:
            of_independent[_among(equations, by_step)] *= -1.0
        atol = np.full(equations.n, self.multipliers)
        atol[equations.independent[tested]] = of_independent[tested]
        correction = self.margin * np.sqrt(equations.n / max(int(tested.sum()), 1))
        return settings.rtol * correction, atol * correction


def _among(equations: Equations, named: tuple[str, ...]) -> np.ndarray:
    """Return a mask of the independent unknowns of these names; not those that follow multipliers."""
    independent = equations.coordinates
    counted = np.repeat(["q" in named, "u" in named], [independent.independent.sum(), independent.independent_u.sum()])
    pressed = np.isin(np.flatnonzero(independent.independent), equations.system.following_reactions)
    counted[: len(pressed)] &= ~pressed
    return counted


PLANAR = tuned("error_test", ErrorControl())
SPATIAL = tuned("error_test_in_space", ErrorControl(margin=0.12, growth=1.6))
CHOSEN = {2: PLANAR, 3: SPATIAL}
"""Error control of every run, by the dimensions of the scene.  Steps of even spatial motions may never change: with
IDA's growth factor, their errors would depend on the start more than on the tolerance."""
