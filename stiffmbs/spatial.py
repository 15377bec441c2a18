"""Mechanisms in space: bodies, markers, joints and forces of three dimensions, used as those of `stiffmbs` are.

Examples
--------
>>> from stiffmbs.spatial import Body, Model, Spherical
>>> model = Model("top", gravity=(0, 0, -9.81))
>>> top = model.add("top", Body(mass=1, inertia=(0.03, 0.03, 0.01), omega=(0, 0, 100)))
>>> model.add("tip", Spherical(i=top.at(0, 0, -0.2), j="ground"))
"""

# ruff: noqa: F401 what is imported is offered
from typing import Any

from .describe.element import Force, Joint
from .describe.spatial.body import Body
from .describe.spatial.marker import Marker
from .describe.spatial.model import FORCES, JOINTS, Model
from .loaded_later import elements_of, loaded

_KINDS = JOINTS, FORCES
_LATER = {"in_space": ".jobs.in_space"}

_OFFERED = "Body", "Force", "Joint", "Marker", "Model", *_LATER


def __getattr__(name: str) -> Any:
    if name == "__all__":
        return [*_OFFERED, *elements_of(*_KINDS)]
    return loaded(name, __name__, _KINDS, _LATER)


def __dir__() -> list[str]:
    return sorted({*globals(), *_OFFERED, *elements_of(*_KINDS)})
