"""Exudyn as it is imported for speed."""

from __future__ import annotations

import contextlib
import io
import sys
from typing import Any

FAST = "exudynFast"
"""Of `sys`: whether exudyn is imported without its checks of ranges, as its documentation recommends for speed."""


def module() -> Any:
    """Exudyn, which would tell on standard output what it is."""
    setattr(sys, FAST, True)
    with contextlib.redirect_stdout(io.StringIO()):
        import exudyn
    exudyn.config.printToConsole = False
    return exudyn


def recorded(mbs: Any, node: int, kind: Any = None) -> int:
    """A sensor that keeps something of a node in memory: its coordinates unless given."""
    exu = module()
    from exudyn import itemInterface as items

    kind = kind or exu.OutputVariableType.Coordinates
    return int(
        mbs.AddSensor(items.SensorNode(nodeNumber=node, storeInternal=True, writeToFile=False, outputVariableType=kind))
    )
