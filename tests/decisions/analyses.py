"""Decisions on analyses: reruns, stages of runs, beams, functions as inputs, forces at the start."""

from __future__ import annotations

from contextlib import nullcontext
from unittest.mock import patch

import numpy as np

from stiffmbs.analyses import (
    balance_within_steps,
    beam_elements,
    check,
    conditions,
    given_inputs,
    job,
    long_runs,
    rerun,
    staged,
    start_forces,
)
from stiffmbs.equilibria import equilibrium
from stiffmbs.errors import SolverError
from tests.decisions.common import BELOW, Record, nothing, refused
from tests.solve.test_parameter_thresholds import DOUBLES, HALVES, count_while


def most_elements_of_a_beam():
    """Return the number of elements at which the search for a tolerance of 0 ends."""
    counts = []

    def beam(count):
        return Record(counts=(count,), tolerance=0.0, times=lambda factor: beam(factor))

    def scene(divided):
        return Record(beams=Record(divided=divided, by_tolerance=["b"]))

    with patch.multiple(
        beam_elements, redivided=lambda _, elements: scene(elements), compared=nothing, _of_position=lambda *_: np.inf
    ):
        assert refused(
            lambda: beam_elements.divided_by(
                scene({"b": beam(1)}), lambda data: counts.append(data.beams.divided["b"].counts[0]) or data
            )
        )
    return counts[-1]


def takes_long(spent, rest):
    """Tell whether a run is given up that took some seconds of processor time, and is predicted to take more of them."""
    clock = iter((0.0, spent))
    watch = long_runs.Predicted(1.0, nothing)
    with patch.object(long_runs.time, "process_time", lambda: next(clock)):
        watch(0.0)
        try:
            watch(spent / (spent + rest))
        except long_runs.TakesLongError:
            return True
    return False


def moves_of_a_message():
    start = Record(moved_far=(), position_sentence=str)
    return int(*check._assembly_sentence(start))


def points_of(given):
    """Return the number of calls of a function that is given as an input over 1 s."""
    times = []
    grid = Record(times=np.arange(2.0), start=0.0, end=1.0)
    with patch.object(given_inputs, "output_grid", lambda _: grid):
        given_inputs._followed("f", lambda t: times.append(t) or given(t), None)
    return len(times)


def jumps(given):
    return [*given_inputs._jumps("f", given, [(0.0, given(0.0)), (1.0, given(1.0))])]


def distance_of_a_jump():
    (before, _), (after, _) = jumps(lambda t: float(t > 0.3))
    return after - before


def least_singular_value():
    """Return the singular value of constraint equations, in quarter octaves, up to which bodies are moved by it."""
    body = Record(moved=lambda q, move: q + move, n_u=2)
    ones = np.ones(2, dtype=bool)
    system = Record(bodies=["a", "b"], of_body=body, active=ones, holonomic=ones, n_u=4, size=1.0)

    def moves(value):
        state = Record(
            q=np.zeros(4),
            evaluate=nothing,
            vector=lambda *_: np.ones(2),
            matrix=lambda *_: np.array([[1.0, 0.0, 0.0, 0.0], [0.0, value, 0.0, 0.0]]),
        )
        data = Record(bodies={"a": Record(), "b": Record(weighs=False)})
        with (
            patch.multiple(job, initial_values=lambda *_: Record(moved_far=())),
            patch.object(job, "CONSISTENCY", Record(most_moves=1, position_tolerance=0.0)),
        ):
            job.assembled(data, Record(system=system, state=state), 0.0)
        return state.q[1] != 0.0

    return count_while(moves, HALVES)


def runs_of(missed, found_again, has_functions):
    """Return the changed settings and the number of runs of 1 s that miss some events, the first and its reruns."""
    changes, computed, left = [], [], iter([missed, *found_again])

    def varied(settings):
        changes.append(settings)
        return job

    def compute(_):
        computed.append(len(computed))
        return Record(trajectory=Record(outcome=None, whole_steps=()))

    dynamics = Record(system=Record(has_functions=has_functions))
    job = Record(grid=Record(start=0.0, end=1.0), settings=None, dynamics=dynamics, varied=varied)
    with patch.multiple(
        rerun, _overlooked=lambda *_: next(left), _noted=lambda found, _: found, replace=lambda job, **_: job,
        traits_of=lambda _: Record(reads=("max_step",)),
    ):  # fmt: skip
        rerun.rerun_after_missed_events(job, compute)
    return changes, len(computed)


def steps_over_a_feature(shortest):
    """Return the longest steps of the reruns of a run of 1 s in which a Python function has a feature of some duration."""
    changes, _ = runs_of(Record(shortest=shortest, note=nothing), [None], True)
    return [each["max_step"] for each in changes]


def reruns(times):
    """Return the number of runs if each of them missed events."""
    missed = Record(times=np.arange(float(times)), note=nothing)
    return runs_of(missed, [missed] * 10, False)[1]


def with_exact_constraints(*drifts):
    """Return the number of runs and the number of the returned one, for mean drifts in tolerances."""
    computed, means = [], iter(drifts)

    def compute(_):
        computed.append(Record(rows=Record(t=np.zeros(2)), trajectory=Record(outcome=None), number=len(computed)))
        return computed[-1]

    with patch.multiple(
        rerun, _compared=lambda *_: (), relaxed=lambda _: True, drifts=lambda *_: True, exactly=lambda _: None,
        _drift=lambda *_: Record(mean=next(means), at_end=0.0, note=nothing), _noted=lambda found, _: found,
    ):  # fmt: skip
        found = rerun.on_exact_constraints(None, compute)
    return len(computed), found.number


def runs_to_a_condition(crosses):
    """Return the points of the runs that find a condition, which is met in the first interval or never."""
    points = []

    def run(*monitor, **changes):
        points.append(changes.get("points"))
        return Record(time=np.arange(2.0), state=nothing_of, success=False)

    def nothing_of(at):
        return at

    crossing = Record(t=0.5, before=0, name="c") if crosses else None
    with patch.multiple(staged, first_crossing=lambda *_: crossing, margin_of=lambda *_: lambda _: [-1.0]):
        staged._up_to_the_first(staged.Runs(run, run), {"c": Record(then="on")}, 1.0, None, True)
    return points


def most_conditions():
    met = []
    part = Record(time=np.zeros(1), state=lambda: None)
    with patch.multiple(
        staged, _up_to_the_first=lambda *_, **__: met.append(1) or (part, "c", 1.0), replace=lambda *_, **__: None
    ):
        condition = Record(then="on", sets={}, output=None)
        assert refused(lambda: staged.run_until(None, {"c": condition}, 1.0, None, None))
    return len(met)


def smallest_distance_from_a_bound():
    """Return the distance, in quarter octaves, up to which a condition counts again."""
    condition = Record(request="r", at_least=0.0, at_most=None, equals=None, within=0.0)

    def is_armed(distance):
        whole = Record(time=np.arange(2.0))
        with patch.object(conditions, "channel_of", lambda *_: np.array([1.0, -distance])):
            return np.isfinite(conditions.margin_of("c", condition, whole, False).armed)

    return count_while(is_armed, BELOW)


def rows_before_a_look(apart):
    """Return the number of rows, at a distance from each other in a run of 1 s, at which a monitor looks first."""
    start = Record(q=np.zeros(1), u=np.zeros(1), lam=np.zeros(0))
    monitored = Record(dynamics=Record(system=None), start=start, grid=Record(start=0.0, end=1.0))
    looked = []
    with (
        patch.object(conditions, "Dynamics", lambda _: Record(place=nothing)),
        patch.object(conditions.Monitor, "_is_met", lambda _: looked.append(1)),
    ):
        monitor, row = conditions.Monitor({}, True, monitored), np.zeros((1, 1))
        return 1 + count_while(lambda k: monitor.look(np.array([k * apart]), row, row) or not looked, range(1, 1000))


def force_at_start(kind, energy=0.0, **equilibrium):
    """Return the force of an element, in quarter octaves of the weight, up to which it has no note."""
    mass = np.array([1.0 / start_forces.STANDARD_GRAVITY, 0.0, 0.0])
    system = Record(mass=mass, of_body=Record(n_u=3, linear=2), size=1.0, groups=[None])
    start = Record(u=np.zeros(3), moved=(), q=np.zeros(1))
    dynamics = Record(system=system, state=Record(unchanged=nullcontext))
    rows = Record(t=np.zeros(1), values=np.zeros((1, 1)))

    def is_silent(force):
        elements = [start_forces.Stretched("e", kind, True, force)]
        changes = {
            "_in_equilibrium": lambda *_: equilibrium.get("settled", []), "_is_elastic": lambda _: True,
            "stretched": lambda *_: elements, "_energy": lambda *_: energy * force**2, "_at_rest": lambda *_: force,
        }  # fmt: skip
        with patch.multiple(start_forces, **changes):
            return not [*start_forces.start_force_notes(None, dynamics, start, 0.0, rows)]

    return count_while(is_silent, DOUBLES)


def softest_mount():
    """Return the deflection of a mount by the weight, in quarter octaves of 1e-5 m, from which on it is a spring."""
    at_rest = [start_forces.Stretched("e", "bushing", True, 1e-3)]
    return count_while(lambda soft: force_at_start("bushing", 0.5e-5 * soft, settled=at_rest) < 10, DOUBLES)


def moves_to_an_equilibrium():
    """Return the number of moves after which the search for the equilibrium ends."""
    asked = []

    def search(dynamics, t, most):
        asked.append(most)
        raise SolverError("not found")

    dynamics = Record(state=Record(q=np.zeros(1)))
    with patch.object(equilibrium, "find_equilibrium", search):
        assert start_forces._in_equilibrium(dynamics, Record(q=np.zeros(1)), 0.0) == []
    return asked[0]


def within_steps(record):
    """Record the nodes of the quadratures of a balance that stays broken, or the steps that it examines."""
    rows = Record(t=np.array([0.0, 1.0]), values=np.zeros((1, 1)))
    system = Record(n_q=999, n_u=0, keeps_energy=False, sampling=np.empty((0, 2)), sampled=np.empty(0, dtype=bool))
    job = Record(dynamics=Record(system=system), settings=None, grid=Record(aside=0.0), of_one_solver=lambda _: job)
    trajectory = Record(step_times=np.linspace(0.0, 1.0, 10_001))
    if record == "steps":
        return len(balance_within_steps._steps(job, trajectory, rows, 5))
    found = []
    changes = {
        "_steps": lambda *_: np.array([[0.0, 1.0]]), "_at_nodes": lambda *asked: found.append(asked[2]) or rows,
        "balance_of_steps": lambda *_: None, "is_broken": lambda *_: True, "_weights_and_jumps": lambda *_: (None, None),
    }  # fmt: skip
    with patch.multiple(balance_within_steps, **changes):
        balance_within_steps.balance_within_steps(job, trajectory, rows)
    return found[0] ** 2 + 10 * found[1]


DECISIONS = {
    "analyses.start_forces:OF_WEIGHT": lambda: force_at_start("spring_damper"),
    "analyses.start_forces:OF_EQUILIBRIUM": lambda: force_at_start(
        "bushing", settled=[start_forces.Stretched("e", "bushing", True, 3.0)]
    ),
    "analyses.start_forces:STIFF": softest_mount,
    "analyses.start_forces:MOST_MOVES": moves_to_an_equilibrium,
    "analyses.balance_within_steps:NODES": lambda: within_steps("nodes"),
    "analyses.balance_within_steps:MOST_NUMBERS": lambda: within_steps("steps"),
    "analyses.beam_elements:MOST": most_elements_of_a_beam,
    "analyses.check:MOST_MOVES": moves_of_a_message,
    "analyses.given_inputs:FEWEST": lambda: points_of(lambda _: 1.0),
    "analyses.given_inputs:MOST": lambda: points_of(lambda t: float(t > 0.3)),
    "analyses.given_inputs:FOLLOWED": lambda: count_while(
        lambda size: not jumps(lambda t: 1.0 + 1e-13 * size * (t > 0.3)), DOUBLES
    ),
    "analyses.given_inputs:JUMP": lambda: count_while(
        lambda size: jumps(lambda t: (1.0 - size) * t + size * (t > 0.3)), BELOW
    ),
    "analyses.given_inputs:ROUNDINGS": distance_of_a_jump,
    "analyses.job:DEPENDENT": least_singular_value,
    "analyses.long_runs:Drafted.patience": lambda: count_while(lambda rest: not takes_long(5.0, rest), DOUBLES[:40]),
    "analyses.long_runs:Drafted.least": lambda: count_while(lambda spent: not takes_long(1e-3 * spent, 1e9), DOUBLES[:60]),
    "analyses.rerun:ROUNDS": lambda: reruns(1),
    "analyses.rerun:PART_OF_A_FEATURE": lambda: steps_over_a_feature(0.125)[0],
    "analyses.rerun:MOST_STEPS": lambda: count_while(lambda k: steps_over_a_feature(1e-2 / k), DOUBLES[:60]),
    "analyses.rerun:STARTS": lambda: count_while(lambda n: reruns(100 * n) > 1, DOUBLES[:40]),
    "analyses.rerun:DRIFTED": lambda: count_while(lambda drift: with_exact_constraints(drift, 0.0)[0] == 1, DOUBLES[:40]),
    "analyses.rerun:LESS": lambda: count_while(
        lambda left: with_exact_constraints(1e9, 1e9 * left)[1] == 0, BELOW
    ),
    "analyses.staged:POINTS": lambda: runs_to_a_condition(True)[2],
    "analyses.staged:LEVELS": lambda: len(runs_to_a_condition(True)) - 3,
    "analyses.staged:LEAST": lambda: runs_to_a_condition(False)[1],
    "analyses.staged:MOST": most_conditions,
    "analyses.conditions:SAME": smallest_distance_from_a_bound,
    "analyses.conditions:LOOKS": lambda: rows_before_a_look(1 / 640),
    "analyses.conditions:ROWS": lambda: rows_before_a_look(1e-6),
}  # fmt: skip
EXPECTED = {
    "analyses.start_forces:OF_WEIGHT": 40, "analyses.start_forces:OF_EQUILIBRIUM": 20, "analyses.start_forces:STIFF": 27,
    "analyses.start_forces:MOST_MOVES": 100,
    "analyses.balance_within_steps:NODES": 115, "analyses.balance_within_steps:MOST_NUMBERS": 200,
    "analyses.beam_elements:MOST": 512, "analyses.check:MOST_MOVES": 50, "analyses.given_inputs:FEWEST": 513,
    "analyses.given_inputs:MOST": 65579, "analyses.given_inputs:FOLLOWED": 27, "analyses.given_inputs:JUMP": 4,
    "analyses.given_inputs:ROUNDINGS": 9.094947017729282e-13, "analyses.job:DEPENDENT": 120, "analyses.long_runs:Drafted.patience": 14, "analyses.long_runs:Drafted.least": 40, "analyses.rerun:ROUNDS": 4,
    "analyses.rerun:PART_OF_A_FEATURE": 0.0625, "analyses.rerun:MOST_STEPS": 40, "analyses.rerun:STARTS": 14,
    "analyses.rerun:DRIFTED": 14, "analyses.rerun:LESS": 4, "analyses.staged:POINTS": 33, "analyses.staged:LEVELS": 3,
    "analyses.staged:LEAST": 1001, "analyses.staged:MOST": 500, "analyses.conditions:SAME": 119,
    "analyses.conditions:LOOKS": 10, "analyses.conditions:ROWS": 99,
}  # fmt: skip
