"""CasADi: CVODES and IDAS on places, Euler parameters and velocities; also with compiled equations where there is a C compiler."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache, partial
from typing import Any

import numpy as np

from ...contestant import Contestant, Failed, Solve
from ..compiled import compiled, compiler
from .mounted import GROUND, Mounted, Shaken, Shown

MOST_STEPS = 10**7
PER_BODY = 13
"""Place, Euler parameters, velocity, and angular velocity in body axes."""


def contestants(given: Shaken) -> Iterator[Contestant]:
    """What is compared is made of their states in the time."""
    m = given.mounted
    ways = [("", cache(partial(equations, m)))]
    if compiler():
        ways.append((", compiled", cache(lambda: compiled(equations(m)))))
    for plugin in ("cvodes", "idas"):
        for end, way in ways:
            yield Contestant(f"CasADi {plugin.upper()}{end}", True, partial(_solved, given, plugin, way))


def _solved(given: Shaken, plugin: str, way: Callable[[], dict[str, Any]], rtol: float) -> Solve:
    return integration(way(), plugin, given.mounted, given.shown, rtol)


def equations(m: Mounted) -> dict[str, Any]:
    """Newton's and Euler's equations."""
    import casadi as ca

    t, y = ca.SX.sym("t"), ca.SX.sym("y", PER_BODY * len(m.solids))
    parts = [y[PER_BODY * k : PER_BODY * (k + 1)] for k in range(len(m.solids))]
    turn = [_rotation(part[3:7]) for part in parts]
    force, torque = ([ca.SX.zeros(3) for _ in m.solids] for _ in range(2))

    def motion(body: int, point: np.ndarray) -> tuple[Any, Any, Any]:
        if body == GROUND:
            return ca.SX(point), ca.SX.zeros(3), None
        arm, part = m.arm(body, point), parts[body]
        return part[:3] + turn[body] @ arm, part[7:10] + turn[body] @ ca.cross(part[10:13], ca.SX(arm)), arm

    def push(body: int, arm: Any, pushed: Any) -> None:
        if body != GROUND:
            force[body] += pushed
            torque[body] += ca.cross(ca.SX(arm), turn[body].T @ pushed)

    for mount in m.mounts:
        (a, va, arm), (b, vb, other) = motion(mount.i, mount.point), motion(mount.j, mount.point)
        pull = -ca.SX(mount.stiffness) * (a - b) - ca.SX(mount.damping) * (va - vb)
        push(mount.i, arm, pull)
        push(mount.j, other, -pull)
    for strut in m.struts:
        (a, va, arm), (b, vb, other) = motion(strut.i, strut.end), motion(strut.j, strut.other)
        length, free = ca.norm_2(a - b), float(np.linalg.norm(strut.end - strut.other))
        along = (a - b) / length
        pull = -(strut.stiffness * (length - free) + strut.damping * ca.dot(along, va - vb)) * along
        push(strut.i, arm, pull)
        push(strut.j, other, -pull)
    force[m.shaken][2] += m.amplitude * ca.sin(m.rate * t)
    rates = []
    for part, solid, f, moment in zip(parts, m.solids, force, torque, strict=True):
        e, w, moments = part[3:7], part[10:13], ca.SX(solid.moments)
        rates += [part[7:10], 0.5 * ca.vertcat(-ca.dot(e[1:], w), e[0] * w + ca.cross(e[1:], w)), f / solid.mass]
        rates.append((moment - ca.cross(w, moments * w)) / moments)
    return {"t": t, "x": y, "ode": ca.vertcat(*rates)}


def _rotation(e: Any) -> Any:
    import casadi as ca

    return ca.SX.eye(3) + 2 * e[0] * ca.skew(e[1:]) + 2 * ca.skew(e[1:]) @ ca.skew(e[1:])


def integration(of: dict[str, Any], plugin: str, m: Mounted, shown: Shown, rtol: float) -> Solve:
    """Integrate over all output times."""
    import casadi as ca

    options: dict[str, Any] = {"reltol": rtol, "abstol": rtol, "max_num_steps": MOST_STEPS, "newton_scheme": "direct"}
    solver = ca.integrator("mounted", plugin, of, m.times[0], m.times[1:].tolist(), options)
    start = np.concatenate([np.r_[solid.centre, 1.0, np.zeros(9)] for solid in m.solids])

    def solve() -> np.ndarray:
        try:
            found = np.asarray(solver(x0=start)["xf"]).T
        except RuntimeError as error:
            raise Failed(str(error).splitlines()[-1]) from None
        rows = np.concatenate([start[None], found]).reshape(len(m.times), -1, PER_BODY)
        return shown(rows[..., :3], rows[..., 3:7], rows[..., 7:10], rows[..., 10:])

    return solve
