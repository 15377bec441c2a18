"""Python functions as fields of elements, for laws that no formula can express."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from .files.quoted import written

Way = Literal["differences", "complex_step"]


class PythonFunction:
    """Python function that a force calls during the solution.

    Parameters
    ----------
    function : callable
        Takes an array of numbers and returns a number, or as many as the force requires. It must be deterministic,
        because it is also called at trial states, in any order of time.
    derivatives : {"differences", "complex_step"}
        Computation of its derivatives: by central differences, or exact to rounding by a complex step. The latter
        requires that it accepts complex numbers and is analytic (without ``abs`` and comparisons).
    """

    def __init__(self, function: Callable[..., object], derivatives: Way = "differences") -> None:
        self.function, self.derivatives = function, derivatives

    @property
    def name(self) -> str:
        """Name of the function in messages."""
        return getattr(self.function, "__qualname__", type(self.function).__qualname__)

    def __repr__(self) -> str:
        return f"PythonFunction({self.name})"

    @classmethod
    def read(cls, found: object) -> PythonFunction:
        """Return a function as the value of a field."""
        if isinstance(found, PythonFunction):
            return found
        if not callable(found):
            raise ValueError(
                f"found {written(found)}, expected a Python function, which only a Model built in Python can have"
            )
        return cls(found)

    @classmethod
    def __get_pydantic_core_schema__(cls, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(cls.read)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: object, handler: GetJsonSchemaHandler) -> dict[str, object]:
        return {"not": {}, "description": "a Python function, which only a Model built in Python can have"}
