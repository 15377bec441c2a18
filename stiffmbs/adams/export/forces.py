"""Export of forces as Adams/Solver statements; z axes of joints that stay parallel."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from functools import singledispatchmethod

import numpy as np

from ...elements.element import Force
from ...elements.spatial.forces.applied import AppliedForce, AppliedTorque
from ...elements.spatial.forces.beam import Beam
from ...elements.spatial.forces.bushing import Bushing
from ...elements.spatial.forces.field import FieldForce
from ...elements.spatial.forces.line_force import LineForce
from ...elements.spatial.forces.spring_damper import SpringDamper
from ...elements.spatial.forces.torsion_spring import TorsionSpring
from ...elements.spatial.joints.cylindrical import Cylindrical
from ...elements.spatial.joints.fixed import Fixed
from ...elements.spatial.joints.orientation import Orientation
from ...elements.spatial.joints.parallel import Parallel
from ...elements.spatial.joints.planar import Planar
from ...elements.spatial.joints.prismatic import Prismatic
from ...elements.spatial.joints.revolute import Revolute
from ...elements.spatial.orientation import matrix
from ...model.spatial_model import SpatialData
from ...reading.marker import GROUND, MarkerReference
from ..statements.geometry import ROUNDING
from .formulas import Functions
from .numbering import Numbering, Refusal, number, numbers, statement

ABOUT_Z = (Cylindrical, Parallel, Planar, Revolute)
"""Joints that allow rotation about their z axis only."""
NO_ROTATION = (Fixed, Orientation, Prismatic)


def kept_parallel(scene: SpatialData, i: MarkerReference, j: MarkerReference) -> bool:
    """Return True if joints keep the z axes of two markers parallel, directly or through other bodies."""
    known = {i.body: _axes(scene, i)[:, 2]}
    left = [i.body]
    while left:
        body = left.pop()
        for joint in scene.joints.values():
            if not isinstance(joint, (*ABOUT_Z, *NO_ROTATION)) or body not in (joint.i.body, joint.j.body):
                continue
            own, other = (joint.i, joint.j) if joint.i.body == body else (joint.j, joint.i)
            axis = _axes(scene, own).T @ known[body]
            if other.body not in known and (isinstance(joint, NO_ROTATION) or np.hypot(axis[0], axis[1]) <= ROUNDING):
                known[other.body] = _axes(scene, other) @ axis
                left.append(other.body)
    return j.body in known and bool(np.linalg.norm(np.cross(known[j.body], _axes(scene, j)[:, 2])) <= ROUNDING)


def _axes(scene: SpatialData, marker: MarkerReference) -> np.ndarray:
    """Return the axes of a marker in the axes of its body as columns, shape (3, 3)."""
    return np.asarray(matrix(scene.place(marker).orientation))


class Forces:
    """Exporter of the forces of one scene."""

    def __init__(self, scene: SpatialData, numbering: Numbering, functions: Functions) -> None:
        self._scene, self._numbering, self._functions = scene, numbering, functions
        self._numbers = itertools.count(1)

    @singledispatchmethod
    def statements(self, force: Force) -> Iterator[str]:
        """Yield the statements of a force.

        Raises Refusal if Adams has no such force.
        """
        raise Refusal(f"found a force of the type {force.kind}, expected one that Adams has")

    @statements.register
    def _applied(self, force: AppliedForce | AppliedTorque) -> Iterator[str]:
        """Yield a VFORCE or VTORQUE along the axes of a marker; its floating marker takes the reaction."""
        of_force = isinstance(force, AppliedForce)
        components = force.force if isinstance(force, AppliedForce) else force.torque
        axes = force.i if force.axes == "body" else force.frame or MarkerReference(body=GROUND)
        other = self._numbering.floating(GROUND if force.j is None else force.j.body)
        names = ("FX", "FY", "FZ") if of_force else ("TX", "TY", "TZ")
        laws = [f"{name} = {self._functions.text(law)}\\" for name, law in zip(names, components, strict=True)]
        ends = f"I = {self._numbering.marker(force.i)}", f"JFLOAT = {other}", f"RM = {self._numbering.marker(axes)}"
        yield statement("VFORCE" if of_force else "VTORQUE", next(self._numbers), *ends, *laws)

    @statements.register
    def _line(self, force: LineForce) -> Iterator[str]:
        yield statement(
            "SFORCE",
            next(self._numbers),
            "TRANSLATIONAL",
            *self._numbering.ends(force),
            f"FUNCTION = {self._functions.text(force.force)}",
        )

    @statements.register
    def _spring(self, spring: SpringDamper | TorsionSpring) -> Iterator[str]:
        if isinstance(spring, SpringDamper):
            sort, free, names = "TRANSLATIONAL", spring.free_length, ("K", "C", "LENGTH", "FORCE")
        else:
            sort, free, names = "ROTATIONAL", spring.free_angle, ("KT", "CT", "ANGLE", "TORQUE")
        if spring.spring_law is None and spring.damper_law is None:
            given = dict(zip(names, (spring.stiffness, spring.damping, free, -spring.preload), strict=True))
            yield statement("SPRINGDAMPER", next(self._numbers), sort, *self._numbering.ends(spring), *_given(given))
            return
        if sort == "ROTATIONAL" and not kept_parallel(self._scene, spring.i, spring.j):
            raise Refusal(
                "found curves of a torsion spring between axes that no joints keep parallel, "
                "expected joints such as a revolute one about the same axis, or no curves"
            )
        yield self._by_laws(spring, free, sort)

    def _by_laws(self, spring: SpringDamper | TorsionSpring, free: float, sort: str) -> str:
        """Return an SFORCE of the deflection s and its rate v: -(k s + law(s) + c v + law(v) + preload)."""
        i, j = self._numbering.marker(spring.i), self._numbering.marker(spring.j)
        s, v = (f"DM({i},{j})", f"VR({i},{j})") if sort == "TRANSLATIONAL" else (f"AZ({i},{j})", f"WZ({i},{j},{j})")
        s = f"{s}-{number(free)}" if free else s
        terms = [f"{number(k)}*({x})" for k, x in ((spring.stiffness, s), (spring.damping, v)) if k]
        laws = ((spring.spring_law, s), (spring.damper_law, v))
        terms += [self._functions.text(law, x) for law, x in laws if law is not None]
        terms += [number(spring.preload)] if spring.preload else []
        return statement(
            "SFORCE", next(self._numbers), sort, *self._numbering.ends(spring), f"FUNCTION = -({'+'.join(terms)})"
        )

    @statements.register
    def _bushing(self, force: Bushing) -> Iterator[str]:
        for name in force.__class__.model_fields:
            if name.startswith("law_") and getattr(force, name) is not None:
                raise Refusal(f"found a {name} of a {force.kind}, expected numbers only, or a force with a formula")
        if force.axes != "j":
            raise Refusal("found a bushing with 'axes: ground', expected 'axes: j'")
        K, C = _filled(force.stiffness), _filled(force.damping)
        if any(np.any(matrix - np.diag(np.diag(matrix))) for matrix in (K, C)):
            raise Refusal("found a bushing that couples its directions, expected a field")
        given = {"K": np.diag(K)[:3], "KT": np.diag(K)[3:], "C": np.diag(C)[:3], "CT": np.diag(C)[3:]}
        given |= {"FORCE": _filled(force.preload)[:3], "TORQUE": _filled(force.preload)[3:]}
        yield statement("BUSHING", next(self._numbers), *self._numbering.ends(force), *_lists(given))

    @statements.register
    def _field(self, force: FieldForce) -> Iterator[str]:
        given = {"KMATRIX": _filled(force.stiffness).T.ravel(), "CMATRIX": _filled(force.damping).T.ravel()}
        given |= {"LENGTH": _filled(force.free), "FORCE": _filled(force.preload)}
        yield statement("FIELD", next(self._numbers), *self._numbering.ends(force), *_lists(given))

    @statements.register
    def _beam(self, force: Beam) -> Iterator[str]:
        given = {
            "LENGTH": force.length, "AREA": force.area, "IXX": force.torsion, "IYY": force.iyy, "IZZ": force.izz,
            "EMODULUS": force.young, "GMODULUS": force.shear_modulus, "ASY": force.asy, "ASZ": force.asz,
        }  # fmt: skip
        damping = [f"CRATIO = {number(force.damping_ratio)}"] if force.damping_ratio else []
        C = _filled(force.damping)
        if np.any(C):  # the lower triangle by columns
            if not np.array_equal(C, C.T):
                raise Refusal("found a damping matrix of a beam that is not symmetric, expected a symmetric one")
            damping = [f"CMATRIX = {numbers(C[np.triu_indices(6)])}"]
        yield statement("BEAM", next(self._numbers), *self._numbering.ends(force), *_given(given), *damping)


def _filled(values: object) -> np.ndarray:
    found: np.ndarray = np.array(values, dtype=float)
    return np.nan_to_num(found, nan=0.0)


def _given(values: Mapping[str, float | None]) -> list[str]:
    return [f"{name} = {number(value)}" for name, value in values.items() if value]


def _lists(values: dict[str, np.ndarray]) -> list[str]:
    return [f"{name} = {numbers(part)}" for name, part in values.items() if np.any(part)]
