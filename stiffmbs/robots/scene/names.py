"""Valid scene names for arbitrary names of a robot file."""

from __future__ import annotations

import re

from ...describe.formula.functions import FUNCTIONS
from ...describe.units.units import UNITS

GROUND = "ground"


class Names:
    """Registry of unique scene names of letters, digits and _."""

    def __init__(self) -> None:
        self._taken = {GROUND, "t", "pi", *UNITS, *FUNCTIONS}

    def take(self, wanted: str, what: str = "") -> str:
        """Return the name if valid and free, else a similar one with a suffix: `what`, or a number."""
        name = re.sub(r"[^0-9A-Za-z_]", "_", wanted) or "_"
        name = f"_{name}" if name[0].isdigit() else name
        name = f"{name}_{what}" if what and name in self._taken else name
        found, k = name, 2
        while found in self._taken:
            found, k = f"{name}_{k}", k + 1
        self._taken.add(found)
        return found
