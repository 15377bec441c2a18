"""Conversion of a dataset to a scene mapping."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial

import numpy as np

from ...elements.spatial.number_format import vector
from ...reading.files.yaml_text import Content
from ..functions.inputs import input_values
from ..functions.motion_law import Law
from ..functions.states import states
from ..functions.translate import Translation
from ..statements.constraints import COMPONENTS, ROTATIONAL, TRANSLATIONAL, Joint, Motion
from ..statements.dataset import Dataset
from ..statements.text import of_each
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
from .racks import notes as rack_notes
from .relations import SORTS, coordinate, initial_displacement, relations
from .requests import Requests, conditions
from .requests import notes as sensor_notes

RUN = {"duration": 5, "output": 0.01}
"""Default run settings, which a dataset lacks."""


def scene(dataset: Dataset) -> dict[str, object]:
    """Return the scene of a dataset for `stiffmbs.model.read_scene.read_scene`.

    Raises DatasetFault if statements contradict each other, or have no equivalent in a scene.
    """
    mechanism = Mechanism(set_in_motion(Mechanism(dataset)))
    mechanism.inputs |= input_values(dataset)
    translation = Translation(mechanism)
    requests = Requests(mechanism)
    makers: list[tuple[str, Callable[[], Content]]] = [
        ("joints", partial(joints, mechanism, translation)),
        ("joints", partial(held, mechanism)),
        ("joints", partial(relations, mechanism)),
        ("joints", partial(gears, mechanism)),
        ("joints", partial(curves, mechanism)),
        ("joints", partial(motions, mechanism, translation)),
        ("states", partial(states, translation)),
        ("states", lambda: mechanism.states),
        ("forces", Forces(mechanism, translation).all),
        ("forces", partial(contacts, translation)),
        ("forces", partial(frictions, translation)),
    ]
    made = of_each(enumerate(makers), lambda numbered: {str(numbered[0]): numbered[1][1]()})
    sections: dict[str, dict[str, object]] = {"joints": {}, "states": {}, "forces": {}}
    for (section, _), entries in zip(makers, made.values(), strict=True):
        sections[section] |= entries
    found: dict[str, object] = {
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


def motions(mechanism: Mechanism, translation: Translation) -> dict[str, object]:
    """Return the scene's drives by name."""

    def made(motion: Motion) -> dict[str, object]:
        of_pair = _between_markers if motion.joint is None else _of_joint
        return {motion.name: of_pair(motion, mechanism, translation)}

    return of_each(mechanism.dataset.motions.values(), made)


def _of_joint(motion: Motion, mechanism: Mechanism, translation: Translation) -> dict[str, object]:
    joint = mechanism.dataset.joints.get(motion.joint or 0)
    if ("JOINT", motion.joint) in mechanism.dataset.inactive:
        raise motion.fault(
            f"found JOINT = {motion.joint}, which is inactive, expected the motion to be deactivated too"
        )
    if joint is None:
        raise motion.fault(f"found JOINT = {motion.joint}, expected the number of a JOINT")
    sort = _sort(motion, joint)
    i, j = mechanism.ends(joint)
    law = Law(motion, translation, sort)
    initial = initial_displacement(sort, i, j)
    return {"type": "drive", "joint": coordinate(joint, sort), **law.over_time(initial)}


def _sort(motion: Motion, joint: Joint) -> str:
    own = SORTS.get(joint.kind)
    if joint.kind == "CYLINDRICAL":
        own = motion.sort
    if own is None or motion.sort not in (None, own):
        raise motion.fault(
            f"found {motion.sort or 'neither ROTATIONAL nor TRANSLATIONAL'} of {joint.label}, {joint.kind}, expected a "
            "revolute, translational or cylindrical joint and a motion that it has"
        )
    return own


def _between_markers(motion: Motion, mechanism: Mechanism, translation: Translation) -> dict[str, object]:
    """Return a drive between two markers: a component in the axes of J, or a body-fixed x-y-z angle."""
    assert motion.i is not None and motion.j is not None and motion.component is not None
    i, j = mechanism.place(motion.i, motion, "I"), mechanism.place(motion.j, motion, "J")
    relative = i.initial.seen_from(j.initial)
    component = motion.component
    drive = {"type": "drive", "i": i.reference, "j": j.reference}
    if component in COMPONENTS[:3]:
        displacement = f"d{component.lower()}({i.reference}, {j.reference}, {j.reference})"
        initial = float(relative.point[COMPONENTS[:3].index(component)])
        return {**drive, "coordinate": displacement, **Law(motion, translation, TRANSLATIONAL).over_time(initial)}
    A = relative.axes  # Rx(b1) Ry(b2) Rz(b3): AX gives b1, and AZ of J against I gives -b3
    angle, initial = {
        "B1": (f"ax({i.reference}, {j.reference})", float(np.arctan2(-A[1, 2], A[2, 2]))),
        "B2": (
            f"asin(dx({mechanism.tip(i)}, {i.reference}, {j.reference}))",
            float(np.arcsin(np.clip(A[0, 2], -1, 1))),
        ),
        "B3": (f"-az({j.reference}, {i.reference})", float(np.arctan2(-A[0, 1], A[0, 0]))),
    }[component]
    return {**drive, "coordinate": angle, **Law(motion, translation, ROTATIONAL).over_time(initial)}
