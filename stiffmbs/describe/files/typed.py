"""The type that an entry of a scene has."""

from __future__ import annotations

from typing import Any

from .quoted import quoted


def typed(kind: str, found: Any) -> Any:
    """An entry as it was found, its type filled in.

    Raises
    ------
    ValueError
        When it has another type than this kind.
    """
    if not isinstance(found, dict):
        return found
    if found.get("type", kind) != kind:
        raise ValueError(f"found the type '{quoted(found['type'])}', expected '{kind}'")
    return {**found, "type": kind}
