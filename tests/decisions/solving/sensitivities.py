"""Decisions of recorded runs, of jumps of sensitivities, and of events that sensitivities refuse."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np

from stiffmbs.errors import SolverError
from stiffmbs.sensitivity_equations import along_run, jumps
from stiffmbs.sensitivity_equations.along_run import Touches
from stiffmbs.sensitivity_equations.jumps import Jumps, Shifted, State
from stiffmbs.sensitivity_equations.native import stages
from stiffmbs.sensitivity_equations.recorded import Recorder
from tests.decisions.common import Reached, Record, nothing
from tests.interpreted import interpreted
from tests.solve.test_parameter_thresholds import DOUBLES, HALVES, count_while


def raised(call, kind=Reached):
    try:
        call()
    except kind:
        return True
    return False


def reached(*_):
    raise Reached


def ended(duration=1.0, fired=()):
    """Return how far the end of a segment at t = 1 s is moved back, and how often the sides of events are evaluated."""
    evaluated = []
    rows = np.array([[1.0, 0.0, 0.0, -1.0]])
    dynamics = Record(system=Record(n_values=lambda _: len(fired)))
    recorder = Record(equations=Record(n=1), dynamics=dynamics, _sides=lambda *_: evaluated.append(1) or len(evaluated))
    Recorder._end_before_the_jump(recorder, Record(rows=rows, fired=fired, first=[1.0 - duration]))
    return rows[0, 2], len(evaluated)


def suspicious(short=1e-3, slope=0.0, change=1.0, size=0.0, coordinate=0):
    """Return whether a short step among steps of 1 s is examined for a discontinuity.

    `slope`: rate of the accelerations around it. `change`: that of one coordinate in the step. `size`: largest
    acceleration of the first coordinate.
    """
    h = np.ones(40)
    h[20] = short
    rows = np.zeros((41, 6))
    rows[:, 0] = np.append(0.0, np.cumsum(h))
    rows[:, 4] = size
    accelerations = np.outer(slope * rows[:, 0], [1.0, 0.0])
    accelerations[21:, coordinate] += change - slope * short * (coordinate == 0)
    recorder = Record(
        equations=Record(n=2, at={"u": np.arange(2)}), _jumps_between=reached,
        dynamics=Record(system=Record(size=1.0, per_velocity=lambda *_: np.ones(2))),
        _all_accelerations=lambda some: accelerations[np.isin(rows[:, 0], some[:, 0])],
    )  # fmt: skip
    return raised(lambda: Recorder._refuse_jumps_within(recorder, Record(rows=rows)))


def discontinuity(part=1.0, noise=0.0):
    """Return whether an acceleration that jumps by a part of its change of 1 is discontinuous, and how often it is computed."""
    computed = []

    def acceleration(t, y):
        computed.append(y[0])
        return np.array([part * (y[0] > 0.3) + (1.0 - part) * y[0] + noise * (y[0] > 1.0)])

    recorder = Record(equations=Record(n=1), _accelerations=acceleration)
    rows = np.zeros(4), np.array([1.0, 0.0, 1.0, 0.0])
    return Recorder._jumps_between(recorder, *rows, np.zeros(1)), len(computed)


def kept(numbers):
    """Return whether one more step is recorded after a number of numbers."""
    engine = Record(ida=Record(kept_steps=lambda: np.ones((1, 4))))
    segment = Record(parts=[], first=np.zeros(4))
    recorder = Record(engine=engine, segments=[segment], nodes=[], _numbers=int(numbers))
    return not raised(lambda: Recorder._keep(recorder, Record(fired=())), SolverError)


def position_sensitivities():
    """Return the ratio of position sensitivities, in steps of 5 % from 1 on, up to which those at a moving time are used."""

    def is_moving(rate):
        left = State(0.0, np.zeros(1), np.zeros(1), np.array([rate]), np.zeros(1), np.zeros(0))
        own = Record(
            _end=lambda _: left, _start=lambda *_: left, _instants=lambda *_: np.ones(1),
            _dynamics=Record(system=Record(n_c=0)),
        )  # fmt: skip
        before, after = Record(fired=(0,)), Record(first=[0.0])
        found = Jumps.over(own, before, after, Shifted(np.ones((1, 1)), np.zeros((1, 1)), np.zeros(1)))
        return found.s.shift[0] != 0.0

    return count_while(is_moving, 0.05 * np.arange(100))


def crosses(rate):
    """Return whether an event function of 1 with a rate crosses its breakpoint."""
    state = Record(
        q=np.zeros(1), u=np.zeros(1), lam=np.zeros(1), evaluate=nothing, values={"event_function": -np.ones(1)}
    )
    own = Record(
        _event=lambda *_: (np.ones((1, 1)), np.array([rate]), np.ones(1)), _dynamics=Record(state=state, system=None)
    )
    side = Record(q=np.zeros(1), u=np.zeros(1), lam=np.zeros(1), t=0.0)
    with patch.object(jumps, "writer", lambda *_: "e"):
        return bool(Jumps._moves_of_events(own, Record(fired=()), side, side, None, None, False))


def examined(values, rates=(1.0, -1.0)):
    """Return whether an event function with two values and rates is examined, and the functions that rest on zero."""
    found = list(zip(values, rates, strict=True))
    own = Record(
        _count=1, _values=lambda row: tuple(np.array([each]) for each in found[int(row[0])]), _touched=reached,
        _turns=lambda *_: True, _between=nothing,
    )  # fmt: skip
    segment = Record(first=np.zeros(1), rows=np.ones((1, 1)))
    resting = []
    is_examined = raised(lambda: resting.extend(Touches.refuse(own, [segment])))
    return is_examined, [*resting[0]] if resting else []


def touched(near=1.0):
    """Return whether rates that differ at a small and at a large displacement are discontinuous, and these displacements."""
    sizes = []

    def change(t, y, dy, to_zero, size):
        sizes.append(size)
        return np.array([near if len(sizes) == 1 else 1.0])

    own = Record(
        _recorder=Record(settings=Record(rtol=1e-6)), _atol=np.ones(1), _slope=lambda *_: np.ones(1), _value=nothing,
        _change=change,
    )  # fmt: skip
    return Touches._touched(own, 0.0, np.zeros(1), 0, 1), sizes


def rests(bend=(0.0, 0.0), off=(0.0, 0.0)):
    """Return whether an event function that rests on its breakpoint is refused, and the displacement that is tried.

    `bend`, `off`: second difference of rates, and error of derivatives, over the whole displacement and over half of it.
    """
    sizes = []

    def of(values):
        def found(t, y, dy, numbers, size):
            sizes.append(size)
            return np.array([values[0] if size == max(sizes) else values[1]])

        return found

    own = Record(
        _recorder=Record(equations=Record(n=1)), _directions=[None], _dynamics=Record(system=None), _bend=of(bend),
        _off_differences=of(off),
    )  # fmt: skip
    segment = Record(first=np.zeros(1), rows=np.zeros((1, 4)))
    with patch.object(along_run, "writer", lambda *_: "e"):
        refused = raised(lambda: Touches.refuse_rest(own, np.array([0]), segment, np.ones((1, 1))), SolverError)
    return refused, max(sizes)


def error_of_derivatives(derivative):
    """Return the error of a derivative of a force of 1 N beyond rounding, if differences vanish."""
    direction = Record(
        q=np.zeros(1), u=np.zeros(1), lam=np.zeros(1), evaluate=nothing, vector=lambda _: np.array([derivative]),
        values=np.zeros(1),
    )  # fmt: skip
    own = Record(
        _recorder=Record(take=nothing),
        _dynamics=Record(
            state=Record(values={"motion": np.ones(1)}), system=Record(term=lambda *_: Record(source=np.array([0])))
        ),
        _with_numbers=lambda *_: np.zeros(2), _forces=None,
    )  # fmt: skip
    with patch.object(along_run, "Direction", lambda *_: direction):
        return Touches._off_differences(own, 0.0, np.zeros(1), np.zeros(1), None, 1.0)[0]


def corrections(ratio, renewed):
    """Return the number of corrections, each a part of the last one, after which factors are given up."""
    made = []
    table = Record(n=1, stages=1, correction=np.zeros(1))
    replaced = {
        "_take_residual": nothing, "_corrected_apart": lambda _: made.append(ratio ** len(made)),
        "_largest": lambda _c, _values, _stages: made[-1],
    }  # fmt: skip
    with interpreted(stages, **replaced):
        assert not stages._iterated(table, 1.0, None, None, np.zeros(1), 0.0, renewed)
    return len(made)


DECISIONS = {
    "variational_stages.most_corrections": lambda: corrections(0.9, True),
    "variational_stages.fast": lambda: count_while(lambda ratio: corrections(ratio, False) == 3, HALVES),
    "sensitivities.rounding": lambda: ended()[0],
    "sensitivities.furthest": lambda: count_while(lambda duration: ended(duration, (0,))[1] > 1, HALVES),
    "sensitivities.short": lambda: count_while(lambda short: not suspicious(short=short), HALVES),
    "sensitivities.sudden": lambda: count_while(
        lambda change: not suspicious(slope=1.0, change=1e-3 * change), DOUBLES
    ),
    "sensitivities.jump": lambda: count_while(lambda change: not suspicious(change=1e-6 * change, size=1.0), DOUBLES),
    "sensitivities.felt": lambda: count_while(
        lambda change: not suspicious(change=1e-9 * change, size=1.0, coordinate=1), DOUBLES
    ),
    "sensitivities.halvings": lambda: discontinuity()[1],
    "sensitivities.left": lambda: count_while(lambda part: discontinuity(part)[0], HALVES),
    "sensitivities.roundings": lambda: count_while(lambda noise: not discontinuity(noise=noise)[0], HALVES),
    "sensitivities.most_numbers": lambda: count_while(kept, DOUBLES),
    "sensitivities.no_jump": lambda: count_while(
        lambda jump: not Jumps(None, None, None, None, None, 1e-6)._counts(np.array([1e-6 * jump]), np.ones(1)), DOUBLES
    ),
    "sensitivities.much_larger": position_sensitivities,
    "sensitivities.alike": lambda: count_while(lambda off: not jumps._same(np.ones(1), np.array([1.0 - off])), HALVES),
    "sensitivities.grazing": lambda: count_while(crosses, HALVES),
    "sensitivities.near": lambda: count_while(lambda least: not examined((1.0, least))[0], HALVES),
    "sensitivities.further": lambda: touched()[1][1] / touched()[1][0],
    "sensitivities.linear": lambda: count_while(lambda near: touched(near)[0], HALVES),
    "sensitivities.at_rest": lambda: count_while(lambda value: not examined((value, value), (1.0, 1.0))[1], HALVES),
    "sensitivities.moved": lambda: rests()[1],
    "sensitivities.kinked": lambda: count_while(lambda half: rests((1.0, half))[0], HALVES),
    "sensitivities.noticed": lambda: count_while(lambda bend: rests((bend, bend))[0], HALVES),
    "sensitivities.steady": lambda: count_while(lambda half: rests(off=(1e3, 1e3 * half))[0], HALVES),
    "sensitivities.rounded": lambda: count_while(
        lambda derivative: error_of_derivatives(1e-16 * derivative) == 0.0, DOUBLES
    ),
}
EXPECTED = {
    "variational_stages.most_corrections": 80, "variational_stages.fast": 6,
    "sensitivities.rounding": 1e-13, "sensitivities.furthest": 94, "sensitivities.short": 14,
    "sensitivities.sudden": 14, "sensitivities.jump": 40, "sensitivities.felt": 40, "sensitivities.halvings": 13,
    "sensitivities.left": 5, "sensitivities.roundings": 40, "sensitivities.most_numbers": 111,
    "sensitivities.no_jump": 27, "sensitivities.much_larger": 21, "sensitivities.alike": 80,
    "sensitivities.grazing": 120, "sensitivities.near": 40, "sensitivities.further": 1000, "sensitivities.linear": 14,
    "sensitivities.at_rest": 160, "sensitivities.moved": 1e-06, "sensitivities.kinked": 6,
    "sensitivities.noticed": 160, "sensitivities.steady": 2, "sensitivities.rounded": 27,
}  # fmt: skip
