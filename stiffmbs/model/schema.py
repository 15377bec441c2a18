"""JSON schema of scene files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..elements.body import SURFACE_LOAD
from ..elements.body import Body as PlanarBody
from ..elements.planar_kinds import FORCES, JOINTS
from ..reading.fields import Described
from .beams.entries import LOAD, MOVING
from .parts.definitions import KEYS
from .parts.options import CHOOSE, OPTIONS
from .parts.parameters import LIMITS
from .parts.planar_frame import PlanarUse
from .planar_scene import PlanarScene

if TYPE_CHECKING:
    from pydantic.json_schema import JsonSchemaValue


def scene_schema() -> dict[str, object]:
    """Return the JSON schema of planar and spatial scene files.

    Returns
    -------
    dict
        For editors; ``stiffmbs schema`` prints it.
    """
    from pydantic.json_schema import models_json_schema

    from ..elements.spatial.body import Body as SpatialBody
    from ..elements.spatial.spatial_kinds import FORCES as SPATIAL_FORCES
    from ..elements.spatial.spatial_kinds import JOINTS as SPATIAL_JOINTS
    from .beams.loads import DistributedLoad, MovingLoad
    from .beams.planar import BeamBody as PlanarBeam
    from .beams.spatial import BeamBody as SpatialBeam
    from .parts.spatial_frame import SpatialUse
    from .spatial_scene import SpatialScene
    from .surface_loads import SurfaceLoad

    planar: list[type[Described]] = [
        PlanarBody,
        PlanarBeam,
        DistributedLoad,
        MovingLoad,
        *JOINTS.values(),
        *FORCES.values(),
    ]
    spatial: list[type[Described]] = [SpatialBody, SpatialBeam, DistributedLoad, MovingLoad, SurfaceLoad]
    spatial += [*SPATIAL_JOINTS.values(), *SPATIAL_FORCES.values()]
    scenes: list[type[Described]] = [PlanarScene, SpatialScene]
    uses: list[type[Described]] = [PlanarUse, SpatialUse]
    found, schema = models_json_schema([(part, "validation") for part in (*scenes, *planar, *spatial, *uses)])
    loop = {"type": "string", "description": "repeat this entry: 'k in 1..N'; k and {k} are replaced in it"}
    for part in dict.fromkeys((*planar, *spatial, *uses)):
        name = found[part, "validation"]["$ref"].rpartition("/")[2]
        schema["$defs"][name]["properties"]["for"] = loop
    for scene, beam in ((PlanarScene, PlanarBeam), (SpatialScene, SpatialBeam)):
        whole = schema["$defs"][found[scene, "validation"]["$ref"].rpartition("/")[2]]
        contact = schema["$defs"]["Contact" if beam is PlanarBeam else "SphereContact"]
        loads = {kind: found[load, "validation"] for kind, load in ((LOAD, DistributedLoad), (MOVING, MovingLoad))}
        _add_beams(whole["properties"], found[beam, "validation"], loads, contact)
        if scene is SpatialScene:
            forces, load = whole["properties"]["forces"]["additionalProperties"], found[SurfaceLoad, "validation"]
            forces["oneOf"].append(load)
            forces["discriminator"]["mapping"][SURFACE_LOAD] = load["$ref"]
    for scene, use in ((PlanarScene, PlanarUse), (SpatialScene, SpatialUse)):
        _add_parts(schema["$defs"], found[scene, "validation"], found[use, "validation"])
    in_plane, in_space = (found[scene, "validation"] for scene in scenes)
    three = {"properties": {"dimensions": {"const": 3}}, "required": ["dimensions"]}
    return {"if": three, "then": in_space, "else": in_plane, "$defs": schema["$defs"]}


def _add_beams(
    properties: JsonSchemaValue, beam: dict[str, object], loads: dict[str, JsonSchemaValue], contact: JsonSchemaValue
) -> None:
    """Add line bodies, loads and contacts of beams to the sections of a scene."""
    bodies, forces = properties["bodies"], properties["forces"]["additionalProperties"]
    bodies["additionalProperties"] = {"anyOf": [bodies["additionalProperties"], {**beam, "required": ["type"]}]}
    named = {**contact["properties"], "type": {"const": "beam_contact"}, "beam": {"type": "string"}}
    named.pop("i")
    required = [key for key in contact["required"] if key != "i"]
    forces["oneOf"] += [*loads.values(), {**contact, "properties": named, "required": [*required, "type", "beam"]}]
    forces["discriminator"]["mapping"] |= {kind: load["$ref"] for kind, load in loads.items()}


def _add_parts(definitions: JsonSchemaValue, scene: JsonSchemaValue, use: JsonSchemaValue) -> None:
    """Add ``include``, ``parts`` and ``use`` to the schema of a scene, which then does not require bodies."""
    whole = definitions[scene["$ref"].rpartition("/")[2]]
    name = {"type": "string"}
    include = {
        "anyOf": [name, {"type": "array", "items": name}],
        "description": "files whose sections are merged with those of this file, relative to its folder",
    }
    placed = definitions[use["$ref"].rpartition("/")[2]]
    placed["additionalProperties"] = {"type": "string", "description": "a word that the part offers"}
    used = _by_name(use, "parts in their places, by name")
    branches = _by_name({"type": ["object", "null"]})
    options = _by_name(branches, "alternative sections: choice, alternative, sections")
    own = {key: whole["properties"][key] for key in KEYS if key in whole["properties"]}
    number = {"anyOf": [{"type": "number"}, name]}
    vector = {"type": "array", "items": number, "minItems": 2, "maxItems": 3, "description": "a point or a direction"}
    own["parameters"] = _by_name({"anyOf": [*number["anyOf"], vector]})
    mounts = _by_name(name, "further bodies that the part connects to, with their defaults")
    limits = _by_name({"enum": [*LIMITS]}, "limits of parameters, by name")
    own = {"include": include, "use": used, "mounts": mounts, "limits": limits, OPTIONS: options, **own}
    part = {"type": "object", "additionalProperties": False, "properties": own}
    placing = {
        "type": "object",
        "properties": {"use": name, **{key: found for key, found in placed["properties"].items() if key != "part"}},
        "required": ["use"],
        "additionalProperties": placed["additionalProperties"],
    }
    described = "definitions of parts, by name; or instances, with `use` for the name of a part"
    parts = _by_name({"anyOf": [part, placing]}, described)
    chosen = _by_name(name, "the selected alternative of each choice of the scene or its parts")
    whole["properties"] |= {"include": include, "parts": parts, "use": used, OPTIONS: options, CHOOSE: chosen}
    whole["required"] = [key for key in whole["required"] if key != "bodies"]
    if not whole["required"]:
        del whole["required"]
    whole["anyOf"] = [{"required": [key]} for key in ("bodies", "include", "use", "parts")]


def _by_name(values: JsonSchemaValue, description: str = "") -> JsonSchemaValue:
    """Return the schema of a mapping of names to some values."""
    described = {"description": description} if description else {}
    return {"type": "object", "additionalProperties": values, **described}
