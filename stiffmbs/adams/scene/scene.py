"""Conversion of a dataset to a scene mapping."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from typing import Any

from ...elements.spatial.number_format import vector
from ..functions.inputs import input_values
from ..functions.states import states
from ..functions.translate import Translation
from ..statements.dataset import Dataset
from ..statements.fault import of_each
from .bodies import bodies, ground_markers
from .bodies import notes as body_notes
from .contacts import contacts
from .curves import curves, touching_bodies
from .curves import notes as curve_notes
from .forces import Forces
from .friction import frictions
from .friction import notes as friction_notes
from .gears import gears
from .initial_conditions import at_start, set_in_motion
from .initial_conditions import notes as start_notes
from .joints import held, joints
from .mechanism import Mechanism
from .motions import motions
from .racks import notes as rack_notes
from .relations import relations
from .requests import Requests
from .sensors import conditions
from .sensors import notes as sensor_notes

RUN = {"duration": 5, "output": 0.01}
"""Default run settings, which a dataset lacks."""


def scene(dataset: Dataset) -> dict[str, Any]:
    """Return the scene of a dataset for `stiffmbs.model.read_scene.read_scene`.

    Raises
    ------
    DatasetFault
        If statements contradict each other, or have no equivalent in a scene.
    """
    mechanism = Mechanism(set_in_motion(Mechanism(dataset)))
    mechanism.inputs |= input_values(dataset)
    translation = Translation(mechanism)
    requests = Requests(mechanism)
    makers: list[tuple[str, Callable[[], dict[str, Any]]]] = [
        ("joints", partial(joints, mechanism, translation)),
        ("joints", partial(held, mechanism)),
        ("joints", partial(relations, mechanism)),
        ("joints", partial(gears, mechanism)),
        ("joints", partial(curves, mechanism)),
        ("joints", partial(motions, mechanism, translation)),
        ("states", partial(states, translation)),
        ("forces", Forces(mechanism, translation).all),
        ("forces", partial(contacts, mechanism, translation)),
        ("forces", partial(frictions, mechanism, translation)),
    ]
    made = of_each(enumerate(makers), lambda numbered: {str(numbered[0]): numbered[1][1]()})
    sections: dict[str, dict[str, Any]] = {"joints": {}, "states": {}, "forces": {}}
    for (section, _), entries in zip(makers, made.values(), strict=True):
        sections[section] |= entries
    found: dict[str, Any] = {
        "name": re.sub(r"(?i)^adams[/ ]view model name:\s*", "", dataset.title),
        "dimensions": 3,
        "gravity": vector(dataset.gravity),
        "inputs": mechanism.inputs,
        "variables": mechanism.variables,
        "markers": {},
        "bodies": {},
        **sections,
        "at_start": at_start(mechanism),
        "requests": requests.all(),
        "run": dict(RUN),
        "notes": [
            *dataset.notes,
            *mechanism.notes(),
            *body_notes(mechanism),
            *rack_notes(mechanism),
            *friction_notes(mechanism),
            *curve_notes(mechanism),
            *sensor_notes(dataset),
            *start_notes(dataset),
            *requests.notes,
        ],
    }
    found["bodies"] = bodies(mechanism) | touching_bodies(mechanism)
    found["markers"] = ground_markers(mechanism)  # includes markers added for formulas
    found["tables"] = mechanism.tables
    found["stages"] = [{"until": conditions(dataset, mechanism.inputs)}] if dataset.active_sensors else []
    return {key: value for key, value in found.items() if value or key == "bodies"}
