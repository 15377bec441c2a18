"""Shift the start time of a scene."""

from __future__ import annotations

import copy
from typing import Any

from stiffmbs.reading.formula.field import FormulaOf

from ..random_scenes.draft import Content
from .change import Change
from .formulas import is_time, replaced, with_other_formulas
from .typed import Mapper, mapped_scene


def shifted(content: Content, start: float) -> Change:
    """Return a scene that starts at `start`, with t - start in its formulas and shifted samples."""

    def replace(node: Any) -> str | None:
        return f"(t - ({start!r}))" if is_time(node) else None

    class Later(Mapper):
        """Replace the time in formulas that may contain it."""

        def formula(self, value: Any, kind: FormulaOf, owner: Content) -> Any:
            return replaced(value, replace) if kind.time else value

    found = mapped_scene(with_other_formulas(copy.deepcopy(content), replace), Later())
    found["run"] = {**found["run"], "start": start}
    for state in found.get("states", {}).values():
        if "offset" in state:
            state["offset"] += start
    return Change(f"starting at {start:g} s", found, start=start)
