"""A run judged by its channels."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from stiffmbs.analyses.run import run
from stiffmbs.errors import StiffmbsError
from stiffmbs.model.model_builder import ModelBuilder
from stiffmbs.model.model_data import ModelData
from stiffmbs.results.solution import Solution
from stiffmbs.solve.trajectory import Outcome as Ending
from stiffmbs.solve.trajectory import ProgressCallback

from .case import Case, Outcome, Verdict, measured, told

PATIENCE = 20.0
"""Time, s, after which a run is given up."""
ANY_STOP = ("t = ",)
"""What the message of a run that stopped names in any case."""


def simulation(
    name: str, what: str, scene: Callable[[], ModelBuilder | ModelData], error: Callable[[Solution], float], allowed: float,
    *, names: tuple[str, ...] = ANY_STOP, noted: tuple[str, ...] = (), expected: Outcome = Outcome.RIGHT,
    quick: bool = True, **how: Any,
) -> Case:  # fmt: skip
    """A case that solves a scene.

    Parameters
    ----------
    name, what, expected, quick
        As in `Case`.
    scene : callable
        Describes it.
    error : callable
        Of the solution, also of one that ended early: its error as a number.
    allowed : float
        The largest error that is right.
    names : tuple of str
        What a message says if the scene is refused or the run stops.
    noted : tuple of str
        What the notes of a run say that goes through.
    **how
        Settings of the run.
    """
    return Case(name, what, lambda: _judged(scene, error, allowed, names, noted, how), expected, quick)


def _judged(
    scene: Callable[[], ModelBuilder | ModelData], error: Callable[[Solution], float], allowed: float,
    names: tuple[str, ...], noted: tuple[str, ...], how: dict[str, Any],
) -> Verdict:  # fmt: skip
    try:
        solution = run(scene(), watch=patience(PATIENCE), **how)
    except StiffmbsError as refusal:
        return told(str(refusal), names)
    found = error(solution)
    if solution.outcome is Ending.INTERRUPTED:
        return _given_up(solution, found, allowed)
    if solution.outcome is Ending.STOPPED:
        return told(solution.message, names, found, allowed)
    notes = "; ".join(solution.notes)
    if noted:
        return told(notes, noted, found, allowed)
    return measured(found, allowed, f"{solution.solver['steps']} steps" + (f"; {notes}" if notes else ""))


def patience(seconds: float) -> ProgressCallback:
    """Interrupts a run, as its user would, when it takes longer than that from now."""
    begun = time.process_time()

    def watch(t: float) -> None:
        if time.process_time() - begun > seconds:
            raise KeyboardInterrupt

    return watch


def _given_up(solution: Solution, found: float, allowed: float) -> Verdict:
    outcome = Outcome.SLOW if found <= allowed else Outcome.WRONG
    steps = solution.solver["steps"]
    return Verdict(
        outcome, found, allowed, f"aborted after {PATIENCE:g} s at t = {solution.t[-1]:.6g} s, {steps} steps"
    )


def refusal(
    name: str, what: str, scene: Callable[[], ModelBuilder | ModelData], names: tuple[str, ...], **how: Any
) -> Case:
    """A case whose scene has no solution: anything but a message that names these words is wrong."""
    return simulation(name, what, scene, lambda solution: float("inf"), 0.0, names=names, expected=Outcome.TOLD, **how)
