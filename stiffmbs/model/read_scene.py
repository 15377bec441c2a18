"""Reading of scenes: from the text of a file to a valid scene, or a message with the line of a fault."""

from __future__ import annotations

import ast
import copy
from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

from pydantic import ValidationError as PydanticError

from ..elements.body import is_flexible, is_surface_load
from ..elements.roads.field import read_roads
from ..errors import InputError, prefixed
from ..reading.did_you_mean import did_you_mean
from ..reading.fields import is_valid, named_entries, sentence
from ..reading.files.files_read import FOLDER, record, recorded
from ..reading.files.include import read_including
from ..reading.files.own_sources import own_sources
from ..reading.files.quoted import written
from ..reading.files.unchanged import Unchanged
from ..reading.files.yaml_text import Content, read_yaml
from ..reading.formula.nodes import TIME
from ..reading.formula.text import UNIT, FormulaError
from ..reading.formula.variables import resolved
from ..reading.names import beginnings
from ..reading.units.units import CONSTANTS, UNITS, Quantity, in_units
from .beams.division import beams_read
from .beams.entries import names_in_formulas, with_beams
from .files import expand
from .files.effective import chosen_options, keep_one_grid
from .files.stages import AT_START, with_held, written_stages
from .files.written_scene import WrittenScene
from .model_data import STARTS_LATER
from .parts.changes import REPEATED, Later, refuse_unused_of_parts, set_later, set_now
from .parts.placed import with_parts
from .parts.placing import NAMED, as_written, placed_in_use
from .scene import Scene, scene_class

Changes = Sequence[tuple[str, object]]
"""Values by their paths."""
LineOf = Callable[[tuple[object, ...]], int | str | None]
"""Function that returns the line in the source of a path of keys."""
NO_FILES: Mapping[str, str] = MappingProxyType({})
OF_ENTRIES = (*NAMED, "use", "roads", "tables", "inputs")
"""Sections whose keys are names of entries."""


def read_scene(
    text: str, changes: Sequence[tuple[str, str]] = (), source: str = "scene", file: Path | None = None
) -> Scene:
    """Read a scene from text.

    Parameters
    ----------
    text : str
        YAML, as in a scene file.
    changes : sequence of (path, text)
        Values that replace those of the text, such as ``("bodies.cart.mass", "12 kg")``.
    source : str
        Name of the scene in messages.
    file : Path, optional
        File of the text; included files are relative to its folder, or to the working folder if it is None.

    Returns
    -------
    Scene

    Raises
    ------
    InputError
        If it is not a valid scene; the message contains the line and the path.
    """
    with recorded() as files:
        found, line = read_including(text, source, file)
    if found is None:
        raise InputError(f"{source}: found an empty scene, expected at least 'bodies'")
    if not isinstance(found, dict):
        kind = "a list" if isinstance(found, list) else "text without keys"
        raise InputError(f"{source}: found {kind}, expected a scene: YAML with 'bodies', as stiffmbs init writes it")
    return made_scene(found, changes, source, line, file.parent if file else None, files=files)


def made_scene(
    found: dict[str, object],
    changes: Changes,
    source: str,
    line_of: LineOf,
    folder: Path | None = None,
    unchanged: Unchanged | None = None,
    files: Mapping[str, str] = NO_FILES,
    starts_later: frozenset[str] = frozenset(),
) -> Scene:
    """Return the scene described by a mapping, which is modified in place; InputError if the scene is not valid.

    The changes are values by their paths; those that are not text are used unchanged. `source` names the scene in
    messages, and `line_of` returns the line in it of a path of keys. Meshes and property files are found in the folder,
    by default the working folder. `unchanged` holds parts that have been validated before; the scene then keeps its source
    only if joints hold at its start. `files` are digests of the files from which the mapping was read. `starts_later`: joints and forces that
    are not checked in the described pose.
    """
    of_files = dict(files), starts_later
    holds = AT_START in found or any(path.partition(".")[0] == AT_START for path, _ in changes)
    is_kept = holds or not unchanged
    kept = WrittenScene(copy.deepcopy(found), tuple(changes), source, folder, *of_files) if is_kept else None
    with recorded() as read, beams_read() as beams:
        scene = _made_scene(found, changes, source, line_of, folder, unchanged or Unchanged(), kept, starts_later)
        record(own_sources(scene))
    scene._beams = beams
    if kept:
        kept.files.update(read)
    return scene


def read_changed(written: WrittenScene, changes: Changes, unchanged: Unchanged | None = None) -> Scene:
    """Read a scene with other values, without what was validated before; errors as for `made_scene`."""
    content = copy.deepcopy(dict(written.content))
    return made_scene(
        content, (*written.changes, *changes), written.source, lambda _: None, written.folder, unchanged,
        starts_later=written.starts_later,
    )  # fmt: skip


def _made_scene(
    found: dict[str, object], changes: Changes, source: str, line_of: LineOf, folder: Path | None,
    known: Unchanged, kept: WrittenScene | None, starts_later: frozenset[str],
) -> Scene:  # fmt: skip
    found, chosen, changes = chosen_options(expand.unshared(found), changes, source)
    parts = found.get("parts")
    found, changes = placed_in_use(found, changes)
    expand.refuse_unused_parameters(found, changes, (*Scene.model_fields, "vehicle", "path"))
    refuse_unused_of_parts(found, changes)
    replaced = expand.replaced_parameters(found, changes)
    names = {section: tuple(part) if isinstance(part := found.get(section), dict) else () for section in OF_ENTRIES}
    later, own = [], []
    for path, value in changes:
        read = read_yaml(value, f"--set {path}") if isinstance(value, str) else value
        if set_later(path, found):
            later.append((path, read))
        else:
            set_now(found, path, read)
            own.append(path)
    keep_one_grid(found, {path for path, _ in changes})
    try:
        others = {**chosen, FOLDER: folder, STARTS_LATER: starts_later}
        scene = _validated(found, replaced, Later(later), others, known)
    except _Located as error:
        message = as_written(str(error), parts)
        there = error.path if message == str(error) else ("parts", *error.path[1:])
        where = _place(error.path, changes, lambda _: line_of(there))
        raise InputError(f"{source}, {_unknown_entry(error.path, own, names)}{where}{message}") from None
    scene._written, scene._validated = kept, known
    if scene.stages:
        scene._stage_scenes = _stage_scenes(scene, source)
    elif scene.at_start:
        scene._held_at_start = _held_at_start(scene, source)
    return scene


def _stage_scenes(scene: Scene, source: str) -> tuple[Scene, ...]:
    """Return the scene of each stage; errors as for `made_scene`."""
    if scene.written is None:
        raise InputError(f"{source}: found stages, expected a scene of one run")
    with prefixed(f"{source}, "):
        stages = written_stages(scene.written, scene.stages)
    return tuple(
        _stage_scene(stage, scene.stages[k].removed, f"{source}, stages.{k}") for k, stage in enumerate(stages)
    )


def _stage_scene(stage: WrittenScene, removed: Collection[str], source: str) -> Scene:
    """Return the scene of a stage; a fault that names an entry that it removes has a hint."""
    try:
        return made_scene(
            dict(stage.content), stage.changes, source, lambda path: None, stage.folder, starts_later=stage.starts_later
        )
    except InputError as error:
        missing = next((name for name in removed if f"'{name}'" in str(error)), "")
        hint = f": the stage removes '{missing}', so its change must also replace or remove (null) what uses it"
        raise InputError(f"{error}{hint if missing else ''}") from None


def _held_at_start(scene: Scene, source: str) -> Scene:
    """Return the scene with its initial conditions of joints; errors as for `made_scene`."""
    if scene.written is None:
        raise InputError(f"{source}: found at_start, expected a scene that starts as described")
    held = with_held(scene.written)
    return made_scene(dict(held.content), held.changes, f"{source}, at_start", lambda path: None, held.folder)


def _place(fault: tuple[object, ...], changes: Changes, line_of: LineOf) -> str:
    """Return the location of a fault, as the beginning of a message: a change, or a line."""
    for path, _ in changes:
        keys = tuple(path.split("."))
        if keys in (fault[: len(keys)], fault[1:] if fault[:1] == ("parameters",) else ()):
            return "--set "
    line = line_of(fault)
    return f"line {line}, " if line else ""


def _unknown_entry(fault: tuple[object, ...], paths: Sequence[str], known: Mapping[str, Sequence[str]]) -> str:
    """Return a clause on a change within an entry that the scene does not have, if the fault is there."""
    for path in paths:
        section, *keys = path.split(".")
        there = any(start in known.get(section, ()) for start, _ in beginnings(".".join(keys)))
        if len(keys) > 1 and (section, keys[0]) == fault[:2] and section in known and not there:
            near = did_you_mean(keys[0], (*known[section], *(known["use"] if section in NAMED else ())))
            return f"--set {path}: found no '{keys[0]}' in {section}{near}, expected an entry of the scene, or a whole new one: "
    return ""


class _Located(Exception):
    """Error with the path of keys at which it occurred."""

    def __init__(self, message: str, path: tuple[object, ...]) -> None:
        super().__init__(message)
        self.path = path


def _validated(
    found: Content, replaced: Mapping[str, Quantity], later: Later, known: Content, unchanged: Unchanged
) -> Scene:
    try:
        parameters = expand.read_parameters(found.get("parameters"), replaced)
        found = _with_path(found, parameters)
        tables = expand.read_tables(found.get("tables"), parameters)
        raw = {
            key: expand.repeat_entries(key, value, parameters) if key in REPEATED else value
            for key, value in found.items()
        }
        for section in REPEATED:
            later.set(section, raw.get(section))
        raw = with_beams(raw, parameters, names_in_formulas(raw))
        variables = _read_variables(raw.get("variables"), parameters, tables, raw.get("states"), raw.get("inputs"))
        context: dict[str, object] = {"parameters": parameters, "tables": tables, "variables": variables, **known}
        context["roads"] = read_roads(raw.get("roads"), context)
        raw = _with_flexible_bodies(raw, context)
        raw, context = with_parts(raw, _family(raw), context, later)
        raw = _with_vehicle(_with_surface_loads(raw, context), context)
    except InputError as error:
        raise _Located(str(error), tuple(str(error).split(":")[0].split("."))) from None
    raw["parameters"] = {name: parameter.value for name, parameter in parameters.items()}
    raw["tables"], raw["roads"] = tables, context["roads"]
    of_parts: Any = context["of_parts"]
    written_entries = dict(raw)
    raw = unchanged.put_into(raw, context)
    try:
        scene = _family(raw).model_validate(raw, context=context)
    except PydanticError as error:
        if "dimensions" not in raw and is_valid(scene_class(3), raw, context):
            raise _Located("dimensions: found none, expected 3 for bodies in space", ("bodies",)) from None
        message = sentence(error)
        path = message.split(":")[0].split(".")
        raise _Located(f"{message}{_of_other_units(parameters, replaced)}", tuple(path)) from None
    scene._quantities, scene._of_parts = parameters, of_parts
    unchanged.keep(written_entries, context, scene)
    return scene


def _of_other_units(parameters: Mapping[str, Quantity], replaced: Mapping[str, Quantity]) -> str:
    """Return a clause on the parameters that changes give another unit than the scene."""
    clauses = [
        f"; {name} is changed from {in_units(before.dimension)} to {in_units(now.dimension)}"
        for name, before in replaced.items()
        if (now := parameters[name]).dimension and before.dimension and now.dimension != before.dimension
    ]
    return "".join(clauses)


def _with_flexible_bodies(raw: dict[str, object], context: Mapping[str, object]) -> dict[str, object]:
    """Return a scene with its flexible bodies expanded; their package is imported only for these."""
    bodies = raw.get("bodies")
    entries = bodies.values() if isinstance(bodies, dict) else ()
    if not any(is_flexible(entry) for entry in entries):
        return raw
    from .flexible import with_flexible_bodies

    return with_flexible_bodies(raw, context)


def _with_surface_loads(raw: dict[str, object], context: Mapping[str, object]) -> dict[str, object]:
    """Return a scene with loads on surfaces of flexible bodies expanded; their module is imported only for these."""
    forces = raw.get("forces")
    if not isinstance(forces, dict) or not any(is_surface_load(entry) for entry in forces.values()):
        return raw
    from .surface_loads import with_surface_loads

    return with_surface_loads(raw, context)


def _with_path(raw: dict[str, object], parameters: Mapping[str, Quantity]) -> dict[str, object]:
    """Return a scene with the tables of its path; their module is imported only for spatial scenes with one."""
    if raw.get("path") is None or raw.get("dimensions") != 3:
        return raw
    from .paths.section import with_path

    return with_path(raw, parameters)


def _with_vehicle(raw: dict[str, object], context: Mapping[str, object]) -> dict[str, object]:
    """Return a scene with the channels of its vehicle; their module is imported only for spatial scenes with one."""
    if raw.get("vehicle") is None or raw.get("dimensions") != 3:
        return raw
    from .vehicle import with_vehicle

    return with_vehicle(raw, context)


def _family(raw: dict[str, object]) -> type[Scene]:
    """Return the class of scenes of the given dimension; planar by default."""
    found = raw.get("dimensions", 2)
    if found not in (2, 3):
        raise _Located(f"dimensions: found {written(found)}, expected 2 or 3", ("dimensions",))
    return scene_class(found)


def _read_variables(
    found: object, parameters: Mapping[str, Quantity], tables: Collection[str], *sections: object
) -> dict[str, ast.expr]:
    """Return the syntax trees of a scene's variables by name; `sections`, of states and inputs, have other names.

    Raise an InputError if a name is not an identifier or already has a meaning, or a formula cannot be read.
    """
    formulas: dict[str, str | float] = {}
    for name, formula in named_entries("variables", found, "formulas"):
        if name in UNITS:
            raise InputError(f"variables.{name}: found the name of a unit, expected another: rename the variable")
        if name in (*CONSTANTS, *parameters, *tables, TIME, UNIT):
            raise InputError(f"variables.{name}: found a name with a meaning already, expected another")
        if isinstance(formula, bool) or not isinstance(formula, str | int | float):
            raise InputError(f"variables.{name}: found {written(formula)}, expected a formula")
        formulas[name] = formula
    with prefixed("variables.", FormulaError):
        known = [name for section in sections if isinstance(section, dict) for name in section]
        return resolved(formulas, {*parameters, *CONSTANTS, TIME, *known})
