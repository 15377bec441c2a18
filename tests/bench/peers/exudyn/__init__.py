"""Exudyn: bodies in absolute coordinates by generalised-alpha, and explicit fixed steps on minimal coordinates."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, Protocol

import numpy as np

from ...contestant import Contestant, Failed, Solve
from ...task import Task
from ..mechanism import mechanism_of
from .bodies import Bodies
from .module import module
from .tree import Tree, chain_of

FULL_MATRIX_UP_TO = 60
"""Coordinates up to which the full matrix is the faster one."""
WITH_JOINTS, WITHOUT = (1e-10, 1e-11), (1e-6, 1e-6)
"""Relative and absolute tolerance of Newton's iteration.

Looser ones spoil errors below 1e-6 where there are joints; tighter ones are below rounding at 1e9 N/m and make it fail.
"""
IMPLICIT_PARTS = (1, 2, 3, 6, 12, 24, 48, 99, 198, 399, 798, 1599, 3198)
EXPLICIT_PARTS = (
    *(1 / part for part in (20, 10, 8, 5, 4, 2)),
    *(1, 2, 3, 4, 5, 6, 8, 9, 12, 15, 18, 24, 30, 39, 48, 60, 81, 99, 120, 150, 198, 249, 300, 399),
)
"""Steps from one output time to the next."""
THIRDS = 3
"""Parts of which the half car's output spacing is a multiple meet the breakpoints of its road."""


class Built(Protocol):
    """A mechanism built of Exudyn's items: its system, and what that has recorded."""

    mbs: Any

    def rows(self) -> tuple[np.ndarray, np.ndarray]:
        """Recorded times, and what is compared at them."""


def contestants(task: Task) -> Iterator[Contestant]:
    """Implicit steps; explicit ones where no constraints are left."""
    m, kinds = mechanism_of(task.scene), module().DynamicSolverType
    spacing = float(task.times[1] - task.times[0])

    def contestant(name: str, build: Callable[[], Built], method: Any, parts: tuple[float, ...]) -> Contestant:
        newton = WITH_JOINTS if m.pins else WITHOUT
        steps = tuple(spacing / part for part in parts)
        return Contestant(
            name, True, lambda step: marching(build(), method, task.times, step, newton), "step", steps
        )  # fmt: skip

    yield contestant("Exudyn generalised-alpha", lambda: Bodies(m), kinds.GeneralizedAlpha, IMPLICIT_PARTS)
    chain = chain_of(m)
    explicit = tuple(part for part in EXPLICIT_PARTS if not task.breakpoints or part % THIRDS == 0)
    for name in ("RK44", "RK67"):
        if chain is not None:
            yield contestant(f"Exudyn {name}, tree", lambda: Tree(m, chain), getattr(kinds, name), explicit)
        elif not m.pins:
            yield contestant(f"Exudyn {name}", lambda: Bodies(m), getattr(kinds, name), explicit)


def marching(
    built: Built, method: Any, times: np.ndarray, step: float, newton: tuple[float, float], modified: bool = False
) -> Solve:
    """Steps of one length; rows at the output times that they meet, nan at the others. `modified`: Newton's iteration."""
    exu, duration = module(), float(times[-1] - times[0])
    settings = exu.SimulationSettings()
    integration = settings.timeIntegration
    integration.endTime, integration.numberOfSteps = duration, round(duration / step)
    integration.adaptiveStep = integration.automaticStepSize = False
    integration.newton.relativeTolerance, integration.newton.absoluteTolerance = newton
    integration.newton.useModifiedNewton = modified
    integration.explicit.computeEndOfStepAccelerations = False
    small = built.mbs.systemData.ODE2Size() <= FULL_MATRIX_UP_TO
    kinds = exu.LinearSolverType
    settings.linearSolver.solverType = kinds.EXUdense if small else kinds.EigenSparse
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = max(step, float(times[1] - times[0]))

    def solve() -> np.ndarray:
        """Solve once; the rows of the results."""
        try:
            done = built.mbs.SolveDynamic(settings, solverType=method, showHints=False)
        except Exception as error:  # exudyn raises its own kinds, all of which mean that the solver gave up
            raise Failed(str(error)) from None
        if not done:
            raise Failed("the solver stopped early")
        t, found = built.rows()
        rows = np.full((len(times), found.shape[1]), np.nan)
        places = np.round((t - times[0]) / (times[1] - times[0])).astype(int)
        rows[places] = found
        return rows

    return solve
