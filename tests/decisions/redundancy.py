"""Decisions on rank, assembled poses, and the choice of redundant equations."""

from __future__ import annotations

from contextlib import suppress
from itertools import islice
from unittest.mock import patch

import numpy as np

from stiffmbs.redundancy import (
    drop_first,
    idle_freedoms,
    inconsistent_constraints,
    loop_rank,
    opposed_actuators,
    replacements,
    uniqueness,
)
from stiffmbs.redundancy.loop_equations import LoopEquations
from stiffmbs.redundancy.messages.redundancy import pose_notes
from stiffmbs.redundancy.overconstraint import listed
from tests.decisions.common import Reached, Record, always, nothing
from tests.solve.test_parameter_thresholds import DOUBLES, HALVES, count_while


def agreeing(gap):
    """Return whether no sentence is on redundant equations that agree to a gap only."""
    rank = Record(equations=Record(loop=Record(joints=[Record(name="j")])), start=Record(gap=gap))
    result = Record(rank=rank, redundant=[1], nearly_dependent=False, motion_unique=True)
    return not [*pose_notes(Record(rank_results=[result]))]


def assembled(violation=1.0, slope=1.0, step=1e-3):
    """Return the displacements and dampings of an assembly whose violation does not change."""
    moves, dampings = [], []

    def solved_gram(damping, C):
        dampings.append(damping)
        return C

    def transposed_times(vector):
        return np.array([slope * abs(vector[0]) if not len(dampings) > len(moves) else step])

    C_q = Record(finite=True, transposed_times=transposed_times, solved_gram=solved_gram)
    pose = Record(q=np.zeros(1), C=np.array([violation]), C_q=C_q)

    def moved(q, move):
        moves.append(abs(move[0]))
        return q

    equations = Record(
        loop=Record(rows=[0]), pose=lambda *_: pose, moved=moved, state=Record(restart_counters=nothing)
    )  # fmt: skip
    LoopEquations.assembled(equations, np.zeros(1), 0.0)
    return moves, dampings


def rank_at(value, gap):
    """Return the rank of one equation whose singular value is given."""
    J = Record(singular_values_above=lambda _: False, shape=(1, 1), scaled=lambda *_: None)
    start = Record(C=np.zeros(1), J=J, gap=gap)
    equations = Record(assembled=lambda *_: start, row_scale=np.ones(1), scale_rows=nothing)
    with patch.multiple(
        loop_rank, _perturbed=lambda *_: [], small_singular=lambda _: (np.array([value]), np.ones((1, 1)))
    ):
        return loop_rank.loop_rank(equations, np.zeros(1), 0.0).rank


def perturbed(gap):
    """Return the largest displacement of each perturbed pose, of which all have a gap, and the number of those found."""
    moves = []

    def moved(q, move):
        moves.append(np.abs(move).max())
        return q

    equations = Record(
        loop=Record(columns=np.arange(100)), moved=moved, assembled=lambda *_: Record(J=Record(finite=True), gap=gap)
    )  # fmt: skip
    found = [*loop_rank._perturbed(equations, Record(gap=0.0, q=None, t=0.0))]
    return moves, len(found)


def large_matrix():
    """Return the bound of singular values, and the number of vectors, of the decomposition of a large matrix."""
    bounds = []
    J = Record(shape=(1000, 1000), is_small=False, singular_values_below=lambda bound: bounds.append(bound) or 0)
    with patch.object(loop_rank, "_by_iteration", lambda J, width: width):
        return bounds, loop_rank.small_singular(J)


def iterated():
    """Return the shift of each subspace iteration."""
    shifts = []
    J = Record(
        shape=(3, 3), solved_gram=lambda shift, vectors: shifts.append(shift) or vectors, transposed_times_all=lambda x: x
    )  # fmt: skip
    loop_rank._by_iteration(J, 2)
    return shifts


def dropped(share):
    """Return which of two rows is dropped: the last one has a share in the null space, relative to the first."""
    equations = Record(loop=Record(joint_of=["a", "b"]))
    found = Record(redundancy=1, null_spaces=[(None, np.array([[1.0], [share]]))], equations=equations)
    return drop_first.redundant_rows(found, ["a", "b"], np.ones(2, dtype=bool))[0].row


def joints_to_choose_from():
    count = []
    pose = None, np.ones((1, 1))
    with patch.object(replacements, "_in_marker_axes", lambda *each: count.append(len(each[-1])) or {}):
        replacements.replacements(None, [pose], list(range(100)))
    return count[0]


OPTIONS = [[Record(count=1)]] * 20


def changed_joints():
    """Return the number of redundant equations up to which joints that release one each are found."""
    with patch.object(replacements, "_independent", always):
        return count_while(lambda count: next(replacements._together(OPTIONS[:10], count), None), range(2, 11))


def trials():
    count = []
    with patch.object(replacements, "_independent", lambda _: count.append(1) or False):
        list(replacements._together(OPTIONS, 4))
    return len(count)


def times_of_a_check():
    """Return the product of t and 1 - t of the times of a run of 1 s at which equations are evaluated."""
    times = []
    equations = Record(
        pose=lambda _, t: times.append(t) or Record(rates=np.zeros(1)), timed=np.zeros(1, dtype=bool)
    )  # fmt: skip
    inconsistent_constraints.time_dependent(equations, Record(q=None, t=0.0), 1.0)
    return np.prod([t * (1.0 - t) for t in times[1:]])


def examined(gap):
    """Return whether equations that hold up to a gap are examined as nearly redundant."""

    def raised(*_):
        raise Reached

    with suppress(Reached), patch.object(inconsistent_constraints, "time_dependent", raised):
        inconsistent_constraints.inconsistencies(Record(start=Record(gap=gap), equations=None), [], 1.0)
        return False
    return True


def kept_row(component):
    J = np.array([[1.0, 0.0], [1.0, component]])
    pose = Record(J=Record(dense=lambda: J))
    return inconsistent_constraints._clearly_independent(pose, np.ones(2, dtype=bool))[1]


def contradicts(distance):
    """Return whether a gap of 1 counts as a contradiction, if the other equations hold at a distance."""
    alone = Record(C=np.array([0.0, 1.0]))
    equations = Record(assembled=lambda *_: alone, distance=lambda *_: distance)
    kept = np.array([True, False])
    return inconsistent_constraints._position_violations(equations, Record(q=None, t=0.0, gap=1.0), kept)[1] > 0.0


def followed(duration):
    """Yield the times of the poses along a motion of rate 1/s."""

    def pose(t):
        return Record(
            q=np.zeros(1), t=t, gap=0.0, J=Record(dense=lambda: np.ones((1, 1)), finite=True), rates=-np.ones(1)
        )

    equations = Record(assembled=lambda q, t: pose(t), moved=lambda q, move: q, distance=lambda *_: 0.0)
    for each in inconsistent_constraints._followed(equations, pose(0.0), duration):
        yield each.t


def is_held(stiffness):
    names, _ = idle_freedoms.held({"k": np.diag([1.0, stiffness])}, np.array([[0.0, 1.0]]), np.ones(2))
    return bool(names)


def displacement_of_a_free_motion():
    moves = []
    system = Record(per_velocity=lambda *_: np.ones(1), size=1.0, of_body=Record(n_u=1))
    replaced = {
        "stiffnesses": lambda *_: {}, "screwed": lambda system, q, body, twist: moves.append(twist[0]) or q
    }  # fmt: skip
    with patch.multiple(idle_freedoms, **replaced):
        idle_freedoms._held(Record(system=system, state=Record(q=np.zeros(1))), 0, np.ones((1, 1)), 0.0)
    return moves[0]


def sampled_states():
    state = Record(q=np.zeros(1), evaluate=nothing, values={"motion": np.zeros(1)})
    return len(
        opposed_actuators._Directions._sampled(
            Record(state=state, system=Record(first_state=1, n_q=1), _times=(0.0, 1.0))
        )
    )


DECISIONS = {
    "redundancy.dependent": lambda: count_while(lambda s: loop_rank._clear([np.array([1e-12 * s])]), DOUBLES),
    "redundancy.closed": lambda: count_while(lambda gap: agreeing(1e-14 * gap), DOUBLES),
    "redundancy.agrees": lambda: count_while(agreeing, HALVES),
    "redundancy.most_steps": lambda: len(assembled()[0]),
    "redundancy.longest_step": lambda: assembled(step=1e3)[0][0],
    "redundancy.rounding": lambda: count_while(lambda slope: assembled(slope=slope)[0], HALVES),
    "redundancy.least_damping": lambda: assembled(violation=1e-9)[1][0],
    "redundancy.sound": lambda: count_while(lambda s: loop_rank._clear([np.array([s])]), HALVES),
    "redundancy.by_gap": lambda: count_while(lambda s: not rank_at(1e-9 * s, 1e-7), DOUBLES),
    "redundancy.poses": lambda: perturbed(0.0)[1],
    "redundancy.perturbation": lambda: perturbed(0.0)[0][0],
    "redundancy.shrinks": lambda: len(perturbed(1.0)[0]),
    "redundancy.clearly_regular": lambda: large_matrix()[0][0],
    "redundancy.more": lambda: large_matrix()[1],
    "redundancy.shift": lambda: iterated()[0],
    "redundancy.iterations": lambda: len(iterated()),
    "redundancy.same_direction": lambda: count_while(
        lambda off: not uniqueness._same(np.array([1.0, 0.0]), np.array([1.0, off])), HALVES
    ),
    "redundancy.well_chosen": lambda: count_while(dropped, HALVES),
    "redundancy.takes_part": lambda: count_while(lambda s: drop_first.rank_of(np.array([[s]])), HALVES),
    "redundancy.independent_component": lambda: count_while(
        lambda s: replacements._independent([Record(count=1, let_go=[np.array([[s]])])]), HALVES
    ),
    "redundancy.most_joints": joints_to_choose_from,
    "redundancy.most_changed": changed_joints,
    "redundancy.most_trials": trials,
    "redundancy.instants": times_of_a_check,
    "redundancy.nearly": lambda: count_while(lambda gap: not examined(gap), HALVES),
    "redundancy.independent_row": lambda: count_while(kept_row, HALVES),
    "redundancy.longest_move": lambda: count_while(contradicts, DOUBLES),
    "redundancy.stride": lambda: [*islice(followed(1e3), 2)][1],
    "redundancy.most_strides": lambda: len([*followed(1e6)]),
    "redundancy.stiffness_rounding": lambda: count_while(is_held, HALVES),
    "redundancy.further": displacement_of_a_free_motion,
    "redundancy.samples": sampled_states,
    "redundancy.most_names": lambda: listed([f"j{k}" for k in range(99)]).count("j"),
}
EXPECTED = {
    "redundancy.dependent": 54, "redundancy.closed": 40, "redundancy.agrees": 80, "redundancy.most_steps": 40,
    "redundancy.longest_step": 1, "redundancy.rounding": 120, "redundancy.least_damping": 1e-13,
    "redundancy.sound": 67, "redundancy.by_gap": 47, "redundancy.poses": 3, "redundancy.perturbation": 0.09883508098,
    "redundancy.shrinks": 8, "redundancy.clearly_regular": 0.001, "redundancy.more": 10, "redundancy.shift": 1e-10,
    "redundancy.iterations": 4, "redundancy.same_direction": 67, "redundancy.well_chosen": 14,
    "redundancy.takes_part": 80, "redundancy.independent_component": 40, "redundancy.most_joints": 10,
    "redundancy.most_changed": 3, "redundancy.most_trials": 2000, "redundancy.instants": 7.093271216e-09,
    "redundancy.nearly": 40, "redundancy.independent_row": 10, "redundancy.longest_move": 18, "redundancy.stride": 0.2,
    "redundancy.most_strides": 151, "redundancy.stiffness_rounding": 160, "redundancy.further": 0.3,
    "redundancy.samples": 4, "redundancy.most_names": 5,
}  # fmt: skip
