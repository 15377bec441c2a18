"""Results of a run that an .asmt file contains."""

from __future__ import annotations

import re

import numpy as np

from ...reading.files.quoted import quoted
from ...reading.files.text_file import lines
from ..assembly import CadFault
from .tree import RESULTS

FORCES = {f"{part}{axis}onI": f"{part.lower()}{axis.lower()}" for part in "FT" for axis in "XYZ"}
"""Components of the force on marker I and of the torque about it, in ground axes, by their rows: as a scene's channels."""
_UNFIT = re.compile(r"[^0-9A-Za-z_]")
_OWNER = re.compile(r"\w*Series\s+/[^/]*(?:/(.*))?")


def stored_results(text: str) -> dict[str, np.ndarray]:
    """Return the results after the model in the text of an .asmt file, by name.

    Forces of joints have the names of a scene's channels, ``hinge.fx``. The pose of a part's frame, its velocities and
    accelerations have those of the file: ``crank.X``, ``crank.Bryantx``; positions of a scene are those of the centre of
    mass. The times are ``time``. The first column, of the pose in the file, is left out. Raises CadFault if there are no
    results, or a row has a word or another number of values.
    """
    _, found, table = "\n".join(["", *lines(text)]).partition(f"\n{RESULTS}\n")
    rows: dict[str, list[float]] = {}
    owner = ""
    for line in table.splitlines():
        name, *words = line.split("\t")
        if opening := _OWNER.match(line.strip()):
            owner = _UNFIT.sub("_", (opening[1] or "").strip())  # empty for the assembly
            continue
        channel = "time" if name.strip() == "Time" else f"{owner}.{FORCES.get(name.strip(), name.strip())}"
        numbers = _numbers(channel, words)
        if numbers and (owner or channel == "time"):
            rows[channel] = numbers
    count = len(rows.get("time", ()))
    if not found or not count:
        raise CadFault("found no results, expected the lines 'TimeSeries' and 'Time' after the model")
    for name, numbers in rows.items():
        if len(numbers) not in (count, count + 1):
            raise CadFault(
                f"results {name}: found {len(numbers)} numbers, expected {count + 1}, as there are {count} times"
            )
    return {name: np.array(numbers[-count:]) for name, numbers in rows.items()}


def _numbers(channel: str, words: list[str]) -> list[float]:
    """Return the numbers of a row; the first word of the times is the word Input."""
    found = [word.strip() for word in words if word.strip() not in ("", "Input")]
    try:
        return [float(word) for word in found]
    except ValueError:
        raise CadFault(f"results {channel}: found '{quoted(' '.join(found))}', expected numbers") from None
