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

_KINDS = ".elements.spatial.spatial_kinds"
_LATER = {
    "BeamBody": ".model.beams.spatial", "Body": ".elements.spatial.body", "Force": ".elements.element", "Joint": ".elements.element", "Marker": ".elements.spatial.marker",
    "FlexibleBody": ".model.flexible", "SurfaceLoad": ".model.surface_loads", "Model": ".model.spatial_model", "in_space": ".analyses.in_space",
}  # fmt: skip


def __getattr__(name: str) -> Any:
    if name == "__all__":
        return [*_LATER, *elements_of(_KINDS)]
    return loaded(name, __name__, _KINDS, _LATER)


def __dir__() -> list[str]:
    return sorted({*globals(), *_LATER, *elements_of(_KINDS)})
