"""Handles: references to the bodies of a model that is built in Python."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from ..errors import InputError
from .did_you_mean import instead_of
from .formula.names import FormulaNames

if TYPE_CHECKING:
    from ..model.model_builder import ModelBuilder


class Handle:
    """Reference to a body of a model, returned by `Model.add`; accepted wherever a body's name is.

    The coordinates and velocities that formulas use (``bar.x``, ``bar.omega``) are SymPy symbols, for
    `ConstraintEquation` and requests. The other fields (``bar.mass``) are those of the body in the model; assigning to
    them changes the model.

    Attributes
    ----------
    name : str
        Name of the body.
    """

    names: ClassVar[FormulaNames]
    fields: ClassVar[Mapping[str, Any]]
    name: str

    def __init__(self, name: str, model: ModelBuilder) -> None:
        vars(self).update(name=name, _model=model)

    @property
    def body(self) -> Any:
        """Current body in the model; asking for a removed one raises an InputError."""
        try:
            return vars(self)["_model"].bodies[self.name]
        except KeyError:
            raise InputError(f"{self.name}: found a body that was removed, expected one of the model") from None

    def __getattr__(self, field: str) -> Any:
        if field in self._symbols():
            import sympy

            return sympy.Symbol(f"{self.name}.{field}", real=True)
        if field not in self.fields:
            known = (*self._symbols(), *self._own())
            raise AttributeError(f"found no '{field}' of the body {vars(self).get('name')}{instead_of(field, known)}")
        return getattr(self.body, field)

    def __setattr__(self, field: str, value: object) -> None:
        body = self.body
        if field in self._symbols() and field in self.fields:
            raise InputError(
                f"{self.name}.{field}: found {value!r} for what formulas read during the run, expected model.replace"
                f"('{self.name}', Body(..., {field}=...)) to change it at the start"
            )
        if field not in self._own():
            raise InputError(f"{self.name}: found the unknown field '{field}'{instead_of(field, self._own())}")
        kept = {name: getattr(body, name) for name in body.model_fields_set}
        vars(self)["_model"].replace(self.name, type(body)(**{**kept, field: value}))

    @classmethod
    def _symbols(cls) -> tuple[str, ...]:
        return cls.names.positions + cls.names.velocities

    @classmethod
    def _own(cls) -> tuple[str, ...]:
        """Return the names of the fields that can be read and set."""
        return tuple(name for name in cls.fields if name not in cls._symbols())

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self._symbols(), *self._own()})

    def __str__(self) -> str:
        return self.name

    def __repr__(self) -> str:
        found = vars(self)["_model"].bodies.get(self.name, "removed from the model")
        return f"<{type(self).__name__} '{self.name}': {found!r}>"


class Handles(Mapping[str, Handle]):
    """Bodies of a part that has several, in a model built in Python, by name and in order."""

    what: ClassVar[str]

    def __init__(self, name: str, bodies: Mapping[str, Handle]) -> None:
        self.name, self._bodies = name, bodies

    def __getitem__(self, body: str) -> Handle:
        return self._bodies[body]

    def __iter__(self) -> Iterator[str]:
        return iter(self._bodies)

    def __len__(self) -> int:
        return len(self._bodies)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name}: {', '.join(self._bodies)}>"

    def __str__(self) -> str:
        return self.name

    def __getattr__(self, body: str) -> Handle:
        if body.startswith("_") or body not in self._bodies:
            raise AttributeError(f"{self.name}: found no {self.what} '{body}'{instead_of(body, self._bodies)}")
        return self._bodies[body]
