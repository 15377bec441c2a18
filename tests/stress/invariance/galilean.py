"""Observe a scene from a frame with constant velocity: its ground becomes a driven body."""

from __future__ import annotations

import ast
import copy
from typing import Any

import numpy as np

from stiffmbs.elements.spatial.orientation import from_matrix
from stiffmbs.reading.formula.field import FormulaOf

from ..random_scenes.draft import GROUND, Content, axes_with_z
from .change import VECTORS, Change, Channels, vector, with_vector
from .formulas import call_of, coordinate_of, replaced, with_other_formulas
from .typed import Mapper, NotLegitimate, class_of, has_road, mapped

CARRIER = "carrier"


def moving(content: Content, velocity: np.ndarray) -> Change:
    """Return the scene on a carrier with a given velocity, shape (3,).

    Raises
    ------
    NotLegitimate
        When the scene has parts.
    """
    dimensions = content.get("dimensions", 2)
    if "use" in content:
        raise NotLegitimate("the bodies of parts have velocities of their own")
    replace = _replace(velocity, dimensions)
    mapper = _OnCarrier(replace)
    found = with_other_formulas(copy.deepcopy(content), replace)
    for body in found["bodies"].values():
        own = body.get("velocity", [0.0] * dimensions)
        body["velocity"] = [a + float(b) for a, b in zip(own, velocity, strict=False)]
    for section in ("joints", "forces"):
        for name, entry in found.get(section, {}).items():
            described = class_of(section, entry, dimensions)
            found[section][name] = mapped(entry, described, mapper)
            if has_road(described):
                found[section][name].setdefault("j", CARRIER)
    _add_carrier(found, velocity, dimensions)
    return Change(
        f"observed from a frame with the velocity {velocity.round(3).tolist()}",
        found,
        lambda c, t: _back(c, t, velocity),
    )


class _OnCarrier(Mapper):
    def __init__(self, replace: Any) -> None:
        self._replace = replace

    def formula(self, value: Any, kind: FormulaOf, owner: Content) -> Any:
        return replaced(value, self._replace)

    def marker(self, value: Any) -> Any:
        if value == GROUND:
            return CARRIER
        return {**value, "body": CARRIER} if isinstance(value, dict) and value["body"] == GROUND else value


def _add_carrier(content: Content, velocity: np.ndarray, dimensions: int) -> None:
    speed = float(np.linalg.norm(velocity))
    inertia: Any = [1.0, 1.0, 1.0] if dimensions == 3 else 1.0
    content["bodies"][CARRIER] = {
        "mass": 1.0,
        "inertia": inertia,
        "velocity": [float(part) for part in velocity[:dimensions]],
    }
    along: Content = (
        {"orientation": [float(part) for part in from_matrix(axes_with_z(velocity))]}
        if dimensions == 3
        else {"angle": float(np.arctan2(velocity[1], velocity[0]))}
    )
    joints = content.setdefault("joints", {})
    joints["carried_along"] = {"type": "prismatic", "i": {"body": CARRIER, **along}, "j": {"body": GROUND, **along}}
    joints["carried_at"] = {"type": "drive", "joint": "carried_along", "position": f"{speed!r}*t"}


def _replace(velocity: np.ndarray, dimensions: int) -> Any:
    """Return the substitution for coordinates and measures relative to the ground."""
    axes = "xyz"[:dimensions]

    def replace(node: ast.expr) -> str | None:
        """Return the text of a coordinate or measure relative to the moving ground; None to keep it."""
        coordinate, call = coordinate_of(node), call_of(node)
        if coordinate:
            body, name = coordinate
            if name in axes:
                return f"({body}.{name} - ({float(velocity[axes.index(name)])!r})*t)"
            if name[0] == "v" and name[1:] in axes:
                return f"({body}.{name} - ({float(velocity[axes.index(name[1:])])!r}))"
            return None
        if call is None or call[0][0] in "ft":
            return None
        name, markers = call
        markers = [CARRIER if marker == GROUND else marker for marker in markers]
        return f"{name}({', '.join(markers + [CARRIER] * (len(markers) == 1))})"

    return replace


def _back(channels: Channels, time: np.ndarray, velocity: np.ndarray) -> Channels:
    """Return channels relative to the carrier, without the kinetic energy."""
    found = {name: series for name, series in channels.items() if not name.startswith(("energy.", "carrie"))}
    for owner in dict.fromkeys(name.rpartition(".")[0] for name in found):
        places, rates = (vector(channels, owner, VECTORS[kind]) for kind in ("{}", "v{}"))
        if places is not None:
            with_vector(found, owner, VECTORS["{}"], places - velocity[:, None] * time)
        if rates is not None:
            with_vector(found, owner, VECTORS["v{}"], rates - velocity[:, None])
    return found
