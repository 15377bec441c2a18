"""Modes that stay at rest: those that leave the plane of a mechanism that moves in a plane.

A mechanism that is its own mirror image about a plane stays so: the solution of its equations is unique. Its bodies then
move in the plane, and modes whose shapes are antisymmetric have no load. Each body, joint and force must be its own
mirror image (`stiffmbs.elements.element.Element.symmetric_with`); any other element keeps all modes. Magnitudes of
forces in the plane do not matter, so formulas may be of any quantity.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ..compile.system import System
from ..elements.element import Element
from ..elements.spatial.flexible.bodies import AXES_HELD, UNUSED_HELD, FloatingFrame
from ..elements.spatial.flexible.interface import FlexibleInterface
from ..elements.spatial.flexible.layout import parts
from ..elements.spatial.marker import Marker
from ..elements.spatial.orientation import matrix
from ..model.model_data import ModelData
from ..reading.formula.formula import Formula
from ..reading.joint_name import JointName
from ..reading.marker import GROUND, MarkerReference
from .relations import PRESOLVE

AXES = "xyz"
PLACES, HALF = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]]), np.repeat([1.0, 0.5], 3)
"""Entries of a symmetric matrix in the layout of a flexible body, and their factors."""


def modes_at_rest(model: ModelData, system: System, q: np.ndarray, u: np.ndarray) -> dict[str, tuple[int, ...]]:
    """Return the modal coordinates that stay zero, as axes of the bodies that carry them.

    They are zero at the start, up to rounding; symmetric shapes may be deformed. `system`: of the whole model. `q`, `u`: its
    state at the start.
    """
    for normal in range(3):
        found = _Mirror(model, system, q, u, normal).modes()
        if found:
            return found
    return {}


class _Mirror:
    """Reflection at the plane through the first floating frame whose normal is an axis of the ground."""

    def __init__(self, model: ModelData, system: System, q: np.ndarray, u: np.ndarray, normal: int) -> None:
        self._model, self._normal = model, normal
        self._signs = np.where(np.arange(3) == normal, -1.0, 1.0)
        count = len(system.bodies)
        places, rates = q[: system.n_pose].reshape(count, -1), u.reshape(count, -1)
        self._pose = {
            name: (place[:3], np.array(matrix(tuple(place[3:]))), rate)
            for name, place, rate in zip(system.bodies, places, rates, strict=True)
        }
        self._frames = {name: body for name, body in model.bodies.items() if isinstance(body, FloatingFrame)}
        self._modal = {modal for frame in self._frames.values() for modal in frame.modes}
        self._offset = self._pose[next(iter(self._frames))][0][normal]
        self._size, self._speed = model.size(), np.abs(u).max(initial=0.0)

    def modes(self) -> dict[str, tuple[int, ...]]:
        """Return the modal coordinates of antisymmetric shapes; none unless the whole mechanism is symmetric."""
        if not (self._zero(self._model.gravity[self._normal], 1.0) and self._keeps_bodies() and self._keeps_elements()):
            return {}
        found: dict[str, tuple[int, ...]] = {}
        for name, frame in self._frames.items():
            signs = self._signs_of_modes(name, frame)
            if signs is None:
                return {}
            for modal, of_modal in zip(frame.modes, signs.reshape(-1, 3), strict=True):
                axes, (place, _, rate) = np.flatnonzero(of_modal < 0), self._pose[modal]
                if not (self._zero(place[axes], self._size) and self._zero(rate[axes], self._speed)):
                    return {}
                found |= {modal: tuple(axes.tolist())} if len(axes) else {}
        return found

    def _zero(self, value: Any, scale: float) -> bool:
        return bool(np.abs(value).max(initial=0.0) <= PRESOLVE.at_rest * scale)

    def _keeps_bodies(self) -> bool:
        """Return True if centres of mass and motions are in the plane, and products of inertia with its normal are zero."""
        across = np.delete(np.arange(3), self._normal)
        for name, body in self._model.bodies.items():
            place, turn, rate = self._pose[name]
            if name in self._modal:
                continue
            moments = np.array(body.principal_moments())
            products = (turn * moments @ turn.T)[self._normal, across]
            turning = (turn @ rate[3:])[across]
            in_plane = self._zero(place[self._normal] - self._offset, self._size)
            slow = self._zero([rate[self._normal], *turning], self._speed)
            if not (in_plane and slow and self._zero(products, moments.max())):
                return False
        return True

    def _keeps_elements(self) -> bool:
        """Return True if all joints and forces are symmetric; those that come with flexible bodies are."""
        own = {name.format(modal) for modal in self._modal for name in (AXES_HELD, UNUSED_HELD)}
        joints = (joint for name, joint in self._model.joints.items() if name not in own)
        return all(
            isinstance(element, FlexibleInterface) or self._keeps(element)
            for element in (*joints, *self._model.forces.values())
        )

    def _keeps(self, element: Element) -> bool:
        conditions = element.symmetric_with
        if conditions is None or any(marker.body in self._modal for _, marker in element.parts(MarkerReference)):
            return False
        for field, marker in element.parts(MarkerReference):
            condition = conditions.get(field, "axes")
            point, axes = self._placed(marker)
            in_plane = condition in ("body", "along z") or self._zero(point[self._normal] - self._offset, self._size)
            seen = {"body": (), "point": (), "axes": (0, 1, 2)}.get(condition, (2,))
            if not (in_plane and all(self._sign(axes[:, k]) for k in seen)):
                return False
        return all(self._keeps_value(element, field, rule) for field, rule in (element.reflected or {}).items())

    def _placed(self, marker: MarkerReference) -> tuple[np.ndarray, np.ndarray]:
        """Return the point and the axes of a marker in ground axes."""
        body, on = self._model.carried(marker)
        point, axes = np.array(on.point), np.array(matrix(on.orientation))
        if body == GROUND:
            return point, axes
        place, turn, _ = self._pose[body]
        return place + turn @ point, turn @ axes

    def _sign(self, direction: np.ndarray) -> float:
        """Return -1 for a direction along the normal, 1 for one in the plane and 0 for any other."""
        if self._zero(np.delete(direction, self._normal), 1.0):
            return -1.0
        return 1.0 if self._zero(direction[self._normal], 1.0) else 0.0

    def _keeps_value(self, element: Any, field: str, rule: str) -> bool:
        """Return True if a field of `Element.reflected` has no antisymmetric components."""
        value = getattr(element, field)
        if value is None:
            return True
        if rule == "joint":
            return self._keeps_coordinate(element.joint)
        forces = self._signs_of_axes(self._axes(element))
        match rule:
            case "vector":
                return _even(value, forces)
            case "rotations":
                return _even(value, -forces)
        turns = -self._signs_of_axes(self._placed(element.j)[1])
        signs = np.concatenate([forces, turns])
        match rule:
            case "components":
                return _even(value, signs)
            case "matrix":
                return all(_even(row, sign * signs) for row, sign in zip(value, signs, strict=True))
            case "x" | "y" | "z":
                return bool(forces[AXES.index(rule)] > 0)
            case "about x" | "about y" | "about z":
                return bool(turns[AXES.index(rule[-1])] > 0)
        return False

    def _axes(self, element: Any) -> np.ndarray:
        """Return the axes of an element's force as columns, in ground axes."""
        frame, axes = getattr(element, "frame", None), element.axes
        if isinstance(frame, Marker):
            return self._placed(frame)[1]
        return np.eye(3) if axes == "ground" else self._placed(element.j if axes == "j" else element.i)[1]

    def _signs_of_axes(self, axes: np.ndarray) -> np.ndarray:
        return np.array([self._sign(axis) for axis in axes.T])

    def _keeps_coordinate(self, name: JointName | None) -> bool:
        """Return True if the coordinate of a joint is an angle about the normal or a displacement in the plane."""
        if name is None:
            return False
        joint = self._model.joints[name.joint]
        if joint.symmetric_with is None or not hasattr(joint, "j"):
            return False
        sign = self._sign(self._placed(joint.j)[1][:, 2])
        return bool(sign == (-1.0 if name.coordinate_of(joint) == "angle" else 1.0))

    def _signs_of_modes(self, name: str, frame: FloatingFrame) -> np.ndarray | None:
        """Return 1 for symmetric and -1 for antisymmetric shapes; None if any mode is neither."""
        terms = list(self._terms(name, frame))
        odd, even = np.zeros(3 * len(frame.modes)), np.zeros(3 * len(frame.modes))
        for values, signs in terms:
            if values.ndim == 2:
                odd = np.maximum(odd, np.abs(values[:, signs < 0]).max(axis=1, initial=0.0))
                even = np.maximum(even, np.abs(values[:, signs > 0]).max(axis=1, initial=0.0))
        of_modes = np.where(odd > even, -1.0, 1.0)
        for values, signs in terms:
            for _ in range(values.ndim - 1):
                signs = np.multiply.outer(of_modes, signs)
            if not self._zero(values[signs < 0], 1.0):
                return None
        return of_modes

    def _terms(self, name: str, frame: FloatingFrame) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Yield the numbers of a flexible body relative to a scale, with components in ground axes, and their signs.

        The last axis has the components, those before it are of modes. A sign is that of a component in a reflection
        of the body without modes, or with symmetric ones.
        """
        n, flip = 3 * len(frame.modes), self._signs
        own, turn = parts(frame.numbers.array, n), self._pose[name][1]
        mass = float(own["modal_mass"][0])
        length = float(np.sqrt(own["moments"].max() / mass))
        vectors = [("d0", mass * length), ("S", mass), ("T", mass / length)]
        axials = [("Y_axial", mass * length), ("axial", mass), ("of_Z", mass)]
        matrices = [("X", mass * length**2), ("Y_symmetric", mass * length), ("symmetric", mass)]
        found = [(own[key] @ turn.T, flip, scale) for key, scale in vectors]
        found += [(own[key] @ turn.T, -flip, scale) for key, scale in axials]
        for key, scale in matrices:
            both = (own[key] * HALF)[..., PLACES]
            turned = np.einsum("ia,jb,...ab->...ij", turn, turn, both)
            found.append((turned.reshape(*turned.shape[:-2], 9), np.outer(flip, flip).ravel(), scale))
        for joint in self._model.joints.values():
            if isinstance(joint, FlexibleInterface) and joint.i.body == name:
                axes = self._placed(joint.i)[1]
                found.append((np.reshape(joint.displacements, (n, 3)) @ axes.T, flip, 1.0))
                found.append((np.reshape(joint.rotations, (n, 3)) @ axes.T, -flip, 1 / length))
        stretch = np.einsum("ik,ilm->klm", own["static"], own["Gamma"])
        scalars = [(own["mass"], mass), (stretch, 1 / length)]
        scalars += [(between, np.abs(between).max() or 1.0) for between in own["coupling"]]
        found += [(values[..., None], np.ones(1), scale) for values, scale in scalars]
        for values, signs, scale in found:
            yield values / max(scale, np.abs(values).max(initial=0.0)), signs


def _even(components: Sequence[object], signs: np.ndarray) -> bool:
    """Return True if all components with another sign than 1 are zero."""
    return all(sign > 0 or _is_zero(component) for sign, component in zip(signs.tolist(), components, strict=True))


def _is_zero(component: object) -> bool:
    """Return True for the number zero, for nothing and for the formula 0."""
    if isinstance(component, Formula):
        tree = getattr(component.tree, "body", component.tree)
        component = tree.value if isinstance(tree, ast.Constant) else component
    return component is None or component == 0
