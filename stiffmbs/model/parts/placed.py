"""Placement of the instances of parts in a scene, with full names."""

from __future__ import annotations

import ast
import functools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError as PydanticError
from pydantic import create_model

from ...elements.body import AnyBody
from ...elements.element import Element
from ...elements.states.amount import stated_dimension
from ...elements.states.section import dimensions_of_entry, refuse_other_meanings
from ...errors import InputError
from ...reading.did_you_mean import did_you_mean
from ...reading.fields import Described, mapping, sentence
from ...reading.files.files_read import Context
from ...reading.files.yaml_text import Content
from ...reading.formula.dimension import Known
from ...reading.formula.full_names import with_full_names
from ...reading.formula.nodes import TAKERS
from ...reading.formula.text import parse
from ...reading.formula.variables import meant_within
from ...reading.marker import MarkerReference
from ...reading.names import GROUND, MOUNT, Names
from ...reading.units.units import Quantity, in_text
from ..beams.entries import names_in_formulas
from .as_described import AsDescribed
from .changes import Later
from .definitions import Definitions, shipped_parts
from .frame import Use
from .hard_points import check_left_and_right, check_sides
from .instances import Instance, Instances
from .mirrored import Mirror
from .placing import NAMED

if TYPE_CHECKING:
    from ..scene import Scene

SECTIONS = ("markers", *NAMED)


def with_parts(
    raw: dict[str, object], scene: type[Scene], context: Context, later: Later
) -> tuple[dict[str, object], dict[str, object]]:
    """Return a scene with its ``use`` expanded, and its validation context.

    The scene is as written, with repeated entries expanded; its type is that of the plane or of space. The context
    holds parameters, tables and variables. `later`: values set in instances of parts from outside. InputError if a part cannot be read or placed.
    """
    raw = {key: dict(value) if isinstance(value, dict) else value for key, value in raw.items()}
    parts, used = raw.pop("parts", None), raw.pop("use", None)
    instances = Instances(
        context,
        Definitions(parts, _frame_kind(scene)[0]),
        later,
        context["words"],
        scene.model_fields["dimensions"].default,
        names_in_formulas(raw),
    )
    if used is not None:
        instances.read(used, context["parameters"])
    instances.refuse_unknown_choices(context["choices"])
    for path in later.unused():
        places = [f"{section}.{name}" for one in instances.found for section in NAMED for name in one.names(section)]
        places += [f"{section}.{name}" for section in NAMED for name in _keys(raw.get(section))]
        places += [f"use.{one.name}.parameters" for one in instances.found]
        near = did_you_mean(path.rpartition(".")[0], places)
        raise InputError(f"--set {path}: found no such place in the scene{near}")
    bodies = [*_keys(raw.get("bodies")), *(name for one in instances.found for name in one.names("bodies"))]
    own: Any = raw.get("states")
    known = {name: context.get(name) or {} for name in ("parameters", "tables", "variables")}
    refuse_other_meanings("states", _keys(own), known)
    states: dict[str, Known] = {}
    for name in _keys(own):
        states |= dimensions_of_entry(name, own[name], context["parameters"])
    for one in instances.found:
        refuse_other_meanings(
            f"{one.where}.states", one.sections.get("states") or {}, {**known, "parameters": one.parameters}
        )
        entries = (one.sections.get("states") or {}).items()
        for name, entry in entries:
            states |= dimensions_of_entry(f"{one.name}.{name}", entry, one.parameters)
    given: Any = raw.get("inputs")
    refuse_other_meanings("inputs", _keys(given), {**known, "states": states})
    states |= {name: stated_dimension(given[name], context["parameters"]) for name in _keys(given)}
    names = Names(frozenset(bodies), states=states, inputs=frozenset(_keys(given)))
    variables = {name: with_full_names(tree, names, TAKERS) for name, tree in (context.get("variables") or {}).items()}
    context = {**context, "names": names, "variables": variables}
    placed = _Placed(raw, scene, context)
    for instance in instances.found:
        placed.add(instance)
    check_sides((one.name, one.wheel, *placed.mounts[one.name]) for one in instances.found if one.wheel is not None)
    return raw, {**context, "of_parts": AsDescribed(placed.described) if placed.described else None}


def _keys(found: object) -> list[str]:
    return [name for name in found if isinstance(name, str)] if isinstance(found, dict) else []


def _frame_kind(scene: type[Scene]) -> tuple[type[Use], type[Any]]:
    """Return the classes of a use and of a part's frame for planar or spatial scenes."""
    if scene.model_fields["dimensions"].default == 3:
        from .spatial_frame import SpatialFrame, SpatialUse

        return SpatialUse, SpatialFrame
    from .planar_frame import PlanarFrame, PlanarUse

    return PlanarUse, PlanarFrame


@functools.cache
def _sections(scene: type[Scene]) -> Any:
    """Return the class that validates the sections of a part like those of a scene."""
    fields: dict[str, Any] = {name: (scene.model_fields[name].annotation, {}) for name in SECTIONS}
    return create_model("Part", __base__=Described, **fields)


class _Values(Mapping[str, ast.expr]):
    """Parameters as numbers with units, parsed on access."""

    def __init__(self, found: Mapping[str, Quantity]) -> None:
        self._found = found

    def __getitem__(self, name: str) -> ast.expr:
        return parse(str(in_text(self._found[name])))

    def __iter__(self) -> Iterator[str]:
        return iter(self._found)

    def __len__(self) -> int:
        return len(self._found)


@dataclass
class _Placed:
    raw: Content
    scene: type[Scene]
    context: Context
    mounts: dict[str, tuple[str, Any]] = field(default_factory=dict)
    """Body that each instance is mounted on, and its frame in that body's axes."""
    described: dict[str, tuple[Instance, Mapping[str, Any]]] = field(default_factory=dict)
    """Instances with their sections before these are placed."""

    def add(self, instance: Instance) -> None:
        """Add all entries of an instance to the scene."""
        on, frame = self._mount(instance)
        self.mounts[instance.name] = on, frame
        in_ground = self._pose(on).then(frame)
        further, joints = self._further_mounts(instance, in_ground)
        mounts = {MOUNT: (on, frame), **further}
        for body, own_frame in mounts.values():
            self._add_markers(body, {instance.name: own_frame.placed(self.scene.origin)})
        local = instance.local() | {name: f"{body}.{instance.name}" for name, (body, _) in mounts.items()} | joints
        outside = self.context["parameters"]
        own = _Values({name: value for name, value in instance.parameters.items() if outside.get(name) != value})
        names = replace(self.context["names"], local=local, values=own, mounts=frozenset(mounts))
        for name, described in instance.flexible.items():
            self._add_flexible(instance, name, described, in_ground)
        found = self._read(instance, names)
        sections = {section: dict(getattr(found, section)) for section in SECTIONS}
        sections["bodies"] |= instance.flexible
        self.described[instance.name] = instance, sections
        if instance.part in shipped_parts():  # their frames have y to the left
            bodies = {name: body for name, (body, _) in further.items() if body != GROUND}
            to_left = in_ground.turned((0.0, 1.0, 0.0))
            check_left_and_right(
                f"use.{instance.name}", bodies, lambda body: self._body(body).coordinates()[:3], to_left
            )
        self._add_markers(on, {f"{instance.name}.{name}": frame.placed(x) for name, x in found.markers.items()})
        for name, body in found.bodies.items():
            self._put("bodies", instance, name, in_ground.placed_body(body))
        mirror = Mirror(instance.name, in_ground, found, tuple(mounts)) if -1.0 in frame.signs else None
        for section in ("joints", "forces"):
            for name, element in getattr(found, section).items():
                where = f"{instance.where}.{section}.{name}"
                moved = mirror.mirrored(element, where) if mirror else element
                self._put(section, instance, name, _on_mounts(moved, instance.name, mounts))
        for name, state in found.states.items():
            where = f"{instance.where}.states.{name}"
            self._put("states", instance, name, mirror.mirrored_state(state, where) if mirror else state)
        for name, request in found.requests.items():
            self._put("requests", instance, name, request)

    def _add_flexible(self, instance: Instance, name: str, described: Any, in_ground: Any) -> None:
        """Add the bodies and joints of a flexible body of an instance."""
        from ..flexible import bodies_and_joints, placed

        full, where = f"{instance.name}.{name}", f"{instance.where}.bodies.{name}"
        bodies, joints = bodies_and_joints(full, placed(described, in_ground), self.context, where)
        for section, made in (("bodies", bodies), ("joints", joints)):
            for own, value in made.items():
                self._put(section, instance, own.removeprefix(f"{instance.name}."), value)

    def _read(self, instance: Instance, names: Names) -> Any:
        variables = meant_within(self.context["variables"], instance.parameters, self.context["parameters"])
        context = {**self.context, "parameters": instance.parameters, "names": names, "variables": variables}
        try:
            return _sections(self.scene).model_validate(dict(instance.sections), context=context)
        except PydanticError as error:
            raise InputError(f"{instance.where}.{sentence(error)} (in {instance.name})") from None

    def _mount(self, instance: Instance) -> tuple[str, Any]:
        """Return the body that an instance is mounted on, and its frame in that body's axes."""
        own, outer = _frame_kind(self.scene)[1].of_use(instance.use), instance.outer
        on = instance.use.on
        if outer is None:
            on = on or GROUND
            if on != GROUND and on not in self._entries("bodies"):
                raise InputError(
                    f"use.{instance.name}.on: found '{on}', expected ground, a body of the scene, or one of a part above"
                )
            return on, own
        mount, frame = self.mounts[outer.name]
        if on in (None, MOUNT):
            return mount, frame.then(own)
        body = Names(local=outer.local()).full(str(on))
        if body not in self.raw["bodies"] or not body.startswith(f"{outer.name}."):
            raise InputError(
                f"{outer.where}.use.{instance.name.removeprefix(outer.name + '.')}.on: found '{on}', expected mount, a body of "
                "the part, or one of a part above"
            )
        return body, frame.mirror().then(own)

    def _further_mounts(
        self, instance: Instance, in_ground: object
    ) -> tuple[dict[str, tuple[str, object]], dict[str, str]]:
        """Return what else an instance connects to by local name: bodies with the part's frame in their axes, and joints."""
        inside = Names(local=instance.outer.local()) if instance.outer else Names()
        found, joints = {}, {}
        for name, given in instance.mounts.items():
            body = self._named(given, instance, inside)
            if body in (self.raw.get("joints") or {}):
                joints[name] = body
                continue
            if body != GROUND and body not in self._entries("bodies"):
                raise InputError(
                    f"use.{instance.name}.mounts.{name}: found '{given}', expected mount, ground, a body or joint of the scene, or one "
                    "of a part above"
                )
            found[name] = body, self._pose(body).inverse().then(in_ground)
        return found, joints

    def _named(self, given: str, instance: Instance, inside: Names) -> str:
        if given == MOUNT:
            return self.mounts[instance.name][0]
        if instance.outer and given in instance.outer.mounts:
            outer = instance.outer
            return self._named(outer.mounts[given], outer, Names(local=outer.outer.local()) if outer.outer else Names())
        return inside.full(given)

    def _pose(self, on: str) -> Any:
        frame = _frame_kind(self.scene)[1]
        return frame() if on == GROUND else frame.of_body(self._body(on))

    def _body(self, name: str) -> AnyBody:
        try:
            found = _sections(self.scene).model_validate(
                {"bodies": {name: self.raw["bodies"][name]}}, context=self.context
            )
        except PydanticError as error:
            raise InputError(sentence(error)) from None
        self.raw["bodies"][name] = found.bodies[name]
        return found.bodies[name]

    def _add_markers(self, on: str, markers: Mapping[str, object]) -> None:
        if on == GROUND:
            self._entries("markers").update(markers)
            return
        body = self._body(on)
        self.raw["bodies"][on] = body.model_copy(update={"markers": {**body.markers, **markers}})

    def _put(self, section: str, instance: Instance, name: str, value: object) -> None:
        full, entries = f"{instance.name}.{name}", self._entries(section)
        if full in entries:
            raise InputError(f"{section}.{full}: found a name that a part makes too, expected another")
        entries[full] = value

    def _entries(self, section: str) -> dict[str, object]:
        """Return a section of the scene, to which parts add entries."""
        if self.raw.get(section) is None:
            self.raw[section] = {}
        return mapping(self.raw[section], section)


def _on_mounts(element: Element, name: str, mounts: Mapping[str, tuple[str, object]]) -> Element:
    """Return an element of a part with its markers on local mounts moved to the mounted bodies."""
    moved = {}
    for field_name in type(element).model_fields:
        value = getattr(element, field_name)
        if isinstance(value, MarkerReference) and value.body in mounts:
            moved[field_name] = _marker_on(value, name, *mounts[value.body])
    return element.model_copy(update=moved) if moved else element


def _marker_on(marker: MarkerReference, name: str, on: str, frame: Any) -> MarkerReference:
    if marker.marker is not None:
        return marker.model_copy(update={"body": on, "marker": f"{name}.{marker.marker}"})
    if marker.placement() is None:
        return marker.model_copy(update={"body": on, "marker": name})
    return frame.placed(marker).model_copy(update={"body": on})  # type: ignore[no-any-return]
