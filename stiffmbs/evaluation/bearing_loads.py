"""Driving angle of a run, and loads in the axes of the bodies on which they act."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..analyses.job import Runnable, data_of
from ..compile.bodies import QUATERNION
from ..compile.quaternions import CONJUGATE, rotated
from ..elements.element import Element
from ..elements.joints.drive import Drive
from ..elements.turns import TURN
from ..errors import InputError
from ..model.scene import Scene
from ..reading.marker import GROUND
from ..results.solution import Solution
from .loads import Load
from .parameters import EVALUATION


@dataclass(frozen=True, eq=False)
class DrivingAngle:
    """Angle of a driven joint that turns in one direction, over its last revolution.

    Attributes
    ----------
    joint : str
        Name of the joint.
    rows : ndarray of int
        Output instants of the last revolution, in the order of time.
    degrees : ndarray
        Angle at these, from 0 to 360 deg, in the order of `rows`.
    """

    joint: str
    rows: np.ndarray
    degrees: np.ndarray

    @property
    def order(self) -> np.ndarray:
        """Return the output instants by their angle."""
        return self.rows[np.argsort(self.degrees, kind="stable")]

    @property
    def sorted_degrees(self) -> np.ndarray:
        """Return the angles in increasing order, deg."""
        return np.sort(self.degrees, kind="stable")


def driving_angle(model: Runnable, solution: Solution) -> DrivingAngle | None:
    """Return the angle of the first drive that turns its joint once or more in one direction; None if there is none.

    Parameters
    ----------
    model : Model, Scene or path
        The model of the solution.
    solution : Solution
        Result of a run.

    Examples
    --------
    >>> import stiffmbs
    >>> crank = stiffmbs.run("examples/crank_slider.yaml")
    >>> angle = stiffmbs.driving_angle("examples/crank_slider.yaml", crank)
    >>> pin = stiffmbs.loads(crank)[0]
    >>> over_the_angle = angle.sorted_degrees, pin.magnitude[angle.order]
    """
    for element in _elements(model).values():
        joint = _joint_of(element)
        channel = f"{joint}.angle"
        if element.kind != Drive.kind or channel not in solution.channels:
            continue
        angle = solution.channels[channel]
        steps = np.diff(angle)
        if (
            np.isfinite(angle).all()
            and abs(angle[-1] - angle[0]) >= TURN * (1 - EVALUATION.missing_turn)
            and (np.all(steps >= 0) or np.all(steps <= 0))
        ):
            rows = np.flatnonzero(np.abs(angle - angle[-1]) <= TURN * (1 + EVALUATION.missing_turn))
            return DrivingAngle(joint, rows, np.degrees(angle[rows]) % 360.0)
    return None


def in_body_axes(model: Runnable, solution: Solution, load: Load) -> dict[str, np.ndarray]:
    """Return the load on each body of a joint or force element in the axes of that body.

    A force that stays in one direction of a body loads one side of its bearing; one that goes around loads all of it.

    Parameters
    ----------
    model : Model, Scene or path
        The model of the solution.
    solution : Solution
        Result of a run.
    load : Load
        One of `stiffmbs.loads` of that solution.

    Returns
    -------
    dict of str to ndarray
        The components of `load` by body, that of the first marker first. The load on the second one has the opposite sign.
        A drive or friction in a joint acts on the bodies of that joint. A gear or an equation has no two bodies: the result
        is empty.

    Raises
    ------
    InputError
        If the model has no such element.
    """
    elements = _elements(model)
    element = elements.get(load.element)
    if element is None:
        raise InputError(f"model: found no joint or force '{load.element}', expected the model of the solution")
    element = elements.get(_joint_of(element), element)
    bodies = [getattr(getattr(element, end, None), "body", "") for end in ("i", "j")]
    return {
        body: _in_axes_of(body, solution, sign * load.components)
        for sign, body in zip((1.0, -1.0), bodies, strict=True)
        if body
    }


def _elements(model: Runnable) -> dict[str, Element]:
    """Return the joints and forces of a model, in all its stages."""
    data = data_of(model)
    stages = data.stage_scenes if isinstance(data, Scene) else ()
    return {name: element for each in (data, *stages) for name, element in (*each.joints.items(), *each.forces.items())}


def _joint_of(element: Element) -> str:
    """Return the name of the joint in which an element acts, as a drive does; empty if there is none."""
    return str(getattr(getattr(element, "joint", None), "joint", ""))


def _in_axes_of(body: str, solution: Solution, components: np.ndarray) -> np.ndarray:
    """Return vectors in the axes of a body; a torque in the plane has the same value there."""
    if body == GROUND or components.shape[1] == 1:
        return components
    if components.shape[1] == 3:
        orientation = np.column_stack([solution.channels[f"{body}.{label}"] for label in QUATERNION])
        return rotated(CONJUGATE * orientation, components)
    angle, (fx, fy) = solution.channels[f"{body}.angle"], components.T
    return np.column_stack([fx * np.cos(angle) + fy * np.sin(angle), fy * np.cos(angle) - fx * np.sin(angle)])
