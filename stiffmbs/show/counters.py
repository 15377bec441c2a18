"""What a solver counted, in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

WORK = {
    "residuals": "residuals", "newton_iterations": "Newton iterations", "jacobians": "Jacobians",
    "factorizations": "factorizations", "accelerations": "accelerations", "moves": "moves",
}  # fmt: skip
"""Counters of work, in the order in which they are told."""
AS_MANY_AS = {"newton_iterations": "residuals", "factorizations": "jacobians"}
"""Counters that are told only where they differ from others."""
IN_VAIN = {"error_test_failures": "failed the error test", "convergence_failures": "did not converge"}
"""Steps that were repeated, and why."""
STARTS = {"breakpoints": ("breakpoint of inputs", "breakpoints of inputs"), "events": ("event", "events")}
"""Instants at which the solver stops and starts anew: one, and several."""


def solver_words(solver: Mapping[str, Any]) -> str:
    """One line on a run's solver: its name, its steps, and what they cost.

    Parameters
    ----------
    solver : mapping of str
        The statistics of a `Solution`.
    """
    chosen = {"scheme": "scheme", "linear_solver": "linear solver"}
    name = [solver["name"], *(f"{word} {solver[key]}" for key, word in chosen.items() if key in solver)]
    parts = (name, _steps(solver), _work(solver), _starts(solver), [f"{solver['seconds'] * 1e3:.1f} ms"])
    return "; ".join(", ".join(told) for told in map(list, parts) if told)


def _steps(solver: Mapping[str, Any]) -> Iterator[str]:
    told = [f"{solver[counter]} more {why}" for counter, why in IN_VAIN.items() if solver.get(counter)]
    if solver.get("rejected") and not told:
        told = [f"{solver['rejected']} more refused"]
    yield f"{solver['steps']} steps" + (f" ({', '.join(told)})" if told else "")
    if "order" in solver:
        yield f"order {solver['order']} at the end"


def _work(solver: Mapping[str, Any]) -> Iterator[str]:
    for counter, word in WORK.items():
        if counter in solver and solver[counter] != solver.get(AS_MANY_AS.get(counter, "")):
            yield f"{solver[counter]} {word}{_asked_for(solver) if counter == 'jacobians' else ''}"


def _asked_for(solver: Mapping[str, Any]) -> str:
    """How many matrices were made because Newton's iteration did not settle with an older one.

    IDA counts them as failures of the iteration, and once more where a new matrix did not help, so that the step did not
    converge.
    """
    asked = solver.get("newton_failures", 0) - solver.get("convergence_failures", 0)
    return f" ({asked} of them as Newton's iteration was too slow with an older one)" if asked > 0 else ""


def _starts(solver: Mapping[str, Any]) -> Iterator[str]:
    starts = [
        f"{solver[counter]} {what[solver[counter] > 1]}" for counter, what in STARTS.items() if solver.get(counter)
    ]
    if starts:
        yield f"started anew at {' and '.join(starts)}"
