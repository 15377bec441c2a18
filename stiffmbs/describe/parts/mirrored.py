"""Elements of mirrored parts."""

from __future__ import annotations

from typing import Any

from ...errors import InputError
from ..element import Element


def mirrored(element: Element, part: str, frame: Any, where: str) -> Element:
    raise InputError(f"{where}: found a mirror")
