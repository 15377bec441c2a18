"""What may be given for a field of each type: numbers as such or as text with units, bodies by name or by their handles."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from .building.handle import Handle
    from .marker import MarkerReference
    from .python_function import PythonFunction
    from .roads import road
    from .table import Table
    from .tyres import coefficients

Number: TypeAlias = "float | np.number[Any] | str"
"""In SI units, or text with a unit: ``0.3``, ``"300 mm"``."""
Numbers: TypeAlias = "Sequence[Number | None] | np.ndarray"
Matrix: TypeAlias = "Sequence[Number | Sequence[Number | None] | np.ndarray | None] | np.ndarray"
"""By rows, or by its diagonal where the field allows it."""
Law: TypeAlias = "float | np.number[Any] | str"
"""A formula, or a number."""
Laws: TypeAlias = "Law | Sequence[Law]"
Curve: TypeAlias = "Law | Table | Mapping[str, Any]"
"""A formula of one variable, or a table."""
Function: TypeAlias = "Callable[..., Any] | PythonFunction"
Marker: TypeAlias = "str | Handle | MarkerReference | Mapping[str, Any]"
"""A body or a marker of it by name, a body's handle, or a marker given on the spot."""
Road: TypeAlias = "road.Road | Mapping[str, Any]"
"""As made in Python, or its type and fields."""
TyreProperties: TypeAlias = "coefficients.TyreProperties | str | Path | Mapping[str, Any]"
"""A property file, or its coefficients."""
Markers: TypeAlias = "Mapping[str, Any]"
"""Named points on a body."""
Geometry: TypeAlias = "Mapping[str, Any] | Sequence[Mapping[str, Any]]"
"""Shapes of a body, each with its ``type``; one may stand alone."""
Orientation: TypeAlias = "Sequence[Any] | np.ndarray | Mapping[str, Any]"
