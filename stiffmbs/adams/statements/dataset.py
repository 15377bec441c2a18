"""Dataset: the data of all statements by number."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

from ...errors import InputError
from ...reading.files.quoted import MOST_LISTED, listed
from ...reading.files.requested import unused_notes
from .bodies import Marker, Part
from .changes import Changes, Key, key_of
from .constraints import Coupler, Gear, GeneralConstraint, Joint, Motion, Primitive
from .contact import Contact
from .curves import CurveOnCurve, PointOnCurve, SpaceCurve
from .declared import Numbered
from .elastic import Beam, Elastic, SpringDamper
from .forces import SingleForce, VectorForce, read_gravity
from .friction import JointFriction
from .keywords import (
    LEFT_OUT,
    LEFT_OUT_ARGUMENTS,
    READERS,
    REFUSED,
    SINGLE,
    TEXT,
    UNREAD_SYSTEM,
    is_unread_system,
    keyword,
)
from .outputs import Array, Request, Spline, Variable
from .sensor import Sensor
from .systems import Differential, Matrix
from .text import ZERO_BYTE, DatasetFault, Statement, raise_all, statements, untitled
from .units import Units, read_units

NO_CHANGES = Changes()
Found = TypeVar("Found", bound=Numbered)
Force = SingleForce | VectorForce | SpringDamper | Elastic | Beam


class _Section(Generic[Found]):
    """Statements of one keyword in a dataset, by number."""

    def __init__(self, keyword: str) -> None:
        self._keyword = keyword

    def __get__(self, dataset: Dataset, owner: object = None) -> Mapping[int, Found]:
        return dataset.statements.get(self._keyword, {})


Kind = TypeVar("Kind")
"""Class of statements."""


@dataclass(frozen=True)
class Dataset:
    """Content of a dataset."""

    title: str  # its first line
    units: Units
    gravity: tuple[float, float, float]  # m/s^2
    statements: Mapping[str, Mapping[int, Any]]  # data of all statements by full name and number
    notes: tuple[str, ...]  # one sentence for each omission
    inactive: frozenset[Key]  # names and numbers of deactivated statements, which `statements` omits
    graphics: Mapping[int, Statement]  # GRAPHICS, which contacts may use

    def _all(self, kind: type[Kind]) -> tuple[Kind, ...]:
        return tuple(x for numbered in self.statements.values() for x in numbered.values() if isinstance(x, kind))

    @property
    def parts(self) -> tuple[Part, ...]:
        """Parts and point masses."""
        return self._all(Part)

    @property
    def forces(self) -> tuple[Force, ...]:
        """All forces except gravity, ordered by kind of statement."""
        return self._all(Force)  # type: ignore[arg-type]

    @property
    def active_sensors(self) -> tuple[Sensor, ...]:
        """Sensors that end or change a simulation."""
        return tuple(sensor for sensor in self.sensors.values() if sensor.then)

    markers = _Section[Marker]("MARKER")
    joints = _Section[Joint]("JOINT")
    primitives = _Section[Primitive]("JPRIM")
    general_constraints = _Section[GeneralConstraint]("GCON")
    motions = _Section[Motion]("MOTION")
    couplers = _Section[Coupler]("COUPLER")
    gears = _Section[Gear]("GEAR")
    points_on_curves = _Section[PointOnCurve]("PTCV")
    curves_on_curves = _Section[CurveOnCurve]("CVCV")
    contacts = _Section[Contact]("CONTACT")
    frictions = _Section[JointFriction]("FRICTION")
    requests = _Section[Request]("REQUEST")
    sensors = _Section[Sensor]("SENSOR")
    variables = _Section[Variable]("VARIABLE")
    differentials = _Section[Differential]("DIFF")
    splines = _Section[Spline]("SPLINE")
    arrays = _Section[Array]("ARRAY")
    curves = _Section[SpaceCurve]("CURVE")
    matrices = _Section[Matrix]("MATRIX")


def read_dataset(text: str, changes: Changes = NO_CHANGES) -> Dataset:
    """Read the text of a dataset and apply the changes of commands.

    Raises InputError if a statement cannot be read, or defines an unsupported mass, force or constraint.
    """
    title, found, ended = all_statements(text)
    named = changes.applied([(keyword(statement.word), statement) for statement in found])
    for name, statement in named:
        if name not in LEFT_OUT:
            _refuse_zero_bytes(name, statement)
    unread = _unread(named)
    units, gravity = _single(named)
    data, faults = _data(named, units)
    if unread:
        raise InputError("; ".join([unread, *map(str, faults[:MOST_LISTED])]))
    raise_all(faults)
    graphics = {key_of(statement)[1]: statement for name, statement in named if name == "GRAPHICS"}
    solids = {number for contact in data.get("CONTACT", {}).values() for pair in contact.pairs for number in pair}
    drawn = [(name, one) for name, one in named if name != "GRAPHICS" or key_of(one)[1] not in solids]
    notes = (*_notes(drawn, ended, title is None), *_unused_arguments(named))
    return Dataset(title or "", units, gravity, data, notes, frozenset(changes.inactive), graphics)


def all_statements(text: str) -> tuple[str | None, tuple[Statement, ...], bool]:
    """Return the title (None if the first line is a statement), the statements, and whether END was found."""
    title, found, ended = statements(text)
    return (None, *untitled(text)) if _is_statement(title) else (title, found, ended)


def faults_of(text: str) -> list[DatasetFault]:
    """Return the faults of single statements of a dataset, except unsupported ones."""
    named = [(keyword(statement.word), statement) for statement in all_statements(text)[1]]
    try:
        units, _ = _single(named)
    except DatasetFault as fault:
        return [fault]
    return _data(named, units)[1]


def _single(named: list[tuple[str | None, Statement]]) -> tuple[Units, tuple[float, float, float]]:
    """Return units and gravity."""
    units = Units()
    for statement in _once("UNITS", named):
        units = read_units(statement)
    gravity = (0.0, 0.0, 0.0)
    for statement in _once("ACCGRAV", named):
        gravity = read_gravity(statement, units)
    return units, gravity


def _data(
    named: list[tuple[str | None, Statement]], units: Units
) -> tuple[dict[str, dict[int, Any]], list[DatasetFault]]:
    """Return the data of all statements by full name and number, and their faults."""
    data: dict[str, dict[int, Any]] = {}
    part: Part | None = None
    faults = []
    for name, statement in named:
        if name not in READERS:
            continue
        try:
            one = read_statement(name, statement, units, part)
            part = one if isinstance(one, Part) else part
            if one.ident in data.setdefault(name, {}):
                first = data[name][one.ident].line
                raise DatasetFault(statement.line, one.label, f"found it a second time (first in line {first})")
            data[name][one.ident] = one
        except DatasetFault as fault:
            faults.append(fault)
    return data, faults


def read_statement(name: str, statement: Statement, units: Units, before: Part | None = None) -> Any:
    """Read a statement by its full name; `before` is the preceding part, which carries a marker.

    Raises DatasetFault.
    """
    if name in SINGLE:
        return read_units(statement) if name == "UNITS" else read_gravity(statement, units)
    one = READERS[name].read(name, statement, units)
    if isinstance(one, Marker) and not one.owner[0]:
        if before is None:
            raise one.fault("found neither PART nor POINT_MASS, expected the part that carries the marker")
        return replace(one, owner=(before.keyword, before.ident))
    return one


def _refuse_zero_bytes(name: str | None, statement: Statement) -> None:
    """Refuse zero bytes in a statement that is used, or in its name."""
    for piece in statement.pieces:
        if ZERO_BYTE in piece.text and name is None:
            raise InputError(f"line {piece.line}: found a zero byte, expected text")
        if ZERO_BYTE in piece.text:
            raise DatasetFault(piece.line, f"{name}/{statement.ident}".rstrip("/"), "found a zero byte, expected text")


def _once(wanted: str, named: list[tuple[str | None, Statement]]) -> list[Statement]:
    found = [statement for name, statement in named if name == wanted]
    if len(found) > 1:
        raise DatasetFault(found[1].line, wanted, f"found it a second time (first in line {found[0].line})")
    return found


def _unread(named: list[tuple[str | None, Statement]]) -> str:
    """Return one sentence that lists unsupported statements; '' if there are none."""
    every = [statement for _, statement in named]
    unread = [
        (f"{name or statement.word}/{statement.ident}".rstrip("/"), statement.line)
        for name, statement in named
        if name is None or (name in REFUSED and not is_unread_system(name, statement, every))
    ]
    if not unread:
        return ""
    named_lines = listed([f"{label} (line {line})" for label, line in unread])
    return (
        f"found unsupported statements: {named_lines}; expected {', '.join((*SINGLE, *READERS))}, or "
        "graphics, output and analysis settings, which are left out"
    )


def _unused_arguments(named: list[tuple[str | None, Statement]]) -> list[str]:
    """Return notes on unused arguments of statements, except texts."""
    for name, statement in named:
        for fields in statement.requests:
            fields.request(
                *(argument for argument, why in LEFT_OUT_ARGUMENTS.get(name or "", {}).items() if why == TEXT)
            )
    return unused_notes([fields for _, statement in named for fields in statement.requests], LEFT_OUT_ARGUMENTS)


def _is_statement(title: str) -> bool:
    """Return True if the first line, a title for Adams in any case, can only be a statement."""
    found = re.match(r"(\w+)\s*/\s*(\d+\s*(?:,|$)|$|\w+\s*=)", title)
    return found is not None and found[1].upper() in (*SINGLE, *READERS)


def _notes(named: list[tuple[str | None, Statement]], ended: bool, without_title: bool) -> Iterator[str]:
    if without_title:
        yield "line 1, the title in Adams, is read as a statement, which Adams would ignore"
    kinds: dict[str, list[int]] = {}
    for name, statement in named:
        if name in LEFT_OUT or name in REFUSED:  # only a GSE reaches this point
            kinds.setdefault(name or "", []).append(statement.line)
    for name, lines in kinds.items():
        places = listed([*map(str, lines)])
        yield f"{name} (line{'s' if len(lines) > 1 else ''} {places}) is left out: {LEFT_OUT.get(name, UNREAD_SYSTEM)}"
    if not ended:
        yield "the dataset has no END, and may have been cut off"
