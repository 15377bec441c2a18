"""A dataset as the mapping that a scene is read from."""

from __future__ import annotations

import re
from typing import Any

from ..functions.translate import Translation
from ..statements.dataset import Dataset
from .bodies import bodies, ground_markers
from .bodies import notes as body_notes
from .forces import Forces
from .gears import gears
from .initial_conditions import notes as start_notes
from .initial_conditions import set_in_motion
from .joints import held, joints
from .mechanism import Mechanism
from .motions import motions
from .number_format import vector
from .racks import notes as rack_notes
from .relations import relations
from .requests import Requests

RUN = {"duration": 5, "output": 0.01}
"""How a dataset is run, which says nothing about it itself."""


def scene(dataset: Dataset) -> dict[str, Any]:
    """The scene of a dataset, as `stiffmbs.describe.scene.read_scene` takes it.

    Raises
    ------
    DatasetFault
        When statements contradict each other, or hold what a scene cannot.
    """
    mechanism = Mechanism(set_in_motion(Mechanism(dataset)))
    translation = Translation(mechanism)
    requests = Requests(mechanism)
    driven = motions(mechanism, translation)  # these before bodies, which get the markers that formulas need
    joined = joints(mechanism, translation)
    meshed = gears(mechanism)
    found: dict[str, Any] = {
        "name": re.sub(r"(?i)^adams[/ ]view model name:\s*", "", dataset.title),
        "dimensions": 3,
        "gravity": vector(dataset.gravity),
        "markers": ground_markers(mechanism),
        "bodies": bodies(mechanism),
        "joints": {
            **joined,
            **held(mechanism),
            **relations(mechanism),
            **meshed,
            **driven,
        },
        "forces": Forces(mechanism, translation).all(),
        "requests": requests.all(),
        "run": dict(RUN),
        "notes": [
            *dataset.notes,
            *mechanism.notes(),
            *body_notes(mechanism),
            *rack_notes(mechanism),
            *start_notes(dataset),
            *requests.notes,
        ],
    }
    found["tables"] = mechanism.tables
    return {key: value for key, value in found.items() if value or key == "bodies"}
