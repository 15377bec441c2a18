"""Base of planar and spatial beams as scenes and Python describe them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field, field_validator, model_validator

from ...elements.body import LineBody, check_names
from ...errors import InputError, prefixed
from ...reading.fields import Measured
from ...reading.handle import Handles
from ...reading.units import si
from .axis import Piece, arc_through, pieces_through
from .division import ElementsField
from .section import AnySection, Material

Bending = Annotated[float, Measured("bending stiffness", above=0)]
InertiaPerLength = Annotated[float, Measured("inertia per length", above=0)]
MassPerLength = Annotated[float, Measured("mass per length", above=0)]


class BeamHandle(Handles):
    """Nodes of a beam in a model built in Python, by name and in order: ``strip.start``, ``strip["node1"]``."""

    what = "node"


class Beam(LineBody):
    """Base of planar and spatial beams: axis, cross section, material and number of elements."""

    dimensions: ClassVar[int]

    type: Literal["beam"] = "beam"
    elements: Annotated[Any, ElementsField()] = Field(
        description="number of elements; one for each interval between ends, corners and stations; auto; or {tolerance: 1 mm} of its position"
    )
    interpolation: Literal["pairs", "spectral"] = Field(
        "pairs", description="of the strain: constant between two nodes, or by polynomials through four or five nodes"
    )
    section: AnySection | None = Field(
        None, description="cross section: circle, tube, rectangle, i, l, u, numbers or points"
    )
    section_end: AnySection | None = Field(
        None, description="cross section at the end, if it varies linearly along the beam: of the same type"
    )
    material: Material | None = Field(None, description="E, nu, density")
    mass_per_length: MassPerLength | None = Field(None, description="in place of section and material, kg/m")
    damping: si.TimeOrZero = Field(0.0, description="viscous over elastic stiffness, s")
    stations: dict[str, si.PositiveLength] = Field(
        default_factory=dict, description="nodes along the length by name: distance from the start along the axis, m"
    )

    @field_validator("section", "section_end", mode="before")
    @classmethod
    def _drawn(cls, found: object) -> object:
        return {"type": "points", **found} if isinstance(found, dict) and "points" in found else found

    @field_validator("stations")
    @classmethod
    def _named(cls, stations: dict[str, float]) -> dict[str, float]:
        check_names(stations, "station")
        for name in stations:
            if "." in name or name in ("start", "end") or name.removeprefix("node").isdigit():
                raise ValueError(f"found the name '{name}', expected one other than start, end and node1, node2 ...")
        return stations

    @model_validator(mode="after")
    def _one_description(self) -> Any:
        direct = {name: getattr(self, name) for name in ("stiffness", "mass_per_length", "inertia_per_length")}  # type: ignore[attr-defined]
        given = {name: getattr(self, name) for name in ("section", "material")}
        if any(value is not None for value in direct.values()):
            both = [name for name, value in given.items() if value is not None]
            if both or self.section_end is not None:
                raise ValueError(
                    f"found both '{(both or ['section_end'])[0]}' and numbers of the section, expected one of them"
                )
            given = direct
        missing = next((name for name, value in given.items() if value is None), None)
        if missing is not None:
            raise ValueError(
                f"{missing}: found nothing, expected a value: a beam has 'section' and 'material', or 'stiffness', "
                "'mass_per_length' and 'inertia_per_length'"
            )
        if self.section_end is not None and self.section_end.type != self.section.type:  # type: ignore[union-attr]
            raise ValueError(
                f"section_end: found the type '{self.section_end.type}', expected '{self.section.type}' as at the start"  # type: ignore[union-attr]
            )
        if self.section_end is not None and self.section_end.type == "points":
            raise ValueError("section_end: found a drawn section, expected one whose numbers vary linearly")
        self.pieces()
        return self

    def add_to(self, model: Any, name: str) -> BeamHandle:
        """Add the nodes and elements to a model built in Python."""
        from .expanded import expanded

        if self.elements.tolerance is not None:
            raise InputError(
                f"{name}.elements: found a tolerance in a model built in Python, expected a number; only scenes take a tolerance"
            )
        with prefixed(f"{name}.", ValueError):
            made = expanded(name, self)
        for full, entry in made.bodies.items():
            model.add(full, model.body_type(**entry))
        for full, entry in made.forces.items():
            model.add(full, model.kinds[1][entry.pop("type")](**entry))
        return BeamHandle(
            name, {node.name: model.handle_type(f"{name}.{node.name}", model) for node in made.line.nodes}
        )

    def pieces(self) -> list[Piece]:
        """Return the pieces of the axis in space; ValueError unless exactly one of its forms gives it a length."""
        start, end, through, points = (getattr(self, name) for name in ("start", "end", "through", "points"))
        if points is not None:
            if start is not None or end is not None or through is not None:
                raise ValueError("found 'points' together with 'start', 'end' or 'through', expected one of them")
            where, axis = "points", [self._in_space(point) for point in points]
        elif start is None or end is None:
            raise ValueError(
                f"{'start' if start is None else 'end'}: found nothing, expected 'start' and 'end', or 'points'"
            )
        else:
            where = "through" if through else "end"
            axis = [self._in_space(point) for point in (start, through, end) if point is not None]
        with prefixed(f"{where}: ", ValueError, ValueError):
            return [arc_through(*axis)] if through is not None else pieces_through(axis)

    def _in_space(self, point: Sequence[float]) -> np.ndarray:
        return np.array([*point, 0.0][:3], dtype=float)
