"""Decisions on steps near breakpoints, on long steps, inputs and jumps."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np

from stiffmbs.solve import missing_rows, sampling
from stiffmbs.solve.events import discontinuity, narrow_inputs
from stiffmbs.solve.events.native import bounds
from stiffmbs.solve.ida.native import first_steps, ida_events
from stiffmbs.solve.trajectory import Grid, History, Outcome, Trajectory
from tests.decisions.common import Record, always, never, nothing, searched
from tests.interpreted import interpreted
from tests.solve.test_parameter_thresholds import DOUBLES, count_while


def distance_from_an_event():
    """Return the distance to an event in the middle of a step of 1 s at which the step ends."""
    w = searched(longest=1e5, n_nodes=0)
    replaced = {
        "go_ahead": nothing, "take_reactions": nothing, "evaluate_near": lambda *_: np.zeros(1), "note_mean_rates": nothing,
        "suspicious": always, "first_event": lambda *_: 0.5,
    }  # fmt: skip
    with interpreted(ida_events, **replaced):
        ida_events._aim(Record(returned=0.0), w, Record(q=None), 1.0)
    return 0.5 - w.target


def largest_part_of_an_interval():
    """Return the hundredths of an interval that a half step passes up to which the step is not shortened."""

    def passes(k):
        return searched(
            n_event_functions=0,
            first_breakpoint=np.array([0, 2]),
            value_before=np.zeros(1),
            m=np.array([0.01 * k]),
            value_after=np.array([0.02 * k]),
        )

    with interpreted(ida_events, _narrowest=lambda *_: 1.0):
        return count_while(lambda k: ida_events._within_intervals(passes(k)), range(1, 200))


def longest_passage():
    """Return the passage, in quarter octaves of 1 us, up to which the first steps are limited in a run of 1 s."""

    def is_found(length):
        with interpreted(first_steps, _another_side=lambda c, w, s, ahead, count: ahead >= length):
            return first_steps._passage(Record(returned=0.0, repeat=0), searched(), None, 1.0, 1.0, 1) > 0.0

    return count_while(is_found, 1e-6 * DOUBLES[:200])


def bounded_passage(w, returned=0.0, repeat=0):
    c = Record(repeat=repeat, returned=returned, next_step_of=nothing, memory=0, next_size=0.0)
    with interpreted(first_steps, _passage=lambda *_: 1.0, _matters=never):
        first_steps.bound_first_steps(c, w, None, 1.0, 1.0)
    return w


def first_part_of_a_run():
    """Return the tenths of a millionth of a run up to which every step of a passage is limited."""
    return count_while(lambda k: not bounded_passage(searched(), 1e-7 * k).under_way, range(1, 100))


def step_bound_by_a_feature():
    """Return the hundredths of a radian up to which a feature bounds a step more than arguments of sines do."""
    return count_while(
        lambda k: bounds.bounded_by_feature(searched(n_turns=1, rate_before=np.array([0.01 * k]))), range(1, 400)
    )


def samples_of_narrow_features():
    asked = []
    features = Record(breakpoints=np.empty(0), instants=lambda *given: asked.append(given[-1]) or np.empty(0))
    narrow_inputs.hidden_peak([], features, np.linspace(0.0, 1.0, 3))
    return asked[0]


def distance_from_the_end_of_an_input():
    """Return the distance, in ten thousandths of the run, up to which a solver has stopped at the end of an input."""
    end = Record(t=1.0, near=0.0, sentence=lambda: "the input ends")
    dynamics, grid = Record(input_end=lambda *_: end), Grid(0.0, 1.0, None)

    def is_end(k):
        state = np.zeros((1, 1))
        found = Trajectory(
            np.array([1.0 - 1e-4 * k]), state, state, Outcome.STOPPED, "stopped", {}, History(np.empty(0), np.empty(0))
        )
        return narrow_inputs.solve_up_to_the_inputs_end(dynamics, grid, lambda _: found).message == "the input ends"

    return count_while(is_end, range(1, 100))


def smallest_jump():
    """Return the change of a rate over the larger move, in tenths of that over the smaller one, up to which there is a jump."""

    def is_jump(tenths):
        change = {1e-6: 0.1 * tenths}

        def pair(size):
            value, rate = np.array([size]), 0.5 * np.array([change.get(size, 1.0)])
            return [Record(values=value, rates=-rate), Record(values=-value, rates=rate)]

        return discontinuity._slides(Record(at_zero=lambda *_: Record(sides=pair)), 1.0, 0)

    return count_while(is_jump, range(1, 1000))


def interval_of_rates():
    found = []
    beside = Record(_count=1, u=np.zeros(1), _at=(), _there=np.zeros(1), _table=0, t=0.0)
    with patch.object(discontinuity, "SIDE", Record(short_call=lambda t, size, interval, *_: found.append(interval))):
        discontinuity._Around.side(beside, 1.0)
    return found[0]


def first_sample():
    """Return the time of a sample before the start, in quarter octaves of 1e-12 periods, up to which it is taken at the start."""
    grid = Grid(0.0, 2.0, None)

    def is_at_start(before):
        system = Record(sampling=np.array([[1.0, -before]]), sampled=np.array([True]))
        return next(sampling.samples(system, grid)).t < 0.5

    return count_while(is_at_start, 1e-12 * DOUBLES[:160])


def gaps_in_output():
    count = 1000
    t, zeros = np.arange(float(count)), np.zeros((count, 1))
    body = Record(moved=lambda q, step: q)

    def report(t, q, u, project):
        return Record(t=t[:1], status=next(iter(missing_rows.FAILURES)))

    dynamics = Record(report=report, system=Record(of_body=body))
    with patch.multiple(
        missing_rows, _unknown=nothing, joined_rows=nothing, with_stiff_forces=nothing, lengths_of_steps=nothing
    ):
        return len(missing_rows.reported(dynamics, Record(t=t, q=zeros, u=zeros), False, 1e-6)[1])


DECISIONS = {
    "next_step.short_of": distance_from_an_event,
    "next_step.of_an_interval": largest_part_of_an_interval,
    "next_step.soon": longest_passage,
    "next_step.passage_steps": lambda: bounded_passage(searched(n_turns=1)).passage,
    "next_step.first_part": lambda: bounded_passage(searched(n_turns=1)).first,
    "next_step.inside": lambda: bounded_passage(searched(), repeat=1).passage,
    "next_step.lifted": first_part_of_a_run,
    "narrow_inputs.most_samples": samples_of_narrow_features,
    "jumps.jumps": smallest_jump,
    "jumps.rate_interval": interval_of_rates,
    "solve.events.native.step_bound:STRETCHED": step_bound_by_a_feature,
    "solve.events.narrow_inputs:NEAR_INPUT_END": distance_from_the_end_of_an_input,
    "solve.trajectory:SAME_TIME": first_sample,
    "solve.missing_rows:MOST_MISSING": gaps_in_output,
}  # fmt: skip
"""Decision of each parameter: ``subsystem.field``, or ``module:NAME``."""
EXPECTED = {
    "next_step.short_of": 0.001, "next_step.of_an_interval": 34, "next_step.soon": 53, "next_step.passage_steps": 0.0625,
    "next_step.first_part": 0.0078125, "next_step.inside": 0.4, "next_step.lifted": 10,
    "narrow_inputs.most_samples": 5000, "jumps.jumps": 99, "jumps.rate_interval": 0.0001,
    "solve.events.native.step_bound:STRETCHED": 99, "solve.events.narrow_inputs:NEAR_INPUT_END": 9, "solve.trajectory:SAME_TIME": 40,
    "solve.missing_rows:MOST_MISSING": 100,
}  # fmt: skip
"""The decisions of the default parameters."""
