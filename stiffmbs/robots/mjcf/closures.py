"""Equality constraints of a compiled MJCF model: closed loops and coupled joints."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ...elements.spatial.marker import ORIGIN
from ...elements.spatial.orientation import conjugate, product, rotated
from ..robot import Connection, Relation, RobotFault
from .fields import name_of


def relations(m: Any) -> Iterator[Relation]:
    """Yield the couplings of joints, and joints held by a constraint."""
    import mujoco

    for k in _active(m):
        if mujoco.mjtEq(m.eq_type[k]) == mujoco.mjtEq.mjEQ_JOINT:
            other = int(m.eq_obj2id[k])
            yield Relation(
                name_of(m, "equality", k),
                m.joint(int(m.eq_obj1id[k])).name,
                m.joint(other).name if other >= 0 else None,
                tuple(map(float, m.eq_data[k, :5])),
            )


def connections(m: Any) -> Iterator[Connection]:
    """Yield the loops closed by a point or rigidly."""
    import mujoco

    for k in _active(m):
        kind = mujoco.mjtEq(m.eq_type[k])
        if kind == mujoco.mjtEq.mjEQ_JOINT:
            continue
        if kind not in (mujoco.mjtEq.mjEQ_CONNECT, mujoco.mjtEq.mjEQ_WELD):
            raise RobotFault(
                f"equality {name_of(m, 'equality', k)}: found the kind {kind.name.split('_')[1].lower()}, expected connect, weld or joint"
            )
        yield _of_sites(m, k) if mujoco.mjtObj(m.eq_objtype[k]) == mujoco.mjtObj.mjOBJ_SITE else _of_bodies(m, k)


def _active(m: Any) -> Iterator[int]:
    return (k for k in range(m.neq) if m.eq_active0[k])


def _is_weld(m: Any, k: int) -> bool:
    import mujoco

    return bool(mujoco.mjtEq(m.eq_type[k]) == mujoco.mjtEq.mjEQ_WELD)


def _of_bodies(m: Any, k: int) -> Connection:
    """Return a connection: a weld fixes body 2 at a pose in body 1, otherwise two points coincide."""
    first, second = int(m.eq_obj1id[k]), int(m.eq_obj2id[k])
    data = [tuple(map(float, m.eq_data[k, a:b])) for a, b in ((0, 3), (3, 6), (6, 10))]
    if _is_weld(m, k):
        return Connection(name_of(m, "equality", k), _body(m, first), _body(m, second), data[1], ORIGIN, data[2])
    return Connection(name_of(m, "equality", k), _body(m, first), _body(m, second), data[0], data[1], None)


def _of_sites(m: Any, k: int) -> Connection:
    """Return a connection of the frames of two sites, or of their points."""
    a, b = int(m.eq_obj1id[k]), int(m.eq_obj2id[k])
    point, other_point = (tuple(map(float, m.site_pos[site])) for site in (a, b))
    link, other = (_body(m, int(m.site_bodyid[site])) for site in (a, b))
    if not _is_weld(m, k):
        return Connection(name_of(m, "equality", k), link, other, point, other_point, None)
    turned = product(m.site_quat[a], conjugate(m.site_quat[b]))
    origin = tuple(float(x) for x in point - rotated(turned, other_point))
    return Connection(name_of(m, "equality", k), link, other, origin, ORIGIN, turned)


def _body(m: Any, body: int) -> str | None:
    return name_of(m, "body", body) if body else None  # body 0 is the world
