"""Random scenes in which drives prescribe every coordinate, for the solver `kinematic`."""

from __future__ import annotations

import copy

import numpy as np

from .bodies import add_body
from .catalogue import FORCES
from .draft import GROUND, Content, Draft, Unfit
from .features import ALL, Features
from .joints import add_joint
from .laws import law_of_time

FULL_ANGLE, WAY = 1.0, 0.5
"""Sizes of driven angles, rad, and of driven velocities, m/s."""


def driven_scene(rng: np.random.Generator, dimensions: int | None = None, features: Features = ALL) -> Content:
    """Return the content of a random scene file in which each joint is driven.

    Parameters
    ----------
    rng : Generator
    dimensions : int, optional
        2 or 3; one of them at random by default.
    features : Features, optional
        What its forces may have.
    """
    draft = Draft(rng, dimensions or int(rng.integers(2, 4)), features)
    draft.content = {**({"dimensions": 3} if draft.in_space else {}), "bodies": {}}
    draft.content["gravity"] = draft.vector(9.0)
    for _ in range(int(rng.integers(1, 4))):
        parent = draft.choice([*draft.poses, GROUND])
        joint = add_joint(draft, draft.choice(["revolute", "prismatic"]), add_body(draft), parent)
        turns = draft.content["joints"][joint]["type"] == "revolute"
        law = {"position": law_of_time(draft, FULL_ANGLE)} if turns else {"velocity": law_of_time(draft, WAY)}
        draft.add("joints", "drive", type="drive", joint=joint, **law)
    fitting = [maker for maker in FORCES if not maker.needs and draft.dimensions in maker.dimensions]
    for _ in range(int(rng.integers(0, 3))):
        try:
            draft.choice(fitting).make(draft)
        except Unfit:
            continue
    draft.content["run"] = {"duration": draft.uniform(0.2, 0.4), "points": 21}
    return {name: section for name, section in copy.deepcopy(draft.content).items() if section}
