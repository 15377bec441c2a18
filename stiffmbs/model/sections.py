"""Sections of a model built in Python, and the checks when a part is added or removed."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, TypeVar

from ..elements.body import AnyBody, LineBody, check_names
from ..elements.element import Element, Force, Joint
from ..elements.kinds import Kinds
from ..elements.own_elements import check_class
from ..elements.states.entry import Entry
from ..elements.states.section import Scope, check_states, names_in_formulas
from ..errors import InputError, prefixed
from ..reading.did_you_mean import did_you_mean
from ..reading.fields import Described
from ..reading.formula.names import NAMES
from ..reading.handle import Handle
from ..reading.marker import GROUND
from .model_data import RESERVED, ModelData, check_element, contents

Data = TypeVar("Data", bound=ModelData)
Body = TypeVar("Body", bound="AnyBody")
BodyHandle = TypeVar("BodyHandle", bound=Handle)
Result = TypeVar("Result")


@dataclass(frozen=True)
class Line:
    """Beam or flexible body of a model, and the names of its bodies and elements."""

    part: LineBody
    names: tuple[str, ...]


class Sections(Generic[Data, Body, BodyHandle]):
    """Parts of a model by section and name."""

    data_type: type[Data]
    body_type: type[Body]
    handle_type: type[BodyHandle]
    kinds: ClassVar[tuple[Kinds, Kinds]]  # joints and forces of the family, by kind

    def __init__(self, name: str, gravity: object) -> None:
        self.name = name
        self.gravity = gravity
        self.markers: dict[str, object] = {}
        self.bodies: dict[str, Body] = {}
        self.states: dict[str, Entry] = {}
        self.inputs: dict[str, object] = {}
        self.joints: dict[str, Joint] = {}
        self.forces: dict[str, Force] = {}
        self.requests: dict[str, object] = {}
        self._lines: dict[str, Line] = {}  # beams and flexible bodies by name
        self._owners: dict[str, str] = {}  # names of these by those of their bodies and elements

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {contents(self)}>"

    def _sections(self) -> tuple[dict[str, Any], ...]:
        return self.bodies, self.states, self.inputs, self.joints, self.forces, self.requests

    def _found(self, name: str) -> dict[str, Any]:
        for section in (self.markers,) if name.startswith(f"{GROUND}.") else self._sections():
            if key_of(name) in section:
                return section
        sections = (self.markers, *self._sections(), self._lines)
        near = did_you_mean(key_of(name), [known for section in sections for known in section])
        raise InputError(f"{name}: found no part of that name{near}, expected one of {self!r}")

    def _section_for(self, name: str, part: object) -> dict[str, Any]:
        if isinstance(part, self.body_type):
            return self.bodies
        if isinstance(part, Entry):
            return self.states
        if not isinstance(part, Joint | Force):
            raise InputError(f"{name}: found {part!r}, expected a body, a joint or a force{self._of_the_family()}")
        check_class(type(part))
        if not any(kinds.fits(part) for kinds in self.kinds):
            raise InputError(
                f"{name}: found {part!r}, expected a joint or a force whose markers are{self._of_the_family()}"
            )
        return self.joints if isinstance(part, Joint) else self.forces

    @contextmanager
    def _restored(self) -> Iterator[None]:
        """Restore all sections if a change of them fails."""
        before: list[tuple[dict[str, Any], dict[str, Any]]]
        before = [(section, dict(section)) for section in (self.markers, *self._sections(), self._lines, self._owners)]
        try:
            yield
        except (InputError, ValueError):
            for section, kept in before:
                section.clear()
                section.update(kept)
            raise

    def _changed(self, name: str, change: Callable[[], Result]) -> Result:
        """Change sections, and return the result; restore them if the change fails, or other parts then refer to missing ones."""
        with self._restored():
            result = change()
            self._check_others(name)
        return result

    def _check_others(self, name: str) -> None:
        """Check the references of all parts after the change of one."""
        scope = self._scope(self._names())
        try:
            for other, element in (*self.joints.items(), *self.forces.items()):
                check_element(other, element, scope)
            check_states(self.states, scope)
            self.data_type.model_construct(**self._content()).check_requests()
        except ValueError as error:
            raise InputError(
                f"{name}: found it in use ({error}), expected the elements that refer to it to be changed first"
            ) from None

    def _of_the_family(self) -> str:
        return " of stiffmbs.spatial" if self._dimensions() == 3 else " of the plane (stiffmbs)"

    def _dimensions(self) -> int:
        dimensions: int = self.data_type.model_fields["dimensions"].default
        return dimensions

    @staticmethod
    def _check_spelling(name: object, what: str) -> None:
        with prefixed("", ValueError):
            check_names([name], what)

    def _check_name(self, name: str) -> None:
        self._check_spelling(name, "part")
        if name in RESERVED or name in self._lines or any(name in section for section in self._sections()):
            raise InputError(f"{name}: found a name that is taken or reserved, expected another")

    def _check(self, name: str, part: Described) -> None:
        with prefixed("", ValueError):
            if isinstance(part, Element):
                check_element(name, part, self._scope(self._names()))
            if isinstance(part, Entry):
                check_states({name: part}, self._scope(None))

    def _names(self) -> set[str]:
        return names_in_formulas(self.states) | set(self.inputs)

    def _scope(self, states: Collection[str] | None) -> Scope:
        return Scope(self.bodies, self.joints, self.markers, NAMES[self._dimensions()], states)

    def _content(self) -> dict[str, Any]:
        sections = ("name", "gravity", "markers", "bodies", "states", "inputs", "joints", "forces", "requests")
        return {section: getattr(self, section) for section in sections}

    def data(self) -> Data:
        """Return the model as the data of a scene.

        Raises
        ------
        InputError
            If the model has no body.
        """
        return self.data_type(**self._content())


def key_of(name: str) -> str:
    """Return the key of a name in its section: the prefix ``ground.`` is removed."""
    return name.removeprefix(f"{GROUND}.")
