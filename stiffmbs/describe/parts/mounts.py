"""Further bodies that a part connects to, besides its mount: the rack of a tie rod, the arm of a strut.

``mounts: {rack: mount}`` in a part defines the local name ``rack``, and the part's mount as the default body. A use can
name another one: ``mounts: {rack: steering.rack}``. Points on it are in the part's frame.
"""

from __future__ import annotations

from typing import Any

from ...errors import InputError
from ..files.quoted import written
from .names import GROUND, MOUNT
from .use import Use


def mounts_of(found: Any, use: Use, where: str) -> dict[str, str]:
    """Return the bodies of the further mounts of a part.

    Parameters
    ----------
    found : mapping of str to str
        Mounts of the definition.
    use : Use
    where : str
        Path of the use.

    Raises
    ------
    InputError
        If the use names a mount that the part does not have.
    """
    mounts = {} if found is None else found
    if not isinstance(mounts, dict) or not all(isinstance(body, str) for body in mounts.values()):
        raise InputError(f"parts.{use.part}.mounts: found {written(found)}, expected a mapping of names to bodies")
    for name in mounts:
        if name in (MOUNT, GROUND) or not str(name).isidentifier():
            raise InputError(f"parts.{use.part}.mounts: found the name {written(name)}, expected another")
    for name in use.mounts:
        if name not in mounts:
            raise InputError(
                f"{where}.mounts.{name}: found no such mount of '{use.part}', expected one of {', '.join(mounts) or 'none'}"
            )
    return {**mounts, **use.mounts}
