"""Reduction of a described flexible body, kept in the cache by content."""

from __future__ import annotations

import hashlib
import io
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ..cache.entries import Folder, digest, tag_of
from ..cache.source_files import digest_of, python_files
from ..errors import InputError
from .description import FlexibleBody, UpTo, content_of_file
from .reduction import ReducedBody, reduce, rigid_body
from .second_order import SecondOrder

FOLDER, BODY, SECOND = "bodies", "body", "second_order"
MOST, MOST_BYTES = 100, 2_000_000_000
"""Limits on the number of entries and on their total size in bytes."""
SAME_MASS = 0.05
"""Difference from the stated mass that is refused, relative to it."""


def reduced_body(body: FlexibleBody, folder: Path) -> ReducedBody:
    """Return the reduced body, from the cache if its description and its files are unchanged.

    Parameters
    ----------
    body : FlexibleBody
    folder : Path
        Folder of relative file names.

    Raises
    ------
    InputError
    """
    name = f"{BODY}-{_key(body, folder)}"
    stored = folder_of_bodies().read(name)
    if stored is not None:
        return _loaded(stored)
    model = body.model(folder)
    _check_mass(body, rigid_body(model)[0])
    count, highest = (None, body.modes.up_to) if isinstance(body.modes, UpTo) else (body.modes, None)
    found = reduce(model, body.interfaces_on(model), count, highest, body.residual_modes)
    out = io.BytesIO()
    np.savez(
        out,
        **{name: value for name, value in vars(found).items() if name != SECOND},
        **{f"{SECOND}.{name}": value for name, value in vars(found.second_order).items()},
    )
    folder_of_bodies().write(name, out.getvalue())
    folder_of_bodies().keep_newest(MOST, MOST_BYTES)
    return found


def _check_mass(body: FlexibleBody, mass: float) -> None:
    """Refuse a mass that contradicts the stated one."""
    if body.mass is not None and abs(mass - body.mass) > SAME_MASS * body.mass:
        raise InputError(
            f"mass: found {mass:.6g} kg by the {'density and volume' if body.mesh else 'mass matrix'} in these units, "
            f"expected the stated {body.mass:g} kg"
        )


@cache
def folder_of_bodies() -> Folder:
    """Return the folder for this version of the reduction."""
    from importlib.metadata import version

    own = digest_of(python_files(Path(__file__).parent))
    return Folder(FOLDER, tag_of(own, version("numpy"), version("scipy")))


def _key(body: FlexibleBody, folder: Path) -> str:
    contents = (hashlib.sha256(content_of_file(folder / name)).hexdigest() for name in body.files)
    described = body.model_dump_json(include=FlexibleBody.model_fields.keys() - {"stiffening"})
    return digest(described, *contents)


def _loaded(content: bytes) -> ReducedBody:
    with np.load(io.BytesIO(content)) as arrays:
        found: dict[str, Any] = {name: arrays[name] if arrays[name].ndim else arrays[name].item() for name in arrays}
    second = {name: found.pop(f"{SECOND}.{name}") for name in (field.name for field in fields(SecondOrder))}
    return ReducedBody(**found, second_order=SecondOrder(**second))
