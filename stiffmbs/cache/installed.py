"""Versions of installed packages on which cache entries depend."""

from __future__ import annotations

import os
import re
import sys
from functools import cache

METADATA = ".dist-info"


@cache
def installed_version(package: str) -> str:
    """Return the version of an installed package from the name of its metadata folder.

    `importlib.metadata.version` looks in the same folders, but its imports take longer than the rest of reading a
    cached scene. It is called for packages without such a folder, as in zipped applications.
    """
    wanted = _normal(package)
    for folder in sys.path:
        try:
            names = os.listdir(folder or os.curdir)
        except OSError:  # a zipped application, or no folder
            continue
        for name in names:
            if name.endswith(METADATA):
                found, _, version = name.removesuffix(METADATA).partition("-")
                if version and _normal(found) == wanted:
                    return version
    from importlib.metadata import version as recorded

    return recorded(package)


def _normal(name: str) -> str:
    """Return the normal form of the name of a package (PEP 503)."""
    return re.sub(r"[-_.]+", "-", name).lower()
