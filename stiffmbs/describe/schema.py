"""The JSON schema of scene files."""

from __future__ import annotations

from typing import Any

from .body import Body as PlanarBody
from .model import FORCES, JOINTS
from .scene import PlanarScene


def scene_schema() -> dict[str, Any]:
    """The JSON schema of scene files, of the plane and of space.

    Returns
    -------
    dict
        For editors, as ``stiffmbs schema`` prints it.
    """
    from pydantic.json_schema import models_json_schema

    from .spatial.body import Body as SpatialBody
    from .spatial.model import FORCES as SPATIAL_FORCES
    from .spatial.model import JOINTS as SPATIAL_JOINTS
    from .spatial.scene import SpatialScene

    planar: list[type[Any]] = [PlanarBody, *JOINTS.values(), *FORCES.values()]
    spatial: list[type[Any]] = [SpatialBody, *SPATIAL_JOINTS.values(), *SPATIAL_FORCES.values()]
    scenes: list[type[Any]] = [PlanarScene, SpatialScene]
    found, schema = models_json_schema([(part, "validation") for part in (*scenes, *planar, *spatial)])
    loop = {"type": "string", "description": "repeat this entry: 'k in 1..N'; k and {k} are replaced in it"}
    for part in dict.fromkeys((*planar, *spatial)):
        name = found[part, "validation"]["$ref"].rpartition("/")[2]
        schema["$defs"][name]["properties"]["for"] = loop
    in_plane, in_space = (found[scene, "validation"] for scene in scenes)
    three = {"properties": {"dimensions": {"const": 3}}, "required": ["dimensions"]}
    return {"if": three, "then": in_space, "else": in_plane, "$defs": schema["$defs"]}
