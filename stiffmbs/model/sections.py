"""Sections of a model built in Python, and the checks when a part is added or removed."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Any, ClassVar, Generic, TypeVar

from ..elements.body import AnyBody, check_names
from ..elements.element import Element, Force, Joint
from ..elements.kinds import Kinds
from ..elements.own_elements import check_class
from ..elements.states.linear_system import StateEntry
from ..elements.states.section import check_states, names_in_formulas
from ..errors import InputError
from ..reading.did_you_mean import did_you_mean
from ..reading.fields import Described
from ..reading.formula.names import NAMES
from ..reading.handle import Handle
from ..reading.marker import GROUND
from .model_data import RESERVED, ModelData, check_element, contents

Data = TypeVar("Data", bound=ModelData)
Body = TypeVar("Body", bound="AnyBody")
BodyHandle = TypeVar("BodyHandle", bound=Handle)


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
        self.states: dict[str, StateEntry] = {}
        self.inputs: dict[str, object] = {}
        self.joints: dict[str, Joint] = {}
        self.forces: dict[str, Force] = {}
        self.requests: dict[str, object] = {}

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {contents(self)}>"

    def _sections(self) -> tuple[dict[str, Any], ...]:
        return self.bodies, self.states, self.inputs, self.joints, self.forces, self.requests

    def _found(self, name: str) -> dict[str, Any]:
        for section in (self.markers,) if name.startswith(f"{GROUND}.") else self._sections():
            if key_of(name) in section:
                return section
        near = did_you_mean(key_of(name), [known for section in (self.markers, *self._sections()) for known in section])
        raise InputError(f"{name}: found no part of that name{near}, expected one of {self!r}")

    def _section_for(self, name: str, part: object) -> dict[str, Any]:
        if isinstance(part, self.body_type):
            return self.bodies
        if isinstance(part, StateEntry):
            return self.states
        if not isinstance(part, Joint | Force):
            raise InputError(f"{name}: found {part!r}, expected a body, a joint or a force{self._of_the_family()}")
        check_class(type(part))
        if not any(kinds.fits(part) for kinds in self.kinds):
            raise InputError(
                f"{name}: found {part!r}, expected a joint or a force whose markers are{self._of_the_family()}"
            )
        return self.joints if isinstance(part, Joint) else self.forces

    def _changed(self, name: str, section: dict[str, object], change: Callable[[], object]) -> None:
        """Change a section; restore it if other parts then refer to missing ones."""
        before = dict(section)
        change()
        try:
            for other, element in (*self.joints.items(), *self.forces.items()):
                self._check_element(other, element)
            self._check_states(self.states, self._names())
            self.data_type.model_construct(**self._content()).check_requests()
        except ValueError as error:
            section.clear()
            section.update(before)
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
        try:
            check_names([name], what)
        except ValueError as error:
            raise InputError(str(error)) from None

    def _check_name(self, name: str) -> None:
        self._check_spelling(name, "part")
        if name in RESERVED or any(name in section for section in self._sections()):
            raise InputError(f"{name}: found a name that is taken or reserved, expected another")

    def _check(self, name: str, part: Described) -> None:
        try:
            if isinstance(part, Element):
                self._check_element(name, part)
            if isinstance(part, StateEntry):
                self._check_states({name: part}, known=None)
        except ValueError as error:
            raise InputError(str(error)) from None

    def _check_element(self, name: str, part: Element) -> None:
        names = NAMES[self._dimensions()]
        check_element(name, part, self.bodies, self.joints, self.markers, names, self._names())

    def _names(self) -> set[str]:
        return names_in_formulas(self.states) | set(self.inputs)

    def _check_states(self, states: Mapping[str, StateEntry], known: Collection[str] | None) -> None:
        check_states(states, self.bodies, self.markers, self.joints, NAMES[self._dimensions()], known)

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
