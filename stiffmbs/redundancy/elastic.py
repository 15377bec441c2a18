"""Elastic support of bodies: the tangent stiffness of each force on each of its bodies at a pose."""

from __future__ import annotations

import numpy as np

from ..compile.group import Group
from ..compile.quaternions import rotated
from ..compile.state import State
from ..compile.system import System
from ..compile.terms import TERM_SETS
from .parameters import REDUNDANCY


def stiffnesses(state: State, t: float) -> dict[int, dict[str, np.ndarray]]:
    """Return the tangent stiffness -df/dq Z of each force against displacements of each body, by body and force.

    Weights, dampers, friction and open contacts have none.

    Parameters
    ----------
    state : State
        At the pose.
    t : float
        s.

    Returns
    -------
    dict of int to dict of str to ndarray, shape (n_u, n_u) of one body
        Angles and moments in the solver's axes; SI units.
    """
    system = state.system
    groups = [(g, group) for g, group in enumerate(system.groups) if group.entries["f_q"] and group.kind.element.kind]
    found: dict[int, dict[str, np.ndarray]] = {}
    if not groups:
        return found
    state.evaluate("tangent", t)
    at = 1 + TERM_SETS["tangent"].index("f_q")
    for g, group in groups:
        first, width = system.places["tangent"][g, at], group.entries["f_q"]
        values = state.values["tangent"][first : first + group.count * width].reshape(group.count, width)
        for e, k in zip(*np.nonzero(_acts(group, values) & (group.bodies < len(system.bodies))), strict=True):
            body = int(group.bodies[e, k])
            f_q = _block(group, values[e], k)
            found.setdefault(body, {})[group.names[e]] = -f_q @ _moves(state, body)
    return found


def _acts(group: Group, values: np.ndarray) -> np.ndarray:
    """Return a mask of the bodies against which each element is stiff, shape (count, bodies)."""
    slot = _own(group)
    return np.array([np.any(values[:, slot == k] != 0.0, axis=1) for k in range(group.kind.n_bodies)]).T


def _own(group: Group) -> np.ndarray:
    """Return the body slot of each entry of df/dq in which a body's force depends on its own coordinates, else -1."""
    row, column = np.array(group.record.patterns["f_q"]).T
    of_row, of_column = row // group.of_body.n_u, column // group.of_body.n_q
    return np.where(of_row == of_column, of_row, -1)


def _block(group: Group, values: np.ndarray, k: int) -> np.ndarray:
    """Return df/dq of one element for one of its bodies, shape (n_u, n_q)."""
    n_u, n_q = group.of_body.n_u, group.of_body.n_q
    own = _own(group) == k
    row, column = np.array(group.record.patterns["f_q"])[own].T
    block = np.zeros((n_u, n_q))
    block[row % n_u, column % n_q] = values[own]
    return block


def _moves(state: State, body: int) -> np.ndarray:
    """Return Z of one body, q' = Z u, shape (n_q, n_u)."""
    of_body = state.system.of_body
    q = state.q[of_body.n_q * body : of_body.n_q * (body + 1)]
    return np.array([of_body.position_rates(q, unit) for unit in np.eye(of_body.n_u)]).T


def held(stiffness: dict[str, np.ndarray], ways: np.ndarray, scale: np.ndarray) -> tuple[list[str], np.ndarray]:
    """Return the forces that are stiff against motions of a body, and the motions without stiffness.

    Parameters
    ----------
    stiffness : dict of str to ndarray
        Of each force, as from `stiffnesses`.
    ways : ndarray, shape (ways, n_u)
        Independent motions, in units of `scale`.
    scale : ndarray, shape (n_u,)
        Units of displacements, m and rad.
    """
    scaled = {name: scale[:, None] * K * scale for name, K in stiffness.items()}
    largest = max((np.abs(K).max() for K in scaled.values()), default=0.0)
    names = [name for name, K in scaled.items() if np.abs(K @ ways.T).max() > REDUNDANCY.stiffness_rounding * largest]
    if not names:
        return [], ways
    _, values, free = np.linalg.svd(sum(scaled[name] for name in names) @ ways.T)
    values = np.pad(values, (0, len(ways) - len(values)))
    return names, free[values <= REDUNDANCY.stiffness_rounding * largest] @ ways


def screwed(system: System, q: np.ndarray, body: int, twist: np.ndarray) -> np.ndarray:
    """Return coordinates after a motion of one body along a constant twist: a screw motion, in the plane a rotation.

    The centre moves by (I + (1 - cos theta)/theta^2 [w] + (theta - sin theta)/theta^3 [w]^2) v with theta = |w|: Lynch
    and Park, Modern Robotics, 2017, eq. 3.88.

    Parameters
    ----------
    twist : ndarray, shape (n_u,) of one body
        Velocity v of the centre of mass, m, and angular velocity w (in space in the body's axes), rad.
    """
    of_body = system.of_body
    v, w = np.zeros(3), np.zeros(3)
    v[: of_body.linear] = twist[: of_body.linear]
    own = q[of_body.n_q * body : of_body.n_q * (body + 1)]
    w[:] = rotated(own[3:], twist[3:]) if of_body.dimensions == 3 else (0.0, 0.0, twist[-1])
    theta = max(float(np.linalg.norm(w)), 1e-8)
    once = np.cross(w, v)
    shift = v + (1 - np.cos(theta)) / theta**2 * once + (theta - np.sin(theta)) / theta**3 * np.cross(w, once)
    step = np.zeros(system.n_u)
    first = of_body.n_u * body
    step[first : first + of_body.linear] = shift[: of_body.linear]
    step[first + of_body.linear : first + of_body.n_u] = twist[of_body.linear :]
    return of_body.moved(q, step)
