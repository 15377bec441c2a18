"""Conversion of a planar model or scene to a spatial scene."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from ...elements import shape as planar
from ...elements.body import Body
from ...elements.element import Element
from ...elements.shape import Shape
from ...errors import InputError, prefixed
from ...reading.marker import GROUND, MarkerReference, Placement
from ..files.stages import Stage, merge_patch
from ..model import PlanarData
from ..model_data import ModelData
from ..scene import Scene
from ..settings import SteadyMotion
from .elements import element_in_space
from .fields import plain
from .formulas import Angles, Written, placement, point, request, turned

ORDER = (
    "name", "dimensions", "parameters", "tables", "variables", "gravity", "markers", "bodies", "states", "inputs", "joints", "forces", "requests", "figure", "units", "start", "at_start", "run", "stages", "notes",
)  # fmt: skip
"""Sections of a converted scene, in the order of the file."""
OF_STAGES = ("name", "dimensions", "start", "at_start", "run", "notes")
"""Sections that a stage does not change."""
CHANNELS = {"omega": "wz", "alpha": "wdz", "torque": "tz"}
"""Spatial names of planar channels, if different."""


def scene_in_space(data: PlanarData) -> Written:
    """Return the spatial scene of a planar model in the x-y plane of the ground.

    Raises InputError for a section or an element without a spatial counterpart; the message names it.
    """
    _refuse_others(data)
    angles = Angles(data)
    written = _one_scene(data, angles)
    if isinstance(data, Scene) and data.stages:
        written |= {"stages": _stages(data, written, angles)}
    return {name: written[name] for name in ORDER if written.get(name)}


def _refuse_others(data: PlanarData) -> None:
    """Refuse sections that are not converted."""
    for name, field in type(data).model_fields.items():
        if name not in ORDER and getattr(data, name) != field.get_default(call_default_factory=True):
            raise InputError(f"{name}: found a section that has no counterpart in space, expected a scene without it")


def _stages(data: Scene, first: Written, angles: Angles) -> list[Written]:
    """Return the stages of a spatial scene, each with all of its changes from the one before."""
    stages: list[Written] = []
    before = {name: part for name, part in first.items() if part and name not in OF_STAGES}
    for stage, scene in zip(data.stages, data.stage_scenes, strict=True):
        assert isinstance(scene, PlanarData)
        found = _one_scene(scene, replace(angles, data=scene))
        found = {name: part for name, part in found.items() if part and name not in OF_STAGES}
        own = {name: part for name, part in stage.model_dump(exclude_defaults=True).items() if name != "change"}
        stages.append({**own, "change": merge_patch(before, found), "run": _run_of(stage, scene)})
        before = found
    return [{name: part for name, part in stage.items() if part} for stage in stages]


def _run_of(stage: Stage, scene: Scene) -> Written:
    """Return the settings of a stage, also those of the scene; without its duration if the stage ends otherwise."""
    settings = scene.run.model_dump(exclude_unset=True)
    if "duration" not in stage.run and (stage.end is not None or not stage.over_time):
        settings.pop("duration", None)
    return settings


def _one_scene(data: PlanarData, angles: Angles) -> Written:
    """Return the sections of a scene without its stages."""
    joints = _elements("joints", data.joints, angles)
    joints |= {_free(f"{body}_in_plane", data): {"type": "planar", "i": body, "j": GROUND} for body in loose(data)}
    requests: Written = {name: request(found, angles) for name, found in data.requests.items()}
    gravity = [*data.gravity, 0] if any(data.gravity) else None
    parts: Written = {"name": data.name, "dimensions": 3, "gravity": gravity, "joints": joints, "requests": requests}
    parts |= {name: plain(getattr(data, name), angles) for name in ("states", "inputs")}
    parts["forces"] = _elements("forces", data.forces, angles)
    if isinstance(data, Scene):
        parts |= {
            "parameters": data.written_parameters(),
            "tables": plain(data.tables, angles),
            "variables": {name: request(found, angles) for name, found in data.variables.items()},
            "figure": _figure(data, requests, angles),
            "units": dict(data.units),
            "start": _start(data.start),
            "at_start": _held_at_start(data, angles),
            "run": plain(data.run.model_dump(exclude_unset=True), angles),
            "notes": list(data.notes),
        }
    parts["bodies"] = {name: _body(name, body, angles) for name, body in data.bodies.items()}
    parts["markers"] = _markers(GROUND, data.markers, angles)
    return parts


def _held_at_start(data: Scene, angles: Angles) -> Written:
    """Return the joints that hold at the start alone."""
    held = next((scene.held_at_start for scene in (data, *data.stage_scenes) if scene.held_at_start), None)
    if held is None:
        return {}
    return _elements("at_start", {name: held.joints[name] for name in data.at_start}, angles)


def _start(start: str | SteadyMotion) -> str | Written | None:
    if isinstance(start, SteadyMotion):
        vectors = {name: [*getattr(start, name), 0] for name in ("velocity", "about") if getattr(start, name)}
        rotation = start.rotation if start.rotation == "found" else [0, 0, start.rotation]
        return {**vectors, "rotation": rotation, "rolling": list(start.rolling), "speed": start.speed}
    return start if start != Scene.model_fields["start"].default else None


def _body(name: str, body: Body, angles: Angles) -> Written:
    """Return a body with three equal moments of inertia; two of them have no effect in the plane."""
    parts: Written = {
        "mass": body.mass,
        "inertia": [body.inertia] * 3,
        "position": [*body.position, 0] if any(body.position) else None,
        **turned(body.angle),
        "velocity": [*body.velocity, 0] if any(body.velocity) else None,
        "omega": [0, 0, body.omega] if body.omega else None,
        "markers": _markers(name, body.markers, angles),
        "geometry": [shape(found) for found in body.geometry],
    }
    return {name: part for name, part in parts.items() if part}


def _markers(owner: str, own: Mapping[str, Placement], angles: Angles) -> Written:
    return {name: placement(placed) for name, placed in own.items()} | angles.added.get(owner, {})


def _elements(section: str, elements: Mapping[str, Element], angles: Angles) -> Written:
    found: Written = {}
    for name, element in elements.items():
        with prefixed(f"{section}.{name}: "):
            found[name] = element_in_space(element, replace(angles, later=name in angles.starts_later))
    return found


def _free(name: str, data: ModelData) -> str:
    while name in {*data.bodies, *data.states, *data.inputs, *data.joints, *data.forces, *data.requests}:
        name += "_"
    return name


def _figure(data: Scene, requests: Written, angles: Angles) -> Written | None:
    """Return the scene's figure; shown angles of bodies, which are not channels in space, are added to the requests."""
    if data.figure is None:
        return None
    figure = data.figure
    asked = set(data.outputs())
    names = {name: name if name in asked else _channel(name) for name in (figure.x, *figure.y)}
    for name, written in names.items():
        body, _, channel = name.rpartition(".")
        if channel == "angle" and name not in asked:
            names[name] = _free(written, data)
            requests[names[name]] = angles.measured(MarkerReference(body=body), MarkerReference(body=GROUND))
    over = {} if figure.x == "time" else {"x": names[figure.x]}
    return figure.model_dump(exclude_unset=True) | over | {"y": [names[name] for name in figure.y]}


def _channel(name: str) -> str:
    """Return the spatial channel that corresponds to a planar one."""
    owner, _, channel = name.rpartition(".")
    if channel == "angle":
        return f"{owner}_angle"
    return f"{owner}.{CHANNELS.get(channel, channel)}" if owner else name


def loose(data: PlanarData) -> Iterator[str]:
    """Yield one body of each group that is connected in a common plane, but not to the ground's plane."""
    independent_of = {body: body for body in (GROUND, *data.bodies)}
    for joint in data.joints.values():
        if joint.keeps_in_plane:
            one, other = (independent_of[marker.body] for _, marker in joint.parts(MarkerReference))
            kept, dropped = (other, one) if other == GROUND else (one, other)
            independent_of = {body: kept if own == dropped else own for body, own in independent_of.items()}
    yield from (body for body in data.bodies if independent_of[body] == body)


def shape(found: Shape) -> Written:
    """Return a shape of a spatial scene, whose depth is half its smaller width, centred on the plane."""
    written: Written = {"type": found.type}
    if found.color is not None:
        written["color"] = found.color
    match found:
        case planar.Polyline():
            closed = {"closed": True} if found.closed else {}
            return written | {"points": [[*place, 0] for place in found.points], **closed}
        case planar.Box():
            written["size"] = [*found.size, min(found.size) / 2]
        case planar.Cylinder():
            written |= {"radius": found.radius, "length": found.radius}
        case planar.Sphere():
            written["radius"] = found.radius
        case planar.Mesh():
            written |= {"file": found.file, "scale": list(found.scale)}
    assert isinstance(found, planar.Placed)
    return written | point(found.point) | turned(found.angle)
