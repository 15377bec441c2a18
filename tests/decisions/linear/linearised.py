"""Decisions on searches for equilibria and steady motion, and on linear analyses of runs."""

from __future__ import annotations

from contextlib import nullcontext
from unittest.mock import patch

import numpy as np

from stiffmbs.analyses import far_away, settled, steady
from stiffmbs.analyses.linearised import campbell, kink, modes, transfer
from stiffmbs.errors import SolverError
from stiffmbs.show import campbell as campbell_shown
from tests.decisions.common import BELOW, Reached, Record, nothing, reach, reached, refused
from tests.solve.test_parameter_thresholds import DOUBLES, count_while


def farthest_equilibrium(notes):
    """Return the distance, in quarter octaves of 0.01 of a mechanism's size, that is not noted."""
    system = Record(of_body=Record(n_q=3, linear=2), bodies=["a"], size=1.0)

    def is_silent(distance):
        found, start = (Record(q=np.array([x, 0.0, 0.0])) for x in (distance, 0.0))
        return not [*notes(Record(system=system), start, found)]

    return count_while(lambda distance: is_silent(0.01 * distance), DOUBLES)


def largest_acceleration_at_rest():
    """Return the acceleration, in quarter octaves of 1e-8 m/s^2, of a state that counts as an equilibrium."""
    body = Record(accelerations=())
    system = Record(
        per_velocity=lambda *_: np.ones(1), of_body=body, size=1.0, name_of=lambda *_: "a.ax", has_coupled_inertia=True
    )
    state = Record(n_poses=1, degrees_of_freedom=1)
    given = {"dynamics": Record(system=system, state=Record(u=None)), "data": Record(gravity=np.zeros(2)), "t": 0.0}

    def is_silent(acceleration):
        found = Record(acceleration=np.array([acceleration]), redundancy=Record(degrees_of_freedom=1), **given)
        with patch.multiple(modes, derivative_notes=lambda *_: (), held=lambda _: (), rotation_as_one=lambda *_: None):
            return not [*modes._notes(found, state)]

    return count_while(lambda acceleration: is_silent(1e-8 * acceleration), DOUBLES)


def rate_of_a_shown_mode():
    """Return the largest velocity of a shown mode that does not oscillate, of amplitude 1."""
    system = Record(size=1.0, of_body=Record(moved=lambda q, move: q + move))
    state = Record(q=np.zeros(1), u=np.zeros(1), unchanged=nullcontext)
    dynamics = Record(system=system, state=state, report=lambda _t, _q, u, project: reach(np.max(np.abs(u))))
    mode = Record(motion=None, shape=np.ones(1))
    return reached(lambda: modes.mode_shape(Record(dynamics=dynamics, t=0.0), np.eye(1), mode, 1, 1.0, 5))


def moved_by(number):
    """Return the size of a move, of 4, that searches a breakpoint."""
    with linearised(lambda *args: found.append(args[-1]) or (reach(found) if len(found) == 4 else None)) as call:
        found = []
        return abs(reached(call)[number][0])


class linearised:
    """Context of the search for a breakpoint of one force, in which `side` returns the equations after a move."""

    def __init__(self, side):
        self._patch = patch.multiple(kink, _side=side, _generic_move=lambda *_: np.ones(1))

    def __enter__(self):
        self._patch.start()
        system = Record(
            names_of=lambda *_: ["a.vx"], n_u=1, of_body=Record(velocities=()), states=[], without_rate=np.zeros(0, dtype=bool)
        )  # fmt: skip
        found = Record(dynamics=Record(system=system), t=0.0)
        return lambda: kink._breakpoint(found, Record(), Record(), np.ones(1), kink.MOVES)

    def __exit__(self, *_):
        self._patch.stop()


def largest_jump(parts, force):
    """Return the jump of a force, in quarter octaves of 1e-9, that is not refused."""

    def accepts(jump):
        def side(*args):
            move = args[-1][0]
            return Record(
                forces=np.array([force + jump * (move > 0)]), parts=np.array([[parts]]), matrix=np.zeros((1, 1))
            )

        with (
            patch.multiple(kink, _moving=lambda *_: ["a.vx"], _largest=lambda *_: reach(0.0)),
            linearised(side) as call,
        ):
            try:
                return reached(call) == 0.0
            except SolverError:
                return False

    return count_while(lambda jump: accepts(1e-9 * jump), DOUBLES)


def largest_curvature():
    wide = kink.MOVES.narrow / kink.MOVES.wide
    return count_while(
        lambda x: not kink.MOVES.break_between(np.ones(1), np.array([wide * (1.0 + 0.01 * x)]))[0], DOUBLES
    )


def largest_rate_of_an_input():
    """Return the change of a prescribed velocity per unit of an input, in quarter octaves of 1e-8, that is accepted."""
    system = Record(size=1.0, states=[])

    def accepts(rate):
        about = Record(found=Record(dynamics=Record(system=system)))
        step = transfer.STEP
        with patch.multiple(
            transfer,
            _with_value=lambda _about, _name, _given, value, _changes: value,
            _acting=lambda _, value: (np.zeros(1), np.zeros(1), np.array([value / step * rate * step]), np.zeros(1)),
        ):
            try:
                transfer._column(about, "f", object(), (), {})
            except AttributeError:  # of the next quantity
                return True
            except transfer.InputError:
                return False

    return count_while(lambda rate: accepts(1e-8 * rate), DOUBLES)


def most_velocities_with_eigenvalues():
    def is_assessed(n):
        system = Record(states=[1], n_u=n)
        growth = settled._growth(Record(system=system, accelerate=lambda _: reach(n)), 0.0)
        try:
            return not [*growth]
        except Reached:
            return True

    return count_while(is_assessed, (100 * DOUBLES[:40]).astype(int))


def move_to_a_branch():
    state = Record(q=np.zeros(1))
    system = Record(of_body=Record(moved=lambda q, move: q + move))
    dynamics = Record(state=state, system=system, assemble=nothing)
    state.q = np.zeros(1)
    with patch.object(settled, "find_equilibrium", lambda *_, **__: state.q[0]):
        return settled._branch(dynamics, Record(q=np.zeros(1)), np.ones(1), 0.0)


def branches():
    """Return the number of unstable equilibria from which a stable one is sought."""
    pose = Record(q=np.zeros(1), imbalance=0.0)
    dynamics = Record(system=Record(states=[]), state=Record(q=np.zeros(1)))
    with patch.multiple(
        settled, find_equilibrium=lambda *_: pose, _directions=lambda *_: (np.ones(1), []), _branch=lambda *_: pose,
        _branch_note=lambda *_: "", _family=lambda _: (), _settled=lambda _dynamics, _found, _start, notes, *_: len(notes) - 1,
    ):  # fmt: skip
        return settled.settled(dynamics, Record(q=np.zeros(1)), 0.0)


def smallest_angle_of_motions():
    return count_while(
        lambda angle: len([*settled._independent(np.array([[1.0, np.cos(angle)], [0.0, np.sin(angle)]]))]) == 2, BELOW
    )


def smallest_growth(of_largest):
    """Return the real part of an eigenvalue, in quarter octaves, up to which its motion grows."""

    def grows(real):
        values = np.array([real, 1.0j]) if of_largest else np.array([real + 1.0j])
        state = Record(matrix=None, n_poses=0, n_states=0)
        instant = Record(dynamics=Record(system=Record(per_velocity=nothing, size=1.0)))
        with patch.multiple(
            settled, eigen=lambda *_: (values, None, None), linearised_at=lambda *_: (None, state, None)
        ):
            return len(settled._growing(instant, settled.MOVES)[0]) > 0

    return count_while(grows, BELOW)


def values_over_a_parameter():
    with patch.object(campbell, "numbers_of", lambda _, per_decade, evenly: reach(evenly)):
        return reached(lambda: campbell.campbell("scene", "a", "1:2"))


def precision_of_a_crossing():
    own, found = Record(_at=nothing, parameter="a"), Record(modes=(None,))
    ends = {0.0: (found, 0), 1.0: (found, 0)}
    with patch.object(campbell, "brentq", lambda *_, xtol: reach(xtol)):
        return reached(lambda: campbell.Campbell._crossing(own, 1, ends, lambda value, _: 0.5 - value))


def size_of_a_diagram():
    with patch.object(campbell_shown, "new_sheet", lambda size: reach(sum(size))):
        return reached(lambda: campbell_shown.campbell_figure(None))


def in_steady_motion(imbalance=0.0):
    """Return the time at which forces of a steady motion of rate 1 are checked, and True if they balance."""
    times = []
    body = Record(moved=lambda q, _: q, reactions=())
    system = Record(per_velocity=lambda *_: np.ones(1), size=1.0, of_body=body, n_u=1, name_of=lambda *_: "a")
    state = Record(q=np.zeros(1), unchanged=nullcontext)
    dynamics = Record(state=state, system=system, assemble=times.append)
    motion = Record(carried=lambda _: np.ones(1))
    with patch.object(
        steady, "balance_at", lambda *_: Record(left=np.array([imbalance]), allowed=np.zeros(1), largest=1.0)
    ):
        balances = not refused(lambda: steady._refuse_unsteady(dynamics, 0.0, motion))
    return times[0], balances


DECISIONS = {
    "analyses.linearised.campbell:COUNT": values_over_a_parameter,
    "analyses.linearised.campbell:FINE": precision_of_a_crossing,
    "show.campbell:SIZE": size_of_a_diagram,
    "show.campbell:PLANE": lambda: count_while(lambda part: campbell_shown.direction(0.01 * part) == "", DOUBLES),
    "show.campbell:BEYOND": lambda: campbell_shown._highest(None, 1.0),
    "analyses.far_away:FAR": lambda: farthest_equilibrium(far_away.far_away),
    "analyses.far_away:BEYOND": lambda: farthest_equilibrium(far_away.beyond_its_size),
    "analyses.linearised.modes:AT_REST": largest_acceleration_at_rest,
    "analyses.linearised.modes:UNHURRIED": rate_of_a_shown_mode,
    "analyses.linearised.kink:Moves.wide": lambda: moved_by(0),
    "analyses.linearised.kink:Moves.narrow": lambda: moved_by(2),
    "analyses.linearised.kink:Moves.steep": lambda: largest_jump(1.0, 0.0),
    "analyses.linearised.kink:Moves.rounding": lambda: largest_jump(0.0, 1.0),
    "analyses.linearised.kink:Moves.curved": largest_curvature,
    "analyses.linearised.transfer:NO_RATE": largest_rate_of_an_input,
    "analyses.settled:MOST_FOR_EIGENVALUES": most_velocities_with_eigenvalues,
    "analyses.settled:BRANCH": move_to_a_branch,
    "analyses.settled:MOST_BRANCHES": branches,
    "analyses.settled:SAME_MOTION": smallest_angle_of_motions,
    "analyses.settled:LARGE_PART": lambda: count_while(
        lambda part: [*settled._independent(np.array([[part], [1.0]]))] == [0], BELOW
    ),
    "analyses.settled:GROWING": lambda: smallest_growth(False),
    "analyses.settled:ROUNDED": lambda: smallest_growth(True),
    "analyses.steady:MOTION_AHEAD": lambda: in_steady_motion()[0],
    "analyses.steady:STEADY_IMBALANCE": lambda: count_while(lambda left: in_steady_motion(1e-8 * left)[1], DOUBLES),
    "analyses.steady:VELOCITY_ERROR": lambda: count_while(lambda x: steady._rounded([x], 1.0) != [0.0], BELOW),
}  # fmt: skip
EXPECTED = {
    "analyses.linearised.campbell:COUNT": 51, "analyses.linearised.campbell:FINE": 1e-4, "show.campbell:SIZE": 16, "show.campbell:PLANE": 14,
    "show.campbell:BEYOND": 1.2,
    "analyses.far_away:FAR": 18, "analyses.far_away:BEYOND": 31, "analyses.linearised.modes:AT_REST": 27,
    "analyses.linearised.modes:UNHURRIED": 6.283185307179586, "analyses.linearised.kink:Moves.wide": 1e-06,
    "analyses.linearised.kink:Moves.narrow": 1e-07, "analyses.linearised.kink:Moves.steep": 44,
    "analyses.linearised.kink:Moves.rounding": 40, "analyses.linearised.kink:Moves.curved": 23,
    "analyses.linearised.transfer:NO_RATE": 27, "analyses.settled:MOST_FOR_EIGENVALUES": 16, "analyses.settled:BRANCH": 0.001,
    "analyses.settled:MOST_BRANCHES": 3, "analyses.settled:SAME_MOTION": 102, "analyses.settled:LARGE_PART": 4,
    "analyses.settled:GROWING": 80, "analyses.settled:ROUNDED": 133, "analyses.steady:MOTION_AHEAD": 0.001,
    "analyses.steady:STEADY_IMBALANCE": 27, "analyses.steady:VELOCITY_ERROR": 106,
}  # fmt: skip
