"""Minimisation of an output over parameters, within bounds and under constraints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..analyses.job import Runnable
from ..errors import InputError, SolverError, StiffmbsError
from ..model.files.written_scene import WrittenScene
from ..solve.settings import changed
from .case_solver import CaseSolver, Task, written_scene
from .outputs import Output, outputs_of
from .parameters import Gradients, ParameterRanges, central_differences, parameter_ranges
from .sensitivities.formulas import of_whole_time

STEP = 1e-3
"""Step of central differences, as a part of each range."""


@dataclass(frozen=True)
class Optimum:
    """Result of an optimisation.

    Attributes
    ----------
    values : dict of str to float
        Parameters, SI units.
    objective : float
        Objective with these parameters.
    before : float
        Objective at the start of the search.
    constraints : dict of str to float
        Constrained outputs.
    runs : int
        Number of integrations.
    success : bool
        True if the search converged with all constraints satisfied.
    message : str
        Reason for termination.
    """

    values: dict[str, float]
    objective: float
    before: float
    constraints: dict[str, float]
    runs: int
    success: bool
    message: str

    def as_dict(self) -> dict[str, object]:
        """Return the content of ``stiffmbs optimise --json``."""
        return {
            "status": "done" if self.success else "stopped", "message": self.message, "runs": self.runs,
            "parameters": self.values, "objective": self.objective, "before": self.before, "constraints": self.constraints,
        }  # fmt: skip


def optimise(
    scene: Runnable,
    objective: str,
    parameters: Mapping[str, object],
    constraints: Mapping[str, tuple[float | None, float | None]] | None = None,
    *,
    start: Mapping[str, float] | None = None,
    tolerance: float = 1e-6,
    **settings: object,
) -> Optimum:
    """Minimise an output of a scene: find a local minimum by sequential quadratic programming.

    Parameters
    ----------
    scene : str, Path, Scene or Model
    objective : str
        A formula of channels and of ``peak``, ``rms`` and the like, as in `stiffmbs.sweep`: ``"rms(chassis.ay)"``.
    parameters : mapping of str to Range, str or (float, float)
        Parameters or paths of the scene, with bounds: ``Range(1e5, 1e6, log=True)`` or ``"1e5:1e6:log"`` is searched
        by its logarithm.
    constraints : mapping of str to (float or None, float or None), optional
        Least and largest value of further outputs: ``{"peak(travel)": (None, 0.08)}``.
    start : mapping of str to float, optional
        Start of the search; by default the middle of each range.
    tolerance : float
        Part of the objective by which the last step may still improve it, and of its bound by which a constraint may be
        violated.
    **settings
        Fields of the run's settings to change.

    Raises
    ------
    InputError
        If the scene, an output or a parameter is invalid.
    SolverError
        If the model cannot be solved at the start of the search.

    References
    ----------
    Kraft, A software package for sequential quadratic programming, DFVLR-FB 88-28, 1988 (`scipy.optimize.minimize`,
    SLSQP).
    """
    limits, written = dict(constraints or {}), written_scene(scene)
    ranges = parameter_ranges(parameters, written)
    model = _Model(written, objective, limits, ranges, settings)
    point = ranges.point(start or {})
    first = model.check(point)
    scale = abs(first[0]) or 1.0
    from scipy.optimize import minimize

    result = minimize(
        lambda at: model.outputs(at)[0] / scale, point, jac=lambda at: model.slopes(at)[0] / scale, method="SLSQP",
        bounds=[(0, 1)] * len(point), constraints=list(model.sides()), options={"ftol": tolerance, "maxiter": 200},
    )  # fmt: skip
    best = np.clip(result.x, 0, 1)
    found = model.outputs(best)
    feasible = all(side["fun"](best) >= -tolerance for side in model.sides())
    message = str(result.message) if feasible else f"{result.message}; not all constraints are satisfied"
    return Optimum(
        dict(zip(ranges.names, ranges.values(best), strict=True)), float(found[0]), float(first[0]),
        dict(zip(limits, found[1:].tolist(), strict=True)), model.runs, bool(result.success and feasible), message,
    )  # fmt: skip


class _Model:
    """Objective and constrained outputs at points of the unit cube, each point solved once."""

    def __init__(
        self, written: WrittenScene, objective: str, limits: Mapping[str, tuple[float | None, float | None]], ranges: ParameterRanges,
        settings: Mapping[str, object],
    ) -> None:  # fmt: skip
        self._texts = [objective, *limits]
        outputs = outputs_of({str(k): text for k, text in enumerate(self._texts)})
        for output in outputs:
            if output.is_series:
                raise InputError(
                    f"output '{output.text}': found a channel over time, expected a number such as peak(...)"
                )
        self._outputs: tuple[Output, ...] = outputs
        self._solver = CaseSolver(Task(written, ranges.names, dict(settings), outputs))
        known = self._solver.scene(ranges.values(ranges.point({})))
        self._gradients = Gradients(written, ranges, self._texts, changed(known.run, dict(settings)))
        self._ranges, self._limits = ranges, limits
        self._known: dict[bytes, np.ndarray] = {}
        self._known_slopes: dict[bytes, np.ndarray] = {}
        self.runs = 0

    def check(self, point: np.ndarray) -> np.ndarray:
        """Return the outputs at the start of the search."""
        known = self._solver.channels(self._ranges.values(point))
        for output in self._outputs:
            output.refuse_unknown(known)
        found = self.outputs(point)
        if not np.isfinite(found).all():
            raise SolverError(f"at the start of the search: {self._message}")
        return found

    def outputs(self, point: np.ndarray) -> np.ndarray:
        """Return the objective and the constrained outputs; nan if the model cannot be solved."""
        key = np.ascontiguousarray(point).tobytes()
        if key not in self._known:
            self.runs += 1
            row = self._solver.row(0, self._ranges.values(np.clip(point, 0, 1)))
            self._message = row.message
            self._known[key] = np.array(row.values, dtype=float)
        return self._known[key]

    def slopes(self, point: np.ndarray) -> np.ndarray:
        """Return the derivatives of all outputs, shape (outputs, parameters), by sensitivities or differences.

        Differences are used if an output is a mean over time, where they cost less, or if the model has no
        sensitivities.
        """
        key = np.ascontiguousarray(point).tobytes()
        if key not in self._known_slopes:
            self._known_slopes[key] = self._slopes_at(point)
        return self._known_slopes[key]

    def _slopes_at(self, point: np.ndarray) -> np.ndarray:
        if any(of_whole_time(text) for text in self._texts):
            return central_differences(self.outputs, point, STEP)
        try:
            slopes = np.array(self._gradients.at(np.clip(point, 0, 1)))
        except StiffmbsError:
            return central_differences(self.outputs, point, STEP)
        self.runs += 1
        return slopes

    def sides(self) -> list[dict[str, Any]]:
        """Return the constraints as functions that must not be negative, relative to their bounds."""
        found = []
        for k, (text, (low, high)) in enumerate(self._limits.items(), start=1):
            if low is None and high is None:
                raise InputError(f"constraint '{text}': found no bound, expected the least or the largest value")
            for bound, sign in ((low, 1.0), (high, -1.0)):
                if bound is not None:
                    found.append(self._side(k, float(bound), sign / (abs(bound) or 1.0)))
        return found

    def _side(self, k: int, bound: float, sign: float) -> dict[str, object]:
        return {
            "type": "ineq",
            "fun": lambda at: sign * (self.outputs(at)[k] - bound),
            "jac": lambda at: sign * self.slopes(at)[k],
        }
