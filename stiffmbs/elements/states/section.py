"""Section `states` of a model: kinds of entries and their validation."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from importlib import import_module
from typing import Annotated, Any

from ...errors import InputError
from ...reading.did_you_mean import did_you_mean
from ...reading.files.quoted import quoted, written
from ...reading.formula.dimension import UNKNOWN, Known
from ...reading.formula.formula import Formula
from ...reading.formula.names import FormulaNames
from ...reading.joint_name import JointName
from ...reading.marker import GROUND, check_marker, listed
from ...reading.units.units import CONSTANTS, UNITS
from ..body import AnyBody
from ..element import Joint
from ..read_by import Context, JsonSchema, ReadBy
from .amount import Amount, stated_dimension
from .entry import Entry

KINDS = {
    "rate": "state:State", "zero": "state:AlgebraicState", "update": "state:SampledState", "numerator": "linear_system:TransferFunction",
    "denominator": "linear_system:TransferFunction", "a": "linear_system:LinearSystem", "pid": "linear_system:PID",
}  # fmt: skip
"""File and class of each kind of entry by a key that only it has, imported on demand."""


def _imported(place: str) -> type[Entry]:
    file, _, name = place.partition(":")
    kind: type[Entry] = getattr(import_module(f".{file}", __package__), name)
    return kind


def _read(found: object, context: Context) -> Entry:
    """Return an entry of the section, whose keys select its kind."""
    if isinstance(found, Entry):
        return found
    if not isinstance(found, dict):
        raise ValueError(f"found {written(found)}, expected a mapping of keys to values")
    key = next((key for key in KINDS if key in found), None)
    if key is None:
        raise ValueError(f"found none of the keys {', '.join(KINDS)}, expected one of them")
    if key == "pid":
        others = [other for other in found if other != "pid"]
        if others:
            raise ValueError(f"found the key '{quoted(others[0])}' next to pid, expected it within: pid: {{...}}")
        found = found["pid"]
    return _imported(KINDS[key]).model_validate(found, context=context)


def _schema(schema_of: Callable[[type[object]], JsonSchema]) -> JsonSchema:
    *schemas, pid = (schema_of(_imported(kind)) for kind in dict.fromkeys(KINDS.values()))
    within = {"type": "object", "additionalProperties": False, "properties": {"pid": pid}, "required": ["pid"]}
    return {"anyOf": [*schemas, within]}


AnyState = Annotated[Any, ReadBy(_read, _schema)]


def dimensions_of_entry(name: str, entry: object, parameters: object) -> dict[str, Known]:
    """Return the names that an entry defines for formulas, with their known dimensions, before its validation."""
    outputs = entry.get("outputs") if isinstance(entry, dict) else getattr(entry, "outputs_", None)
    if isinstance(outputs, list | tuple) and outputs:
        return {f"{name}.{output}": UNKNOWN for output in outputs}
    return {name: _dimension_of_state(entry, parameters)}


def _dimension_of_state(entry: object, parameters: object) -> Known:
    """Return the known dimension of a state before its validation; unknown if its start cannot be read."""
    start = getattr(entry, "start", None)
    if isinstance(start, Amount):
        return start.dimension
    return stated_dimension(entry.get("start") if isinstance(entry, dict) else None, parameters)


def names_in_formulas(states: Mapping[str, Entry]) -> set[str]:
    """Return the names of states and outputs in formulas."""
    found = {full for name, state in states.items() for full, _ in state.outputs(name)}
    return found | {name for name, state in states.items() if any(full == name for full, _ in state.values(name))}


def refuse_loops(outputs: Mapping[str, Formula]) -> None:
    """Refuse outputs in algebraic loops. Raises ValueError."""
    needs = {name: [other for other in formula.states if other in outputs] for name, formula in outputs.items()}
    try:
        TopologicalSorter(needs).prepare()
    except CycleError as error:
        loop = error.args[1][::-1]
        raise ValueError(
            f"states.{loop[0]}: found an algebraic loop ({' -> '.join(loop)}), expected a state in the loop"
        ) from None


def refuse_other_meanings(where: str, states: Iterable[str], known: Mapping[str, Collection[str]]) -> None:
    """Refuse states whose names have another meaning in a scene's formulas.

    `where`: path in the scene, for messages. `known`: other names in formulas, by section. Raises InputError.
    """
    for name in states:
        for section, names in known.items():
            if name in names:
                raise InputError(f"{where}.{name}: found a name that {section}.{name} has too, expected another")


@dataclass(frozen=True)
class Scope:
    """Parts of a model to which its elements and formulas can refer."""

    bodies: Mapping[str, AnyBody]
    joints: Mapping[str, Joint]
    on_ground: Mapping[str, object]  # markers
    names: FormulaNames
    states: Collection[str] | None  # names of states and inputs; None while others can still be added


def check_states(states: Mapping[str, Any], scope: Scope) -> None:
    """Refuse states whose names already have a meaning, and formulas with unknown references. Raises ValueError."""
    for name, state in states.items():
        if name in UNITS or name in CONSTANTS:
            raise ValueError(f"states.{name}: found the name of a unit or constant, expected another")
        for field, formula in state.formulas():
            where = f"states.{name}.{field}"
            for _, markers in formula.measures():
                for marker in markers:
                    check_marker(where, marker, scope.bodies, scope.on_ground)
            check_formula(where, formula, scope)


def check_formula(where: str, formula: Formula, scope: Scope) -> None:
    """Refuse a formula that names an unknown body, joint or state."""
    for body in formula.bodies():
        if body not in scope.bodies and body not in scope.joints and body != GROUND:
            near = did_you_mean(body, scope.bodies)
            raise ValueError(f"{where}: found the unknown body '{body}'{near}, expected {listed(scope.bodies)}")
    _check_reactions(where, formula, scope.joints)
    known = formula.states if scope.states is None else scope.states
    for state in formula.states:
        if state not in known:
            raise ValueError(
                f"{where}: found the unknown name '{state}'{did_you_mean(state, known)} in '{formula.text}', expected t, a body's "
                f"coordinate such as cart.x, a parameter or a state ({', '.join(sorted(known)) or 'there is none'})"
            )
    for reason in scope.names.validation_errors(formula, scope.joints):
        raise ValueError(f"{where}: {reason}")


def _check_reactions(where: str, formula: Formula, joints: Mapping[str, Joint]) -> None:
    """Refuse a formula of reactions of unknown joints, or of joints that are not between two markers."""
    for name, joint in formula.reactions():
        if joint not in joints:
            raise ValueError(
                f"{where}: found '{name}({joint})'{did_you_mean(joint, joints)} in '{formula.text}', expected one of the joints "
                f"{', '.join(joints) or 'none'}"
            )
        if next(joints[joint].parts(JointName), None) or next(joints[joint].parts(Formula), None):
            raise ValueError(
                f"{where}: found '{name}({joint})' of the type {joints[joint].kind}, expected a joint between markers without a formula"
            )
