"""What a joint and a force are: fields with units, and their equations in SymPy, written once.

An element's equations are static functions of `e`, the element with its markers as symbolic frames
(`stiffmbs.compile.symbolic.planar_frames.Frame`, in space `stiffmbs.compile.symbolic.spatial_frames.SpatialFrame`) and its numbers as
symbols.  Jacobians, velocity and acceleration terms, reactions and kernels are all derived from them, so an element is its
fields, its equations and their names.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator, Mapping
from functools import reduce
from operator import or_
from types import ModuleType
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

from pydantic import Field, WithJsonSchema

from ..errors import InputError
from .fields import Described
from .formula.field import Formula
from .marker import MarkerReference
from .names import names_of

if TYPE_CHECKING:
    from .model_data import ModelData

Symbolic = Any
"""The element as its equations see it (`stiffmbs.compile.symbolic.frames.SymbolicElement`): a frame for a marker, a symbol for a number, an expression for a formula, a
function for a formula or table of a variable, a symbolic element for a joint that is referred to; ``e.t`` for time,
``e.rate(expression)`` for a total time derivative, ``e.frames`` for the bodies."""


COORDINATES = ("angle", "displacement")
"""What the coordinates of joints are called."""


class JointName(str):
    """The name of a joint of the model, or of one of its coordinates (``sleeve.angle``), in a field of another element."""

    @property
    def joint(self) -> str:
        """The joint's name."""
        owner, _, last = self.rpartition(".")
        return owner if owner and last in COORDINATES else str(self)

    def coordinate_of(self, joint: Joint) -> str | None:
        """Which of the joint's coordinates is meant; None where it has no such one, or there is a choice."""
        name = self[len(self.joint) + 1 :]
        if name:
            return name if name in joint.coordinates else None
        return joint.coordinates[0] if len(joint.coordinates) == 1 else None

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Any) -> Any:
        from pydantic_core import core_schema

        return core_schema.with_info_after_validator_function(
            lambda text, info: cls(names_of(info).full(text)), core_schema.str_schema()
        )


JointReference = Annotated[
    JointName, WithJsonSchema({"type": "string", "description": "the name of a joint, or of one of its coordinates"})
]


class Element(Described):
    """Base of joints and forces.  A subclass in its own file in `joints` or `forces` is all that a new kind takes.

    Attributes
    ----------
    reflected : mapping of str to str, optional
        How fields change in the mirror image of a part; those that it does not name stay.  Each marker's axes X become
        S X S (`stiffmbs.describe.parts.planar_frame.PlanarFrame`).  None: the element cannot be mirrored.  For a number, a
        law or components along the axes: ``vector``, ``rotations``, ``components`` (of force, then of torque), ``matrix``,
        ``angle`` (about the last axis), ``pitch`` (along z for each turn), ``x``, ``about x``; names of fields that name joints: as
        the product of their coordinates.  For a marker: its axis whose direction matters, such as ``z``.
    """

    kind: ClassVar[str] = ""
    reflected: ClassVar[dict[str, str] | None] = None

    def parts(self, part: type) -> Iterator[tuple[str, Any]]:
        """The element's markers, formulas, or joint names: every value of a type, by field name, in order."""
        for name in type(self).model_fields:
            value = getattr(self, name)
            for item in value if isinstance(value, tuple) else (value,):
                if isinstance(item, part):
                    yield name, item

    def markers(self) -> Iterator[tuple[str, MarkerReference]]:
        """The element's markers by field name, the first body's first; those in its formulas after its own."""
        yield from self.parts(MarkerReference)
        for name, formula in self.parts(Formula):
            for _, markers in formula.measures():
                yield from ((name, marker) for marker in markers)

    def equation_names(self) -> tuple[str, ...]:
        """The names of the element's constraint equations; none for a force."""
        return ()

    def refused(self, joints: Mapping[str, Joint]) -> Iterator[tuple[str, str]]:
        """A field and what is wrong with the joint that it refers to, "found ..., expected ..."; nothing where all fit."""
        yield from ()

    def misplaced(self, model: ModelData) -> Iterator[str]:
        """Why the element cannot act where the bodies are drawn."""
        yield from ()

    def as_drawn(self, model: ModelData) -> Self:
        """The element with what it leaves open taken from the bodies' described poses."""
        return self


class Joint(Element):
    """A constraint between bodies.

    Attributes
    ----------
    equations : tuple of str
        The names of the equations that `position`, then `velocity`, return; used in reports.
    coordinates : tuple of str
        The names of its coordinates, for drives and couplers: ``angle``, ``displacement``.  A joint has a static
        function of `e` by the name of each.
    """

    equations: ClassVar[tuple[str, ...]] = ()
    coordinates: ClassVar[tuple[str, ...]] = ()

    @staticmethod
    def position(e: Symbolic) -> Any:
        """The constraint equations C(q, t) = 0, one expression for each name in `equations`."""
        return ()

    @staticmethod
    def velocity(e: Symbolic) -> Any:
        """Equations linear in u that have no position form, such as a prescribed rate."""
        return ()

    @staticmethod
    def point(e: Symbolic) -> Any:
        """The joint's point, about which its torque is reported."""
        return e.i.point

    def equation_names(self) -> tuple[str, ...]:
        return self.equations


class Force(Element):
    """An applied force: efforts on coordinates or on rates, by virtual power.

    The generalised force is the sum of effort times the derivative of its coordinate: a spring is its tension on
    its length, a force at a point is its components on the point's coordinates.  A force that acts on a rate that
    belongs to no coordinate, as a torque in space on an angular velocity, has `powers` in place of `efforts`.

    Attributes
    ----------
    turns : bool
        Whether it stands for a body's turning in space, and the body's kinematics, p' = Z(p) w, belong to it.
    beyond : str
        What is wrong where one of its `limits` is passed: "found ..., expected ...".
    """

    turns: ClassVar[bool] = False
    beyond: ClassVar[str] = ""

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Any, Any]]:
        """Pairs of an effort and the coordinate that it does work on."""
        raise NotImplementedError

    @classmethod
    def powers(cls, e: Symbolic) -> list[tuple[Any, Any]]:
        """Pairs of an effort and the rate that it has its power with, the rate being linear in velocities."""
        return [(effort, e.rate(coordinate)) for effort, coordinate in cls.efforts(e)]

    @staticmethod
    def potential(e: Symbolic) -> Any:
        """Potential energy, J; zero for a force that has none."""
        return 0

    @staticmethod
    def switches(e: Symbolic) -> Any:
        """Expressions that change their sign where the force has a corner in the state, such as a gap."""
        return ()

    @classmethod
    def limits(cls, e: Symbolic) -> Any:
        """Expressions above zero for as long as the force's law holds; where one is not, the run stops."""
        return ()

    @staticmethod
    def point(e: Symbolic) -> Any:
        """The point on the first body about which the force's torque is reported."""
        return e.i.point


def kinds(package: ModuleType, base: type[Element]) -> dict[str, type[Any]]:
    """The element classes found in the files of a package, by kind."""
    found: dict[str, type[Any]] = {}
    for module in pkgutil.iter_modules(package.__path__):
        members = vars(importlib.import_module(f"{package.__name__}.{module.name}")).values()
        for member in members:
            named = isinstance(member, type) and issubclass(member, base) and member.kind
            if named and found.setdefault(member.kind, member) is not member:
                raise InputError(f"two classes of elements have the kind '{member.kind}'")
    return found


def any_of(found: Mapping[str, type[Element]]) -> Any:
    """The type of a field that takes an element of any of the kinds, told apart by its ``type``."""
    return Annotated[reduce(or_, found.values()), Field(discriminator="type")]
