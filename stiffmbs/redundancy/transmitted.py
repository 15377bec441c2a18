"""What joints in space transmit."""

from __future__ import annotations

COMPONENTS = ("fx", "fy", "fz", "tx", "ty", "tz")


def transmitted() -> dict[str, tuple[str, ...]]:
    """What each kind of joint in space transmits, of those that state it (`Joint.transmits`).

    Kinds that transmit forces alone come first, and of these those that transmit most: guides by points are easier to make
    than those by orientations.
    """
    from ..describe.spatial.model import JOINTS

    found = [(kind, joint.transmits) for kind, joint in JOINTS.items() if joint.transmits]
    return dict(sorted(found, key=lambda item: (any(name[0] == "t" for name in item[1]), -len(item[1]))))
