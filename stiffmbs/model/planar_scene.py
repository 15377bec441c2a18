"""Scenes in the plane."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ..elements.requests.names import OF_PLANE
from ..elements.requests.output import Output
from ..elements.requests.output_field import output_field
from .model import PlanarData
from .scene import Scene


class PlanarScene(PlanarData, Scene):
    """Scene in the plane."""

    variables: dict[str, Annotated[Output, output_field(OF_PLANE)]] = Field(
        default_factory=dict, description="formulas by name, which other formulas use"
    )
