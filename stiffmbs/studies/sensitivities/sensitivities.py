"""Sensitivity analysis: derivatives of outputs of a run by parameters of its scene."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np

from ...analyses.job import Job, Runnable, prepare
from ...compile.directional.direction import Numbers
from ...compile.reactions import reactions
from ...compile.system import System
from ...dynamics.dynamics import OutputRows
from ...errors import InputError, SolverError
from ...model.settings import RunSettings
from ...redundancy.messages.redundancy import derivative_notes
from ...results.channels import channels_of, counters, motion_channels, state_channels
from ...results.requests import requested
from ...sensitivity_equations.along_run import AlongRun, Instant, Side
from ...sensitivity_equations.block_system import Change
from ...sensitivity_equations.recorded import SENSITIVITIES, STAGES, Recorder
from ...solve.integrator import integrated
from ...solve.missing_rows import reported
from ...solve.settings import changed
from ...solve.trajectory import Grid, Outcome
from ...tuning import in_use
from ..outputs import outputs_of
from .formulas import ZERO, Formula
from .parameters import Parameter, Scenes, with_weights
from .set_up import SetUp, breakpoint_rates

FINEST = 1e-12
"""Finest tolerance of a run."""
TIGHTER = 1e-6
"""Ratio of the run's rtol to the requested one, down to `FINEST`.

Derivatives of forces in stiff bushings and of vibrations are less accurate than the motion.
"""
NUMBERS_OF_STEPS = {"bdf": tuple(200 * 8**k for k in range(4)), "radau": tuple(200 * 2**k for k in range(8))}
FEWEST = 200
"""Least numbers of steps of a run, and the first of them.

The error control disregards derivatives: steps may have any length if the motion is at rest or steady.
"""
ALIKE = {"bdf": 3, "radau": 2}
"""Number of successive runs that must agree. At rest bdf stays at order 1, which damps all vibrations: two of three runs may agree
only because of this."""
AGREED, NOISE = {"bdf": 5e-3, "radau": 1e-4}, 1e-9
"""Accepted difference between the derivatives of two runs, relative to their size, and relative to the output."""
AT_THE_LIMIT = 0.9
"""Part of the longest allowed step above which a step is not limited by the error control."""
HELD = {"formulation": "SI2", "presolve": False}
"""Settings of the run along which sensitivities are integrated."""


@dataclass(frozen=True)
class Sensitivity:
    """Output and its derivatives by parameters.

    Attributes
    ----------
    of : str
        Output, a formula of channels.
    value : float or ndarray, shape (n,)
        SI units; over the output instants if it is a channel.
    to : dict of str to float or ndarray
        Derivative by each parameter, SI units.
    time : ndarray, shape (n,)
        Output instants, s.
    notes : tuple of str
        Notes on the output, one sentence each.
    """

    of: str
    value: Any
    to: dict[str, Any]
    time: np.ndarray
    notes: tuple[str, ...] = ()

    def as_dict(self, scene: str) -> dict[str, object]:
        """Return the content of ``stiffmbs sensitivities --json``, with notes if there are any."""
        to = {name: np.asarray(slope).tolist() for name, slope in self.to.items()}
        value = np.asarray(self.value).tolist()
        notes = {"notes": list(self.notes)} if self.notes else {}
        return {"scene": scene, "of": self.of, "value": value, "to": to, **notes}


def sensitivities(scene: Runnable, to: Sequence[str] | str, of: str, **settings: object) -> Sensitivity:
    """Compute derivatives of an output of a run by parameters of its scene, by forward sensitivity analysis.

    The equations of motion are differentiated exactly, and integrated along the steps of `bdf` with their own iteration
    matrices, or along the steps of `radau` with ``solver="radau"``. Jumps at breakpoints in time and at events are included.

    Parameters
    ----------
    scene : str, Path, Scene or Model
    to : sequence of str
        Parameters of the scene, or paths of numbers in it: ``"k_b"``, ``"bodies.bar.mass"``,
        ``"forces.spring.i.point.0"``.
    of : str
        A formula of channels and of ``peak``, ``max``, ``min``, ``final``, ``first``, ``rms``, ``mean`` and
        ``integral`` of them.
    **settings
        Fields of the run's settings to change: ``duration=2.0, rtol=1e-9``.

    Returns
    -------
    Sensitivity

    Raises
    ------
    InputError
        If the scene, a parameter or the output is invalid, or a parameter changes the structure of the model.
    AssemblyError
        If no consistent start is found.
    SolverError
        If the run stops early, or the motion is not differentiable: an event function only touches zero.

    Notes
    -----
    The error control sees the motion, not its variations.  If it does not limit the steps (a motion at rest, or a
    steady one), steps are shortened until the derivatives agree.  Vibrations that the motion does not excite are damped
    by `bdf` if more than about
    1e4 of their periods are in the run.

    References
    ----------
    Caracotsios and Stewart, Comput. Chem. Eng. 9 (1985) 359-365; Feehery, Tolsma and Barton, Appl. Numer. Math. 25
    (1997) 41-54;
    Galan, Feehery and Barton, Appl. Numer. Math. 31 (1999) 17-47.

    Examples
    --------
    >>> found = stiffmbs.sensitivities("examples/half_car.yaml", ["k_b", "V"], "peak(front_bushing.fx)")
    >>> found.to["V"]
    """
    names = [to] if isinstance(to, str) else list(to)
    if not names or len(set(names)) < len(names):
        raise InputError(f"to: found {', '.join(names) or 'no parameter'}, expected one parameter or more, each once")
    if not isinstance(of, str):
        raise InputError(f"of: found {of!r}, expected the text of one formula such as 'peak(bushing.fx)'")
    (output,) = outputs_of(of)
    scenes = Scenes.of_model(scene)
    asked = changed(scenes.known.run, settings)
    found: list[Sensitivity] = []
    solver = _solver(asked)
    sizes = {name: abs(Parameter(scenes, name).value) for name in names}
    numbers, agreed = NUMBERS_OF_STEPS[solver], partial(_agree, AGREED[solver], sizes)
    for steps in numbers:
        run = differentiated(scenes, names, asked, steps)
        found += run.sensitivities([output.text])
        last = found[-ALIKE[solver] :]
        if not run.at_the_limit or (len(last) == ALIKE[solver] and all(map(agreed, last, last[1:]))):
            return found[-1]
    raise SolverError(
        f"sensitivities: found that {numbers[-1]} steps do not resolve how '{output.text}' changes with {', '.join(names)}, "
        "expected a shorter run, or more damping of a motion that is not excited"
    )


def _solver(settings: RunSettings) -> str:
    """Return the solver with whose steps sensitivities are integrated: `radau` if it is requested, otherwise `bdf`."""
    return "radau" if settings.solver == "radau" else "bdf"


def _agree(agreed: float, sizes: Mapping[str, float], coarse: Sensitivity, fine: Sensitivity) -> bool:
    """Return True if derivatives along longer and along shorter steps are equal within the accepted error.

    `sizes`: magnitudes of the parameters. The derivative of an output that is zero up to rounding may be rounding itself:
    then changes of the output by the whole parameter below `ZERO` are equal.
    """
    size = float(np.max(np.abs(fine.value), initial=0.0))
    for name, slope in fine.to.items():
        apart = float(np.max(np.abs(coarse.to[name] - slope), initial=0.0))
        if size <= ZERO and apart * sizes[name] <= ZERO and sizes[name] > 0:
            continue
        if apart > agreed * float(np.max(np.abs(slope), initial=0.0)) + NOISE * size:
            return False
    return True


def differentiated(scenes: Scenes, names: Sequence[str], asked: RunSettings, fewest: int = FEWEST) -> DifferentiatedRun:
    """Run with a much tighter tolerance, or with the requested one if that fails; errors as for `sensitivities`.

    A run that stops because a force chatters is not repeated, as no tolerance resolves chattering.
    """
    scenes = with_weights(scenes, names)
    for rtol in (min(asked.rtol, max(TIGHTER * asked.rtol, FINEST)), asked.rtol):
        job = prepare(scenes.known, differentiable(changed(asked, {"rtol": rtol}), fewest))
        run = DifferentiatedRun(scenes, names, job)
        if run.success or run.chatters:
            break
    return run


def differentiable(settings: RunSettings, fewest: int = FEWEST) -> RunSettings:
    """Settings of a run along which sensitivities can be integrated, in at least the `fewest` steps."""
    longest = settings.duration / fewest
    return changed(
        settings,
        {**HELD, "solver": _solver(settings), "stages": STAGES, "max_step": min(settings.max_step or longest, longest)},
    )


class DifferentiatedRun:
    """Run with the derivatives of its outputs by parameters.

    `job`: the unchanged scene, with settings that are `differentiable`. `times`: output times that replace those of the
    settings.
    """

    def __init__(self, scenes: Scenes, names: Sequence[str], job: Job, times: np.ndarray | None = None) -> None:
        parameters = [Parameter(scenes, name) for name in names]
        self._job = job
        system = job.dynamics.system
        if system.sampled.any():
            name = system.states[int(np.argmax(system.sampled))]
            raise InputError(
                f"states.{name}: found a sampled state, expected none: sensitivities do not include the jumps of samples"
            )
        self._set_ups = [SetUp(job, parameter) for parameter in parameters]
        self._numbers = [set_up.numbers for set_up in self._set_ups]
        grid = job.grid if times is None else Grid(job.grid.start, job.grid.end, times)
        with in_use(job.settings.tuning):
            self._recorder = Recorder(job.dynamics, job.settings)
            job.dynamics.forget_pivots()
            self._trajectory = integrated(self._recorder, job.start, grid, lambda _: None)
        if self._trajectory.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        # `success`: the whole time was solved. `chatters`: it stopped because a force chatters. `at_the_limit`: the
        # longest allowed step, not the error control, limits some steps.
        self.success = self._trajectory.outcome is Outcome.DONE
        self.chatters = self._recorder.chatters
        self.at_the_limit = self._recorder.longest_step >= AT_THE_LIMIT * (job.settings.max_step or np.inf)
        self._jumping: list[tuple[str, int, np.ndarray]] = []

    def sensitivities(self, texts: Sequence[str]) -> list[Sensitivity]:
        """Return the sensitivities of formulas of channels; errors as for `stiffmbs.sensitivities`."""
        rows = self._rows
        channels = channels_of(self._job.data, self._job.dynamics.system, rows)
        outputs = outputs_of(tuple(texts))
        for output in outputs:
            output.refuse_unknown(channels)
        formulas = [Formula(output.text, rows.t, channels) for output in outputs]
        slopes = self._slopes(channels, np.unique(np.concatenate([formula.instants() for formula in formulas])))
        redundancy = self._job.redundancy
        notes = [tuple(derivative_notes(redundancy, output.channels)) for output in outputs]
        return [self._of_formula(formula, slopes, own) for formula, own in zip(formulas, notes, strict=True)]

    def _of_formula(self, formula: Formula, slopes: dict[str, np.ndarray], notes: tuple[str, ...]) -> Sensitivity:
        dual = formula.dual(slopes)
        by = np.broadcast_to(dual.slope, (*np.shape(dual.value), len(self._set_ups)))
        if np.ndim(dual.value) == 0:
            self._refuse_jumps(formula, slopes)
        if not np.isfinite(by).all():
            raise SolverError(
                f"sensitivities: found a derivative of '{formula.text}' that is no number, expected finite ones"
            )
        to = {set_up.parameter.name: _plain(by[..., k]) for k, set_up in enumerate(self._set_ups)}
        return Sensitivity(formula.text, _plain(dual.value), to, self._rows.t, notes)

    def _refuse_jumps(self, formula: Formula, slopes: dict[str, np.ndarray]) -> None:
        """Reject a number that evaluates a channel at a discontinuity; a series has the value of the right side."""
        for name, k, moved in self._jumping:
            here = np.zeros((len(self._rows.t), 1), dtype=bool)
            here[k] = True
            slope = formula.dual({**slopes, name: np.where(here & moved, np.nan, slopes[name])}).slope
            for parameter in np.flatnonzero(np.isnan(np.broadcast_to(slope, moved.shape))):
                raise SolverError(
                    f"sensitivities: found that '{name}' is discontinuous at the output time t = {self._rows.t[k]:.9g} s, and "
                    f"'{self._set_ups[parameter].parameter.name}' moves the discontinuity: '{formula.text}' has no derivative "
                    "with respect to it; expected other output times"
                )

    @cached_property
    def _rows(self) -> OutputRows:
        if not self.success:
            raise SolverError(f"sensitivities: the run {self._trajectory.message}")
        with in_use(self._job.settings.tuning):
            rows, gaps = reported(self._job.dynamics, self._trajectory, True, self._job.settings.rtol)
        if len(rows.t) < len(self._trajectory.t) or gaps:
            raise SolverError(
                "sensitivities: found output times without accelerations and reactions, expected them everywhere"
            )
        return rows

    def _slopes(self, channels: dict[str, np.ndarray], instants: np.ndarray) -> dict[str, np.ndarray]:
        """Return the derivatives of all channels, shape (n, directions); zero at other than the given instants."""
        job, rows, count = self._job, self._rows, len(self._set_ups)
        with in_use(job.settings.tuning):
            along = AlongRun(job.dynamics, self._recorder, self._numbers, breakpoint_rates(self._set_ups))
            start_q, start_u = (np.array([set_up.start[k] for set_up in self._set_ups]) for k in range(2))
            try:
                found = list(along.at(rows, instants, start_q, start_u))
            finally:
                along.close()
        if not found:
            return {}
        at = rows.at(instants)
        changed = self._changed(at, {name: values[instants] for name, values in channels.items()}, found)
        slopes = {name: np.zeros((len(rows.t), count)) for name in changed}
        for name, slope in changed.items():
            slopes[name][instants] = slope
        for instant in found:
            if instant.sides:
                self._take_both_sides(instant, channels, slopes)
        return slopes

    def _take_both_sides(
        self, instant: Instant, channels: dict[str, np.ndarray], slopes: dict[str, np.ndarray]
    ) -> None:
        """Average both sides of a breakpoint at an output time, as central differences do."""
        job, k, moved = self._job, instant.number, instant.moved
        there = [channels_of(job.data, job.dynamics.system, side.row) for side in instant.sides]
        left, right = (self._changed(s.row, at, [s]) for s, at in zip(instant.sides, there, strict=True))
        for name, slope in slopes.items():
            jump = abs(float(there[1][name][0] - there[0][name][0]))
            jumps = jump > SENSITIVITIES.no_jump * job.settings.rtol * np.abs(channels[name]).max()
            both = right[name][0] if jumps else 0.5 * (left[name][0] + right[name][0])
            slope[k] = np.where(moved, both, slope[k])
            if jumps:
                self._jumping.append((name, k, moved))

    def _changed(
        self, rows: OutputRows, channels: dict[str, np.ndarray], found: Sequence[Instant | Side]
    ) -> dict[str, np.ndarray]:
        """Return the derivatives of all channels at some output times, shape (times, directions)."""
        job, changes = self._job, [each.change for each in found]
        values = np.array([each.values for each in found])
        slopes = changed_channels(job.dynamics.system, rows.u, self._numbers, changes, values)
        if job.data.requests:
            moved_q = np.array([change.q for change in changes])
            slopes |= changed_requests(job, self._set_ups, rows, channels, slopes, moved_q)
        return slopes


def _plain(value: Any) -> Any:
    return float(value) if np.ndim(value) == 0 else np.asarray(value, dtype=float)


def changed_channels(
    system: System, u: np.ndarray, numbers: Sequence[Numbers], changes: Sequence[Change], values: np.ndarray
) -> dict[str, np.ndarray]:
    """Return the derivatives of the channels of bodies, elements and energies, each of shape (instants, directions).

    `u` of shape (instants, n_u). `numbers`: numbers of the directions. `values` of shape (instants, directions,
    values): derivatives of the output terms.
    """
    shape = len(changes), len(numbers)
    moved_q, moved_u, moved_a = (
        np.concatenate([getattr(change, name) for change in changes]) for name in ("q", "u", "acceleration")
    )
    channels = motion_channels(system, moved_q, moved_u, moved_a)
    flat = values.reshape(-1, values.shape[-1])
    channels |= state_channels(system, moved_q, flat)
    channels |= reactions(system, flat)
    channels["energy.potential"] = flat[:, system.term("output", "potential").source].sum(axis=1)
    channels = {name: slope.reshape(shape) for name, slope in channels.items()}
    masses = np.array([each.mass for each in numbers])
    kinetic = np.einsum("iu,idu->id", system.mass * u, moved_u.reshape(*shape, -1)) + 0.5 * u**2 @ masses.T
    kinetic += flat[:, system.term("output", "kinetic").source].sum(axis=1).reshape(shape)
    return channels | {"energy.kinetic": kinetic, "energy.total": kinetic + channels["energy.potential"]}


def changed_requests(
    job: Job, set_ups: Sequence[SetUp], rows: OutputRows, channels: Mapping[str, np.ndarray], slopes: Mapping[str, np.ndarray],
    moved_q: np.ndarray,
) -> dict[str, np.ndarray]:  # fmt: skip
    """Return the derivatives of requests, by central differences of their formulas, shape (n, directions).

    `channels`: channels that formulas read, shape (n,). `slopes`: their derivatives, shape (n, directions). `moved_q`
    of shape (n, directions, n_q): derivatives of the coordinates, including revolution counters.
    """
    columns = []
    for k, set_up in enumerate(set_ups):
        found = []
        for scene, shift in zip(set_up.scenes, set_up.shifts, strict=True):
            there = {name: channels[name] + shift * slope[:, k] for name, slope in slopes.items()}
            counted = counters(scene, job.dynamics.system, rows.q + shift * moved_q[:, k])
            found.append(requested(scene, rows.t, there, counted))
        columns.append({name: set_up.derivative([values[name] for values in found]) for name in found[0]})
    return {name: np.column_stack([column[name] for column in columns]) for name in columns[0]}
