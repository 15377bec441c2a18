"""Decisions of compiled code: geometry, beams, factors, rotations."""

from __future__ import annotations

from contextlib import nullcontext
from unittest.mock import patch

import numpy as np

from stiffmbs.compile.machine import compiler, finish
from stiffmbs.compile.machine.beams import screws
from stiffmbs.compile.machine.geometry import common_normal, ellipsoids
from stiffmbs.compile.machine.native import evaluate, factors, rotation_vector
from tests.decisions.common import BELOW, Reached, Record, executed, nothing, reach, reached
from tests.interpreted import interpreted
from tests.solve.test_parameter_thresholds import DOUBLES, count_while


def inlined_instructions():
    source = Record(namespace=dict, signatures=[], of="", text="")
    with patch("stiffmbs.compile.machine.translate.unit.assembly", lambda *args: reach(args[-1])):
        return reached(lambda: compiler.drafted("", source))


def waits_for_drafts():
    """Return the times for which the process without drafts waits before it ends."""
    now = [0.0]
    waits = []

    def sleep(seconds):
        waits.append(seconds)
        now[0] += seconds

    with (
        patch.multiple(finish, alone=lambda _: nullcontext(), _drafts=list, units=tuple),
        patch.multiple(finish.time, monotonic=lambda: now[0], sleep=sleep),
        patch.object(finish.os, "nice", nothing),
    ):
        finish.finish()
    return waits


def normal(part=nothing, grow=nothing):
    """Find a common normal of solids, with functions for the solids and their cores."""
    with interpreted(
        common_normal, room=np.zeros, along=lambda *_: 1.0, take_unit_length=nothing, across=nothing, thinnest=lambda _: 1e-9,
        ellipsoids=nothing, _part=part, _grow=grow,
    ):  # fmt: skip
        common_normal.find_normal(np.ones(3), np.ones(3))


def calls_of(name):
    """Return the number of calls of a function by an iteration that never ends."""
    calls = []
    with interpreted(
        common_normal, room=lambda n: np.ones(n), along=lambda *_: 0.0, take_unit_length=nothing, across=nothing, made_definite=nothing,
        curvature=nothing, solved=nothing, reach=lambda *_: 1e9, **{"support": nothing, "moved": nothing, name: lambda *_: calls.append(1)},
    ):  # fmt: skip
        common_normal._part(np.ones(54), np.ones(3), np.ones(3), -1e9, 0)
    return len(calls)


def halvings_of_a_step():
    return calls_of("moved") / calls_of("support")


def parts_of_a_normal():
    """Return the tolerances and the numbers of last steps of each stage."""
    found = []
    normal(part=lambda *args: found.append(args[-2:]))
    return found


def stages_of_growth():
    found = []
    normal(grow=lambda *_: found.append(1))
    return len(found)


def thickness_of_a_core():
    """Return the thickness that is removed from a sphere of radius 1 to form its core."""
    pose, m = np.zeros(100), np.zeros(54)
    with interpreted(ellipsoids, least=lambda _: 1.0):
        pose[ellipsoids.SQUARES : ellipsoids.SQUARES + 3] = 1.0
        pose[ellipsoids.TURN] = 1.0
        ellipsoids.ellipsoids(pose, 0.0, 1.0, m)
    return 1.0 - m[0]


def terms_of(x):
    """Return the number of terms of a series."""
    sizes = []
    with (
        interpreted(screws, room=np.zeros, clear=nothing),
        patch.object(screws, "abs", lambda value: sizes.append(1) or abs(value), create=True),
    ):
        screws.series(x, 0, 0, np.zeros(4))
    return len(sizes)


def largest_angle_of_a_quad():
    def is_accepted(angle):
        with interpreted(evaluate, quad_of=lambda *_: reach(True)):
            try:
                return evaluate.share_four(np.full(3, angle), np.zeros(4, int), None)
            except Reached:
                return True

    return count_while(lambda angle: is_accepted(1e3 * angle), DOUBLES)


def smallest_diagonal_pivot():
    """Return the diagonal entry of a column, in quarter octaves of its largest, up to which it is the pivot."""

    def is_kept(entry):
        f = Record(
            n=2, capacity=100, order=[0, 1], pivot=np.zeros(2, int), work=np.zeros(2), stack=np.array([0, 1, 0, 0, 0, 0]), ready=0,
            a=np.array([entry, 1.0, 1.0, 0.0]), a_row=[0, 1, 0, 1], a_start=[0, 2, 4], l=np.zeros(9), u=np.zeros(9),
            l_row=np.zeros(9, int), u_row=np.zeros(9, int), l_start=np.zeros(3, int), u_start=np.zeros(3, int),
        )  # fmt: skip
        with interpreted(factors, _reach=lambda *_: 0):
            factors._factored_within(f)
        return f.pivot[0] == 0

    return count_while(is_kept, BELOW)


def smallest_previous_pivot():
    def is_accepted(entry):
        f = Record(
            n=2, order=[0, 1], pivot=[0, 1], work=np.zeros(2), a=np.array([entry, 1.0, 1.0, 0.0]), a_row=[0, 1, 0, 1], a_start=[0, 2, 4],
            l=np.zeros(9), u=np.zeros(9), l_row=[0, 1, 1], u_row=[0, 0, 1], l_start=[0, 2, 3], u_start=[0, 1, 3],
        )  # fmt: skip
        with interpreted(factors):
            return factors.refactor(f) == factors.DONE

    return count_while(is_accepted, BELOW)


def lightest_body(inertia=1.0, entry=1.0):
    """Return the inertia of a body that an equation couples to one of unit inertia."""
    f = Record(a_start=[0, 2], a=np.array([entry, 1.0]), a_row=[0, 1], work=np.array([1.0, inertia]))
    factors._spread(f, 0)
    return f.work[1]


def spreads_of_inertia():
    spread = []
    with interpreted(factors, _spread=lambda *_: spread.append(1)):
        factors.spread_inertia(Record(n=1, work=np.zeros(1)))
    return len(spread)


def farthest_rotation_by_series():
    def is_near(away):
        with interpreted(rotation_vector, _near_one=lambda *_: -1.0):
            return rotation_vector.rotation_vector(1.0 - away, 0) == -1.0

    return count_while(lambda away: not is_near(away), BELOW)


DECISIONS = {
    "compile.machine.compiler:SOURCES": lambda: executed("compile.machine.compiler").compiled_source.cache_info().maxsize,
    "compile.machine.object_code:INLINED": inlined_instructions,
    "compile.machine.geometry.common_normal:THINNER": stages_of_growth,
    "compile.machine.geometry.common_normal:STAGES": lambda: len(parts_of_a_normal()) - 1,
    "compile.machine.geometry.common_normal:MOST_STEPS": lambda: calls_of("support"),
    "compile.machine.geometry.common_normal:MOST_HALVINGS": halvings_of_a_step,
    "compile.machine.geometry.common_normal:POLISHES": lambda: parts_of_a_normal()[-1][1],
    "compile.machine.geometry.common_normal:FLAT": lambda: parts_of_a_normal()[-1][0],
    "compile.machine.geometry.common_normal:ROUGHLY": lambda: parts_of_a_normal()[0][0],
    "compile.machine.geometry.ellipsoids:CORE": thickness_of_a_core,
    "compile.machine.finish:Finishing.patience": lambda: round(sum(waits_for_drafts()), 6),
    "compile.machine.finish:Finishing.pause": lambda: waits_for_drafts()[0],
    "compile.machine.beams.screws:TERMS": lambda: terms_of(1e3),
    "compile.machine.beams.screws:NEGLIGIBLE": lambda: count_while(lambda x: terms_of(x) > 1, BELOW),
    "compile.machine.beams.section:MOST": lambda: executed("compile.machine.beams.section").NODES,
    "compile.machine.native.evaluate:FARTHEST": largest_angle_of_a_quad,
    "compile.machine.native.factors:KEEP_DIAGONAL": smallest_diagonal_pivot,
    "compile.machine.native.factors:TOO_SMALL": smallest_previous_pivot,
    "compile.machine.native.factors:LIGHT": lambda: count_while(
        lambda inertia: lightest_body(inertia=inertia) == inertia, BELOW
    ),
    "compile.machine.native.factors:COUPLES": lambda: count_while(
        lambda entry: lightest_body(inertia=1e-30, entry=entry) > 1e-30, BELOW
    ),
    "compile.machine.native.factors:SPREAD_OVER": spreads_of_inertia,
    "compile.machine.native.rotation_vector:NEAR": farthest_rotation_by_series,
    "compile.machine.native.rotation_vector:TERMS": lambda: rotation_vector._near_one(3.0, 0),
}  # fmt: skip
EXPECTED = {
    "compile.machine.compiler:SOURCES": 8192, "compile.machine.object_code:INLINED": 40, "compile.machine.geometry.common_normal:THINNER": 13,
    "compile.machine.geometry.common_normal:STAGES": 16, "compile.machine.geometry.common_normal:MOST_STEPS": 60,
    "compile.machine.geometry.common_normal:MOST_HALVINGS": 30.0, "compile.machine.geometry.common_normal:POLISHES": 4,
    "compile.machine.geometry.common_normal:FLAT": 1e-14, "compile.machine.geometry.common_normal:ROUGHLY": 1e-08,
    "compile.machine.geometry.ellipsoids:CORE": 0.5, "compile.machine.finish:Finishing.patience": 2.2, "compile.machine.finish:Finishing.pause": 0.2,
    "compile.machine.beams.screws:TERMS": 17, "compile.machine.beams.screws:NEGLIGIBLE": 274,
    "compile.machine.beams.section:MOST": 690, "compile.machine.native.evaluate:FARTHEST": 27,
    "compile.machine.native.factors:KEEP_DIAGONAL": 13, "compile.machine.native.factors:TOO_SMALL": 40,
    "compile.machine.native.factors:LIGHT": 80, "compile.machine.native.factors:COUPLES": 13,
    "compile.machine.native.factors:SPREAD_OVER": 4, "compile.machine.native.rotation_vector:NEAR": 13,
    "compile.machine.native.rotation_vector:TERMS": 308.33391674417925,
}  # fmt: skip
