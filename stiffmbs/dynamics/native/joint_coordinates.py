"""Coordinates of joints and their rates at the current state, angles with their full turns."""

from math import floor, pi

from stiffmbs.compile.machine.native.access import compiled, state_view
from stiffmbs.compile.machine.native.evaluate import OUTPUT, evaluate
from stiffmbs.compile.machine.native.memory import copied
from stiffmbs.dynamics.native.layouts import WITHOUT_TURNS
from stiffmbs.dynamics.native.views import joint_coordinates_view

TURN = 2.0 * pi


@compiled
def follow_joints(j, t, q, u):
    """Compute coordinates and rates at a state; an angle takes the turn of its counter, or that to which its mean rate leads."""
    s = state_view(j.state)
    copied(s.q, q, s.n_q)
    copied(s.u, u, s.n_u)
    values = evaluate(s, OUTPUT, t)
    half = 0.5 * (t - j.t)
    for k in range(j.n):
        x, rate = values[j.place[k]], values[j.rate_place[k]]
        if j.counter[k] != WITHOUT_TURNS:
            near = j.coordinate[k] + half * (j.rate[k] + rate)
            if j.counter[k] >= 0:
                near = q[j.counter[k]]
            x += TURN * floor((near - x) / TURN + 0.5)
        j.coordinate[k] = x
        j.rate[k] = rate
    j.t = t


def follow(t, q, u, joints):
    """Call `follow_joints` from Python."""
    follow_joints(joint_coordinates_view(joints), t, q, u)
