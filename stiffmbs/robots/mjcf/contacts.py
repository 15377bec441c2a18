"""Contacts of a compiled MJCF model: pairs of geoms that MuJoCo lets touch, with their stiffness and friction."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import sqrt
from typing import Final

import numpy as np

from ...reading.files.quoted import listed
from ..contact import BOX, CAPSULE, CYLINDER, ELLIPSOID, SPHERE, Contact, PerMass, Shape, impeded, split
from ..robot import RobotFault
from .actuators import Disabled
from .fields import RequestedModel, name_of

LEAST_IMPEDANCE: Final = 1e-4
MOST_IMPEDANCE: Final = 0.9999
"""Bounds of impedances in MuJoCo."""
LEAST_SHARE: Final = 1e-15
"""Smallest weight of a geom in a mixture in MuJoCo."""
NAMES = {"hfield": "height field", "sdf": "signed distance field"}
"""Kinds of geoms in notes."""


def contacts(m: RequestedModel, disabled: Disabled) -> tuple[tuple[Contact, ...], list[str]]:
    """Return the contacts of a model, and notes on those without an equivalent in a scene."""
    if disabled("CONTACT", "CONSTRAINT"):
        return (), []
    shapes = [_shape(m, geom) for geom in range(m.ngeom)]
    stated = {_pair(*_stated(m, k)): k for k in range(m.npair)}
    numbers = {shape: geom for geom, shape in enumerate(shapes)}
    pairs = [*stated, *(pair for pair in _touching(m, disabled) if pair not in stated)]
    held, notes = split((shapes[first], shapes[second]) for first, second in pairs)
    found = []
    for first, second in held:
        pair = numbers[first], numbers[second]
        found.append(Contact(first, second, *(_of_pair(m, stated[pair]) if pair in stated else _mixed(m, *pair))))
    return tuple(found), notes + list(_rolling(m, {geom for pair in pairs for geom in pair}, stated.values()))


def _pair(first: int, second: int) -> tuple[int, int]:
    return min(first, second), max(first, second)


def _stated(m: RequestedModel, k: int) -> tuple[int, int]:
    return int(m.pair_geom1[k]), int(m.pair_geom2[k])


def _shape(m: RequestedModel, geom: int) -> Shape:
    import mujoco

    kind = mujoco.mjtGeom(m.geom_type[geom]).name.removeprefix("mjGEOM_").lower()
    a, b, c = map(float, m.geom_size[geom])
    sizes = {
        SPHERE: (a,),
        CAPSULE: (a, 2.0 * b),
        CYLINDER: (a, 2.0 * b),
        BOX: (2.0 * a, 2.0 * b, 2.0 * c),
        ELLIPSOID: (a, b, c),
    }
    body = int(m.geom_bodyid[geom])
    return Shape(
        name=name_of(m, "geom", geom),
        link=name_of(m, "body", body) if body else None,
        kind=NAMES.get(kind, kind),
        size=sizes.get(kind, ()),
        position=tuple(map(float, m.geom_pos[geom])),
        orientation=tuple(map(float, m.geom_quat[geom])),
    )


def _touching(m: RequestedModel, disabled: Disabled) -> Iterator[tuple[int, int]]:
    """Yield the pairs of geoms that may touch by their bits and bodies, the first of lower number."""
    kinds, affinities, bodies = m.geom_contype[:], m.geom_conaffinity[:], m.geom_bodyid[:]
    moving, parents = m.body_weldid[:][bodies], m.body_weldid[:][m.body_parentid[:][m.body_weldid[:][bodies]]]
    excluded = {int(m.exclude_signature[k]) for k in range(m.nexclude)}
    for first in range(m.ngeom):
        others = np.arange(first + 1, m.ngeom)
        allowed = (kinds[first] & affinities[others]) | (kinds[others] & affinities[first])
        allowed = (allowed != 0) & (moving[others] != moving[first])
        if not disabled("FILTERPARENT"):
            of_parent = (moving[first] == parents[others]) | (moving[others] == parents[first])
            allowed &= ~(of_parent & (moving[others] != 0) & (moving[first] != 0))
        for second in others[allowed]:
            low, high = sorted((int(bodies[first]), int(bodies[second])))
            if (low << 16) + high not in excluded:
                yield first, int(second)


def _of_pair(m: RequestedModel, k: int) -> tuple[PerMass, float, float]:
    """Return the stiffness, friction and margin of a stated pair."""
    friction = float(m.pair_friction[k][0]) if m.pair_dim[k] > 1 else 0.0
    return _softness(m.pair_solref[k], m.pair_solimp[k]), friction, float(m.pair_margin[k])


def _mixed(m: RequestedModel, first: int, second: int) -> tuple[PerMass, float, float]:
    """Return the stiffness, friction and margin of a pair by MuJoCo's rules: those of the geom with priority, or a mixture."""
    order = int(m.geom_priority[first]) - int(m.geom_priority[second])
    if order:
        geom = first if order > 0 else second
        solref, solimp = m.geom_solref[geom], m.geom_solimp[geom]
        dimensions, friction = m.geom_condim[geom], m.geom_friction[geom][0]
    else:
        share = _share(float(m.geom_solmix[first]), float(m.geom_solmix[second]))
        a, b = m.geom_solref[first], m.geom_solref[second]
        solref = share * a + (1.0 - share) * b if a[0] > 0 and b[0] > 0 else np.minimum(a, b)
        solimp = share * m.geom_solimp[first] + (1.0 - share) * m.geom_solimp[second]
        dimensions = max(m.geom_condim[first], m.geom_condim[second])
        friction = max(m.geom_friction[first][0], m.geom_friction[second][0])
    margin = float(m.geom_margin[first] + m.geom_margin[second])
    return _softness(solref, solimp), float(friction) if dimensions > 1 else 0.0, margin


def _share(a: float, b: float) -> float:
    """Return the weight of the first of two geoms in a mixture."""
    if a >= LEAST_SHARE and b >= LEAST_SHARE:
        return a / (a + b)
    return 0.5 if a < LEAST_SHARE and b < LEAST_SHARE else float(a >= LEAST_SHARE)


def _softness(solref: np.ndarray, solimp: np.ndarray) -> PerMass:
    """Return the spring and damper of a contact beyond the width of its impedance."""
    impedance = float(np.clip(solimp[1], LEAST_IMPEDANCE, MOST_IMPEDANCE))
    first, second = map(float, solref)
    if first > 0 and second > 0:
        return impeded(1.0 / (first * second), 2.0 / first, impedance)
    if first < 0 and second <= 0:
        return impeded(sqrt(-first), -second, impedance)
    raise RobotFault(
        f"found a contact with solref='{first:g} {second:g}', expected a time constant and a damping ratio above zero, or both numbers below zero"
    )


def _rolling(m: RequestedModel, geoms: Iterable[int], stated: Iterable[int]) -> Iterator[str]:
    names = [name_of(m, "geom", geom) for geom in sorted(geoms) if m.geom_condim[geom] > 3]
    names += [name_of(m, "pair", k) for k in stated if m.pair_dim[k] > 3]
    if names:
        yield f"contacts have no rolling and drilling friction: {listed(names)}"
