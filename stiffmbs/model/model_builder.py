"""Base class of planar and spatial models built in Python."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Collection, Mapping, Sequence
from typing import Any, overload

from pydantic import TypeAdapter

from ..elements.body import LineBody
from ..elements.element import Force, Joint
from ..elements.requests.check import ByChannel, by_channel, check_output
from ..elements.requests.order import dimensions, with_named
from ..elements.requests.output_field import read_request
from ..elements.states.amount import InputValue
from ..elements.states.entry import Entry
from ..errors import InputError, prefixed
from ..reading.fields import located
from ..reading.formula.text import FormulaError
from ..reading.given import Law
from ..reading.handle import Handles
from ..reading.marker import GROUND, MarkerReference
from .sections import Body, BodyHandle, Data, Line, Sections, key_of


class ModelBuilder(Sections[Data, Body, BodyHandle]):
    """Base of the models built in Python."""

    @overload
    def add(self, name: str, part: Body) -> BodyHandle: ...

    @overload
    def add(self, name: str, part: LineBody) -> Any: ...

    @overload
    def add(self, name: str, part: Joint | Force | Entry) -> None: ...

    def add(self, name: str, part: Any) -> Any:
        """Add a body, a joint, a force or a state.

        Parameters
        ----------
        name : str
            Letters, digits and ``_``; no other part has it.

        Returns
        -------
        BodyHandle, BeamHandle, FlexibleHandle or None
            For a body, its handle, for use in markers and formulas and to change the body.

        Raises
        ------
        InputError
            If the name is taken, reserved or not an identifier, or the part names an unknown body.
        """
        if isinstance(part, LineBody):
            self._check_name(name)
            with self._restored():
                return self._add_line(name, part)
        section = self._section_for(name, part)
        self._check_name(name)
        self._check(name, part)
        section[name] = part
        return self._handle(name)

    def _add_line(self, name: str, part: LineBody) -> Any:
        """Add a beam or a flexible body, and record the names of its bodies and elements."""
        before = [(section, len(section)) for section in self._sections()]
        handles = part.add_to(self, name)
        names = tuple(key for section, count in before for key in [*section][count:])
        self._lines[name] = Line(part, names)
        self._owners |= dict.fromkeys(names, name)
        return handles

    @overload
    def replace(self, name: str | BodyHandle, part: Body) -> BodyHandle: ...

    @overload
    def replace(self, name: str | Handles, part: LineBody) -> Any: ...

    @overload
    def replace(self, name: str | BodyHandle, part: Joint | Force) -> None: ...

    def replace(self, name: str | BodyHandle | Handles, part: Any) -> Any:
        """Replace a body, a joint or a force, keeping its name.

        Parameters
        ----------
        name : str, BodyHandle, BeamHandle or FlexibleHandle
            Name of the part that is replaced.
        part : Body, Beam, FlexibleBody, Joint or Force
            Replacement of the same category: a body for a body, a beam for a beam, a flexible body for a flexible body,
            a joint for a joint, a force for a force. Of a flexible body, other parts may use the interfaces that both have.

        Returns
        -------
        BodyHandle, BeamHandle, FlexibleHandle or None
            As for `add`; existing handles of bodies refer to the new body.

        Raises
        ------
        InputError
            If there is no such part, the new one names an unknown body, or others refer to something that the new one
            lacks.
        """
        name = str(name)
        if name in self._lines:
            return self._replace_line(name, part)
        section = self._found(name)
        self._check_owner(name, part)
        if isinstance(part, LineBody) or section is not self._section_for(name, part):
            raise InputError(
                f"{name}: found {part!r} in place of {section[name]!r}, expected a body for a body, a joint for a joint, a force for a force"
            )
        self._check(name, part)
        fewer_markers = section is self.bodies and section[name].markers.keys() - part.markers.keys()
        if isinstance(part, Joint) or (isinstance(part, Force) and self.requests) or fewer_markers:
            self._changed(name, lambda: section.update({name: part}))
        section[name] = part
        return self._handle(name)

    def _replace_line(self, name: str, part: Any) -> Any:
        """Replace a beam or a flexible body by another one; its bodies and elements take the places of the old ones."""
        old = self._lines[name]
        if type(part) is not type(old.part):
            raise InputError(
                f"{name}: found {part!r} in place of {old.part!r}, expected a beam for a beam, a flexible body for a flexible body"
            )
        self._check_loads(name)
        before = [(section, [*section]) for section in self._sections()]

        def change() -> Any:
            """Put the new part in place of the old one; return its handles."""
            self._take_out(name)
            handles = self._add_line(name, part)
            for section, keys in before:
                _in_the_order(section, keys, {*old.names, *self._lines[name].names})
            return handles

        return self._changed(name, change)

    def _take_out(self, name: str) -> None:
        """Remove a beam or a flexible body with all its bodies and elements."""
        for key in self._lines.pop(name).names:
            del self._owners[key]
            for section in self._sections():
                section.pop(key, None)

    def _check_loads(self, name: str) -> None:
        """Refuse the change of a flexible body on which loads act whose forces are those of its modes."""
        load = next((other for other, line in self._lines.items() if line.part.depends_on() == name), None)
        if load is not None:
            raise InputError(
                f"{name}: found the load '{load}' on it, expected that to be removed first and added again"
            )

    def _check_owner(self, name: str, part: object) -> None:
        """Refuse the change of a body or element that belongs to a beam or a flexible body. `part`: None if it is removed."""
        owner = self._owners.get(name)
        if owner is None:
            return
        if part is None or not self._lines[owner].part.allows(self._found(name)[name], part):
            what = f"model.remove('{owner}')" if part is None else f"model.replace('{owner}', ...)"
            raise InputError(f"{name}: found a part of '{owner}', which can only be changed as a whole: {what}")

    def remove(self, name: str | BodyHandle | Handles) -> None:
        """Remove a body, a beam, a joint, a force, a request, or a marker of ground (``"ground.pivot"``) from the model.

        Raises
        ------
        InputError
            If there is no such part, or others refer to it.
        """
        name = str(name)
        if name in self._lines:
            self._check_loads(name)
            self._changed(name, lambda: self._take_out(name))
            return
        section = self._found(name)
        self._check_owner(name, None)
        self._changed(name, lambda: section.pop(key_of(name)))

    def _handle(self, name: str) -> BodyHandle | None:
        return self.handle_type(name, self) if name in self.bodies else None

    def mark(self, name: str, marker: MarkerReference) -> None:
        """Name a marker on ground, for references and formulas: ``ground.name``.

        Parameters
        ----------
        marker : Marker
            On ``ground``, with an explicit point and direction.

        Raises
        ------
        InputError
            If the name is taken or not an identifier, or the marker is not an explicit marker on ground.
        """
        self._check_spelling(name, "marker")
        if name in self.markers:
            raise InputError(f"{name}: found a name that is taken, expected another")
        placement = marker.placement() if isinstance(marker, MarkerReference) and marker.body == GROUND else None
        if placement is None:
            raise InputError(f"{name}: found {marker!r}, expected a marker with a point on ground")
        self.markers[name] = placement

    def add_input(self, name: str, value: object) -> None:
        """Add an input: a named value for formulas, which every run can set.

        Parameters
        ----------
        name : str
            Letters, digits and ``_``; no other part has it.
        value : float, str or Table
            A number, text with a unit, or a table of time.

        Raises
        ------
        InputError
            If the name is taken, or the value is none of these.
        """
        self._check_name(name)
        with located(f"inputs.{name}"):
            self.inputs[name] = TypeAdapter(InputValue).validate_python(value)

    def request(self, name: str, formula: Law | Mapping[str, Law]) -> None:
        """Report a formula as a channel of the given name, or several formulas as ``name.component``.

        Parameters
        ----------
        name : str
            Name of the channel.
        formula : str, float or mapping of str to these
            In SI units, such as ``"0.6*abs(bar.omega)"`` or ``"fx(hinge) + tip_speed"``, of existing parts and
            requests; several by the names of their components.

        Raises
        ------
        InputError
            As for `add`, and for a formula that cannot be read.
        """
        self._check_name(name)
        names = self.data_type.output_names
        with prefixed("", ValueError), prefixed(f"requests.{name}: ", FormulaError):
            read = read_request(names, formula, None)
            added = dict(by_channel({name: read}))
            outputs = ChainMap(added, ByChannel(self.requests))  # type: ignore[arg-type]  # it is only read
            for channel, output in added.items():
                check_output(f"requests.{channel}", output, self, names, outputs)
            dimensions(with_named(added, outputs))
        self.requests[name] = read

    def to_scene(self) -> str:
        """Return the text of a scene file from which `stiffmbs.read_scene` makes the same model.

        Raises
        ------
        InputError
            As for `data`.
        """
        from .model_text import model_text

        return model_text(self.data())


def _in_the_order(section: dict[str, Any], before: Sequence[str], own: Collection[str]) -> None:
    """Move the own entries of a section to the place of the first of them before a change."""
    first = next((k for k, key in enumerate(before) if key in own), len(before))
    moved = {key: section[key] for key in section if key in own}
    others = {key: value for key, value in section.items() if key not in own}
    keys = [*others]
    section.clear()
    section.update(
        {**{key: others[key] for key in keys[:first]}, **moved, **{key: others[key] for key in keys[first:]}}
    )
