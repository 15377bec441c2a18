"""Models built in Python, piece by piece: what those of the plane and those of space have in common."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Callable, Collection, Mapping
from typing import Any, ClassVar, Generic, TypeVar, overload

from pydantic import TypeAdapter
from pydantic import ValidationError as PydanticError

from ...errors import InputError
from ..body import check_names
from ..element import Element, Force, Joint
from ..fields import Described, sentence
from ..formula.names import NAMES
from ..formula.text import FormulaError
from ..given import Law
from ..kinds import Kinds
from ..marker import GROUND, MarkerReference
from ..model_data import RESERVED, ModelData, check_element, contents
from ..own_elements import check_class
from ..requests.check import ByChannel, by_channel, check_output
from ..requests.order import dimensions, with_named
from ..requests.output_field import RequestField
from ..states.inputs import InputValue
from ..states.linear_system import StateEntry
from ..states.section import check_states, names_in_formulas
from .handle import Handle

Data = TypeVar("Data", bound=ModelData)
Body = TypeVar("Body", bound=Described)
BodyHandle = TypeVar("BodyHandle", bound=Handle)


class ModelBuilder(Generic[Data, Body, BodyHandle]):
    """Base of the models built in Python.

    Attributes
    ----------
    data_type, body_type, handle_type : types
        The class of what is built, of its bodies, and of what stands for a body that has been added.
    kinds : Kinds, Kinds
        The joints and the forces of the family, by kind.
    """

    data_type: type[Data]
    body_type: type[Body]
    handle_type: type[BodyHandle]
    kinds: ClassVar[tuple[Kinds, Kinds]]

    def __init__(self, name: str, gravity: Any) -> None:
        self.name = name
        self.gravity = gravity
        self.markers: dict[str, Any] = {}
        self.bodies: dict[str, Body] = {}
        self.states: dict[str, StateEntry] = {}
        self.inputs: dict[str, Any] = {}
        self.joints: dict[str, Joint] = {}
        self.forces: dict[str, Force] = {}
        self.requests: dict[str, Any] = {}

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {contents(self)}>"

    @overload
    def add(self, name: str, part: Body) -> BodyHandle: ...

    @overload
    def add(self, name: str, part: Joint | Force | StateEntry) -> None: ...

    def add(self, name: str, part: Any) -> BodyHandle | None:
        """Add a body, a joint, a force or a state.

        Parameters
        ----------
        name : str
            Letters, digits and ``_``; no other part has it.
        part : Body, Joint, Force or State

        Returns
        -------
        BodyHandle or None
            For a body what stands for it in markers and formulas, and changes it.

        Raises
        ------
        InputError
            When the name is taken, reserved or no identifier, or the part names an unknown body.
        """
        section = self._section_for(name, part)
        self._check_name(name)
        self._check(name, part)
        section[name] = part
        return self._handle(name)

    @overload
    def replace(self, name: str | BodyHandle, part: Body) -> BodyHandle: ...

    @overload
    def replace(self, name: str | BodyHandle, part: Joint | Force) -> None: ...

    def replace(self, name: str | BodyHandle, part: Any) -> BodyHandle | None:
        """Put another body, joint or force in the place of one, under its name.

        Parameters
        ----------
        name : str or BodyHandle
            Of the part that goes.
        part : Body, Joint or Force
            A body for a body, a joint for a joint, a force for a force.

        Returns
        -------
        BodyHandle or None
            As `add` does; handles that there are already stand for the new body too.

        Raises
        ------
        InputError
            When there is no such part, the new one names an unknown body, or others name what the new one does not have.
        """
        name = str(name)
        section = self._found(name)
        if section is not self._section_for(name, part):
            raise InputError(
                f"{name}: found {part!r} in place of {section[name]!r}, expected a body for a body, a joint for a joint, a force for a force"
            )
        self._check(name, part)
        fewer_markers = section is self.bodies and section[name].markers.keys() - part.markers.keys()
        if isinstance(part, Joint) or (isinstance(part, Force) and self.requests) or fewer_markers:
            self._changed(name, section, lambda: section.update({name: part}))
        section[name] = part
        return self._handle(name)

    def remove(self, name: str | BodyHandle) -> None:
        """Take a body, a joint, a force, a request, or a marker of ground (``"ground.pivot"``) out of the model.

        Raises
        ------
        InputError
            When there is no such part, or others name it.
        """
        name = str(name)
        section = self._found(name)
        self._changed(name, section, lambda: section.pop(_key(name)))

    def _handle(self, name: str) -> BodyHandle | None:
        return self.handle_type(name, self) if name in self.bodies else None

    def _sections(self) -> tuple[dict[str, Any], ...]:
        return self.bodies, self.states, self.inputs, self.joints, self.forces, self.requests

    def _found(self, name: str) -> dict[str, Any]:
        """The section that holds a part."""
        for section in (self.markers,) if name.startswith(f"{GROUND}.") else self._sections():
            if _key(name) in section:
                return section
        raise InputError(f"{name}: found no part of that name, expected one of {self!r}")

    def _section_for(self, name: str, part: Any) -> dict[str, Any]:
        """The section that a part belongs to."""
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

    def _changed(self, name: str, section: dict[str, Any], change: Callable[[], object]) -> None:
        """Change a section, unless other parts then name what is no longer there."""
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
            raise InputError(f"{name}: found it in use ({error}), expected what names it changed first") from None

    def _of_the_family(self) -> str:
        return " of stiffmbs.spatial" if self._dimensions() == 3 else " of the plane (stiffmbs)"

    def _dimensions(self) -> int:
        dimensions: int = self.data_type.model_fields["dimensions"].default
        return dimensions

    def mark(self, name: str, marker: Any) -> None:
        """Give a marker on ground a name, for references and formulas: ``ground.name``.

        Parameters
        ----------
        name : str
        marker : Marker
            On ``ground``, with its point and direction given on the spot.

        Raises
        ------
        InputError
            When the name is taken or no identifier, or the marker is not given on the spot on ground.
        """
        self._check_spelling(name, "marker")
        if name in self.markers:
            raise InputError(f"{name}: found a name that is taken, expected another")
        placement = marker.placement() if isinstance(marker, MarkerReference) and marker.body == GROUND else None
        if placement is None:
            raise InputError(f"{name}: found {marker!r}, expected a marker with a point on ground")
        self.markers[name] = placement

    def add_input(self, name: str, value: Any) -> None:
        """Add an input: a value by a name that formulas use, and that each run may be given anew.

        Parameters
        ----------
        name : str
            Letters, digits and ``_``; no other part has it.
        value : float, str or Table
            A number, also as text with a unit, or a table of time.

        Raises
        ------
        InputError
            When the name is taken, or the value is none of these.
        """
        self._check_name(name)
        try:
            self.inputs[name] = TypeAdapter(InputValue).validate_python(value)
        except PydanticError as error:
            raise InputError(f"inputs.{name}: {sentence(error)}") from None

    def request(self, name: str, formula: Law | Mapping[str, Law]) -> None:
        """Report a formula of anything that a run knows as a channel of the given name, or several as ``name.component``.

        Parameters
        ----------
        name : str
            Of the channel.
        formula : str, float or mapping of str to these
            In SI units, such as ``"0.6*abs(bar.omega)"`` or ``"fx(hinge) + tip_speed"``, of parts and requests that have been
            added; several by the names of their components.

        Raises
        ------
        InputError
            As for `add`, and for a formula that cannot be read.
        """
        self._check_name(name)
        names = self.data_type.output_names
        try:
            read = RequestField(names).read(formula, {})
            added = dict(by_channel({name: read}))
            outputs = ChainMap(added, ByChannel(self.requests))  # type: ignore[arg-type]  # it is only read
            for channel, output in added.items():
                check_output(f"requests.{channel}", output, self, names, outputs)
            dimensions(with_named(added, outputs))
        except FormulaError as error:
            raise InputError(f"requests.{name}: {error}") from None
        except ValueError as error:
            raise InputError(str(error)) from None
        self.requests[name] = read

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
        check_element(
            name,
            part,
            self.bodies,
            self.joints,
            self.markers,
            NAMES[self._dimensions()],
            self._names(),
        )

    def _names(self) -> set[str]:
        return names_in_formulas(self.states) | set(self.inputs)

    def _check_states(self, states: Mapping[str, StateEntry], known: Collection[str] | None) -> None:
        check_states(states, self.bodies, self.markers, self.joints, NAMES[self._dimensions()], known)

    def _content(self) -> dict[str, Any]:
        sections = ("name", "gravity", "markers", "bodies", "states", "inputs", "joints", "forces", "requests")
        return {section: getattr(self, section) for section in sections}

    def data(self) -> Data:
        """The model as it would stand in a scene.

        Raises
        ------
        InputError
            When the model has no body.
        """
        return self.data_type(**self._content())

    def to_scene(self) -> str:
        """The text of a scene file that holds the model: `stiffmbs.read_scene` makes the same model of it.

        Raises
        ------
        InputError
            As for `data`.
        """
        from ..model_text import model_text

        return model_text(self.data())


def _key(name: str) -> str:
    """The name in its section: that of a marker of ground is without its owner."""
    return name.removeprefix(f"{GROUND}.")
