"""Which body the rig of an axle clamps where none is named."""

from pathlib import Path

import pytest

from stiffmbs import InputError, read_scene
from stiffmbs.studies.suspension.axle import axle_of


def test_the_body_that_carries_the_axle_is_clamped():
    text = (Path(__file__).parents[3] / "examples" / "vehicles" / "leaf_sprung_car.yaml").read_text()
    assert axle_of(read_scene(text), "rear").body == "chassis"
    assert axle_of(read_scene(text.replace("chassis", "ladder")), "rear").body == "ladder"


def test_the_axle_of_a_trailer_names_its_body():
    """The body of the truck holds it by the hitch alone."""
    scene = read_scene((Path(__file__).parents[3] / "examples" / "vehicles" / "truck.yaml").read_text())
    assert [axle_of(scene, axle).body for axle in ("front", "rear")] == ["chassis", "chassis"]
    assert axle_of(scene, "axle", "trailer").body == "trailer"
    with pytest.raises(InputError, match="axle 'axle': found its suspension on trailer and not on chassis"):
        axle_of(scene, "axle")
