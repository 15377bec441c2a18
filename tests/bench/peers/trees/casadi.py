"""CasADi: IDAS on places, Euler parameters, velocities and multipliers; also with compiled equations where there is a C compiler."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np

from ...contestant import Contestant, Failed, Solve
from ..casadi import BAUMGARTE, MOST_STEPS, OUT_OF_THE_TEST
from ..compiled import compiled, compiler
from .tree import GROUND, Tree

PER_BODY, VELOCITIES = 13, 6
"""Place, Euler parameters, velocity, and angular velocity in axes that are those of ground at the start."""


def contestants(tree: Tree) -> Iterator[Contestant]:
    """SI2, and index 1 where bodies are few, multipliers out of the error test."""
    few = sum(link.mass > 0 for link in tree.links) <= FEW
    for name, form in (("SI2", si2), *([("index 1", index_1)] if few else [])):
        yield Contestant(f"CasADi IDAS {name}", True, partial(_solved, tree, cache(partial(form, tree))))
        if compiler():
            yield Contestant(
                f"CasADi IDAS {name}, compiled", True, partial(_solved, tree, cache(partial(_compiled, form, tree)))
            )


def _compiled(form: Callable[[Tree], dict[str, Any]], tree: Tree) -> dict[str, Any]:
    return compiled(form(tree))


def _solved(tree: Tree, equations: Callable[[], dict[str, Any]], rtol: float) -> Solve:
    return integration(equations(), tree, rtol)


FEW = 7
"""Bodies up to which index 1 is tried: with more it takes ten times as long as SI2, and minutes to be compiled."""


class Bodies:
    """A tree's bodies with their joints, in CasADi's symbols; links without a mass belong to the joint of the next one."""

    def __init__(self, tree: Tree) -> None:
        import casadi as ca

        self._ca, self._tree = ca, tree
        self.links = [k for k, link in enumerate(tree.links) if link.mass]
        self.x = ca.SX.sym("x", PER_BODY * len(self.links))
        parts = {k: self.x[PER_BODY * n : PER_BODY * (n + 1)] for n, k in enumerate(self.links)}
        self._place = {k: part[:3] for k, part in parts.items()} | {GROUND: ca.SX.zeros(3)}
        self._turn = {k: _rotation(part[3:7]) for k, part in parts.items()} | {GROUND: ca.SX.eye(3)}
        self._spin = {k: part[10:] for k, part in parts.items()} | {GROUND: ca.SX.zeros(3)}
        self._parameters = [part[3:7] for part in parts.values()]

    @property
    def u(self) -> Any:
        """The velocities in x."""
        return self.x[self.velocities]

    @property
    def velocities(self) -> list[int]:
        """Their places in x."""
        return [PER_BODY * n + 7 + i for n in range(len(self.links)) for i in range(VELOCITIES)]

    def rates(self, u: Any, acceleration: Any) -> Any:
        """x', from the velocities with which places move, and the accelerations."""
        ca = self._ca
        moved = zip(self._parameters, ca.vertsplit(u, VELOCITIES), ca.vertsplit(acceleration, VELOCITIES), strict=True)
        return ca.vertcat(*(ca.vertcat(v[:3], _turning(e, v[3:]), a) for e, v, a in moved))

    def carrier(self, k: int) -> int:
        """The body, or ground, that a link's hinges hang on."""
        parent = self._tree.links[k].parent
        return parent if parent == GROUND or self._tree.links[parent].mass else self.carrier(parent)

    def constraints(self) -> Any:
        """A point of both bodies coincides; about a single hinge its axis stands still in the carrier."""
        ca, rows = self._ca, []
        for k in self.links:
            link, before = self._tree.links[k], self.carrier(k)
            origin = np.zeros(3) if before == GROUND else self._tree.links[before].centre
            rows.append(
                self._place[k] + self._turn[k] @ ca.SX(link.hinge - link.centre)
                - self._place[before] - self._turn[before] @ ca.SX(link.hinge - origin)
            )  # fmt: skip
            if before == link.parent:
                own = self._turn[k] @ ca.SX(link.axis)
                rows += [ca.dot(own, self._turn[before] @ ca.SX(across)) for across in _across(link.axis)]
        return ca.vertcat(*rows)

    def forces(self) -> tuple[Any, Any]:
        """Masses and inertias as one matrix, and the forces with the gyroscopic moments."""
        ca, blocks = self._ca, []
        pulls = {k: self._tree.links[k].mass * ca.SX(self._tree.gravity) for k in self.links}
        moments: dict[int, Any] = {}
        for k in self.links:
            inertia, w = ca.SX(self._tree.links[k].inertia), self._spin[k]
            blocks += [self._tree.links[k].mass * ca.SX.eye(3), inertia]
            moments[k] = -ca.cross(w, inertia @ w)
        for k in self.links:
            link, before = self._tree.links[k], self.carrier(k)
            axis = self._turn[k] @ ca.SX(link.axis)
            rate = ca.dot(axis, self._turn[k] @ self._spin[k] - self._turn[before] @ self._spin[before])
            torque = -link.damping * rate * axis
            moments[k] += self._turn[k].T @ torque
            if before != GROUND:
                moments[before] -= self._turn[before].T @ torque
        return ca.diagcat(*blocks), ca.vertcat(*(ca.vertcat(pulls[k], moments[k]) for k in self.links))


def _rotation(e: Any) -> Any:
    import casadi as ca

    return ca.SX.eye(3) + 2 * e[0] * ca.skew(e[1:]) + 2 * ca.skew(e[1:]) @ ca.skew(e[1:])


def _turning(e: Any, w: Any) -> Any:
    """The rates of Euler parameters."""
    import casadi as ca

    return 0.5 * ca.vertcat(-ca.dot(e[1:], w), e[0] * w + ca.cross(e[1:], w))


def _across(axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two directions perpendicular to a unit vector and to each other."""
    first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first /= np.linalg.norm(first)
    return first, np.cross(axis, first)


@dataclass(frozen=True)
class Motion:
    """Constraints, their rates, multipliers, and x' with these, where places move with their velocities."""

    bodies: Bodies
    C: Any
    rate: Any
    J: Any
    lam: Any
    acceleration: Any


def motion_of(tree: Tree) -> Motion:
    """Newton's and Euler's equations with multipliers."""
    import casadi as ca

    b = Bodies(tree)
    C = b.constraints()
    rate = ca.jtimes(C, b.x, b.rates(b.u, ca.SX.zeros(VELOCITIES * len(b.links))))
    J, lam = ca.jacobian(rate, b.x)[:, b.velocities], ca.SX.sym("lam", C.size1())
    mass, force = b.forces()
    return Motion(b, C, rate, J, lam, ca.solve(mass, force - J.T @ lam))


def index_1(tree: Tree) -> dict[str, Any]:
    """Accelerations' constraints with Baumgarte's stabilisation: z = lambda."""
    import casadi as ca

    m = motion_of(tree)
    b = m.bodies
    rates = b.rates(b.u, m.acceleration)
    closing = ca.jtimes(m.rate, b.x, rates) + 2 * BAUMGARTE * m.rate + BAUMGARTE**2 * m.C
    return {"t": ca.SX.sym("t"), "x": b.x, "z": m.lam, "ode": rates, "alg": closing}


def si2(tree: Tree) -> dict[str, Any]:
    """Gear, Gupta and Leimkuhler's index-2 form: z = (lambda, mu)."""
    import casadi as ca

    m = motion_of(tree)
    mu = ca.SX.sym("mu", m.C.size1())
    rates = m.bodies.rates(m.bodies.u - m.J.T @ mu, m.acceleration)
    return {
        "t": ca.SX.sym("t"), "x": m.bodies.x, "z": ca.vertcat(m.lam, mu), "ode": rates, "alg": ca.vertcat(m.C, m.rate),
    }  # fmt: skip


def at_start(tree: Tree) -> np.ndarray:
    """Places and velocities of all bodies at the start."""
    omega, velocity = tree.motion_at_start()
    rows = []
    for link, w, v in zip(tree.links, omega, velocity, strict=True):
        if link.mass:
            rows.append(np.r_[link.centre, 1.0, np.zeros(3), v + np.cross(w, link.centre - link.hinge), w])
    return np.concatenate(rows)


def consistent(tree: Tree, start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Multipliers and rates at the start, where places and velocities are consistent."""
    import casadi as ca
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import spsolve

    equations = index_1(tree)
    x, z = equations["x"], equations["z"]
    found = ca.Function("found", [x, z], [equations["ode"], equations["alg"], ca.jacobian(equations["alg"], z)])
    _, alg, slope = (np.asarray(part) for part in found(start, np.zeros(z.size1())))
    lam = np.atleast_1d(spsolve(csc_array(slope), -alg.ravel()))
    return lam, np.asarray(found(start, lam)[0]).ravel()


def integration(equations: dict[str, Any], tree: Tree, rtol: float) -> Solve:
    """Integrate over all output times, from multipliers that are consistent."""
    import casadi as ca

    start = at_start(tree)
    lam, rates = consistent(tree, start)
    z = np.concatenate([lam, np.zeros(equations["z"].size1() - len(lam))])
    tolerances = np.r_[np.full(len(start), rtol), np.full(len(z), OUT_OF_THE_TEST)]
    options = {
        "reltol": rtol, "abstolv": tolerances.tolist(), "max_num_steps": MOST_STEPS, "newton_scheme": "direct",
        "calc_ic": False, "init_xdot": rates.tolist(),
    }  # fmt: skip
    solver = ca.integrator("tree", "idas", equations, tree.times[0], tree.times[1:].tolist(), options)

    def solve() -> np.ndarray:
        try:
            found = np.asarray(solver(x0=start, z0=z)["xf"]).T
        except RuntimeError as error:
            raise Failed(str(error).splitlines()[-1]) from None
        rows = np.concatenate([start[None], found]).reshape(len(tree.times), -1, PER_BODY)
        return np.asarray(rows[..., :3].reshape(len(rows), -1))

    return solve
