"""Reduction of a described flexible body, kept in the cache by content."""

from __future__ import annotations

import hashlib
import io
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ..cache import entries
from ..cache.installed import installed_version
from ..cache.source_files import digest_of, python_files
from ..errors import InputError
from .description import FlexibleBody, UpTo
from .reduction import ReducedBody, reduce, rigid_body
from .second_order import SecondOrder

SECOND = "second_order"
SAME_MASS = 0.05
"""Difference from the stated mass that is refused, relative to it."""


def reduced_body(body: FlexibleBody, folder: Path) -> ReducedBody:
    """Return the reduced body, from the cache if its description and its files are unchanged.

    The shapes of a mesh's modes do not depend on Young's modulus and density: it is reduced once for all their values.
    `folder`: folder of relative file names. Raises InputError.
    """
    modulus, density = body.scales
    highest = body.modes.up_to * np.sqrt(density / modulus) if isinstance(body.modes, UpTo) else None
    body = body.scaled()
    name = _name(body, highest, folder)
    stored = entries.read(name)
    if stored is not None:
        found = _loaded(stored)
        _check_mass(body, found.mass * density)
        return found.of_material(modulus, density)
    model = body.model(folder)
    _check_mass(body, rigid_body(model)[0] * density)
    count = None if isinstance(body.modes, UpTo) else body.modes
    found = reduce(model, body.interfaces_on(model), count, highest, body.residual_modes, body.loads_on(model))
    out = io.BytesIO()
    np.savez(
        out,
        **{name: value for name, value in vars(found).items() if name != SECOND},
        **{f"{SECOND}.{name}": value for name, value in vars(found.second_order).items()},
    )
    entries.write(name, out.getvalue())
    return found.of_material(modulus, density)


def _check_mass(body: FlexibleBody, mass: float) -> None:
    """Refuse a mass that contradicts the stated one."""
    if body.mass is not None and abs(mass - body.mass) > SAME_MASS * body.mass:
        raise InputError(
            f"mass: found {mass:.6g} kg by the {'density and volume' if body.mesh else 'mass matrix'} in these units, "
            f"expected the stated {body.mass:g} kg"
        )


@cache
def _reduction() -> str:
    """Return a digest of the reduction."""
    folder = Path(__file__).parent
    own = digest_of([*python_files(folder), *python_files(folder / "shells")])
    return entries.digest(own, installed_version("numpy"), installed_version("scipy"))


def _name(body: FlexibleBody, highest: float | None, folder: Path) -> str:
    contents = (hashlib.sha256(content).hexdigest() for content in body.contents(folder))
    unused = {"stiffening", "mass", "modes"} if highest else {"stiffening", "mass"}
    described = body.model_dump_json(include=FlexibleBody.model_fields.keys() - unused)
    return entries.name_of("body", _reduction(), described, repr(highest), *contents)


def _loaded(content: bytes) -> ReducedBody:
    with np.load(io.BytesIO(content)) as arrays:
        found: dict[str, Any] = {name: arrays[name] if arrays[name].ndim else arrays[name].item() for name in arrays}
    second = {name: found.pop(f"{SECOND}.{name}") for name in (field.name for field in fields(SecondOrder))}
    return ReducedBody(**found, second_order=SecondOrder(**second))
