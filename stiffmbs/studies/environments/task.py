"""Tasks on a scene: inputs, observations, rewards, limits and random starts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...analyses.job import Runnable
from ...errors import InputError, SolverError, prefixed
from ...model.settings import Settings
from ...reading.files.quoted import written
from ..outputs import REDUCTIONS, Output, channel_of, outputs_of, parsed
from ..simulations import Simulations, simulations

Range = tuple[float, float]
"""Least and largest value."""


class TaskOptions(Settings, total=False):
    """Fields of a task and settings of its runs; see `stiffmbs.gym.Environment`."""

    actions: Mapping[str, Range]
    observations: Sequence[str]
    reward: str
    limits: Mapping[str, Range]
    joints: Mapping[str, Range]
    rates: Mapping[str, Range]
    dt: float
    steps: int


@dataclass(frozen=True)
class Learnt:
    """Task on a scene; the fields are described at `stiffmbs.gym.Environment`."""

    actions: dict[str, Range]
    observations: tuple[Output, ...]
    reward: Output
    limits: tuple[tuple[Output, Range], ...]
    joints: dict[str, Range]
    rates: dict[str, Range]
    dt: float
    steps: int

    @classmethod
    def of(
        cls, *, actions: Any = (), observations: Any = (), reward: Any = None, limits: Any = None, joints: Any = None,
        rates: Any = None, dt: Any = 0.02, steps: Any = 500, **settings: Any,
    ) -> tuple[Learnt, dict[str, Any]]:  # fmt: skip
        """Return a task, and the settings of its runs; raise an InputError if a part of it is invalid."""
        if not isinstance(dt, int | float) or not 0.0 < dt < np.inf:
            raise InputError(f"dt: found {dt!r}, expected a time greater than 0 s")
        if isinstance(steps, bool) or not isinstance(steps, int | np.integer) or steps < 1:
            raise InputError(f"steps: found {steps!r}, expected a whole number, 1 or more")
        if not actions:
            raise InputError("actions: found no ranges, expected one of an input at least")
        if isinstance(observations, str) or not observations:
            raise InputError(f"observations: found {written(observations)}, expected a list of channels or formulas")
        task = cls(
            _ranges("actions", actions), tuple(_formula("observations", text) for text in observations),
            _formula("reward", reward),
            tuple((_formula("limits", text), each) for text, each in _ranges("limits", limits or {}).items()),
            _ranges("joints", joints or {}), _ranges("rates", rates or {}), float(dt), int(steps),
        )  # fmt: skip
        return task, settings

    def simulations(self, model: Runnable, n: int, workers: int, settings: Mapping[str, Any]) -> Simulations:
        """Return simulations of a scene at their starts; raise an InputError if the task does not fit the scene."""
        inputs = {name: float(np.clip(0.0, *bounds)) for name, bounds in self.actions.items()}
        sims = simulations(model, n, inputs, workers=workers, **settings)
        others = [name for name in sims.inputs if name not in self.actions]
        if others:
            raise InputError(
                f"actions: found no range of input '{others[0]}', expected one of each input of the scene: {', '.join(sims.inputs)}"
            )
        self.begin(sims, np.ones(n, dtype=bool), np.random.default_rng(0))
        for formula in (*self.observations, self.reward, *(formula for formula, _ in self.limits)):
            with prefixed(f"'{formula.text}': "):
                self._values(sims, formula)
        return sims

    def begin(self, sims: Simulations, which: np.ndarray, random: np.random.Generator) -> None:
        """Reset simulations, a mask of shape (n,), to random starts."""
        count = int(np.count_nonzero(which))
        joints, rates = (
            {name: random.uniform(*bounds, count) for name, bounds in ranges.items()} or None
            for ranges in (self.joints, self.rates)
        )
        sims.reset(which, joints=joints, rates=rates)

    def step(self, sims: Simulations, actions: np.ndarray, shape: tuple[int, ...]) -> str:
        """Take a step with an action for each simulation; return a sentence on failures, or an empty string.

        Raise an InputError if the array of actions has not this shape.
        """
        actions = np.asarray(actions, dtype=float)
        if actions.shape != shape:
            raise InputError(f"actions: found an array of shape {actions.shape}, expected {shape}")
        actions = actions.reshape(len(sims), len(self.actions))
        try:
            sims.step(self.dt, dict(zip(self.actions, actions.T, strict=True)))
        except SolverError as error:
            return str(error)
        return ""

    def observed(self, sims: Simulations) -> np.ndarray:
        """Return the observations, shape (n, observations)."""
        return np.column_stack([self._values(sims, formula) for formula in self.observations])

    def rewards(self, sims: Simulations) -> np.ndarray:
        """Return the rewards, shape (n,)."""
        return self._values(sims, self.reward)

    def terminated(self, sims: Simulations) -> np.ndarray:
        """Return a mask of the simulations beyond a limit, or whose last step has failed."""
        found = sims.failed
        for formula, (least, largest) in self.limits:
            values = self._values(sims, formula)
            found |= ~((least <= values) & (values <= largest))
        return found

    @staticmethod
    def _values(sims: Simulations, formula: Output) -> np.ndarray:
        return np.broadcast_to(np.asarray(formula.value(_Now(sims)), dtype=float), (len(sims),))


@dataclass(frozen=True)
class _Now:
    """Inputs, channels and times of simulations, as an `Output` reads them."""

    sims: Simulations

    @property
    def time(self) -> np.ndarray:
        """Times, s."""
        return self.sims.t

    def __getitem__(self, name: str, /) -> np.ndarray:
        inputs = self.sims.inputs
        return inputs[name] if name in inputs else self.sims[name]


def _formula(field: str, text: str) -> Output:
    """Return a formula of values at one instant."""
    if not isinstance(text, str):
        raise InputError(f"{field}: found {written(text)}, expected a formula of channels and inputs")
    with prefixed(f"{field}: "):
        (found,) = outputs_of([text])
        reduced = [name for name in _called(found.text) if name in REDUCTIONS]
        if reduced:
            raise InputError(f"'{text}': found {reduced[0]}, expected values at one instant")
    return found


def _called(text: str) -> list[str]:
    """Return the functions that a formula calls."""
    import ast

    calls = (node.func for node in ast.walk(parsed(text)) if isinstance(node, ast.Call))
    return [channel_of(function) or "" for function in calls]


def _ranges(field: str, found: Mapping[str, Any]) -> dict[str, Range]:
    """Return ranges by name."""
    if not isinstance(found, Mapping):
        raise InputError(f"{field}: found {written(found)}, expected ranges by name")
    ranges = {}
    for name, given in found.items():
        try:
            least, largest = (float(value) for value in given)
        except (TypeError, ValueError):
            least, largest = np.nan, np.nan
        if not least <= largest:
            raise InputError(f"{field}: '{name}': found {written(given)}, expected a least and a largest number")
        ranges[name] = (least, largest)
    return ranges
