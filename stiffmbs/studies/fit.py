"""Parameter estimation: least-squares fit of a model to measured channels, with confidence intervals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from numbers import Real
from typing import Any

import numpy as np

from ..analyses.job import Runnable
from ..analyses.run import solved
from ..errors import InputError, SolverError, StiffmbsError
from ..model.files.written_scene import WrittenScene
from ..reading.files.quoted import written as as_written
from ..results.solution import Solution
from ..solve.settings import changed
from ..solve.trajectory import Outcome
from .case_solver import CaseSolver, Task, written_scene
from .measured import Measured, measured, of_common_noise, of_separate_noise
from .outputs import Output, outputs_of
from .parameters import Gradients, ParameterRanges, central_differences, parameter_ranges

CONFIDENCE = 0.95
ROUNDS = 3
"""Number of fits in which channels are weighted by the residuals of the previous fit."""
INSIDE = 1e-6
"""Distance of the start of a search from the bounds, as a part of each range."""
FAR = 1e3
"""Weighted residual of a model that cannot be solved."""


@dataclass(frozen=True)
class Fit:
    """Fitted parameters.

    Attributes
    ----------
    values : dict of str to float
        The parameters, SI units.
    intervals : dict of str to (float, float)
        95 % confidence intervals, by the linearised model and Student's distribution, without integration errors.
    standard_errors : dict of str to float
        Standard errors of the parameters, SI units, by the linearised model.
    correlation : ndarray
        Correlation of the estimates, in the order of `values`.
    residuals : dict of str to float
        Root mean square of model - data, by channel.
    solution : Solution
        Solution of the fitted model at the times of the data.
    runs : int
        Number of integrations.
    success : bool
        True if the search converged.
    message : str
        Reason for termination, and the parameters that are at a bound.
    """

    values: dict[str, float]
    intervals: dict[str, tuple[float, float]]
    standard_errors: dict[str, float]
    correlation: np.ndarray
    residuals: dict[str, float]
    solution: Solution
    runs: int
    success: bool
    message: str

    def as_dict(self) -> dict[str, object]:
        """Return the content of ``stiffmbs fit --json``."""
        return {
            "status": "done" if self.success else "stopped", "message": self.message, "runs": self.runs,
            "parameters": {
                name: {"value": value, "interval": list(self.intervals[name]), "standard_error": self.standard_errors[name]}
                for name, value in self.values.items()
            },
            "residuals": self.residuals,
        }  # fmt: skip


def fit(
    scene: Runnable,
    data: object,
    parameters: Mapping[str, object],
    *,
    start: Mapping[str, float] | None = None,
    sigma: Mapping[str, float] | None = None,
    **settings: object,
) -> Fit:
    """Fit parameters of a model to measured channels.

    `scipy.optimize.least_squares` minimises the sum of squares of (model - data) / sigma within the bounds.
    Derivatives are forward sensitivities (`stiffmbs.sensitivities`), or central differences of runs if the model has
    none.

    Parameters
    ----------
    scene : str, Path, Scene or Model
    data : mapping, Solution, pandas.DataFrame, str or Path
        Measured channels over ``time``, or formulas of channels; nan values are left out.
    parameters : mapping of str to Range, str or (float, float)
        Parameters or paths of the scene, with bounds: ``Range(1e5, 1e6, log=True)`` or ``"1e5:1e6:log"`` is searched
        by its logarithm.
    start : mapping of str to float, optional
        Start of the search; by default the middle of each range.
    sigma : mapping of str to float, optional
        Standard deviation of each channel's noise, up to a common factor; by default estimated from the residuals.
    **settings
        Fields of the run's settings to change, such as ``rtol=1e-8``.

    Raises
    ------
    InputError
        If the scene, the data or a parameter is invalid, or the data do not determine a parameter.
    SolverError
        If the model cannot be solved at the start of the search.

    References
    ----------
    Seber and Wild, Nonlinear Regression, 1989, chapter 5: confidence intervals.
    """
    found, written = measured(data), written_scene(scene)
    ranges = parameter_ranges(parameters, written)
    model = _Model(written, ranges, found, settings)
    weights = _weights(found, sigma)
    point = ranges.point(start or {})
    model.check(point)
    point = np.clip(point, INSIDE, 1 - INSIDE)
    for _ in range(1 if sigma is not None or len(found.channels) == 1 else ROUNDS):
        result = model.searched(point, weights)
        point = result.x
        if sigma is None:
            off = model.residual_rms(point)
            weights = {name: 1 / max(rms, 1e-9 / weights[name]) for name, rms in off.items()}
    return _concluded(model, ranges, point, weights, result, of_channels=sigma is None)


def _weights(found: Measured, sigma: Mapping[str, float] | None) -> dict[str, float]:
    if sigma is None:
        return {name: 1 / (float(np.nanstd(values)) or 1.0) for name, values in found.channels.items()}
    if not isinstance(sigma, Mapping):
        raise InputError(f"sigma: found {as_written(sigma)}, expected a number for each channel by name")
    for name in found.channels:
        given = sigma.get(name)
        if isinstance(given, bool) or not isinstance(given, Real) or not 0 < given < np.inf:
            raise InputError(
                f"sigma: found {as_written(given)} for '{name}', expected a number greater than 0 for each channel"
            )
    return {name: 1 / sigma[name] for name in found.channels}


class _Resolved(Exception):
    """End of a search."""

    def __init__(self, point: np.ndarray) -> None:
        super().__init__()
        self.point = point


class _Model:
    """Model at points of the unit cube, compared with the data."""

    def __init__(
        self, scene: WrittenScene, ranges: ParameterRanges, data: Measured, settings: Mapping[str, object]
    ) -> None:
        self._outputs: tuple[Output, ...] = outputs_of({name: name for name in data.channels})
        self._solver = CaseSolver(Task(scene, ranges.names, {}, self._outputs))
        self._ranges, self._data = ranges, data
        self.runs = 0  # number of integrations so far
        known = self._solver.scene(ranges.values(ranges.point({})))
        begin, end = known.run.start, float(data.time[-1])
        if data.time[0] < begin:
            raise InputError(f"data: found a time of {data.time[0]:g} s, expected none before the start at {begin:g} s")
        self._settings = changed(known.run, {**settings, "duration": end - begin, "points": 2})
        self._times = np.union1d([begin], data.time)
        self._gradients: Gradients | None = Gradients(scene, ranges, list(data.channels), self._settings, self._times)
        self._step = max(1e-4, self._settings.rtol ** (1 / 3))
        self._known: dict[bytes, list[np.ndarray] | None] = {}
        self._known_slopes: dict[bytes, list[np.ndarray]] = {}

    def solution(self, point: np.ndarray) -> Solution:
        """Return the solution at the times of the data; errors as for `stiffmbs.run`."""
        scene = self._solver.scene(self._ranges.values(point))
        job = self._solver.job(scene, self._settings)
        self.runs += 1
        return solved(replace(job, grid=replace(job.grid, times=self._times)))

    def check(self, point: np.ndarray) -> None:
        """Raise an error if the model cannot be solved at the start of the search."""
        solution = self.solution(point)
        if solution.outcome is not Outcome.DONE:
            raise SolverError(f"at the start of the search: {solution.message}")
        for output in self._outputs:
            output.refuse_unknown(solution)
        self._known[point.tobytes()] = self._off(solution)

    def searched(self, point: np.ndarray, weights: Mapping[str, float]) -> Any:
        """Return the result of `scipy.optimize.least_squares` from a point on.

        It ends where the next step is below the run's tolerance, or changes the model by less than its integration
        error. This is the relative offset of Bates and Watts, Technometrics 23 (1981) 179-183, with that error in place
        of the residuals.
        """
        from scipy.optimize import OptimizeResult, least_squares

        try:
            return least_squares(
                lambda at: self.residuals(at, weights), point, jac=lambda at: self._unresolved(at, weights),
                bounds=(0, 1), xtol=self._settings.rtol,
            )  # fmt: skip
        except _Resolved as end:
            message = "the next step changes the model by less than its integration error"
            return OptimizeResult(x=end.point, success=True, message=message, active_mask=np.zeros(len(point)))

    def _unresolved(self, point: np.ndarray, weights: Mapping[str, float]) -> np.ndarray:
        """Return the Jacobian; raise `_Resolved` where the next step is below the integration error."""
        J = self.jacobian(point, weights)
        step = np.linalg.qr(J)[0].T @ self.residuals(point, weights)
        signal = [w * np.nanstd(self._data.channels[name]) for name, w in weights.items()]
        if len(J) > len(point) and np.linalg.norm(step) < self._settings.rtol * np.sqrt(
            len(J) * np.mean(np.square(signal))
        ):
            raise _Resolved(point)
        return J

    def _off(self, solution: Solution) -> list[np.ndarray]:
        """Return model - data of each channel, without gaps of the data."""
        rows = np.searchsorted(solution.time, self._data.time)
        values = [np.broadcast_to(one.value(solution), solution.time.shape)[rows] for one in self._outputs]
        return [(a - b)[np.isfinite(b)] for a, b in zip(values, self._data.channels.values(), strict=True)]

    def differences(self, point: np.ndarray) -> list[np.ndarray] | None:
        """Return model - data of each channel at a point, which is solved once; None if it cannot be solved."""
        key = point.tobytes()
        if key not in self._known:
            try:
                solution = self.solution(point)
            except StiffmbsError:
                self._known[key] = None
                return None
            if solution.outcome is Outcome.INTERRUPTED:
                raise KeyboardInterrupt
            self._known[key] = self._off(solution) if solution.outcome is Outcome.DONE else None
        return self._known[key]

    def residuals(self, point: np.ndarray, weights: Mapping[str, float]) -> np.ndarray:
        """Return the weighted residuals of all channels."""
        off = self.differences(point)
        if off is None:
            return np.full(sum(int(np.isfinite(values).sum()) for values in self._data.channels.values()), FAR)
        return np.concatenate([weights[name] * part for name, part in zip(self._data.channels, off, strict=True)])

    def jacobian(self, point: np.ndarray, weights: Mapping[str, float]) -> np.ndarray:
        """Return the Jacobian by sensitivities, or by differences if the model has none."""
        key = point.tobytes()
        if key not in self._known_slopes:
            self._known_slopes[key] = self._slopes(point)
        slopes = self._known_slopes[key]
        return np.concatenate([weights[name] * part for name, part in zip(self._data.channels, slopes, strict=True)])

    def _slopes(self, point: np.ndarray) -> list[np.ndarray]:
        """Return the derivatives of the differences of each channel; by differences of runs once sensitivities failed."""
        try:
            slopes = self._gradients.at(point) if self._gradients else None
        except StiffmbsError:
            slopes = self._gradients = None
        if slopes is None:
            ones = dict.fromkeys(self._data.channels, 1.0)
            return self.by_channel(central_differences(lambda at: self.residuals(at, ones), point, self._step))
        self.runs += 1
        rows, shape = np.searchsorted(self._times, self._data.time), (len(self._times), len(point))
        return [
            np.broadcast_to(slope, shape)[rows][np.isfinite(values)]
            for values, slope in zip(self._data.channels.values(), slopes, strict=True)
        ]

    def by_channel(self, rows: np.ndarray) -> list[np.ndarray]:
        """Split rows of `residuals` or `jacobian` by channel."""
        return np.split(
            rows, np.cumsum([int(np.isfinite(values).sum()) for values in self._data.channels.values()])[:-1]
        )

    def residual_rms(self, point: np.ndarray) -> dict[str, float]:
        """Return the root mean square of the residuals by channel."""
        off = self.by_channel(self.residuals(point, dict.fromkeys(self._data.channels, 1.0)))
        return {name: float(np.sqrt(np.mean(part**2))) for name, part in zip(self._data.channels, off, strict=True)}


def _concluded(
    model: _Model,
    ranges: ParameterRanges,
    point: np.ndarray,
    weights: Mapping[str, float],
    result: Any,
    of_channels: bool,
) -> Fit:
    from scipy.stats import t as student

    J, r = model.jacobian(point, weights), model.residuals(point, weights)
    if len(r) <= len(point):
        raise InputError(f"data: found {len(r)} values, expected more than the {len(point)} parameters")
    singular = np.linalg.svd(J, compute_uv=False)
    if not singular[-1] > 1e-10 * singular[0]:
        flat = ranges.names[int(np.argmax(np.abs(np.linalg.svd(J)[2][-1])))]
        raise InputError(
            f"data: found that they do not determine '{flat}', expected channels that depend on it, or fewer parameters"
        )
    found = of_separate_noise(*map(model.by_channel, (J, r))) if of_channels else of_common_noise(J, r)
    errors = np.sqrt(np.diag(found.covariance))
    values, half = ranges.values(point), student.ppf((1 + CONFIDENCE) / 2, found.freedom) * errors
    low, high = (ranges.values(point + side * half) for side in (-1, 1))
    rms = model.residual_rms(point)
    slopes = ranges.slopes(point)
    return Fit(
        dict(zip(ranges.names, values, strict=True)),
        {name: (a, b) for name, a, b in zip(ranges.names, low, high, strict=True)},
        {name: float(error) for name, error in zip(ranges.names, errors * slopes, strict=True)},
        found.covariance / np.outer(errors, errors), rms, model.solution(point), model.runs, bool(result.success),
        "; ".join([str(result.message).rstrip("."), *_at_bounds(ranges, result.active_mask)]),
    )  # fmt: skip


def _at_bounds(ranges: ParameterRanges, active: np.ndarray) -> list[str]:
    """Return a clause on each parameter that is at a bound at the end of the search."""
    return [
        f"'{name}' is at its {'lower' if side < 0 else 'upper'} bound, {one.low if side < 0 else one.high:g}: a better fit may "
        "lie beyond it, and its confidence interval is not valid"
        for name, one, side in zip(ranges.names, ranges.ranges, active, strict=True)
        if side
    ]
