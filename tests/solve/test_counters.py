"""The lines of a summary on the solver say what its counters mean."""

import stiffmbs
from stiffmbs.show.summary import solver_lines

from ..conftest import EXAMPLES

IDA = {
    "name": "bdf", "linear_solver": "dense, 19 unknowns", "steps": 1000, "residuals": 2000, "jacobians": 310,
    "factorizations": 310, "error_test_failures": 4, "convergence_failures": 2, "newton_iterations": 2000,
    "newton_failures": 302, "rejected": 6, "order": 5, "breakpoints": 0, "events": 3, "seconds": 0.0725,
}  # fmt: skip


def test_matrices_made_anew_are_no_failures():
    assert list(solver_lines(IDA)) == [
        ("solver", "bdf, linear solver dense, 19 unknowns"),
        ("steps", "1000 (4 error test failures, 2 convergence failures), order 5 at the end"),
        ("restarts", "at 3 events"),
        ("cost", "2000 residuals, 310 Jacobians (300 after slow Newton convergence), 72.5 ms"),
    ]


def test_what_did_not_happen_is_not_told():
    quiet = {
        **IDA,
        "error_test_failures": 0,
        "convergence_failures": 0,
        "newton_failures": 0,
        "rejected": 0,
        "events": 0,
    }
    assert list(solver_lines(quiet)) == [
        ("solver", "bdf, linear solver dense, 19 unknowns"),
        ("steps", "1000, order 5 at the end"),
        ("cost", "2000 residuals, 310 Jacobians, 72.5 ms"),
    ]


def test_explicit_steps_count_accelerations():
    found = {
        "name": "projected",
        "steps": 56,
        "rejected": 1,
        "accelerations": 851,
        "breakpoints": 2,
        "events": 0,
        "seconds": 0.001,
    }
    assert list(solver_lines(found)) == [
        ("solver", "projected"),
        ("steps", "56 (1 rejected)"),
        ("restarts", "at 2 input breakpoints"),
        ("cost", "851 accelerations, 1.0 ms"),
    ]
    both = dict(solver_lines(found | {"breakpoints": 1, "events": 1}))
    assert both["restarts"] == "at 1 input breakpoint and 1 event"


def test_every_counter_of_a_run_is_told_or_known_to_be_part_of_another():
    solution = stiffmbs.run(stiffmbs.load_scene(EXAMPLES / "bar_pendulum.yaml"), duration=0.5)
    words = str(list(solver_lines(solution.solver)))
    known = {"newton_failures", "rejected", "breakpoints", "events", "convergence_failures"}
    told = [
        k for k, v in solution.solver.items() if isinstance(v, int) and k not in known and v and str(v) not in words
    ]
    assert told == []
