"""Random scenes of all kinds of elements."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np

from .bodies import add_body
from .catalogue import FORCES, PARTS, RELATIONS, STATES, Maker
from .draft import GROUND, Content, Draft, Unfit
from .features import ALL, Features
from .joints import EQUATIONS, add_joint

PARTS_PART, TYRES_PART = 0.12, 0.15
"""Fractions of spatial scenes with a library part, and with a wheel on a road."""
TRIES = 4
DOUBLED = ("revolute", "prismatic", "cylindrical", "spherical", "fixed", "universal")


def random_scene(rng: np.random.Generator, dimensions: int | None = None, features: Features = ALL) -> Content:
    """Return the content of a random scene file.

    Poses satisfy the joints; velocities are made consistent at the start of a run.  The motion is short, damped and not chaotic,
    so that it is reproducible.

    Parameters
    ----------
    rng : Generator
    dimensions : int, optional
        2 or 3; one of them at random by default.
    features : Features, optional
        What the scene may have.
    """
    draft = Draft(rng, dimensions or int(rng.integers(2, 4)), features)
    draft.content = beginning(draft)
    if features.inputs and draft.chance(0.2):
        draft.section("inputs")["push"] = draft.uniform(-1, 1)
    _add_part(draft)
    add_tree(draft)
    _some(draft, RELATIONS, int(rng.integers(0, 3)))
    if features.loops and draft.chance(0.4):
        _close_loop(draft)
    if features.redundant and draft.chance(0.3):
        _double_joint(draft)
    _some(draft, STATES, int(rng.choice([0, 0, 1, 2])))
    add_forces(draft, int(rng.integers(2, 5)))
    _add_requests(draft)
    return without_empty_sections(draft)


def without_empty_sections(draft: Draft) -> Content:
    """Return the content of a draft."""
    return {name: section for name, section in copy.deepcopy(draft.content).items() if section not in ({}, None)}


def add_forces(draft: Draft, count: int) -> None:
    """Add random forces other than tyres."""
    _some(draft, tuple(maker for maker in FORCES if maker.needs != ("tyres",)), count)


def beginning(draft: Draft) -> Content:
    """Return a scene without bodies."""
    down = [0.0] * (draft.dimensions - 1) + [-9.81]
    gravity = draft.choice([down, down, down, draft.vector(9.0), [0.0] * draft.dimensions])
    run = {"duration": draft.uniform(0.2, 0.4), "points": 21}
    space: dict[str, Any] = {"dimensions": 3} if draft.in_space else {}
    return {**space, "gravity": gravity, "bodies": {}, "run": run}


def _add_part(draft: Draft) -> None:
    """Add a part or a wheel to some of the scenes in space."""
    if draft.in_space and draft.features.parts and draft.chance(PARTS_PART):
        _some(draft, PARTS, 1)
    elif draft.in_space and draft.features.tyres and draft.chance(TYRES_PART):
        draft.content["gravity"] = [0.0, 0.0, -9.81]
        _some(draft, tuple(maker for maker in FORCES if maker.needs == ("tyres",)), 1)


def add_tree(draft: Draft) -> None:
    """Add bodies, each free or with a random joint to a previous body or the ground."""
    for _ in range(int(draft.rng.integers(1, 4 if draft.in_space else 5))):
        parent = draft.choice([*draft.poses, GROUND, GROUND])
        body = add_body(draft)
        if draft.chance(0.85):
            _some_joint(draft, tuple(EQUATIONS[draft.dimensions]), body, parent)


def _close_loop(draft: Draft) -> None:
    """Add a joint of few equations between two bodies that already have joints."""
    few = tuple(kind for kind, count in EQUATIONS[draft.dimensions].items() if count <= 2)
    _some_joint(draft, few, *draft.two_bodies())


def _some_joint(draft: Draft, kinds: tuple[str, ...], i: str, j: str) -> None:
    for _ in range(TRIES):
        try:
            add_joint(draft, draft.choice(kinds), i, j)
        except Unfit:
            continue
        return


def _double_joint(draft: Draft) -> None:
    """Add a copy of a joint, so that its equations are redundant."""
    names = [name for name, joint in draft.content.get("joints", {}).items() if joint["type"] in DOUBLED]
    if names:
        draft.add("joints", "second", **copy.deepcopy(draft.content["joints"][draft.choice(names)]))


def _some(draft: Draft, makers: tuple[Maker, ...], count: int) -> None:
    """Add some elements; an element that does not fit is skipped after a few attempts."""
    fitting = [maker for maker in makers if draft.dimensions in maker.dimensions and draft.features.has(maker.needs)]
    for _ in range(count if fitting else 0):
        for _ in range(TRIES):
            try:
                draft.choice(fitting).make(draft)
            except Unfit:
                continue
            break


def _add_requests(draft: Draft) -> None:
    """Add random requests of a distance, an acceleration and a reaction."""
    body, other = draft.two_bodies()
    if draft.chance(0.5):
        draft.section("requests")["apart"] = f"dm({body}, {other})"
    if draft.chance(0.3):
        draft.section("requests")["felt"] = f"accx({body}, ground, {body})"
