"""Common normal of two convex solids, in kernels (`stiffmbs.compile.symbolic.spline`).

The unit normal n maximises n.d - h_i(n) - h_j(n), with d from the centre of j to that of i. The maximum is the distance
of the solids, or minus the penetration depth. Separate solids have one such normal. For a small penetration it
continues the normal of their cores, which are thinner in all directions. The normal between the cores minimises h_i +
h_j for given n.d, a convex problem. Boyd and Vandenberghe, Convex Optimization (2004), sec. 8.2; Ong and Gilbert,
Growth distances, IEEE Transactions on Robotics and Automation 12 (1996) 888-903.
"""

from __future__ import annotations

from math import sqrt

from ....errors import InputError
from ..native.access import compiled, room, shifted
from ..translate.arithmetic import sum_of_products
from ..translate.code import Code, constant
from ..translate.values import Operand, Value, builtin, dual, slope_of, undirected
from .ellipsoids import (
    POSE,
    SQUARES,
    TURN,
    across,
    along,
    curvature,
    ellipsoids,
    made_definite,
    moved,
    reach,
    solved,
    support,
    take_unit_length,
    thinnest,
    times,
)

THINNER = 0.2
"""Ratio of ellipsoid thickness between stages: each stage starts near its solution."""
STAGES = 16
"""Stages from the cores to the solids."""
MOST_STEPS, MOST_HALVINGS = 60, 30
POLISHES = 4
"""Newton steps after the step size has reached rounding."""
FLAT, ROUGHLY = 1e-14, 1e-8
"""Predicted relative increase of the distance at which the iteration ends: last stage, earlier stages."""


def _posed(code: Code, arguments: tuple[Operand, ...]) -> Value:
    array = code.doubles(len(arguments))
    for k, argument in enumerate(arguments):
        code.store(code.item(array, constant(k)), code.converted(undirected(argument), "float"))
    return array


@builtin
def common_normal(code: Code, component: Operand, *pose: Operand) -> Value | None:
    """Return a component of the normal in the axes of j, from j to i; all components are computed together."""
    known, at, number = code.kept("common_normal", POSE + 3), _posed(code, pose), code.integer(component)
    found, normal = code.unit.called(code, _component, [number, at, known]), shifted.lower(code, known, constant(POSE))
    if found is None or not any(map(slope_of, pose)):
        return found
    slopes = (
        (slope, by)
        for k, slope in enumerate(map(slope_of, pose))
        if slope and (by := code.unit.called(code, _slope, [number, constant(k), normal, at]))
    )
    return dual(found, sum_of_products(code, slopes))


@builtin
def common_normal_slope(code: Code, component: Operand, by: Operand, *normal_and_pose: Operand) -> Value | None:
    """Return the derivative of a component with respect to an entry of the pose, at the normal."""
    if any(map(slope_of, normal_and_pose)):
        raise InputError("found a contact of solids whose second derivatives are needed, expected another contact")
    normal, pose = _posed(code, normal_and_pose[:3]), _posed(code, normal_and_pose[3:])
    return code.unit.called(code, _slope, [code.integer(component), code.integer(by), normal, pose])


@compiled
def _grow(m, t, n):
    """Move n in its plane across t to the minimum of the support function."""
    h, k, g, p, trial = room(10), room(3), room(2), room(2), room(3)
    for _ in range(MOST_STEPS):
        support(m, n, h)
        g[0], g[1] = along(shifted(h, 1), t), along(shifted(h, 1), shifted(t, 3))
        curvature(h, t, 0.0, k)
        made_definite(k)
        solved(k, g, p)
        promised = g[0] * p[0] + g[1] * p[1]
        size = 1.0
        if promised <= ROUGHLY * h[0]:
            return
        for _ in range(MOST_HALVINGS):
            moved(n, t, p, -size, trial)
            if reach(m, trial) <= h[0] - 1e-4 * size * promised:
                break
            size *= 0.5
        if reach(m, trial) >= h[0]:
            return
        for c in range(3):
            n[c] = trial[c]


@compiled
def _part(m, d, n, flat, polishes):
    """Rotate the unit vector n to the maximum of n.d - h(n), to a relative accuracy `flat`, then take extra steps."""
    h, k, g, p, trial, t = room(10), room(3), room(2), room(2), room(3), room(6)
    u = shifted(t, 3)
    polished = 0
    for _ in range(MOST_STEPS):
        support(m, n, h)
        distance = along(n, d) - h[0]
        across(n, t)
        g[0], g[1] = along(d, t) - along(shifted(h, 1), t), along(d, u) - along(shifted(h, 1), u)
        curvature(h, t, distance, k)
        made_definite(k)
        solved(k, g, p)
        promised = g[0] * p[0] + g[1] * p[1]
        if promised <= flat * h[0]:
            polished += 1
        length = sqrt(p[0] * p[0] + p[1] * p[1])
        step = 0.5 / length if length > 0.5 else 1.0
        for _ in range(MOST_HALVINGS):
            moved(n, t, p, step, trial)
            take_unit_length(trial)
            if polished > 0 or along(trial, d) - reach(m, trial) >= distance + 1e-4 * step * promised:
                break
            step *= 0.5
        for c in range(3):
            n[c] = trial[c]
        if polished > polishes:
            return


@compiled
def find_normal(pose, n):
    """Find the unit vector of largest distance, or smallest penetration, of two solids."""
    m, t = room(54), room(6)
    for c in range(3):
        n[c] = pose[c]
    if along(n, n) == 0.0:
        n[2] = 1.0
    take_unit_length(n)
    across(n, t)
    last = thinnest(pose)
    fat = 1.0
    while fat > last:
        fat = max(fat * THINNER, last)
        ellipsoids(pose, fat, 1.0, m)
        _grow(m, t, n)
    take_unit_length(n)
    for stage in range(STAGES + 1):
        ellipsoids(pose, 0.0, 1.0 - stage / STAGES, m)
        if stage < STAGES:
            _part(m, pose, n, ROUGHLY, 0)
        else:
            _part(m, pose, n, FLAT, POLISHES)


@compiled
def _component(component, pose, known):
    """Return a component of the normal, cached for an unchanged pose."""
    same = True
    for k in range(POSE):
        if known[k] != pose[k]:
            same = False
            break
    n = shifted(known, POSE)
    if not same:
        find_normal(pose, n)
        for k in range(POSE):
            known[k] = pose[k]
    return n[component]


@compiled
def _changed(pose, m, n, by, change):
    """Differentiate d minus the support function's gradient with respect to an entry of the pose.

    The derivative of M n/s with s^2 = n.M n is M' n/s - M n (n.M' n)/(2 s^3), and M' is that of R D R^T.
    """
    for c in range(3):
        change[c] = 1.0 if by == c else 0.0
    r, v, w = shifted(pose, TURN), room(3), room(3)
    for term in range(6):
        at = SQUARES + 3 * term
        for c in range(3):
            v[c] = 0.0
        if TURN <= by < SQUARES and term < 3:
            row = (by - TURN) // 3
            column = by - TURN - 3 * row
            square = pose[at + column]
            v[row] += square * (r[column] * n[0] + r[3 + column] * n[1] + r[6 + column] * n[2])
            for c in range(3):
                v[c] += square * r[3 * c + column] * n[row]
        elif at <= by < at + 3 and term < 3:
            column = by - at
            part = r[column] * n[0] + r[3 + column] * n[1] + r[6 + column] * n[2]
            for c in range(3):
                v[c] = part * r[3 * c + column]
        elif at <= by < at + 3:
            v[by - at] = n[by - at]
        g = shifted(m, 9 * term)
        s = times(g, n, w)
        if s > 0.0:
            longer = 0.5 * along(v, n) / (s * s)
            for c in range(3):
                change[c] -= (v[c] - longer * (g[c] * w[0] + g[3 + c] * w[1] + g[6 + c] * w[2])) / s


@compiled
def _slope(component, by, n, pose):
    """Differentiate the normal by the implicit function theorem: (t^T h'' t + gap) p = t^T (d - h')' and n' = t p."""
    m, h, t, k, g, p, change = room(54), room(10), room(6), room(3), room(2), room(2), room(3)
    ellipsoids(pose, 0.0, 0.0, m)
    support(m, n, h)
    gap = along(n, pose) - h[0]
    across(n, t)
    curvature(h, t, gap, k)
    _changed(pose, m, n, by, change)
    g[0], g[1] = along(change, t), along(change, shifted(t, 3))
    solved(k, g, p)
    return p[0] * t[component] + p[1] * t[3 + component]
