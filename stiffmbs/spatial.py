"""Spatial mechanisms: bodies, markers, joints and forces in three dimensions, used like those of `stiffmbs`.

Examples
--------
>>> from stiffmbs.spatial import Body, Model, Spherical
>>> model = Model("top", gravity=(0, 0, -9.81))
>>> top = model.add("top", Body(mass=1, inertia=(0.03, 0.03, 0.01), omega=(0, 0, 100)))
>>> model.add("tip", Spherical(i=top.at(0, 0, -0.2), j="ground"))
"""

from typing import Any

from .loaded_later import elements_of, loaded

_MODEL = ".describe.spatial.model"
_LATER = {
    "Body": ".describe.spatial.body", "Force": ".describe.element", "Joint": ".describe.element", "Marker": ".describe.spatial.marker",
    "Model": _MODEL, "in_space": ".analyses.in_space",
}  # fmt: skip


def __getattr__(name: str) -> Any:
    if name == "__all__":
        return [*_LATER, *elements_of(_MODEL)]
    return loaded(name, __name__, _MODEL, _LATER)


def __dir__() -> list[str]:
    return sorted({*globals(), *_LATER, *elements_of(_MODEL)})
