"""Models built in Python, piece by piece: what those of the plane and those of space have in common."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from ..errors import InputError
from .body import check_names
from .element import Element, Force, Joint
from .fields import Described
from .formula.names import NAMES
from .formula.text import FormulaError
from .marker import GROUND, MarkerReference
from .model_data import RESERVED, check_element
from .requests.check import by_channel, check_output
from .requests.order import dimensions
from .requests.output_field import RequestField


class ModelBuilder:
    """Base of the models built in Python.

    Attributes
    ----------
    data_type, body_type, handle_type : types
        The class of what is built, of its bodies, and of what stands for a body that has been added.
    kinds : mapping of str to type
        The joints and forces of the family, by kind.
    """

    data_type: ClassVar[type[Any]]
    body_type: ClassVar[type[Described]]
    handle_type: ClassVar[type[Any]]
    kinds: ClassVar[Mapping[str, type[Element]]]

    def __init__(self, name: str, gravity: tuple[float | str, ...]) -> None:
        self.name = name
        self.gravity = gravity
        self.markers: dict[str, Any] = {}
        self.bodies: dict[str, Any] = {}
        self.joints: dict[str, Joint] = {}
        self.forces: dict[str, Force] = {}
        self.requests: dict[str, Any] = {}

    def add(self, name: str, part: Any) -> Any:
        """Add a body (its handle is returned), a joint or a force under a name.

        Raises
        ------
        InputError
            When the name is taken, reserved or no identifier, or the part names an unknown body.
        """
        section: dict[str, Any]
        match part:
            case self.body_type():
                section = self.bodies
            case Joint():
                section = self.joints
            case Force():
                section = self.forces
            case _:
                raise InputError(f"{name}: found {part!r}, expected a body, a joint or a force{self._of_the_family()}")
        if isinstance(part, Element) and type(part) not in self.kinds.values():
            raise InputError(f"{name}: found {part!r}, expected a joint or a force{self._of_the_family()}")
        self._check(name, part)
        section[name] = part
        return self.handle_type(name) if isinstance(part, self.body_type) else None

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

    def request(self, name: str, formula: Any) -> None:
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
            requests = {**self.requests, name: read}
            outputs = dict(by_channel(requests))
            for channel, output in by_channel({name: read}):
                check_output(f"requests.{channel}", output, self, names, outputs)
            dimensions(outputs)
        except FormulaError as error:
            raise InputError(f"requests.{name}: {error}") from None
        except ValueError as error:
            raise InputError(str(error)) from None
        self.requests = requests

    @staticmethod
    def _check_spelling(name: object, what: str) -> None:
        try:
            check_names([name], what)
        except ValueError as error:
            raise InputError(str(error)) from None

    def _check_name(self, name: str) -> None:
        self._check_spelling(name, "part")
        taken = {*self.bodies, *self.joints, *self.forces, *self.requests, *RESERVED}
        if name in taken:
            raise InputError(f"{name}: found a name that is taken or reserved, expected another")

    def _check(self, name: str, part: Described) -> None:
        self._check_name(name)
        try:
            if isinstance(part, Element):
                check_element(name, part, self.bodies, self.joints, self.markers, NAMES[self._dimensions()])
        except ValueError as error:
            raise InputError(str(error)) from None

    def data(self) -> Any:
        """The model as it would stand in a scene.

        Raises
        ------
        InputError
            When the model has no body.
        """
        return self.data_type(
            name=self.name, gravity=self.gravity, markers=self.markers, bodies=self.bodies, joints=self.joints,
            forces=self.forces, requests=self.requests,
        )  # fmt: skip
