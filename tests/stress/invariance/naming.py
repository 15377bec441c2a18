"""Rename and reorder the bodies, joints, forces and states of a scene."""

from __future__ import annotations

import json
import re

import numpy as np

from ..random_scenes.draft import Content
from .change import Change, Channels

SECTIONS = ("bodies", "joints", "forces", "states", "tables", "roads", "use", "inputs", "requests")


def renamed(content: Content, rng: np.random.Generator) -> Change:
    """Return a scene with other names in another order."""
    names = [name for section in SECTIONS for name in content.get(section, {})]
    others = {name: f"n{number}_{name[::-1]}" for name, number in zip(names, rng.permutation(len(names)), strict=True)}
    pattern = re.compile(r"(?<![\w.])(" + "|".join(map(re.escape, names)) + r")(?!\w)")
    text = json.dumps({key: content[key] for key in (*SECTIONS, "joints") if key in content})
    found = content | json.loads(pattern.sub(lambda match: others[match[1]], text))
    for section in SECTIONS:
        if section in found:
            found[section] = {
                list(found[section])[k]: list(found[section].values())[k] for k in rng.permutation(len(found[section]))
            }
    own = {new: old for old, new in others.items()}

    def back(channels: Channels, time: np.ndarray) -> Channels:
        return {_old(name, own): series for name, series in channels.items()}

    return Change("with other names in another order", found, back)


def _old(channel: str, own: dict[str, str]) -> str:
    first, dot, rest = channel.partition(".")
    return own.get(first, first) + dot + rest
