"""Reasons why elements of SDFormat files have no effect."""

from __future__ import annotations

from collections.abc import Mapping

SHAPES, SENSORS, SOLVER, LIMITS = (
    "shapes and contacts are left out",
    "requests of the scene measure",
    "settings of the simulator",
    "limits are not held",
)
DRAWING, PLUGINS = "graphics", "plugins are programs of the simulator"
REASONS: Mapping[str, Mapping[str, str]] = {
    "*": {
        "<plugin>": PLUGINS, "<sensor>": SENSORS, "<light>": DRAWING, "<actor>": DRAWING, "<visual>": DRAWING,
        "<projector>": DRAWING, "<particle_emitter>": DRAWING, "<collision>": SHAPES, "<gripper>": SHAPES,
        "<self_collide>": SHAPES, "<allow_auto_disable>": SOLVER,
    },
    "joint": {"<physics>": SOLVER}, "link/collision": {"*": SHAPES},
    "joint/axis/limit": {"*": LIMITS}, "joint/axis2/limit": {"*": LIMITS},
    "link": {"<kinematic>": "all links follow the forces", "<must_be_base_link>": SOLVER, "<audio_source>": SENSORS, "<audio_sink>": SENSORS},
    "world": {
        "<scene>": DRAWING, "<gui>": DRAWING, "<audio>": SENSORS, "<physics>": SOLVER, "<road>": DRAWING, "<population>": SHAPES,
        "<state>": "models start where their poses place them", "<atmosphere>": "the fluid is left out", "<wind>": "the fluid is left out",
        "<magnetic_field>": SENSORS, "<spherical_coordinates>": SENSORS,
    },
}  # fmt: skip
"""Reasons why elements have no effect."""
WITH_CONTACTS: Mapping[str, Mapping[str, str]] = {
    **{key: value for key, value in REASONS.items() if key != "link/collision"},
    "link/collision/geometry/mesh": {"*": "meshes have no contact"},
}
"""Reasons if the shapes of contacts are read."""
