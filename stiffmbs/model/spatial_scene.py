"""Scenes in space."""

from __future__ import annotations

from collections.abc import Collection
from typing import Annotated

from pydantic import Field

from ..elements.requests.names import OF_SPACE
from ..elements.requests.output import Output
from ..elements.requests.output_field import output_field
from .paths.section import OF_COURSE, Path
from .scene import Scene
from .spatial_model import SpatialData
from .vehicle import Vehicle


class SpatialScene(SpatialData, Scene):
    """Scene in space."""

    variables: dict[str, Annotated[Output, output_field(OF_SPACE)]] = Field(
        default_factory=dict, description="formulas by name, which other formulas use"
    )
    path: Path | None = Field(None, description="the course that a driver follows")
    vehicle: Vehicle | None = Field(
        None, description="the sprung body, whose motion is reported in the axes of ISO 8855"
    )

    def continued_tables(self) -> Collection[str]:
        """Return the names of the tables of the path, which goes on straight."""
        return OF_COURSE if self.path else ()
