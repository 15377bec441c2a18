"""Scenes with full turns added to described angles, or with markers i and j exchanged, which must move the same."""

from __future__ import annotations

import copy
import re
from collections.abc import Iterator
from typing import Any

import numpy as np

from ..random_scenes.draft import Content
from .change import Change, Channels
from .typed import NotLegitimate

TURN = 2 * np.pi
HOLDING = ("revolute", "fixed", "prismatic", "point_on_line", "distance", "spring_damper", "bushing")
"""Kinds whose forces do not depend on full turns between described angles."""
MESHING = ("gear", "coupler", "rack_and_pinion")
"""Kinds whose default offset follows from the described angles."""
EXCHANGED = ("revolute", "fixed", "distance", "spring_damper", "torsion_spring")
SECTIONS = ("joints", "forces")


def _bodies(entry: Content) -> list[str]:
    """Return the bodies of the markers i and j of an element."""
    markers = [entry[key] for key in ("i", "j") if key in entry]
    return [marker["body"] if isinstance(marker, dict) else str(marker).partition(".")[0] for marker in markers]


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict | list):
        for part in value.values() if isinstance(value, dict) else value:
            yield from _texts(part)


def _elements(content: Content) -> Iterator[tuple[str, Content]]:
    for section in SECTIONS:
        yield from content.get(section, {}).items()


def _named_elsewhere(content: Content, name: str, allowed: tuple[str, ...] = ()) -> bool:
    """Return True if a formula, or an element of another kind than the allowed ones, names a body or joint."""
    others = [content.get("states", {}), content.get("requests", {})]
    others += [entry for key, entry in _elements(content) if key != name and entry["type"] not in allowed]
    return any(re.search(rf"(?<![\w.]){re.escape(name)}(?!\w)", text) for text in _texts(others))


def with_full_turns(content: Content, rng: np.random.Generator) -> Change:
    """Return a planar scene with full turns added to the angles of bodies that only holding elements refer to."""
    if content.get("dimensions", 2) == 3:
        raise NotLegitimate("no angles of bodies in space")
    free = {name for name in content["bodies"] if not _named_elsewhere(content, name, HOLDING)}
    for name, entry in _elements(content):
        meshed = entry["type"] in HOLDING and not _named_elsewhere(content, name, (*HOLDING, *MESHING))
        set_offset = any(name in entry.values() and "offset" in entry for _, entry in _elements(content))
        if not meshed or set_offset:
            free -= {*_bodies(entry)}
    if not free:
        raise NotLegitimate("each body is named in a formula, or turns a spring or drive")
    turns = {name: int(rng.integers(-3, 4)) for name in sorted(free)}
    found = copy.deepcopy(content)
    for name, n in turns.items():
        found["bodies"][name]["angle"] = found["bodies"][name].get("angle", 0.0) + TURN * n
    between = {f"{name}.angle": n for name, n in turns.items()}
    for name, entry in content.get("joints", {}).items():
        if len(own := _bodies(entry)) == 2:
            between[f"{name}.angle"] = turns.get(own[0], 0) - turns.get(own[1], 0)

    def back(channels: Channels, _: np.ndarray) -> Channels:
        return {name: series - TURN * between.get(name, 0) for name, series in channels.items()}

    return Change(f"with full turns {turns}", found, back)


def with_exchanged_markers(content: Content, rng: np.random.Generator) -> Change:
    """Return a scene in which some elements have their markers i and j exchanged; their channels are left out."""
    found, exchanged = copy.deepcopy(content), set()
    for section in SECTIONS:
        for name, entry in content.get(section, {}).items():
            plain = not entry.keys() & {"spring_law", "damper_law"} and not _named_elsewhere(content, name)
            if entry["type"] in EXCHANGED and {"i", "j"} <= entry.keys() and plain and rng.random() < 0.7:
                signs = {key: -entry[key] for key in ("free_angle", "preload") if key in entry}
                signs = signs if entry["type"] == "torsion_spring" else {}
                found[section][name] = {**entry, "i": entry["j"], "j": entry["i"], **signs}
                exchanged.add(name)
    if not exchanged:
        raise NotLegitimate("no element with exchangeable markers")

    def back(channels: Channels, _: np.ndarray) -> Channels:
        return {name: series for name, series in channels.items() if name.rpartition(".")[0] not in exchanged}

    return Change(f"with i and j of {', '.join(sorted(exchanged))} exchanged", found, back)
