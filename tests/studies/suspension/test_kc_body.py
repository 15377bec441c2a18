"""Which body the rig of an axle clamps where none is named."""

from pathlib import Path

from stiffmbs import read_scene
from stiffmbs.studies.suspension.axle import axle_of


def test_the_body_that_carries_the_axle_is_clamped():
    text = (Path(__file__).parents[3] / "examples" / "vehicles" / "leaf_sprung_car.yaml").read_text()
    assert axle_of(read_scene(text), "rear").body == "chassis"
    assert axle_of(read_scene(text.replace("chassis", "ladder")), "rear").body == "ladder"
