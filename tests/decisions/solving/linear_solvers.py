"""Decisions of the loop over IDA's steps, and of linear solvers."""

from __future__ import annotations

import numpy as np

from stiffmbs.solve import sampling
from stiffmbs.solve.ida.native import ida_loop
from stiffmbs.solve.ida.statistics import StepLog
from stiffmbs.solve.linear_solvers.native import block_lu, block_trial
from stiffmbs.solve.trajectory import Grid, Outcome
from tests.decisions.common import Record, always, never, nothing
from tests.interpreted import interpreted
from tests.solve.test_parameter_thresholds import DOUBLES, count_while


def steps_of_a_call():
    count = []
    c = Record(served=0, stopping=0.0)
    with interpreted(ida_loop, _served=nothing, stepped=lambda *_: count.append(1) or 0):
        ida_loop.advanced(c, None, 1, [1.0], 1.0, 10**9, None)
    return len(count)


def steps_in_memory():
    """Return the number of steps after which samples replace older ones."""
    c = Record(since_sample=0, next_sample=0, samples=np.zeros(100), n_reported=0, returned=0.0, y=None)
    count = 0
    with interpreted(ida_loop, array_of=nothing, _report=nothing):
        while count == 0 or c.next_sample or c.since_sample:
            ida_loop._sample(c)
            count += 1
    return count


def part_of_the_way():
    with interpreted(ida_loop):
        return ida_loop._toward(Record(returned=0.0, size=0.0), 1.0)


def tiny_steps():
    c = Record(tiny=0, size=0.0, internal=1.0)
    return count_while(lambda _: not ida_loop._stalled(c), range(1000))


def samples_of_a_call():
    """Return the largest number of samples that change nothing, over which one call integrates."""
    taken, at_rest = [], np.zeros(1)

    def solve(dynamics, now, ends, settings, watch):
        taken.append(len(ends))
        return Record(t=np.array(ends), q=np.zeros((len(ends), 1)), u=np.zeros((len(ends), 0)), outcome=Outcome.DONE)

    replaced = {
        "samples": lambda system, grid: [sampling.Sample(float(k), np.zeros(0, int)) for k in range(1, 20_000)],
        "next_values": lambda *_: at_rest, "_acting": lambda system: np.array([True]), "_joined": nothing,
        "_up_to": lambda grid, t, ends, finer: ends, "_up_to_row": lambda found, row: found,
        "_restarted": lambda *_: (Record(q=at_rest), 0.0), "_before_breakpoints": lambda found, *_: list(found),
    }  # fmt: skip
    dynamics = Record(system=Record(sampled=np.array([True]), first_state=0), input_features=nothing)
    with interpreted(sampling, **replaced):
        sampling.solved_between_samples(
            solve, dynamics, Record(q=at_rest, u=None), Grid(0.0, 1.0, np.empty(0)), None, None
        )
    return max(taken)


def steps_in_a_log():
    log = Record(count=0, _kept=0, _chunks=[], _rows=np.empty(0))
    StepLog.add(log, 10**9)
    return log._kept


def trial(left=0.5):
    """Return the record of a trial of factors that leaves a residual, relative to the allowed one."""
    s = Record(
        terms=np.ones(1), allowed=np.zeros(1), trial=None, tried=np.zeros(1), pivot=np.ones(1), serves=0, refined=0
    )
    replaced = {
        "_near_tried": never,
        "_sized": nothing,
        "_multiply": nothing,
        "_left_after_solution": lambda s, f: left,
    }
    with interpreted(block_trial, **replaced):
        block_trial.trusted(s, Record(n=1))
    return s


def largest_change_of_a_pivot():
    """Return the ratio of a pivot to that of the last trial, in quarter octaves, up to which no trial follows."""

    def near(ratio):
        return block_trial._near_tried(Record(serves=1, n=1, pivot=[ratio], tried=[1.0]))

    return count_while(near, DOUBLES)


def setups_after_refusals():
    """Return the number of setups without a trial after many refusals."""
    s = Record(
        ready=1,
        n_lu=1,
        parts=1,
        factors=None,
        waits=0,
        refused=999,
        setup_pivots=nothing,
        with_pivots={0: Record(last_flag=0)},
    )
    replaced = {
        "holds": always, "block_view": lambda table: s, "_eliminated": nothing, "trusted": never, "_has_pivots": always,
        "sparse_view": lambda table: Record(last_flag=0),
    }  # fmt: skip
    with interpreted(block_lu, **replaced):
        block_lu.setup({0: {block_lu.LU: 0}}, None)
    return s.waits


DECISIONS = {
    "loop.most_steps": steps_of_a_call,
    "loop.samples": steps_in_memory,
    "loop.steps_apart": steps_in_memory,
    "loop.first_part": part_of_the_way,
    "loop.most_tiny": tiny_steps,
    "loop.most_passed": samples_of_a_call,
    "loop.most_items": steps_in_a_log,
    "pivots.largest_residual": lambda: trial().allowed[0],
    "pivots.refinable": lambda: count_while(lambda left: trial(left).refined, DOUBLES[1:]),
    "pivots.changed": largest_change_of_a_pivot,
    "pivots.most_between_trials": setups_after_refusals,
}  # fmt: skip
"""Decision of each parameter: ``subsystem.field``, or ``module:NAME``."""
EXPECTED = {
    "loop.most_steps": 2048, "loop.samples": 64, "loop.steps_apart": 64, "loop.first_part": 0.01, "loop.most_tiny": 99, "loop.most_passed": 64, "loop.most_items": 1000000,
    "pivots.largest_residual": 1e-09, "pivots.refinable": 53, "pivots.changed": 12, "pivots.most_between_trials": 50,
}  # fmt: skip
"""The decisions of the default parameters."""
