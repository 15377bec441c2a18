"""Scenes that differ only in values used by forces: only these forces are read again.

`stiffmbs.model.read_scene.made_scene` reads the whole scene if other sections use a changed value, and reports errors.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from pydantic import ValidationError as PydanticError

from ...elements.element import Force
from ...errors import InputError
from ...reading.files.unchanged import Unchanged, names_in
from ...reading.formula.field import READ_BEFORE
from ...reading.formula.formula import Formula
from ...reading.units.units import Quantity
from ..parts.changes import set_later
from ..parts.options import CHOOSE, OPTIONS
from ..scene import Scene
from .expand import read_parameter, replaced_parameters, set_value, unshared
from .written_scene import WrittenScene

PARAMETERS, FORCES = "parameters", "forces"
NOT_AS_WRITTEN = ("use", "stages", OPTIONS, CHOOSE)
"""Sections that make the entries of a scene differ from those of its file."""


class ChangedForces:
    """Scenes with other values of some parameters and of some fields of forces.

    `names`: paths of the varied values, as for `stiffmbs.load_scene`. `unchanged`: record of a scene of the same
    content that was already validated.
    """

    def __init__(self, written: WrittenScene, names: Sequence[str], unchanged: Unchanged) -> None:
        self._names, self._unchanged = names, unchanged
        self._content = unshared(dict(written.content))
        replaced = [(name, None) for name in (*(path for path, _ in written.changes), *names)]
        self._replaced = replaced_parameters(self._content, replaced)
        self._changed: frozenset[str] = frozenset()
        self._affected = self._found(written)
        self._formulas = dict(self._read_before())

    def _read_before(self) -> Iterator[tuple[tuple[str, tuple[str, ...], bool], Formula]]:
        scene = self._unchanged.scene
        for name in self._affected or () if scene else ():
            for _, formula in scene.forces[name].parts(Formula):  # type: ignore[union-attr]
                yield (formula.text, formula.variables, formula.velocities), formula

    def _found(self, written: WrittenScene) -> frozenset[str] | None:
        """Return the forces that use the values; None if other elements use them too."""
        content, parameters = self._content, self._content.get(PARAMETERS) or {}
        if any(content.get(section) for section in NOT_AS_WRITTEN) or any(isinstance(v, str) for _, v in written.changes):  # fmt: skip
            return None
        if any(set_later(path, content) for path in (*(path for path, _ in written.changes), *self._names)):
            return None
        for path, value in written.changes:
            set_value(content, path, value)
        own: set[str] = set()
        changed: set[str] = set()
        for name in self._names:
            section, _, rest = name.partition(".")
            force = next((force for force in content.get(FORCES) or {} if rest.startswith(f"{force}.")), None)
            if name in parameters or (section == PARAMETERS and rest in parameters):
                changed.add(name.removeprefix(f"{PARAMETERS}."))
            elif section == FORCES and force is not None and rest != f"{force}.type":
                own.add(force)
            else:
                return None
        changed |= _following(parameters, changed)
        self._changed = frozenset(changed)
        if any(names_in({key: entry}) & changed for key, entry in content.items() if key not in (PARAMETERS, FORCES)):
            return None
        forces = content.get(FORCES) or {}
        found = frozenset(own | {name for name, entry in forces.items() if names_in({name: entry}) & changed})
        as_written = all(
            isinstance(forces[name], dict) and "for" not in forces[name] and "{" not in f"{name}{_texts(forces[name])}"
            for name in found
        )
        scene = self._unchanged.scene
        expanded = scene is not None and not found <= scene.forces.keys()
        return found if as_written and not expanded else None

    def scene(self, values: Sequence[object]) -> Scene | None:
        """Return the scene with the given values; None if it must be read as a whole."""
        before = self._unchanged.scene
        if self._affected is None or before is None or any(isinstance(value, str) for value in values):
            return None
        try:
            parameters = self._parameters(values)
            forces = self._forces(values, {**self._unchanged.context, PARAMETERS: parameters})
            scene = before.model_copy(
                update={
                    PARAMETERS: {name: quantity.value for name, quantity in parameters.items()},
                    FORCES: {**before.forces, **forces},
                }
            )
            scene.check_elements({f"{FORCES}.{name}": force for name, force in forces.items()})
        except (InputError, PydanticError, ValueError):
            return None
        scene._quantities, scene._written = parameters, None
        return scene

    def _parameters(self, values: Sequence[object]) -> dict[str, Quantity]:
        content = self._content.get(PARAMETERS) or {}
        given = {name.removeprefix(f"{PARAMETERS}."): value for name, value in zip(self._names, values, strict=True)}
        found: dict[str, Quantity] = dict(self._unchanged.context[PARAMETERS])
        for name in content:
            if name in self._changed:
                found[name] = read_parameter(name, given.get(name, content[name]), found, self._replaced)
        return found

    def _forces(self, values: Sequence[object], context: Mapping[str, object]) -> dict[str, Force]:
        assert self._unchanged.scene is not None and self._affected is not None
        content = {FORCES: {name: unshared(self._content[FORCES][name]) for name in self._affected}}
        for name, value in zip(self._names, values, strict=True):
            if name.startswith(f"{FORCES}."):
                set_value(content, name, value)
        forces = self._unchanged.scene.forces
        context = {**context, READ_BEFORE: self._formulas}
        return {
            name: type(forces[name]).model_validate(entry, context=context) for name, entry in content[FORCES].items()
        }


def _following(parameters: Mapping[str, object], changed: set[str]) -> set[str]:
    """Return the parameters whose formulas depend on changed ones, directly or indirectly."""
    found = set(changed)
    for name, value in parameters.items():  # each may use only earlier ones
        if name not in found and names_in({"": value}) & found:
            found.add(name)
    return found


def _texts(entry: object) -> str:
    """Return all texts of an entry, concatenated."""
    match entry:
        case str():
            return entry
        case dict():
            return "".join(_texts(part) for pair in entry.items() for part in pair)
        case list() | tuple():
            return "".join(map(_texts, entry))
    return ""
