"""Decisions of the checks of a run on its own motion."""

from __future__ import annotations

from itertools import repeat
from unittest.mock import patch

import numpy as np

import stiffmbs
from stiffmbs.analyses.job import prepare
from stiffmbs.errors import InputError
from stiffmbs.run_checks import (
    geometric_stiffness,
    growth,
    locked,
    lost_digits,
    motion,
    overlooked,
    singular_poses,
    tables,
)
from stiffmbs.run_checks.singular_poses import PosesBetween
from tests.decisions.common import Record, nothing
from tests.solve.test_parameter_thresholds import DOUBLES, HALVES, count_while

SETTINGS = Record(rtol=0.0, duration=1.0)


def silent(sentences):
    """Return whether a check yields no sentence."""
    return not [*sentences]


def farthest_body():
    """Return the distance of a body from the origin, in quarter octaves of 1e8 m, up to which a joint is accepted."""

    def accepted(distance):
        system = Record(
            n_c=1, of_body=Record(n_q=3, linear=2), q=np.array([distance, 0.0, 0.0]), n_pose=3, size=1.0, bodies=["a"]
        )  # fmt: skip
        try:
            motion.refuse_far_away(system)
        except InputError:
            return False
        return True

    return count_while(lambda distance: accepted(1e8 * distance), DOUBLES)


def largest_loss():
    rows = Record(t=np.zeros(1), q=np.zeros((1, 1)), u=np.zeros((1, 1)), acceleration=np.zeros((1, 1)))
    system = Record(mass=np.ones(1), per_velocity=lambda linear, angular: np.full(1, linear))
    dynamics = Record(state=Record(q=np.zeros(1), u=np.zeros(1)), system=system)

    def is_silent(lost):
        with patch.object(lost_digits, "lost_digits", lambda *_: ("k", lost, 1.0)):
            return silent(lost_digits.lost_digits_notes(dynamics, rows))

    return count_while(lambda lost: is_silent(1e-6 * lost), DOUBLES)


def lost_force():
    """Return the change of the force of a spring of 1e9 N/m at 1 m by rounding."""
    scene = """
    {bodies: {a: {mass: 1, inertia: 1, position: [1, 0]}}, forces: {k: {type: spring_damper, i: a, j: ground, stiffness: 1e9, free_length: 1}}}
    """
    return lost_digits.lost_digits(prepare(stiffmbs.read_scene(scene)).dynamics.state, 0.0)[1]


def geometric_stiffness_without_note():
    rows = Record(t=np.zeros(1))

    def is_silent(ratio):
        with patch.object(geometric_stiffness, "_ratios", lambda *_: np.array([[0.0, ratio]])):
            return silent(geometric_stiffness._note("a", {"stiffened": [1]}, rows, None))

    return count_while(lambda ratio: is_silent(1e-3 * ratio), DOUBLES)


def deformation_without_note():
    with patch.object(geometric_stiffness, "_length", lambda _: 1.0):
        return count_while(
            lambda part: silent(geometric_stiffness._note_on_large_deformation("a", {}, np.array([[1e-4 * part]]))),
            DOUBLES,
        )


def widest_gap(on_constraints):
    """Return the opening of a joint, in quarter octaves of 1e-8 sizes, that is accepted."""
    state = Record(q=np.zeros(1), u=np.zeros(1), evaluate=nothing, vector=lambda *_: np.ones(1))
    dynamics = Record(system=Record(n_c=1, size=1.0, equations=[("j", "x")]), state=state)

    def accepted(gap):
        rows = Record(
            position_violation=np.array([gap]), q=np.zeros((1, 1)), u=np.zeros((1, 1)), t=np.zeros(1)
        )  # fmt: skip
        return silent(growth._open_joint(dynamics, rows, on_constraints))

    return count_while(lambda gap: accepted(1e-8 * gap), DOUBLES)


def largest_velocity_violation(coefficient):
    """Return the violation of a velocity equation, in quarter octaves of 1e-4, that is accepted."""
    terms = {
        "V": Record(source=[0], row=[0]),
        "J": Record(source=np.array([1]), row=np.array([0]), column=np.array([0])),
    }
    solved = Record(q=np.zeros((1, 1)), u=np.ones((1, 1)), t=np.zeros(1))

    def accepted(violation):
        state = Record(values_at=lambda *_: np.array([[violation, coefficient]]))
        dynamics = Record(system=Record(term=lambda _, name: terms[name], n_c=1), state=state)
        return locked._first(dynamics, np.array([0]), solved, np.array([0])) is None

    return count_while(lambda violation: accepted(1e-4 * violation), DOUBLES)


def poses_between_two_outputs():
    of_body = Record(n_q=1, move=lambda q, there: there - q, moved=lambda q, step: q + step)
    dynamics = Record(system=Record(of_body=of_body, bodies=["a"]))
    solved = Record(t=np.arange(2.0), q=np.zeros((2, 1)), u=np.zeros((2, 1)))
    return sum(1 for _ in locked._poses(dynamics, solved))


def departed(gap, assembled, poses=1):
    """Return whether a dropped equation is found to contradict the other one, and the number of assembled poses.

    `gap`: violation of the dropped equation, relative to that of the other one.
    """
    tried = []
    state = Record(q=np.zeros(1), restart_counters=nothing, evaluate=nothing, values={"position": np.array([gap, 1.0])})
    system = Record(
        term=lambda *_: Record(source=np.arange(2), row=np.arange(2)), n_c=2, active=np.array([False, True]),
        holonomic=np.ones(2, dtype=bool), size=1.0,
    )  # fmt: skip
    dynamics = Record(system=system, state=state, assemble=lambda _: tried.append(1) or assembled)
    with patch.object(locked, "_poses", lambda *_: repeat((0, 0.0, np.zeros(1)), poses)):
        found = locked.departure(dynamics, [0], None)
    return found is not None, len(tried)


def largest_turn():
    system = Record(term=lambda *_: Record(source=[0], row=[0]))
    rows = Record(position_violation=np.zeros(1), t=np.zeros(1), q=np.zeros((1, 1)), u=np.zeros((1, 1)))

    def is_silent(apart):
        state = Record(values_at=lambda *_: np.array([[apart]]))
        with patch.object(motion, "writer", lambda *_: "j"):
            return silent(motion.missed_revolutions_notes(Record(system=system, state=state), rows))

    return count_while(lambda apart: is_silent(0.01 * apart), DOUBLES)


def rows_of(change, acceleration):
    """Return two rows at a distance of 1 s."""
    return Record(
        t=np.array([0.0, 1.0]), u=np.array([[0.0], [change]]), acceleration=np.full((2, 1), acceleration), values=None
    )


STEPS = np.array([-1.0, 3.0])


def largest_contradiction():
    """Return the contradiction of an acceleration, in quarter octaves of a percent, that is accepted."""

    def accepted(part):
        return not len(
            overlooked.contradicting_rows(rows_of(1.0 - 0.01 * part, 1.0), np.ones(1), STEPS, np.zeros(1))[0]
        )

    return count_while(accepted, DOUBLES)


def velocity_within_tolerances():
    """Return the contradiction of a velocity, in quarter octaves of tolerances, that is accepted."""
    system = Record(
        has_laws=True, mass=np.ones(1), n_q=0, n_c=0, of_body=Record(velocities=None), name_of=lambda *_: "a.vx"
    )
    dynamics = Record(system=system, state=None)

    def accepted(tolerances):
        replaced = {
            "absolute_tolerances": lambda *_: np.array([1e-6]), "acting": lambda *_: "", "_of_errors": lambda *_: np.zeros(1),
        }  # fmt: skip
        with patch.multiple(overlooked, **replaced):
            rows, steps = rows_of(1e-6 * tolerances, 0.0), Record(step_times=STEPS)
            found = overlooked.overlooked(dynamics, rows, steps, SETTINGS, nothing)
        return found is None

    return count_while(accepted, DOUBLES)


def judged(off, acceleration):
    """Return whether the midpoint of a step of 1 s shows a missed event; `off` is in tolerances."""
    system = Record(mass=np.ones(1), n_q=0, n_c=0, of_body=Record(velocities=None), name_of=lambda *_: "a.vx")
    found = Record(dynamics=Record(system=system, state=None), begin=np.zeros(1), end=np.ones(1))
    rows = Record(t=np.zeros(1), u=np.zeros((1, 1)), acceleration=np.array([[acceleration]]))
    replaced = {
        "absolute_tolerances": lambda *_: np.ones(1), "acting": lambda *_: "", "_of_errors": lambda *_: np.zeros(1),
        "_shortest": lambda *_: 1.0,
    }  # fmt: skip
    with patch.multiple(overlooked, **replaced):
        made = overlooked._judged(found, np.array([0]), Record(rate=np.array([[acceleration - off]])), rows, SETTINGS)
    return made is not None


def duration_of_a_peak():
    """Return the duration of a contradiction that a single sample shows, relative to the spacing of samples in a run."""

    def report(t, *_):
        off = np.zeros((len(t), 1))
        off[len(t) // 2] = 1.0
        return Record(t=t, acceleration=off)

    def at(steps, places):
        return Record(t=places, q=None, u=None, rate=np.zeros((len(places), 1)))

    dynamics = Record(report=report, system=Record(mass=np.ones(1)))
    found = Record(begin=np.zeros(1), end=np.ones(1), at=at, dynamics=dynamics)
    with patch.multiple(overlooked, near_constraints=lambda _: True, _spacing=lambda _: 1.0):
        return overlooked._shortest(found, np.array([0]), np.array([0.5]), np.ones(1), SETTINGS)


def parts_of_a_whole_run():
    found = Record(begin=np.zeros(1), end=np.ones(1))
    return len(overlooked._all_along(found, np.array([0]), SETTINGS)[1])


def change_by_errors(of):
    """Return the change of an acceleration of 1 by each tolerance of a position or a velocity."""
    dynamics = Record(
        system=Record(n_q=1), report=lambda t, q, u, project: Record(acceleration={"q": q, "u": u}[of].copy())
    )  # fmt: skip
    rows = Record(q=np.zeros((1, 1)), u=np.zeros((1, 1)), t=np.zeros(1))
    with patch.object(overlooked, "absolute_tolerances", lambda *_: np.ones(2)):
        return overlooked._of_errors(dynamics, rows, 0, SETTINGS, overlooked.RUN_CHECKS.slight)[0]


def instants_of_a_dip():
    asked = []

    def again(t):
        asked.append(len(t))
        return Record(t=t)

    replaced = {
        "deepest_dips": lambda _: [1], "PosesBetween": lambda *_: Record(usual=1.0), "_nearest": lambda *_: (1.0, None)
    }  # fmt: skip
    rows = Record(log_determinant=None, t=np.arange(3.0), q=None)
    with patch.multiple(singular_poses, **replaced):
        list(singular_poses.singular_passage_notes(Record(system=None), rows, 1e-6, again))
    return asked[0]


def largest_distance():
    """Return the distance of a pose, in quarter octaves of 1, down to which it counts as regular."""

    def is_regular(d):
        poses = Record(distance=lambda _: d, _sound_from=lambda k, sense: k + sense)
        found = PosesBetween.at_singular(poses, 0)
        return found.start == found.stop

    return count_while(is_regular, HALVES)


def nearest(weight=1.0, rows=1, n_u=1):
    """Return the most nearly singular of 1000 poses, and the number of them whose distance was computed."""
    asked = []
    of_body = Record(pose=lambda *_: "")
    system = Record(n_u=n_u, of_body=of_body, bodies=[], equations=[(f"j{k}", "x") for k in range(rows)])
    poses = Record(
        _t=np.linspace(0.0, 1.0, 1000), _q=np.zeros((1000, 1)), _rows=np.arange(rows), _system=system, _bodies=[],
        distance=lambda k: asked.append(k) or 0.0, _least=lambda _: (0.0, np.array([1.0, weight, *[0.0] * (rows - 2)])),
    )  # fmt: skip
    return PosesBetween.nearest(poses, 0.0, 1.0), len(asked)


def poses_of_a_motion():
    asked = []
    poses = Record(
        _t=np.zeros(1000), _rows=np.zeros(1), _scaled=lambda k: asked.append(k) or np.ones((1, 1)), _system=None,
        _least=lambda k: (asked.append(k) or 1.0, None),
    )  # fmt: skip
    PosesBetween.usual.func(poses)
    return len(asked)


def pose_note(rtol):
    pose = singular_poses.SingularPose(0.0, ("j",), (), ())
    return [*singular_poses._notes(pose, 1.0, rtol)]


DECISIONS = {
    "run_checks.coarse": farthest_body,
    "run_checks.lost": largest_loss,
    "run_checks.roundings": lost_force,
    "run_checks.stiffened": geometric_stiffness_without_note,
    "run_checks.of_second_order": deformation_without_note,
    "run_checks.too_much": deformation_without_note,
    "run_checks.open": lambda: widest_gap(True),
    "run_checks.drifted": lambda: widest_gap(False),
    "run_checks.most_instants": lambda: len(singular_poses.some_instants(10**5)),
    "run_checks.unfollowed_part": lambda: largest_velocity_violation(1.0),
    "run_checks.unfollowed_velocity": lambda: largest_velocity_violation(0.0),
    "run_checks.poses": poses_between_two_outputs,
    "run_checks.left_out": lambda: count_while(lambda gap: not departed(gap, -1)[0], DOUBLES),
    "run_checks.most_assemblies": lambda: departed(1e6, 0, 5000)[1],
    "run_checks.uncertain_turn": largest_turn,
    "run_checks.overlooked_tolerances": velocity_within_tolerances,
    "run_checks.overlooked_part": largest_contradiction,
    "run_checks.dip": lambda: count_while(
        lambda part: not singular_poses.deepest_dips(np.array([0.0, np.log(part), 0.0])), HALVES
    ),
    "run_checks.most_dips": lambda: len(singular_poses.deepest_dips(np.array([0.0, -9.0] * 50 + [0.0]))),
    "run_checks.dip_instants": instants_of_a_dip,
    "run_checks.magnified": lambda: singular_poses._magnified(1.0),
    "run_checks.decided": lambda: count_while(lambda d: not singular_poses._decided_by_chance(d), HALVES),
    "run_checks.worth_telling": lambda: count_while(lambda rtol: not pose_note(1e-6 * rtol), DOUBLES),
    "run_checks.last_digits": lambda: count_while(lambda d: not singular_poses._decided_by_chance(d), HALVES),
    "run_checks.nearly_singular": largest_distance,
    "run_checks.takes_part": lambda: count_while(lambda weight: len(nearest(weight, 2)[0].joints) == 2, HALVES),
    "run_checks.floor": lambda: singular_poses._smallest(np.zeros((1, 1)))[0],
    "run_checks.iterations": lambda: singular_poses._smallest(np.diag([1.0, 0.5]))[1][0],
    "run_checks.few_rows": lambda: count_while(
        lambda n: np.ptp(singular_poses._smallest(np.eye(n))[1]) < 1e-9, range(20, 200, 20)
    ),
    "run_checks.usual_poses": poses_of_a_motion,
    "run_checks.effort": lambda: nearest(rows=1000, n_u=5)[1],
    "run_checks.contradicted_tolerances": lambda: count_while(lambda off: not judged(off, 0.0), DOUBLES),
    "run_checks.parts_of_a_run": parts_of_a_whole_run,
    "run_checks.parts_of_a_peak": duration_of_a_peak,
    "run_checks.slight": lambda: change_by_errors("q"),
    "run_checks.slight_velocity": lambda: change_by_errors("u"),
    "run_checks.tables:SAMPLES": lambda: len(tables._samples(0.0, 1.0)),
}
EXPECTED = {
    "run_checks.coarse": 22, "run_checks.lost": 27, "run_checks.roundings": 4.440892099e-07,
    "run_checks.stiffened": 20, "run_checks.of_second_order": 27,
    "run_checks.too_much": 27, "run_checks.open": 27, "run_checks.drifted": 80, "run_checks.most_instants": 400,
    "run_checks.unfollowed_part": 27, "run_checks.unfollowed_velocity": 14, "run_checks.poses": 5001,
    "run_checks.left_out": 14, "run_checks.most_assemblies": 500, "run_checks.uncertain_turn": 27,
    "run_checks.overlooked_tolerances": 65, "run_checks.overlooked_part": 20, "run_checks.dip": 9,
    "run_checks.most_dips": 5, "run_checks.dip_instants": 201, "run_checks.magnified": 10, "run_checks.decided": 54,
    "run_checks.worth_telling": 27, "run_checks.last_digits": 54, "run_checks.nearly_singular": 21,
    "run_checks.takes_part": 7, "run_checks.floor": 1e-07, "run_checks.iterations": 1.525878906e-05,
    "run_checks.few_rows": 3, "run_checks.usual_poses": 20, "run_checks.effort": 100,
    "run_checks.contradicted_tolerances": 40, "run_checks.parts_of_a_run": 20001, "run_checks.parts_of_a_peak": 0.015503875968992248,
    "run_checks.slight": 0.01, "run_checks.slight_velocity": 10.0, "run_checks.tables:SAMPLES": 2001,
}  # fmt: skip
