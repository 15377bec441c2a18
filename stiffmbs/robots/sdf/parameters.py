"""Parameters of the reader of SDFormat files."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class SdfParameters:
    """Parameters of the reader of SDFormat files.

    - `files`: largest number of files that a file includes, repeated ones and those of included files counted. Source: a bound on the
      work for files that include others many times.
    - `parallel`: largest sine of the angle between the axes of a gearbox and of the hinge that it turns. Source: orientations are
      written with three to six digits.
    """

    files: int = 1000
    parallel: float = 1e-3


SDF = SdfParameters()
