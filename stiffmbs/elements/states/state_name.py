"""Names of states."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pydantic_core import CoreSchema


def own_state(element: str, state: str) -> str:
    """Return the full name of an element's own state."""
    return f"{element}.{state}"


class StateName(str):
    """Full name of a state."""

    @classmethod
    def __get_pydantic_core_schema__(cls, source: object, handler: object) -> CoreSchema:
        from pydantic_core import core_schema

        return core_schema.no_info_after_validator_function(cls, core_schema.str_schema())
