"""Disable and enable flags of an MJCF model."""

from __future__ import annotations

from typing import Any

from ...reading.files.requested import Fields

OF_PASSIVE = ("SPRING", "DAMPER")
"""Flags that older versions of MuJoCo combine as PASSIVE."""


class Disabled:
    """Disable flags of a compiled model by name, with a record of the requested ones."""

    def __init__(self, m: Any) -> None:
        import mujoco

        off, on = (_bits(kind) for kind in (mujoco.mjtDisableBit, mujoco.mjtEnableBit))
        self._off = Fields("flag", "", {name: "disabled" for name, bit in off.items() if m.opt.disableflags & bit})
        self._on = Fields("flag", "", {name: "enabled" for name, bit in on.items() if m.opt.enableflags & bit})

    def __call__(self, *names: str) -> bool:
        """Return True if any of the features is disabled."""
        found = [name in self._off or (name in OF_PASSIVE and "PASSIVE" in self._off) for name in names]
        return any(found)

    def all(self, *names: str) -> bool:
        """Return True if all of the features are disabled."""
        found = [self(name) for name in names]
        return all(found)

    def fields(self) -> tuple[Fields[str], Fields[str]]:
        """Return the disable and the enable flags that are set."""
        return self._off, self._on


def _bits(kind: Any) -> dict[str, int]:
    """Return the flags of an enumeration by name, without prefix."""
    return {name[7:]: int(getattr(kind, name)) for name in dir(kind) if name.startswith(("mjDSBL_", "mjENBL_"))}
