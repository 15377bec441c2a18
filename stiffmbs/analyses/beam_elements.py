"""Discretisation errors of beams: estimates by another number of elements, and numbers of elements by a tolerance."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Final

import numpy as np

from ..errors import InputError, SolverError, StiffmbsError
from ..model.beams.division import Divided, Elements
from ..model.read_scene import read_changed
from ..model.scene import Scene
from ..results.scales import kind_of
from ..results.solution import Solution

ORDER: Final = 2
"""Lowest order of convergence of beams in smooth motion (docs: Beams, Accuracy)."""
MOST = 512
"""Largest number of elements of a beam in the search for a tolerance."""


def redivided(scene: Scene, elements: Mapping[str, Elements], notes: tuple[str, ...] = ()) -> Scene:
    """Return a scene with other elements of its beams, by name, and further notes.

    Raises InputError if the scene was not read from text, was changed since, or refers to nodes that it then lacks.
    """
    if scene.written is None or not scene.is_as_read:
        raise InputError("found a changed copy of a scene, expected a scene as it was read")
    changes = [(f"bodies.{name}.elements", chosen) for name, chosen in elements.items()]
    return read_changed(scene.written, [*changes, *([("notes", [*scene.notes, *notes])] if notes else [])])


def compared(scene: Scene, one: Solution, other: Solution) -> dict[str, float]:
    """Return the largest difference of each channel over the time that two runs have in common.

    Channels of elements and of distributed loads are left out, as they are at other places.
    """
    found = {}
    kept = one.time <= other.time[-1]
    times = one.time[kept]
    aligned = np.array_equal(times, other.time)
    for name, values in one.channels.items():
        owner = name.rpartition(".")[0]
        if name in other.channels and owner != "constraint" and owner not in scene.beams.forces:
            theirs = other[name] if aligned else np.interp(times, other.time, other[name])
            difference = np.abs(values[kept] - theirs)
            found[name] = float(np.nanmax(difference)) if np.isfinite(difference).any() else float("nan")
    return found


def divided_by(data: Scene, solve: Callable[[Scene], Solution]) -> Scene:
    """Return a scene whose beams have as many elements as their tolerances require.

    The number of elements is doubled until the estimated error is within the tolerance. It is a third of the change of the
    position of the beam's nodes: Richardson's extrapolation for the order 2.

    `data`: with at least one such beam. `solve`: returns the results of a scene. Raises SolverError if a tolerance is
    not reached.
    """
    tolerances = {name: data.beams.divided[name].tolerance or 0.0 for name in data.beams.by_tolerance}
    doublings, errors = dict.fromkeys(tolerances, 0), dict.fromkeys(tolerances, float("nan"))
    coarse: Solution | None = None
    while True:
        elements = {name: data.beams.divided[name].times(2 ** doublings[name]) for name in tolerances}
        scene = redivided(data, elements)
        counts = {name: sum(scene.beams.divided[name].counts) for name in tolerances}
        try:
            fine = solve(scene)
        except StiffmbsError:
            if max(counts.values()) * 2 > MOST:
                raise
            fine = None
        if coarse is not None and fine is not None:
            differences = compared(scene, fine, coarse)
            errors = {
                name: _of_position(name, data.beams.divided[name], differences) / (2**ORDER - 1) for name in tolerances
            }
        wanting = [name for name, tolerance in tolerances.items() if not errors[name] <= tolerance]
        if not wanting:
            notes = (
                f"beam {name}: {counts[name]} elements, estimated position error {errors[name]:.2g} m"
                for name in tolerances
            )
            return redivided(data, elements, tuple(notes))
        for name in wanting:
            if 2 * counts[name] > MOST:
                raise SolverError(
                    f"bodies.{name}.elements: found an estimated error of {errors[name]:.2g} m with {counts[name]} elements, expected "
                    f"{tolerances[name]:.2g} m; use a larger tolerance or give a number of elements"
                )
            doublings[name] += 1
        coarse = fine


def _of_position(name: str, beam: Divided, differences: Mapping[str, float]) -> float:
    """Return the largest difference of the position of a beam's nodes, m."""
    channels = (f"{name}.{node}.{axis}" for node in beam.names for axis in "xyz")
    return float(np.max([differences[channel] for channel in channels if channel in differences]))


def discretisation(scene: Scene, found: Solution, solve: Callable[[Scene], Solution]) -> tuple[dict[str, float], str]:
    """Return the estimated discretisation errors of the results of a scene with beams, and a sentence on them.

    The error of a channel is the largest of all channels of its kind of the beam or element, because a single difference may
    be small by chance.

    Another beam has half as many elements. It has twice as many if an interval has a single element, or if the scene refers
    to a node that the coarser beam lacks. Let r be the ratio of both numbers, and p the order. The finer of both beams has
    the error difference/(r^p - 1), and the coarser one r^p times it (Richardson's extrapolation).

    `found`: its results. `solve`: returns the results of a scene at the same times.
    """
    beams = scene.beams.divided
    fewest = min(count for beam in beams.values() for count in beam.counts)
    obstacle = ""
    for factor in (0.5, 2.0) if fewest > 1 else (2.0,):
        elements = {name: beam.times(factor) for name, beam in beams.items()}
        try:
            other = solve(redivided(scene, elements))
        except StiffmbsError as error:
            obstacle = str(error)
            continue
        counts = [(sum(a.counts), sum(elements[name].counts or ())) for name, a in beams.items()]
        ratio = min(max(a / b, b / a) for a, b in counts) ** ORDER
        share = (1.0 if factor < 1 else ratio) / (ratio - 1)
        errors = _largest_of_kind(beams, {n: share * d for n, d in compared(scene, found, other).items()})
        return errors, _sentence(found, errors, [*beams], counts)
    return {}, f"discretisation of beams not estimated: {obstacle}"


def _largest_of_kind(beams: Iterable[str], errors: Mapping[str, float]) -> dict[str, float]:
    """Return for each channel the largest error of the same kind of its beam or element."""
    groups = {}
    for name in errors:
        owner, kind = name.rpartition(".")[0], kind_of(name)
        beam = next((beam for beam in beams if owner.startswith(f"{beam}.")), owner)
        groups[name] = (beam, kind) if kind else (name, "")
    largest: dict[tuple[str, str], float] = {}
    for name, group in groups.items():
        largest[group] = max(largest.get(group, 0.0), errors[name])
    return {name: largest[group] for name, group in groups.items()}


def _sentence(found: Solution, errors: Mapping[str, float], beams: list[str], counts: list[tuple[int, int]]) -> str:
    largest: dict[str, str] = {}
    for name in errors:
        unit = found.unit(name)
        if unit in ("m", "rad", "N", "N m") and errors[name] > errors.get(largest.get(unit, ""), 0.0):
            largest[unit] = name
    errors_found = [f"{errors[name]:.2g} {unit} of {name}" for unit, name in sorted(largest.items())]
    other = ", ".join(
        f"{b} instead of {a} elements of {name}" for name, (a, b) in list(zip(beams, counts, strict=True))[:3]
    )
    return f"discretisation of beams ({other}): errors of at most about {', '.join(errors_found) or 'zero'}"
