"""Scenes in space."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ..requests.names import OF_SPACE
from ..requests.output import Output
from ..requests.output_field import OutputField
from ..scene import Scene
from .model import SpatialData


class SpatialScene(SpatialData, Scene):
    """Scene in space."""

    variables: dict[str, Annotated[Output, OutputField(OF_SPACE)]] = Field(
        default_factory=dict, description="formulas by name, which other formulas use"
    )
