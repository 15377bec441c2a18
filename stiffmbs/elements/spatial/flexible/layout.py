"""Layout of the numbers of a flexible body: those of `BODY`, of `MODE` for each mode, and Z_lk by l and k."""

from __future__ import annotations

BODY = {"gravity": 3, "d0": 3, "X": 9, "moments": 3, "modal_mass": 1}
MODE = {"stiffness": 1, "damping": 1, "S": 3, "Y": 9}
"""Names and lengths of consecutive numbers."""
MODES, OF_MODE = sum(BODY.values()), sum(MODE.values())
"""Number of the first mode, and numbers of each."""
