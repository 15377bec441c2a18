"""Conversion of planar models and scenes to space."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from pathlib import Path
from typing import overload

from ..errors import InputError, prefixed
from ..model.embedding.formulas import Written
from ..model.embedding.scene import scene_in_space
from ..model.model import Model as PlanarModel
from ..model.model import PlanarData
from ..model.read_scene import made_scene
from ..model.scene import Scene
from ..model.spatial_model import Model
from ..model.spatial_scene import SpatialScene
from ..reading.files.text_file import source_name
from ..reading.files.yaml_text import scene_text
from .driven_turns import turns_of_drives, with_turns
from .load_scene import load_scene


@overload
def in_space(planar: PlanarModel) -> Model: ...


@overload
def in_space(planar: PlanarData) -> SpatialScene: ...


def in_space(planar: PlanarModel | PlanarData) -> Model | SpatialScene:
    """Convert a planar model or scene to space: in the x-y plane of the ground, element by element.

    A model built in Python becomes a model of this module, to which elements can be added; a scene becomes a scene.

    Names and numbers are kept.  Revolute joints rotate about z, prismatic joints slide along the axes of their markers,
    circles in contact become spheres.  The moments of inertia about x and y are set to that about z; they have no
    effect in the plane.  Bodies that no revolute, prismatic or fixed joint keeps in the plane get a `planar` joint,
    ``NAME_in_plane``.  The forces equal those in the plane; out-of-plane reactions of closed loops are not unique, as
    in any overconstrained mechanism.  In formulas ``bar.angle`` becomes ``az(bar, ground)`` and ``bar.omega`` becomes
    ``wz(bar)``.

    Parameters
    ----------
    planar : Model or Scene
        Planar model or scene.

    Returns
    -------
    Model or Scene
        Spatial model or scene.

    Raises
    ------
    InputError
        If the model is not planar, or has an element without a counterpart in space; the message names it.
    """
    if isinstance(planar, PlanarModel):
        return _built(planar)
    if isinstance(planar, PlanarData):
        return _embedded(planar)
    raise InputError(f"found {planar!r}, expected a planar Model or scene")


def _embedded(planar: PlanarData) -> SpatialScene:
    return _checked(scene_in_space(_in_driven_turns(planar)), planar.name or "in space")


def _in_driven_turns(planar: PlanarData) -> PlanarData:
    """Return the planar model in the turns of its drives, in which it starts."""
    if not isinstance(planar, Scene):
        return with_turns(planar, turns_of_drives(planar, None, 0.0))
    first = next(iter(planar.stage_scenes), planar)
    turns = turns_of_drives(first, None, first.run.start)
    found = with_turns(planar, turns)
    if turns:
        found._stage_scenes = tuple(with_turns(scene, turns) for scene in planar.stage_scenes)
    return found


def text_in_space(path: str | Path, changes: Sequence[tuple[str, str]] = ()) -> str:
    """Return a planar scene's file, with changed values, as spatial scene text; errors also as for `load_scene`."""
    planar = load_scene(path, changes)
    if not isinstance(planar, PlanarData):
        raise InputError(f"{source_name(path)}: found a scene in space, expected a planar one")
    with prefixed(f"{source_name(path)}: "):
        found = scene_in_space(_in_driven_turns(planar))
    _checked(copy.deepcopy(found), source_name(path))
    return scene_text(found)


def _checked(found: Written, source: str) -> SpatialScene:
    scene = made_scene(found, (), source, lambda path: None)
    assert isinstance(scene, SpatialScene)
    return scene


def _built(planar: PlanarModel) -> Model:
    """Return a spatial model with all elements of a planar model built in Python."""
    scene = _embedded(planar.data())
    model = Model(scene.name, scene.gravity)
    for section in ("markers", "bodies", "states", "inputs", "joints", "forces", "requests"):
        getattr(model, section).update(getattr(scene, section))
    return model
