"""Planar models and scenes in space."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from pathlib import Path

from ..describe.files.scene_text import scene_text
from ..describe.files.text_file import source_name
from ..describe.model import PlanarData
from ..describe.model_builder import ModelBuilder
from ..describe.scene import made_scene
from ..describe.spatial.embedding.markers import Written
from ..describe.spatial.embedding.scene import scene_in_space
from ..describe.spatial.model import Model
from ..describe.spatial.scene import SpatialScene
from ..errors import InputError
from .load_scene import load_scene


def embedded(planar: PlanarData) -> SpatialScene:
    """The scene in space of a planar model or scene; see `stiffmbs.spatial.in_space`."""
    return _checked(scene_in_space(planar), planar.name or "in space")


def text_in_space(path: str | Path, changes: Sequence[tuple[str, str]] = ()) -> str:
    """The text of the scene in space of a planar scene's file, some values changed; errors as for `load_scene` too."""
    planar = load_scene(path, changes)
    if not isinstance(planar, PlanarData):
        raise InputError(f"{source_name(path)}: found a scene in space, expected a planar one")
    try:
        found = scene_in_space(planar)
    except InputError as error:
        raise InputError(f"{source_name(path)}: {error}") from None
    _checked(copy.deepcopy(found), source_name(path))
    return scene_text(found)


def _checked(found: Written, source: str) -> SpatialScene:
    scene = made_scene(found, (), source, lambda path: None)
    assert isinstance(scene, SpatialScene)
    return scene


def built(planar: ModelBuilder, model: Model) -> Model:
    """A model in space, at first empty, with all that a planar one built in Python has; errors as for `embedded`."""
    scene = embedded(planar.data())
    model.name, model.gravity = scene.name, scene.gravity
    for section in ("markers", "bodies", "joints", "forces", "requests"):
        getattr(model, section).update(getattr(scene, section))
    return model
