"""Types accepted by constructors in Python: numbers also as text with units, bodies also as handles."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from ..elements.roads import envelope, road
    from ..elements.tyres import coefficients
    from .handle import Handle
    from .marker import MarkerReference
    from .python_function import PythonFunction
    from .table import Table

Number: TypeAlias = "float | np.number[Any] | str"
"""Number in SI units, or text with a unit: ``0.3``, ``"300 mm"``."""
Numbers: TypeAlias = "Sequence[Number | None] | np.ndarray"
Matrix: TypeAlias = "Sequence[Number | Sequence[Number | None] | np.ndarray | None] | np.ndarray"
"""Matrix by rows, or by its diagonal if the field allows it."""
Law: TypeAlias = "float | np.number[Any] | str"
"""Formula or number."""
Laws: TypeAlias = "Law | Sequence[Law]"
Curve: TypeAlias = "Law | Table | Mapping[str, object]"
"""Formula of one variable, or table."""
Function: TypeAlias = "Callable[..., object] | PythonFunction"
Marker: TypeAlias = "str | Handle | MarkerReference | Mapping[str, object]"
"""Name of a body or of a marker, handle of a body, or explicit marker."""
MarkerSequence: TypeAlias = "Sequence[Marker]"
Road: TypeAlias = "road.Road | Mapping[str, object]"
"""Road made in Python, or its type and fields."""
TyreProperties: TypeAlias = "coefficients.TyreProperties | str | Path | Mapping[str, object]"
"""Property file, or its coefficients."""
Envelope: TypeAlias = "envelope.Envelope | Mapping[str, object]"
"""Cams of the enveloping contact of a tyre."""
Markers: TypeAlias = "Mapping[str, object]"
"""Named points on a body."""
Geometry: TypeAlias = "Mapping[str, object] | Sequence[Mapping[str, object]]"
"""Shapes of a body, each with its ``type``; a single one needs no list."""
Orientation: TypeAlias = "Sequence[object] | np.ndarray | Mapping[str, object]"
