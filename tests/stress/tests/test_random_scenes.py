"""Random scenes have elements of all kinds, and can be read and run."""

import json
import re

import numpy as np
import pytest

from stiffmbs.analyses.run import run
from stiffmbs.elements.states.section import KINDS
from stiffmbs.errors import StiffmbsError
from stiffmbs.model import model as plane
from stiffmbs.model import spatial_model as space
from stiffmbs.model.parts.definitions import shipped_parts
from stiffmbs.model.read_scene import read_scene
from tests.stress.random_scenes.catalogue import WITHOUT, kinds
from tests.stress.random_scenes.driven import driven_scene
from tests.stress.random_scenes.features import STATIC, TREE, Features
from tests.stress.random_scenes.scene import random_scene

pytestmark = pytest.mark.long  # kernels that no other test compiles, or many scenes


def scenes(count, **options):
    return [random_scene(np.random.default_rng(seed), **options) for seed in range(count)]


def used(scene):
    return {
        *(("joints", joint["type"]) for joint in scene.get("joints", {}).values()),
        *(("forces", force["type"]) for force in scene.get("forces", {}).values()),
        *(("use", use["part"]) for use in scene.get("use", {}).values()),
        *(("states", key) for state in scene.get("states", {}).values() for key in state if key in KINDS),
    }


@pytest.mark.parametrize(("dimensions", "model"), [(2, plane), (3, space)])
def test_every_kind_of_element_has_a_maker(dimensions, model):
    """A new kind of element needs a maker, or a reason in WITHOUT."""
    made = {kind for section, kind in kinds(dimensions) if section in ("joints", "forces")}
    assert made | set(WITHOUT) >= {*model.JOINTS.shipped, *model.FORCES.shipped}
    assert not made & set(WITHOUT)
    assert {kind for section, kind in kinds(dimensions) if section == "states"} | {"numerator"} == set(KINDS)


def test_every_shipped_part_has_a_maker():
    made = {kind for section, kind in kinds(3) if section == "use"}
    assert made | set(WITHOUT) >= set(shipped_parts())


@pytest.mark.sampled(2)
@pytest.mark.parametrize("dimensions", [2, 3])
def test_scenes_have_all_kinds(dimensions):
    found = set.union(*map(used, scenes(1500 if dimensions == 3 else 300, dimensions=dimensions)))
    assert found >= set(kinds(dimensions))


def test_a_seed_gives_one_scene():
    assert scenes(5) == scenes(5)


def test_features_are_left_out():
    for scene in scenes(60, features=STATIC):
        sections = {key: json.dumps(scene.get(key, {})) for key in ("joints", "forces", "states")}
        assert not any(re.search(r"\bt\b", text) for text in sections.values())
        assert "drive" not in sections["joints"]
        assert "impact" not in sections["forces"]
        assert not any("velocity" in body for body in scene["bodies"].values())
    for scene in scenes(60, features=TREE):
        assert not {"coupler", "gear", "rack_and_pinion", "equation"} & {kind for _, kind in used(scene)}
    bare = Features(**dict.fromkeys(Features.__dataclass_fields__, False))
    assert not any({"states", "use", "roads", "inputs"} & scene.keys() for scene in scenes(60, features=bare))


def test_scenes_run(every):
    """Nine of ten scenes run to their end; drives of others contradict their joints, which is refused."""
    found = [outcome(random_scene(np.random.default_rng(seed))) for seed in every(range(20), 4)]
    assert len(found) - found.count("DONE") <= max(1, 0.1 * len(found))


def outcome(scene):
    try:
        return run(read_scene(json.dumps(scene))).outcome.name
    except StiffmbsError as refusal:
        return str(refusal)


@pytest.mark.parametrize("dimensions", [2, 3])
def test_driven_scenes_have_no_freedom(dimensions):
    scene = read_scene(json.dumps(driven_scene(np.random.default_rng(1), dimensions)))
    assert run(scene, solver="kinematic").outcome.name == "DONE"
