"""Reaction components that joints in space transmit."""

from __future__ import annotations

COMPONENTS = ("fx", "fy", "fz", "tx", "ty", "tz")


def transmitted() -> dict[str, tuple[str, ...]]:
    """Return the components that each kind of joint in space transmits (`Joint.transmits`), if declared.

    Kinds that transmit only forces come first, those with most components leading, as point guides are easier to make
    than orientation guides.
    """
    from ..elements.spatial.spatial_kinds import JOINTS

    found = [(kind, joint.transmits) for kind, joint in JOINTS.items() if joint.transmits]
    return dict(sorted(found, key=lambda item: (any(name[0] == "t" for name in item[1]), -len(item[1]))))
