"""Statistics of a solver as lines of a summary."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

WORK = {
    "residuals": "residuals", "newton_iterations": "Newton iterations", "jacobians": "Jacobians",
    "factorizations": "factorizations", "accelerations": "accelerations", "moves": "moves",
}  # fmt: skip
"""Counters of work, in the order of a summary."""
AS_MANY_AS = {"newton_iterations": "residuals", "factorizations": "jacobians"}
"""Counters that are shown only where they differ from others."""
REPEATED = {"error_test_failures": "failed the error test", "convergence_failures": "did not converge"}
"""Reasons for which steps were repeated."""
RESTARTS = {"breakpoints": ("input breakpoint", "input breakpoints"), "events": ("event", "events")}
"""Instants at which the solver restarts: one, and several."""


def solver_lines(solver: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield label and text of each line on the solver of a run: its name, its steps, and their cost.

    `solver`: the statistics of a `Solution`.
    """
    chosen = {"scheme": "scheme", "linear_solver": "linear solver"}
    yield (
        "solver",
        ", ".join([solver["name"], *(f"{word} {solver[key]}" for key, word in chosen.items() if key in solver)]),
    )
    yield "steps", ", ".join(_steps(solver))
    restarts = [
        f"{solver[counter]} {words[solver[counter] > 1]}" for counter, words in RESTARTS.items() if solver.get(counter)
    ]
    if restarts:
        yield "restarts", f"at {' and '.join(restarts)}"
    yield "cost", ", ".join([*_work(solver), f"{solver['seconds'] * 1e3:.1f} ms"])


def _steps(solver: Mapping[str, Any]) -> Iterator[str]:
    repeated = [f"{solver[counter]} more {why}" for counter, why in REPEATED.items() if solver.get(counter)]
    if solver.get("rejected") and not repeated:
        repeated = [f"{solver['rejected']} more rejected"]
    yield str(solver["steps"]) + (f" ({', '.join(repeated)})" if repeated else "")
    if "order" in solver:
        yield f"order {solver['order']} at the end"


def _work(solver: Mapping[str, Any]) -> Iterator[str]:
    for counter, word in WORK.items():
        if counter in solver and solver[counter] != solver.get(AS_MANY_AS.get(counter, "")):
            yield f"{solver[counter]} {word}{_slow_convergence(solver) if counter == 'jacobians' else ''}"


def _slow_convergence(solver: Mapping[str, Any]) -> str:
    """Return how many Jacobians were computed because Newton's iteration converged too slowly with an older one.

    IDA counts them as failures of the iteration, and once more where a new matrix did not help, so that the step did not
    converge.
    """
    slow = solver.get("newton_failures", 0) - solver.get("convergence_failures", 0)
    return f" ({slow} after slow Newton convergence)" if slow > 0 else ""
