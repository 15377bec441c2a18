"""Transform the markers and formulas of a body to another frame or another body."""

from __future__ import annotations

import ast
import copy
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from stiffmbs.elements.spatial.orientation import matrix
from stiffmbs.reading.formula.field import FormulaOf

from ..random_scenes.draft import GROUND, Content, about_z
from .formulas import call_of, coordinate_of, replaced, with_other_formulas
from .typed import Mapper, NotLegitimate, class_of, mapped

ORIGIN, CENTRE = "origin", "centre"


@dataclass(frozen=True)
class Frame:
    """Frame of a second description of a body, in the axes of the first.

    Attributes
    ----------
    body : str
        Of the other description.
    origin : ndarray, shape (3,)
    axes : ndarray, shape (3, 3)
        As columns.
    dimensions : int
    turn : float
        The angle of its axes in the plane, with the whole turns between the angles of the two descriptions.
    """

    body: str
    origin: np.ndarray
    axes: np.ndarray
    dimensions: int
    turn: float = 0.0

    def placement(self, marker: Content) -> Content:
        """Return the point and the axes of a marker in this frame."""
        n = self.dimensions
        point = self.axes.T @ (three(marker.get("point", [])) - self.origin)
        if n == 2:
            return {"point": point[:2].tolist(), "angle": marker.get("angle", 0.0) - self.turn}
        return {"point": point.tolist(), **turned(self.axes.T @ axes_of(marker), n)}


class Reframed(Mapper):
    """Mapping of markers and formulas to bodies in other frames.

    Parameters
    ----------
    frames : mapping of str to Frame
        Of the bodies whose markers move.
    replace : callable, optional
        Of formulas; they stay by default.
    """

    def __init__(self, frames: dict[str, Frame], replace: Callable[[ast.expr], str | None] | None = None) -> None:
        self._frames, self._replace = frames, replace

    def marker(self, value: Any) -> Any:
        """Return a marker on the other body."""
        found = {"body": value} if isinstance(value, str) else dict(value)
        frame = self._frames.get(found["body"])
        return value if frame is None else {"body": frame.body, **frame.placement(found)}

    def formula(self, value: Any, kind: FormulaOf, owner: Content) -> Any:
        """Return a formula in the channels of the other body."""
        return value if self._replace is None else replaced(value, self._replace)


def reframed(content: Content, frames: dict[str, Frame], others: Content) -> Content:
    """Return a scene with other bodies, and with transformed markers and formulas.

    Parameters
    ----------
    content : dict
        Of the scene.
    frames : dict of str to Frame
        Of the bodies that are described otherwise.
    others : dict
        Its bodies, without named markers.

    Raises
    ------
    NotLegitimate
        When a part or a drive names such a body.
    """
    named(content, frames)
    bodies = copy.deepcopy(others)
    for name, frame in frames.items():
        centre = content["bodies"][name].get("center_of_mass", [])
        markers = bodies[frame.body].setdefault("markers", {})
        markers[f"{ORIGIN}_{name}"] = frame.placement({})
        markers[f"{CENTRE}_{name}"] = frame.placement({"point": centre})
    replace = _replace(frames)
    found = {**with_other_formulas(copy.deepcopy(content), replace), "bodies": bodies}
    mapper, dimensions = Reframed(frames, replace), content.get("dimensions", 2)
    for section in ("joints", "forces"):
        for key, entry in content.get(section, {}).items():
            found[section][key] = mapped(entry, class_of(section, entry, dimensions), mapper)
    return found


def named(content: Content, bodies: Iterable[str]) -> None:
    """Raise NotLegitimate if a part or the drive of a coordinate names one of the bodies."""
    driven = {
        joint["coordinate"].partition(".")[0] for joint in content.get("joints", {}).values() if "coordinate" in joint
    }
    for name in bodies:
        if name in driven or any(name in part.values() for part in content.get("use", {}).values()):
            raise NotLegitimate(f"{name} is named by a part or a drive")


def _replace(frames: dict[str, Frame]) -> Callable[[ast.expr], str | None]:
    """Return the substitution for coordinates and measures of bodies in other frames."""

    def replace(node: ast.expr) -> str | None:
        """Return the measure that replaces a coordinate, or a measure of other markers; None to keep it."""
        coordinate, call = coordinate_of(node), call_of(node)
        if coordinate and coordinate[0] in frames:
            return _measure(coordinate[0], coordinate[1], frames[coordinate[0]])
        if call is None or call[0][0] in "ft":
            return None
        markers = [f"{frames[each].body}.{ORIGIN}_{each}" if each in frames else each for each in call[1]]
        return f"{call[0]}({', '.join(markers)})"

    return replace


def _measure(name: str, label: str, frame: Frame) -> str:
    """Return the measure that is equivalent to a body coordinate."""
    centre, own = f"{frame.body}.{CENTRE}_{name}", f"{frame.body}.{ORIGIN}_{name}"
    if label in ("x", "y", "z"):
        return f"d{label}({centre}, {GROUND})"
    if label in ("vx", "vy", "vz"):
        return f"{label}({centre}, {GROUND})"
    if label in ("wx", "wy", "wz"):
        return f"{label}({own}, {GROUND}, {own})"
    if label == "omega":
        return f"wz({own})"
    if label == "angle":
        return f"({frame.body}.angle - ({frame.turn!r}))"
    raise NotLegitimate(f"a formula of {name}.{label}")


def axes_of(marker: Content) -> np.ndarray:
    """Return the axes of a marker or body, given by an angle, a quaternion or a matrix."""
    if "angle" in marker:
        return about_z(marker["angle"])
    found = marker.get("orientation", np.eye(3))
    return matrix(found) if len(found) == 4 else np.array(found)


def turned(axes: np.ndarray, dimensions: int) -> Content:
    """Return axes as the field of a marker or body."""
    if dimensions == 3:
        return {"orientation": axes.tolist()}
    return {"angle": float(np.arctan2(axes[1, 0], axes[0, 0]))}


def three(components: Any) -> np.ndarray:
    """Return a vector with three components; an empty vector is zero."""
    return np.array([*components, 0.0, 0.0, 0.0][:3])


def tensor_of(body: Content) -> np.ndarray:
    """Return a body's inertia tensor about its centre of mass in body axes; only about z in the plane."""
    found = np.array(body["inertia"])
    return np.diag([0.0, 0.0, float(found)]) if found.ndim == 0 else np.diag(found) if found.ndim == 1 else found
