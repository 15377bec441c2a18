"""Scenes in space."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ..scene import Scene
from .model import SpatialData
from .output import Output, check_output
from .output_field import OutputField


class SpatialScene(SpatialData, Scene):
    """A scene in space."""

    variables: dict[str, Annotated[Output, OutputField()]] = Field(
        default_factory=dict, description="formulas by name, which other formulas use"
    )

    def check_requests(self) -> None:
        super().check_requests()
        for name, output in self.variables.items():
            check_output(f"variables.{name}", output, self)
