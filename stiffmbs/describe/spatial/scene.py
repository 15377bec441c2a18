"""Scenes in space."""

from __future__ import annotations

from ..scene import Scene
from .model import SpatialData


class SpatialScene(SpatialData, Scene):
    """A scene in space."""
