"""What a joint and a force are: fields with units, and their equations in SymPy, written once.

An element's equations are static functions of `e`, the element with its markers as symbolic frames
(`stiffmbs.compile.frames.Frame`) and its numbers as symbols.  Jacobians, velocity and acceleration terms,
reactions and kernels are all derived from them, so an element is its fields, its equations and their names.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from types import ModuleType
from typing import Any, ClassVar

from ..errors import InputError
from .fields import Described
from .formula_field import Formula
from .marker import Marker

Symbolic = Any
"""The element as its equations see it: `Frame` for a marker, a symbol for a number, ``e.t`` for time,
``e.rate(expression)`` for a total time derivative."""


class Element(Described):
    """Base of joints and forces.  A subclass in its own file in `joints` or `forces` is all that a new kind takes."""

    kind: ClassVar[str] = ""

    def markers(self) -> Iterator[tuple[str, Marker]]:
        """The element's markers by field name, the first body's first."""
        for name in type(self).model_fields:
            if isinstance(value := getattr(self, name), Marker):
                yield name, value

    def formulas(self) -> Iterator[tuple[str, Formula]]:
        """The element's formulas, labelled by field name and place."""
        for name in type(self).model_fields:
            value = getattr(self, name)
            for k, item in enumerate(value if isinstance(value, tuple) else (value,)):
                if isinstance(item, Formula):
                    yield f"{name}[{k}]", item

    def bodies(self) -> tuple[str, ...]:
        """The bodies (or ground) that the element acts on, in the order of its markers, then of its formulas."""
        named = [marker.body for _, marker in self.markers()]
        for _, formula in self.formulas():
            named += [body for body in formula.bodies if body not in named]
        return tuple(named)

    @classmethod
    def equation_names(cls, element: Element) -> tuple[str, ...]:
        """The names of the element's constraint equations; none for a force."""
        return ()


class Joint(Element):
    """A constraint between bodies.

    Attributes
    ----------
    equations : tuple of str
        The names of the equations that `position` returns, used in reports.
    """

    equations: ClassVar[tuple[str, ...]] = ()

    @staticmethod
    def position(e: Symbolic) -> Any:
        """The constraint equations C(q, t), one expression for each name in `equations`."""
        raise NotImplementedError

    @staticmethod
    def point(e: Symbolic) -> Any:
        """The joint's point, about which its torque is reported."""
        return e.i.point

    @classmethod
    def equation_names(cls, element: Element) -> tuple[str, ...]:
        return cls.equations


class Force(Element):
    """An applied force: efforts on coordinates, by virtual power.

    The generalised force is the sum of effort times the derivative of its coordinate: a spring is its tension on
    its length, a force at a point is its two components on the point's two coordinates.
    """

    @staticmethod
    def efforts(e: Symbolic) -> list[tuple[Any, Any]]:
        """Pairs of an effort and the coordinate that it does work on."""
        raise NotImplementedError

    @staticmethod
    def potential(e: Symbolic) -> Any:
        """Potential energy, J; zero for a force that has none."""
        return 0

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
