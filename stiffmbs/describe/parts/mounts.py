"""Further bodies that a part connects to, besides its mount: the rack of a tie rod, the arm under a strut.

``mounts: {rack: mount}`` in a part says that it calls such a body ``rack``, and that it is the part's mount unless a use names
another one: ``mounts: {rack: steering.rack}``.  A point on it is given in the part's frame.
"""

from __future__ import annotations

from typing import Any

from ...errors import InputError
from ..files.quoted import written
from .names import GROUND, MOUNT
from .use import Use


def mounts_of(found: Any, use: Use, where: str) -> dict[str, str]:
    """The bodies that stand for the further mounts of a part.

    Parameters
    ----------
    found : mapping of str to str
        Of the definition.
    use : Use
    where : str
        The path of the use.

    Raises
    ------
    InputError
        Where the use names one that the part does not have.
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
