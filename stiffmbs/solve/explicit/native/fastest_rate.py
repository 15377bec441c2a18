"""Fastest rates of the motion about a state, by power iteration on differences of accelerations.

Apart from the steps and linked by addresses: runs of implicit solvers need the rate, too, and compile little for it.
"""

from math import sin, sqrt

from stiffmbs.compile.machine.native.access import compiled, shifted, state_view
from stiffmbs.compile.machine.native.calls import call_int
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.compile.machine.native.orientation import add_rates
from stiffmbs.dynamics.native.block_systems import largest_of
from stiffmbs.dynamics.native.views import dynamics_view, eliminated_view
from stiffmbs.solve.explicit.native.parameters import FASTEST_RATE


@compiled
def _accelerated(t, target, dynamics, accelerate):
    """Compute target = u' at the current state, by elimination if worthwhile; 0 or a negative status."""
    m = dynamics_view(dynamics)
    if m.eliminates and call_int(eliminated_view(m.eliminated).attempt, (t, target, m.eliminated)):
        return 0
    return call_int(accelerate, (t, target, dynamics))


@compiled
def _product(mass, v, w, n):
    """Return the product of two motions in the mass matrix, in which stiffness and damping are symmetric."""
    total = 0.0
    for k in range(n):
        total += mass[k] * v[k] * w[k]
    return total


@compiled
def _answered(t, of_pose, work, s, dynamics, accelerate):
    """Compute w, the change of accelerations by a small change of the pose, or of velocities, by v; 0 or a negative status."""
    n = s.n_u
    at_start, v, w, start = work, shifted(work, n), shifted(work, 2 * n), shifted(work, 3 * n)
    scale = FASTEST_RATE.move / largest_of(v, n)
    if of_pose:
        copied(start, s.q, s.n_q)
        add_rates(s, v, scale, s.q)
    else:
        copied(start, s.u, n)
        for k in range(n):
            s.u[k] += scale * v[k]
    status = _accelerated(t, w, dynamics, accelerate)
    if of_pose:
        copied(s.q, start, s.n_q)
    else:
        copied(s.u, start, n)
    for k in range(n):
        w[k] = (w[k] - at_start[k]) / scale
    return status


@compiled
def _growth(t, of_pose, mass, work, s, dynamics, accelerate):
    """Return the amplification from changes of the pose, or of velocities, to accelerations; the motion is in v then."""
    n = s.n_u
    v, w = shifted(work, n), shifted(work, 2 * n)
    for k in range(n):
        v[k] = sin(1.0 + 3.7 * k) / mass[k]
    growth = 0.0
    for _ in range(FASTEST_RATE.iterations):
        if _answered(t, of_pose, work, s, dynamics, accelerate) < 0:
            return 0.0
        growth = sqrt(_product(mass, w, w, n)) / sqrt(_product(mass, v, v, n))
        if not 0.0 < growth < float("inf"):
            return 0.0
        copied(v, w, n)
    return growth


@compiled
def _quotient(t, of_pose, mass, work, s, dynamics, accelerate):
    """Return the Rayleigh quotient of stiffness, or of damping, for the motion v; 0 where accelerations fail."""
    n = s.n_u
    v, w = shifted(work, n), shifted(work, 2 * n)
    if _answered(t, of_pose, work, s, dynamics, accelerate) < 0:
        return 0.0
    return max(-_product(mass, v, w, n) / _product(mass, v, v, n), 0.0)


@compiled
def _excite(t, mass, work, s, dynamics, accelerate):
    """Compute v, the change of accelerations by a displacement along them: that of stiff forces; return False if there is none."""
    n = s.n_u
    v = shifted(work, n)
    copied(v, work, n)
    if not _product(mass, v, v, n) > 0.0 or _answered(t, 1, work, s, dynamics, accelerate) < 0:
        return False
    copied(v, shifted(work, 2 * n), n)
    return _product(mass, v, v, n) > 0.0


def fastest_rates(t, mass, found, work, dynamics, accelerate):
    """Find the rates of the motion at the current state, 1/s: its fastest vibration, its largest damping, both of the excited motion.

    They stay zero without accelerations. The excited motion is the second part of `work`. `accelerate`: address of
    `stiffmbs.dynamics.native.dynamics.accelerate`.
    """
    s = state_view(dynamics_view(dynamics).state)
    if _accelerated(t, work, dynamics, accelerate) < 0:
        return
    found[0] = sqrt(_growth(t, 1, mass, work, s, dynamics, accelerate))
    found[1] = _growth(t, 0, mass, work, s, dynamics, accelerate)
    if _excite(t, mass, work, s, dynamics, accelerate):
        found[2] = sqrt(_quotient(t, 1, mass, work, s, dynamics, accelerate))
        found[3] = _quotient(t, 0, mass, work, s, dynamics, accelerate)
