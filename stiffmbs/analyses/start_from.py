"""Runs that start from a saved state instead of the described one."""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias, TypeVar

import numpy as np

from ..compile.bodies import BODY_KINDS
from ..compile.system import System
from ..dynamics.turns import counted_angles
from ..elements.initial_pose import InitialPose
from ..errors import InputError
from ..model.current_pose import CurrentPose, in_current_pose
from ..model.model_data import ModelData
from ..model.settings import RunSettings
from ..reading.files.quoted import listed
from ..reading.joint_name import FREE_COORDINATES
from ..reading.names import owner_of
from ..results.frames import from_own_axes, rates_from_own_axes
from ..results.saved_state import SET_UP, SavedState, read_state
from ..results.solution import Solution

StartFrom: TypeAlias = SavedState | Solution | str | Path
"""Saved state: one row of a solution or of a results file, by default the last."""
Data = TypeVar("Data", bound=ModelData)


def state_to_start_from(given: StartFrom | None) -> SavedState | None:
    """Return the state to start from, or None if none is given; raise an InputError if the argument holds no state."""
    match given:
        case None | SavedState():
            return given
        case Solution():
            return given.state()
        case str() | Path():
            return read_state(given)
    raise InputError(
        f"start_from: found a {type(given).__name__}, expected a file of results, a Solution, or a state of one"
    )


def starting_at(state: SavedState | None, given: RunSettings | None, changes: dict[str, object]) -> dict[str, object]:
    """Return settings changes with the state's time as the start, unless the caller requests another start."""
    asked = "start" in changes or (given is not None and "start" in given.model_fields_set)
    return changes if state is None or asked else {**changes, "start": state.t}


def in_pose_of(state: SavedState | None, model: Data) -> Data:
    """Return a model in the pose of a saved state, in which a restart sets up its elements; the same one without a state.

    Raise an InputError if the state belongs to other bodies, or if an element cannot start to act in its pose.
    """
    if state is None:
        return model
    _refuse_others(model, state)
    acted = _acted(state)
    own = {name: angle for name in model.joints if np.isfinite(angle := state.turns.get(f"{name}/0", np.nan))}
    pose = CurrentPose(model, acted, {**_angles(state), **own}, _turns_set_up(state))
    places = _motion(model, state)[0].reshape(len(model.bodies), -1).tolist()
    bodies = {name: body.in_pose(place) for (name, body), place in zip(model.bodies.items(), places, strict=True)}
    found = in_current_pose(model, bodies, pose)
    drawn = InitialPose(found)
    for section in ("joints", "forces"):
        for name, element in getattr(found, section).items():
            for reason in () if name in acted else element.invalid_placement(drawn):
                raise InputError(f"{section}.{name}: {reason}, in the pose at t = {state.t:.9g} s of {state.source}")
    return found


def _motion(model: ModelData, state: SavedState) -> tuple[np.ndarray, np.ndarray]:
    """Return the coordinates and velocities of the bodies, with unit quaternions; raise an InputError if they lack values."""
    of_body, channels = BODY_KINDS[model.dimensions], state.channels
    q, u = (
        np.array([channels[f"{body}.{label}"] for body in model.bodies for label in labels])
        for labels in (of_body.positions, of_body.velocities)
    )
    if not np.all(np.isfinite([*q, *u])):
        raise InputError(
            f"{state.source}: found no numbers for all bodies at t = {state.t:g} s, expected an earlier row"
        )
    if of_body.dimensions == 3:
        turned = q.reshape(-1, of_body.n_q)[:, of_body.linear :]
        lengths = np.linalg.norm(turned, axis=1, keepdims=True)
        if not np.all(lengths > 0):
            raise InputError(f"{state.source}: found a quaternion of length 0, expected 1")
        turned /= lengths
    return q, u


def _angles(state: SavedState) -> dict[str, float]:
    """Return the coordinates of joints, angles with their full turns."""
    of_joints = ((name, x) for name, x in state.channels.items() if name.rpartition(".")[2] in FREE_COORDINATES)
    return {name: x for name, x in of_joints if np.isfinite(x)}


def _turns_set_up(state: SavedState) -> dict[str, tuple[int, ...]]:
    """Return the full turns by which elements were reduced when they were set up during the motion before."""
    found: dict[str, tuple[int, ...]] = {}
    for key, turns in state.turns.items():
        name, _, kind = key.rpartition("/")
        if kind.startswith(SET_UP) and np.isfinite(turns):
            found[name] = (*found.get(name, ()), round(turns))
    return found


def started_from(system: System, model: ModelData, state: SavedState | None) -> System:
    """Return a system that starts from a saved state, or as described if there is none.

    `model`: of the system, in the pose of the state (`in_pose_of`). Raise an InputError if the state lacks values.
    """
    if state is None:
        if model.dimensions == 2:  # angles in the plane count their turns
            return system
        return replace(system, described_angles=model.described_angles())
    q, u = _motion(model, state)
    q, u = from_own_axes(system, q[None])[0], rates_from_own_axes(system, u[None])[0]
    return replace(
        system,
        q=np.concatenate([q, _turns(system, model, state), _states(system, state)]),
        u=u,
        start_angles=_angles(state),
        turns_set_up={} if model._current_pose is None else model._current_pose.turns_set_up(model),
        open_rates=np.zeros(system.n_u, dtype=bool),
    )


def _turns(system: System, model: ModelData, state: SavedState) -> np.ndarray:
    """Return the revolution counters.

    An angle between markers that the state has counted keeps its turns in each formula. Other angles that it has not
    counted start at zero. Angles of joints that the state has are set later. Raise an InputError if it holds no counters.
    """
    of_requests = {name for name, _ in model.angle_counters()}
    turns, acted = np.zeros(system.n_counters), _acted(state)
    has_all = state.elements is not None or bool(state.turns)
    for angle in counted_angles(system):
        known = state.turn(angle.element, angle.number, angle.measure)
        is_new = has_all or angle.element in of_requests or angle.element not in acted
        if known is None and not is_new and angle.channel not in state.channels:
            raise InputError(
                f"{state.source}: found no count of the turns of '{angle.element}', expected a file .npz of the same mechanism"
            )
        turns[angle.place - system.n_pose] = known or 0.0
    return turns


def _acted(state: SavedState) -> Container[str]:
    """Return the elements that acted before a state; those with a channel if it does not tell."""
    return state.elements if state.elements is not None else {owner_of(name) for name in state.channels}


def _states(system: System, state: SavedState) -> np.ndarray:
    for name in system.states:
        if not np.isfinite(state.channels.get(name, np.nan)):
            raise InputError(f"{state.source}: found no number for the state '{name}', expected one in each row")
    return np.array([state.channels[name] for name in system.states])


def _refuse_others(model: ModelData, state: SavedState) -> None:
    of_body, channels, bodies = BODY_KINDS[model.dimensions], state.channels, tuple(model.bodies)
    labels = (*of_body.positions, *of_body.velocities)
    owners = dict.fromkeys(owner_of(name) for name in channels if name.endswith(f".{of_body.velocities[0]}"))
    saved = [owner for owner in owners if all(f"{owner}.{label}" in channels for label in labels)]
    if not saved:
        other = BODY_KINDS[5 - of_body.dimensions]
        of_other = any(all(f"{owner}.{label}" in channels for label in other.positions) for owner in owners)
        found = f"bodies of {_where(other.dimensions)}" if of_other else "no states of bodies"
        raise InputError(
            f"{state.source}: found {found}, expected those of a scene {_where(of_body.dimensions, 'in ')}"
        )
    missing, more = ([name for name in one if name not in other] for one, other in ((bodies, saved), (saved, bodies)))  # fmt: skip
    if missing:
        raise InputError(
            f"{state.source}: found no state of body {_listed(missing)}, expected the bodies of the scene; it has {_listed(saved)}"
        )
    if more:
        raise InputError(
            f"{state.source}: found body {_listed(more)}, which the scene does not have, expected its bodies {_listed(bodies)}"
        )


def _where(dimensions: int, before: str = "") -> str:
    return f"{before}the plane" if dimensions == 2 else f"{before}space"


def _listed(names: Sequence[str]) -> str:
    return listed([f"'{name}'" for name in names])
