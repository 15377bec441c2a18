"""Beams among the entries of scenes and parts; the code of beams is imported only if there are any."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping

from ...reading.files.yaml_text import Content

LOAD, MOVING, CONTACT = "distributed_load", "moving_load", "beam_contact"
"""Types of the forces on the nodes of a beam."""


def with_beams(
    sections: Content,
    parameters: Mapping[str, object],
    names: Collection[str],
    dimensions: object = None,
    part: str = "",
    instance: str = "",
) -> Content:
    """Return the sections of a scene or part with beams replaced by their nodes and elements.

    The sections are as written, with repeated entries expanded; the dimensions are by default those that they contain.
    `names`: those of variables, states and inputs of the scene. `part` is the path of a part for messages, `instance` its
    name, both followed by a dot. InputError if a beam cannot
    be read, or one of its names is taken.
    """
    bodies, forces = sections.get("bodies"), sections.get("forces")
    if not (_any(bodies, lambda kind: True) or _any(forces, lambda kind: kind in (LOAD, MOVING, CONTACT))):
        return sections
    from .expand import expand_beams

    if not isinstance(bodies, dict | None):
        return sections
    chosen = sections.get("dimensions", 2) if dimensions is None else dimensions
    found, forces = expand_beams(bodies or {}, forces, parameters, names, chosen, f"{part}bodies", instance)
    return {**sections, "bodies": found, "forces": forces}


def names_in_formulas(scene: Mapping[str, object]) -> set[str]:
    """Return the names of variables, states and inputs of a scene as written."""
    sections = (scene.get(section) for section in ("variables", "states", "inputs"))
    return {str(name) for section in sections if isinstance(section, dict) for name in section}


def _any(section: object, fits: Callable[[object], bool]) -> bool:
    """Return True if a section has an entry with a type that fits."""
    entries = section.values() if isinstance(section, dict) else ()
    return any(isinstance(entry, dict) and "type" in entry and fits(entry["type"]) for entry in entries)
