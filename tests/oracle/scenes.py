"""Random scenes of the elements that the independent equations of motion have."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import partial

from tests.stress.random_scenes import forces, relations, states
from tests.stress.random_scenes.bodies import add_body
from tests.stress.random_scenes.draft import GROUND, Draft, Unfit
from tests.stress.random_scenes.features import SMOOTH
from tests.stress.random_scenes.joints import add_joint
from tests.stress.random_scenes.scene import beginning, without_empty_sections

from .joints import PLANE, SPACE

FEATURES = replace(SMOOTH, nonholonomic=False)
STATES = (
    states.add_state,
    states.add_algebraic_state,
    states.add_filter,
    states.add_linear_system,
    states.add_controller,
)
FORCES = (
    forces.add_force, forces.add_torque, forces.add_line_force, forces.add_spring_damper, forces.add_torsion_spring,
    forces.add_bushing,
)  # fmt: skip
TRIES = 6


def random_content(rng, features=FEATURES, dimensions=None, forces_of=FORCES, bodies=4):
    """Return the content of a random scene without tables."""
    draft = Draft(rng, dimensions or int(rng.integers(2, 4)), features)
    draft.content = beginning(draft)
    kinds = [*(SPACE if draft.in_space else PLANE), "distance"]
    for _ in range(int(rng.integers(1, bodies))):
        parent = draft.choice([*draft.poses, GROUND, GROUND])
        body = add_body(draft)
        if draft.chance(0.85):
            _one(draft, [partial(add_joint, kind=kind, i=body, j=parent) for kind in kinds])
    if features.loops and draft.chance(0.4):
        few = ["distance", "point_on_plane", "perpendicular"] if draft.in_space else ["distance", "point_on_line"]
        i, j = draft.two_bodies()
        _one(draft, [partial(add_joint, kind=kind, i=i, j=j) for kind in few])
    if draft.chance(0.3) and (features.loops or features.time):
        _one(draft, [relations.add_coupler] * features.loops + [relations.add_drive] * features.time)
    if features.redundant and draft.chance(0.3) and draft.content.get("joints"):
        names = [
            name for name, joint in draft.content["joints"].items() if "i" in joint and joint["type"] != "distance"
        ]
        if names:
            draft.add("joints", "second", **json.loads(json.dumps(draft.content["joints"][draft.choice(names)])))
    for _ in range(int(rng.choice([0, 0, 1, 2])) if features.states else 0):
        _one(draft, STATES)
    for _ in range(int(rng.integers(2, 6))):
        _one(draft, forces_of)
    return without_empty_sections(draft)


def _one(draft, makers):
    """Add an element without a table, after some attempts or not at all."""
    for _ in range(TRIES):
        before = json.loads(json.dumps(draft.content)), dict(draft.poses), list(draft.coordinates), draft.freedoms
        try:
            draft.choice(makers)(draft)
        except Unfit:
            pass
        else:
            if "table" not in json.dumps(draft.content):
                return
        draft.content, draft.poses, draft.coordinates, draft.freedoms = before
