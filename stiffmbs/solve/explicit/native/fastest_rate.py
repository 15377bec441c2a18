"""Fastest rate of a motion by power iteration on accelerations (von Mises, Pollaczek-Geiringer, 1929)."""

from __future__ import annotations

from math import sin, sqrt

from stiffmbs.compile.machine.native.access import compiled, shifted, state_view
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.orientation import add_rates
from stiffmbs.dynamics.native.block_systems import largest_of
from stiffmbs.dynamics.native.views import dynamics_view
from stiffmbs.solve.explicit.native.stages import accelerated

ITERATIONS = 5
"""Number of iterations; they give a lower bound close to the largest eigenvalue."""
MOVE = 1e-7
"""Largest change of a coordinate or velocity, m, rad, m/s, rad/s; small compared with the breakpoints of laws."""


@compiled
def _size(mass, v, n):
    """Return the norm of a motion in the mass matrix, in which stiffness and damping are symmetric."""
    total = 0.0
    for k in range(n):
        total += mass[k] * v[k] * v[k]
    return sqrt(total)


@compiled
def _growth(t, of_pose, mass, eliminates, work, eliminated, s, m):
    """Return the amplification from changes of the pose, or of velocities, to accelerations."""
    n = s.n_u
    at_start, v, w, start = work, shifted(work, n), shifted(work, 2 * n), shifted(work, 3 * n)
    if of_pose:
        copied(start, s.q, s.n_q)
    else:
        copied(start, s.u, n)
    for k in range(n):
        v[k] = sin(1.0 + 3.7 * k) / mass[k]
    growth = 0.0
    for _ in range(ITERATIONS):
        scale = MOVE / largest_of(v, n)
        if of_pose:
            add_rates(s, v, scale, s.q)
        else:
            for k in range(n):
                s.u[k] += scale * v[k]
        status = accelerated(eliminates, eliminated, s, m, t, w)
        if of_pose:
            copied(s.q, start, s.n_q)
        else:
            copied(s.u, start, n)
        if status < 0:
            return 0.0
        for k in range(n):
            w[k] = (w[k] - at_start[k]) / scale
        growth = _size(mass, w, n) / _size(mass, v, n)
        if not 0.0 < growth < float("inf"):
            return 0.0
        copied(v, w, n)
    return growth


def fastest_rate(t, eliminates, mass, work, eliminated, dynamics):
    """Return the largest |lambda|, 1/s, of the motion at the current state; 0 without accelerations."""
    m = dynamics_view(dynamics)
    s = state_view(m.state)
    if accelerated(eliminates, eliminated, s, m, t, work) < 0:
        return 0.0
    stiffness = _growth(t, 1, mass, eliminates, work, eliminated, s, m)
    damping = _growth(t, 0, mass, eliminates, work, eliminated, s, m)
    return max(sqrt(stiffness), damping)
