"""Check of references to markers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .marker import GROUND, MarkerReference


def check_marker(where: str, marker: MarkerReference, bodies: Mapping[str, Any], on_ground: Mapping[str, Any]) -> None:
    """Refuse a marker on an unknown body, or a marker name that its body does not have."""
    if marker.body != GROUND and marker.body not in bodies:
        raise ValueError(f"{where}: found the unknown body '{marker.body}', expected {listed(bodies)}")
    own = on_ground if marker.body == GROUND else bodies[marker.body].markers
    if marker.marker is not None and marker.marker not in own:
        raise ValueError(f"{where}: found '{marker.label}', expected one of its markers ({', '.join(own) or 'none'})")


def listed(bodies: Mapping[str, Any]) -> str:
    """Return the names of bodies as a list for a message."""
    names = list(bodies)
    return ", ".join([*names[:8], *(["..."] if len(names) > 8 else []), GROUND])
