"""Base of the joints between two markers."""

from __future__ import annotations

from typing import Generic

from pydantic import Field

from ...reading.marker import M
from ..element import Joint


class Pair(Joint, Generic[M]):
    """Base of the joints between two markers; scenes use its planar and spatial subclasses."""

    reflected = {}

    i: M = Field(description="marker of the first body, on which the reaction is reported")
    j: M = Field(description="marker of the second body")
