"""Notes on flexible bodies whose stiffness changes by loads and rotation, and on those that deform too much."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from ..compile.quaternions import rotated
from ..compile.system import System
from ..dynamics.dynamics import OutputRows
from ..elements.spatial.flexible.layout import components, parts
from ..notes import Note, NoteKind, Severity
from .parameters import RUN_CHECKS
from .singular_poses import some_instants

BEAM = "use a body of type: beam, or divide the body into several"
DEFORMED = NoteKind(
    "large-deformation",
    "'{element}' deforms by up to {percent:.2g} % of its length (root mean square), outside the second-order theory: "
    "deflections of a beam would have an error of about {error:.1g} %",
    BEAM,
)
STIFFENED = NoteKind(
    "geometric-stiffness",
    "'{element}': loads and rotation change the stiffness by {lowest:+.2g} % to {highest:+.2g} % at t = {t:.4g} s; "
    "this geometric stiffness is {included}",
    severity=Severity.REMARK,
)
BUCKLES = NoteKind(
    "buckling",
    STIFFENED.text + ". A body that loses all its stiffness buckles, outside the second-order theory: {remedy}",
    BEAM,
)
WITHOUT_MESH = NoteKind(
    "geometric-stiffness-left-out",
    "'{element}': rotation at up to {rate:.3g} rad/s and interface forces of up to {force:.3g} N can change its "
    "stiffness by {percent:.2g} %, estimated by a slender clamped beam with its lowest free frequency of "
    "{frequency:.3g} Hz; geometric stiffness is not included, because a body described by matrices has no stresses: {remedy}",
    "use a mesh, or several bodies",
)
CLAMPED: Final = 36.0
"""Stiffening of a slender beam clamped at one end, over the square of its angular velocity by its lowest free one."""
EULER = 4 * 4.730041**4 / np.pi**2
"""Force by the buckling load of that beam, over force by mass, length and the square of its lowest free one."""


def geometric_stiffness_notes(system: System, rows: OutputRows) -> Iterator[Note]:
    """Yield a note on each flexible body whose geometric stiffness matters, relative to the elastic one."""
    for group in system.groups:
        for e in range(group.count if group.entries["inertia"] and len(rows.t) else 0):
            name, n = group.names[e].removesuffix(".frame"), 3 * (group.kind.n_bodies - 1)
            first = int(group.index[e, 2 * group.kind.n_bodies])
            numbers = parts(group.numbers[first + int(group.numbers[first]) :], n)
            places = group.index[e, : 2 * group.kind.n_bodies].reshape(-1, 2)
            yield from _note_on_large_deformation(name, numbers, rows.q[:, (places[1:, :1] + np.arange(3)).ravel()])
            if n and numbers["stiffened"][0] >= 0:
                yield from _note(name, numbers, rows, places)
            elif n:
                yield from _note_without_mesh(name, numbers, system, rows, int(places[0, 1]))


def _note_on_large_deformation(name: str, numbers: dict[str, np.ndarray], y: np.ndarray) -> Iterator[Note]:
    """Yield a note by the root mean square of the displacement over the mass, which is that of the modal coordinates."""
    ratio = float(np.sqrt((y**2).sum(axis=1).max(initial=0.0))) / _length(numbers)
    error = RUN_CHECKS.of_second_order * ratio**2
    if error > RUN_CHECKS.too_much:
        yield DEFORMED(name, percent=100 * ratio, error=100 * error)


def _length(numbers: dict[str, np.ndarray]) -> float:
    """Return the length of a slender beam with the mass and the moment of inertia of the body, m."""
    return float(np.sqrt(12 * numbers["moments"].max() / numbers["modal_mass"][0]))


def _note(name: str, numbers: dict[str, np.ndarray], rows: OutputRows, places: np.ndarray) -> Iterator[Note]:
    """Yield a note by the extreme eigenvalues of geometric and elastic stiffness, of all deformations of the free body."""
    chosen = some_instants(len(rows.t))
    ratios = _ratios(numbers, rows, places, chosen)
    at = int(np.abs(ratios).max(axis=1).argmax())
    lowest, highest = ratios[at]
    if max(-lowest, highest) > RUN_CHECKS.stiffened:
        included = "included" if numbers["stiffened"][0] else "not included (stiffening: false)"
        kind = BUCKLES if lowest < -1 else STIFFENED
        yield kind(name, lowest=100 * lowest, highest=100 * highest, t=rows.t[chosen[at]], included=included)


def _note_without_mesh(
    name: str, numbers: dict[str, np.ndarray], system: System, rows: OutputRows, motion: int
) -> Iterator[Note]:
    """Yield a note by a slender beam of the same mass, moment of inertia and lowest frequency."""
    rate = float(np.linalg.norm(rows.u[:, motion + 3 : motion + 6], axis=1).max())
    mass = float(numbers["modal_mass"][0])
    lowest = float(np.sqrt(numbers["stiffness"].min() / mass))
    forces = [
        np.linalg.norm(rows.values[:, [system.reported[f"{joint}.f{axis}"] for axis in "xyz"]], axis=1).max()
        for joint in (key.removesuffix(".fx") for key in system.reported if key.endswith("_interface.fx"))
        if joint.startswith(f"{name}.")
    ]
    force = float(max(forces, default=0.0))
    ratio = (CLAMPED * rate**2 + EULER * force / (mass * _length(numbers))) / lowest**2
    if ratio > RUN_CHECKS.stiffened:
        yield WITHOUT_MESH(name, rate=rate, force=force, percent=100 * ratio, frequency=lowest / (2 * np.pi))


def _ratios(numbers: dict[str, np.ndarray], rows: OutputRows, places: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """Return the extreme ratios by interface forces, rotation, acceleration of the frame and weight, shape (times, 2)."""
    (pose, motion), modal = places[0], (places[1:, :1] + np.arange(3)).ravel()
    y, turn = rows.q[np.ix_(chosen, modal)], rows.q[chosen, pose + 3 : pose + 7]
    spin = rows.u[chosen, motion + 3 : motion + 6]
    stiffness, static, Gamma = numbers["stiffness"][:, 0], numbers["static"], numbers["Gamma"]
    p = y
    if numbers["stretch"][0]:
        p = y + np.einsum("ikl,tk,tl->ti", Gamma, y, y, optimize=True) @ static / 2
    square = np.einsum("ta,tb->tab", spin, spin) - np.einsum("ta,ta->t", spin, spin)[:, None, None] * np.eye(3)
    of_rotation = components(square)[0] * ([1.0] * 3 + [0.5] * 3)
    field = rotated(turn * [1, -1, -1, -1], rows.acceleration[chosen, motion : motion + 3] - numbers["gravity"])
    changed = (
        np.einsum("ti,ikl->tkl", (p * stiffness) @ static.T, Gamma)
        + np.einsum("tc,klc->tkl", of_rotation, numbers["symmetric"])
        + np.einsum("ta,kla->tkl", field, numbers["T"])
    )
    scale = 1 / np.sqrt(stiffness)
    return np.linalg.eigvalsh(scale[:, None] * (changed + changed.swapaxes(1, 2)) / 2 * scale)[:, [0, -1]]  # type: ignore[no-any-return]
