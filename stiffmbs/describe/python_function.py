"""Python functions as fields of elements, for laws that no formula can express."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import core_schema

from .files.quoted import written

Way = Literal["differences", "complex_step"]


class PythonFunction:
    """A Python function that a force calls while a model is solved.

    Parameters
    ----------
    function : callable
        Takes an array of numbers and returns a number, or as many as the force wants.  It must give the same for the same
        numbers: it is called at trial states too, and not in the order of time.
    derivatives : {"differences", "complex_step"}
        How its derivatives are computed: by central differences, or exact to rounding by a step along the imaginary axis,
        for which it must take complex numbers and be analytic (without ``abs`` and comparisons).
    """

    def __init__(self, function: Callable[..., Any], derivatives: Way = "differences") -> None:
        self.function, self.derivatives = function, derivatives

    @property
    def name(self) -> str:
        """What messages call it."""
        return getattr(self.function, "__qualname__", type(self.function).__qualname__)

    def __repr__(self) -> str:
        return f"PythonFunction({self.name})"

    @classmethod
    def read(cls, found: object) -> PythonFunction:
        """A function as a field has it."""
        if isinstance(found, PythonFunction):
            return found
        if not callable(found):
            raise ValueError(
                f"found {written(found)}, expected a Python function, which only a Model built in Python can have"
            )
        return cls(found)

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> Any:
        return core_schema.no_info_plain_validator_function(cls.read)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"not": {}, "description": "a Python function, which only a Model built in Python can have"}
