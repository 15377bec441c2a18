"""Layout of the numbers of a flexible body: those of `BODY`, of `MODE` for each mode, and of `PAIR` by l and k.

`PAIR` has Z + W, the axial vector and the trace of Z, and T (`stiffmbs.compile.machine.native.flexible.sums`).
"""

from __future__ import annotations

BODY = {"gravity": 3, "d0": 3, "X": 9, "moments": 3, "modal_mass": 1}
MODE = {"stiffness": 1, "damping": 1, "S": 3, "Y": 9}
PAIR = {"ZW": 9, "axial": 3, "trace": 1, "T": 3}
"""Names and lengths of consecutive numbers."""
MODES, OF_MODE, OF_PAIR = sum(BODY.values()), sum(MODE.values()), sum(PAIR.values())
"""Number of the first mode, and numbers of each mode and pair."""
