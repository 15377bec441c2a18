"""Generators of random elements of each kind, and the kinds without one."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType

from . import contacts, forces, parts, relations, states, tyres
from .draft import Draft
from .joints import EQUATIONS

Make = Callable[[Draft], str]
PLANE, SPACE, BOTH = (2,), (3,), (2, 3)


@dataclass(frozen=True)
class Maker:
    """Generator of elements of one kind.

    Attributes
    ----------
    section : str
        Section of the scene: ``joints``, ``forces``, ``states`` or ``use``.
    kind : str
        The element's `type`; the distinctive key of a state; the name of a part.
    make : callable
    needs : tuple of str
        Required `Features` of the scene.
    dimensions : tuple of int
    """

    section: str
    kind: str
    make: Make
    needs: tuple[str, ...] = ()
    dimensions: tuple[int, ...] = BOTH


EVENTS = ("events",)
RELATIONS: tuple[Maker, ...] = (
    Maker("joints", "coupler", relations.add_coupler, ("loops",)),
    Maker("joints", "gear", relations.add_gear, ("loops",)),
    Maker("joints", "rack_and_pinion", relations.add_rack_and_pinion, ("loops",)),
    Maker("joints", "drive", relations.add_drive, ("time",)),
    Maker("joints", "equation", relations.add_equation, ("loops",)),
    Maker("joints", "velocity_equation", relations.add_velocity_equation, ("nonholonomic",)),
)
FORCES: tuple[Maker, ...] = (
    Maker("forces", "force", forces.add_force),
    Maker("forces", "torque", forces.add_torque),
    Maker("forces", "line_force", forces.add_line_force),
    Maker("forces", "spring_damper", forces.add_spring_damper),
    Maker("forces", "torsion_spring", forces.add_torsion_spring),
    Maker("forces", "bushing", forces.add_bushing),
    Maker("forces", "joint_friction", forces.add_joint_friction, ("friction",)),
    Maker("forces", "field", forces.add_field, dimensions=SPACE),
    Maker("forces", "beam", forces.add_beam, dimensions=SPACE),
    Maker("forces", "wheel_torque", forces.add_wheel_torque, dimensions=SPACE),
    Maker("forces", "brake", forces.add_brake, EVENTS, SPACE),
    Maker("forces", "contact", contacts.add_contact, EVENTS, PLANE),
    Maker("forces", "sphere_contact", contacts.add_sphere_contact, EVENTS, SPACE),
    Maker("forces", "capsule_impact", contacts.add_capsule_impact, EVENTS, SPACE),
    Maker("forces", "solid_impact", contacts.add_solid_impact, EVENTS, SPACE),
    *(
        Maker("forces", f"{kind}_plane_impact", partial(contacts.add_plane_impact, kind=kind), EVENTS, SPACE)
        for kind in ("box", "cylinder", "ellipsoid")
    ),
    *(
        Maker("forces", f"sphere_{kind}_impact", partial(contacts.add_sphere_impact, kind=kind), EVENTS, SPACE)
        for kind in ("box", "cylinder", "sphere")
    ),
    *(
        Maker("forces", kind, partial(tyres.add_tyre, kind=kind), ("tyres",), SPACE)
        for kind in ("vertical_tyre", "fiala_tyre", "magic_formula_tyre")
    ),
)
STATES: tuple[Maker, ...] = (
    Maker("states", "rate", states.add_state, ("states",)),
    Maker("states", "zero", states.add_algebraic_state, ("states",)),
    Maker("states", "update", states.add_sampled_state, ("states",)),
    Maker("states", "denominator", states.add_filter, ("states",)),
    Maker("states", "a", states.add_linear_system, ("states",)),
    Maker("states", "pid", states.add_controller, ("states",)),
)
PARTS: tuple[Maker, ...] = tuple(
    Maker("use", part, partial(parts.add_part, part=part), ("parts",), SPACE)
    for part in (*parts.SUSPENSIONS, *parts.ALONE)
)
WITHOUT: Mapping[str, str] = MappingProxyType(
    {
        "python_force": "a function of Python is no part of a scene file",
        **dict.fromkeys(
            ("exact_beam", "beam_section"), "the line body beam creates it, and tests/beams has its scenes"
        ),
        "road_contact": "it needs a road; tests/roads/test_road_contact.py compares it with a contact with a plane",
        "driver": "it needs a car with four wheels on tyres, which examples/car.yaml is",
        **dict.fromkeys(
            ("twist_beam", "pushrod_wishbone", "trailer_hitch", "telescopic_fork", "swingarm"),
            "it belongs to one kind of vehicle, with an example in examples/vehicles",
        ),
        **dict.fromkeys(
            ("step_steer", "ramp_steer", "sine_with_dwell"),
            "it drives a joint as a drive does, and tests/model/parts/test_manoeuvres.py compares it with its formula",
        ),
        **dict.fromkeys(
            ("steering_column", "differential", "driveline", "powertrain"),
            "it connects bodies that rotate or slide, and tests/model/parts/test_driveline_parts.py compares it with hand calculations",
        ),
        **dict.fromkeys(
            ("brakes",),
            "it brakes the wheels of a car, and tests/model/parts/test_brakes.py compares it with its formulas",
        ),
        **dict.fromkeys(
            ("air_spring", "hydromount", "viscoelastic_bushing"),
            "it carries a stated load, and tests/mechanisms/test_springs_of_vehicles.py compares it with its formula",
        ),
    }
)
"""Kinds and parts without a generator, with reasons."""


def kinds(dimensions: int) -> Iterator[tuple[str, str]]:
    """Yield the section and kind of all elements that random scenes have."""
    yield from (("joints", kind) for kind in EQUATIONS[dimensions])
    for maker in (*RELATIONS, *FORCES, *STATES, *PARTS):
        if dimensions in maker.dimensions:
            yield maker.section, maker.kind
