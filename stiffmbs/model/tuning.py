"""Validation of changed solver parameters, ``run.tuning``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ..errors import prefixed
from ..reading.did_you_mean import instead_of
from ..reading.files.quoted import quoted, written
from ..tuning import SUBSYSTEMS, defaults_of, numbers_of

MOST = 1000
"""Largest ratio of an integer to its default, as some are sizes of arrays."""

REMOVED = {
    "masking": "events are no longer left out after a number of steps; remove this entry",
    "presolve: at_rest": "all modes of flexible bodies are solved for; remove this entry",
}
"""Subsystems and parameters of earlier versions, and what replaces them."""

Read = Callable[[Any], float]
"""Conversion of an entry to a number; raises a ValueError for other entries."""


def checked(found: object, read: Read) -> dict[str, dict[str, object]]:
    """Return changed parameters by subsystem and name.

    ValueError if a name is unknown, or a value has another type than the default, or is out of its range.
    """
    changes: dict[str, dict[str, object]] = {}
    for name, values in _entries(found, "subsystems"):
        _refuse_unknown("", "subsystem", name, SUBSYSTEMS)
        usual = numbers_of(defaults_of(name))
        changes[name] = {}
        for field, value in _entries(values, f"parameters of '{name}'"):
            _refuse_unknown(f"{name}: ", "parameter", field, usual)
            changes[name][field] = _checked(f"{name}.{field}", value, usual[field], read)
    return changes


def _entries(found: object, names: str) -> list[tuple[Any, Any]]:
    if not isinstance(found, Mapping):
        raise ValueError(f"found {written(found)}, expected a mapping of {names} to values")
    return list(found.items())


def _refuse_unknown(where: str, what: str, found: object, known: Mapping[str, object]) -> None:
    if (removed := f"{where}{found}") in REMOVED:
        raise ValueError(f"{where}found the removed {what} '{found}': {REMOVED[removed]}")
    if found not in known:
        raise ValueError(f"{where}found the unknown {what} '{quoted(found)}'{instead_of(found, known)}")


def _checked(where: str, found: object, usual: Any, read: Read) -> Any:
    """Return a value with the type of the default, in its range."""
    if isinstance(usual, tuple):
        if not isinstance(found, list | tuple) or len(found) != len(usual):
            raise ValueError(f"{where}: found {written(found)}, expected a list of {len(usual)} numbers")
        return tuple(_checked(where, *pair, read) for pair in zip(found, usual, strict=True))
    with prefixed(f"{where}: ", ValueError, ValueError):
        value = read(found)
    if isinstance(usual, int) and value == round(value) and (usual == 0 or 1 <= value <= MOST * usual) and value >= 0:
        return int(value)
    least, most = bounds(usual)
    if isinstance(usual, float) and (least < value < most or value == usual):
        return value
    expected = f"an integer from {min(usual, 1)} to {MOST * usual}" if isinstance(usual, int) else _between(least, most)
    raise ValueError(f"{where}: found {written(found)}, expected {expected} (the default is {usual!r})")


def bounds(usual: float) -> tuple[float, float]:
    """Return the open range of a parameter: fractions stay below 1 and factors above 1, so that loops end."""
    if usual < 1.0:
        return 0.0, 1.0
    return (0.0 if usual == 1.0 else 1.0), float("inf")


def _between(least: float, most: float) -> str:
    return f"a number between {least:g} and {most:g}" if most == 1.0 else f"a number greater than {least:g}"
