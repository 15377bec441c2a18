"""Parameters by name: their current values, and scenes with other values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

from ...analyses.job import Runnable, data_of
from ...errors import InputError
from ...model.files.changed_forces import ChangedForces
from ...model.files.written_scene import WrittenScene
from ...model.read_scene import read_changed
from ...model.scene import Scene
from ...reading.did_you_mean import did_you_mean
from ...reading.files.unchanged import Unchanged
from ..case_solver import written_scene

STEP = 1e-4
"""Step of a parameter for set-up differences, relative to it; absolute, SI units, for a zero parameter."""

ALMOST_ZERO = 1e-300
"""Value that replaces a zero that would remove elements, such as zero gravity, which removes weights."""


class Scenes:
    """Scenes that differ by one value; common data is validated once.

    `unchanged`: data that has been validated before. `known`: scene as written.
    """

    def __init__(self, written: WrittenScene, unchanged: Unchanged | None = None) -> None:
        self._written, self._unchanged = written, unchanged or Unchanged()
        self._changed_forces: dict[tuple[str, ...], ChangedForces] = {}
        as_read = self._unchanged.scene
        self.known = as_read if as_read and as_read.written is written else read_changed(written, (), self._unchanged)

    @classmethod
    def of_model(cls, model: Runnable) -> Scenes:
        """Return the scenes of a model, a scene or a file; errors as for `written_scene`."""
        data = data_of(model)
        if isinstance(data, Scene) and data.validated.scene is data and not (data.stages or data.at_start):
            return cls(written_scene(data), data.validated)
        return cls(written_scene(data))

    def at(self, changes: Sequence[tuple[str, object]]) -> Scenes:
        """Return scenes that differ by one value from a scene with other values; errors as for `changed`."""
        return Scenes(replace(self._written, changes=(*self._written.changes, *changes)), self._unchanged)

    def changed(self, changes: Sequence[tuple[str, object]]) -> Scene:
        """Return the scene with other values. Raises InputError if a value is invalid."""
        names, values = [path for path, _ in changes], [value for _, value in changes]
        if names and self._unchanged.scene is self.known:
            if tuple(names) not in self._changed_forces:
                self._changed_forces[tuple(names)] = ChangedForces(self._written, names, self._unchanged)
            found = self._changed_forces[tuple(names)].scene(values)
            if found is not None:
                return found
        return read_changed(self._written, changes, self._unchanged)


class Parameter:
    """Number in a scene: a parameter, or a path such as ``forces.spring.stiffness`` or ``bodies.bar.position.0``.

    `value`: value in the scene, SI units. Raises InputError if the scene has no such value, or it is not a number.
    """

    def __init__(self, scenes: Scenes, name: str) -> None:
        self.name, self._scenes = name, scenes
        self._path, self._places, self._whole = _found(scenes.known, name)
        self.value = float(_part(self._whole, self._places))

    @property
    def step(self) -> float:
        """Return the step for differences of the set-up."""
        return STEP * (abs(self.value) if abs(self.value) > ALMOST_ZERO else 1.0)

    def brings_gravity(self) -> bool:
        """Return True if gravity is nonzero for another value."""
        with suppress(InputError):  # another value may be invalid
            return any(self.scene(self.value + self.step).gravity)
        return False

    def almost_zero(self) -> tuple[str, object]:
        """Return the change that replaces zero by a negligible value."""
        return self._path, _replaced(self._whole, self._places, ALMOST_ZERO)

    def scene(self, value: float) -> Scene:
        """Return the scene with another value. Raises InputError if the value is invalid."""
        return self._scenes.changed([(self._path, _replaced(self._whole, self._places, value))])


def with_weights(scenes: Scenes, names: Sequence[str]) -> Scenes:
    """Return scenes in which bodies have weights if only a zero parameter makes gravity zero."""
    if any(scenes.known.gravity):
        return scenes
    parameters = [Parameter(scenes, name) for name in names]
    return scenes.at([each.almost_zero() for each in parameters if each.value == 0.0 and each.brings_gravity()])


def _found(scene: Scene, name: str) -> tuple[str, tuple[int, ...], Any]:
    """Return the path without trailing indices, these indices, and the object at the path."""
    parts = name.split(".")
    if name in scene.parameters:
        return name, (), scene.parameters[name]
    if len(parts) == 2 and parts[0] == "parameters" and parts[1] in scene.parameters:
        return name, (), scene.parameters[parts[1]]
    if len(parts) < 2 or parts[0] == "run":
        known = ", ".join(scene.parameters) or "none"
        raise InputError(
            f"to: found '{name}'{did_you_mean(name, scene.parameters)}, expected a parameter of the scene ({known}) or a path such as "
            "forces.spring.stiffness"
        )
    places, whole = _in_parts(scene, name) or _walked(_sections(scene, parts[0]), parts, name)
    return ".".join(parts[: len(parts) - len(places)]), places, whole


def _sections(scene: Scene, section: str) -> object:
    """Return the scene, or for bodies a mapping with the descriptions of flexible bodies."""
    if section == "bodies" and any(not body.rigid for body in scene.bodies.values()):
        from ...model.flexible import described_bodies

        return {"bodies": {**described_bodies(scene.bodies), **scene.bodies}}
    return scene


def _in_parts(scene: Scene, name: str) -> tuple[tuple[int, ...], Any] | None:
    """Return what `_walked` returns for a path of a part, or of all uses of a part; None for another path."""
    described = scene.of_parts.at(name) if scene.of_parts else ()
    found = [_walked(at, rest.split("."), name) for at, rest in described]
    numbers = {_part(whole, places) for places, whole in found}
    if len(numbers) > 1:
        values = ", ".join(f"{value:g}" for value in sorted(numbers))
        raise InputError(
            f"to: found '{name}', which has the values {values} in the uses of the part, expected a path of one use"
        )
    if not found and name.startswith("parts."):
        raise InputError(
            f"to: found '{name}', which no use of a part takes, expected a path of a use, such as use.left.parameters.L"
        )
    if any(each != found[0] for each in found):  # vectors that are equal in this component
        return (), numbers.pop()
    return found[0] if found else None


def _walked(at: object, parts: Sequence[str], name: str) -> tuple[tuple[int, ...], Any]:
    """Return the trailing indices of a path, and the object at the path without them."""
    k = 0
    while k < len(parts):
        if parts[k].isdigit() and isinstance(at, list | tuple):
            places = tuple(map(int, parts[k:]))
            if not _is_number(_part(at, places, name)):
                raise InputError(f"to: found '{name}', which is no number, expected one; add a place such as .0")
            return places, at
        at, k = _next(at, parts, k, name)
    if not _is_number(at):
        what = "a vector; add a place such as .0" if isinstance(at, list | tuple) else "no number"
        raise InputError(f"to: found '{name}', which is {what}, expected a number")
    return (), at


def _is_number(found: object) -> bool:
    return isinstance(found, int | float) and not isinstance(found, bool)


def _next(at: object, parts: Sequence[str], k: int, name: str) -> tuple[object, int]:
    """Return the object under the next part of a path, or under several as names may have dots, and the next index."""
    for end in range(len(parts), k, -1):
        key = ".".join(parts[k:end])
        found = at.get(key) if isinstance(at, Mapping) else getattr(at, key, None)
        if found is not None:
            return found, end
    raise InputError(f"to: found '{name}', expected a path of the scene; it has no '{'.'.join(parts[: k + 1])}'")


def _part(whole: object, places: Sequence[int], name: str = "") -> Any:
    for place in places:
        if not isinstance(whole, list | tuple) or place >= len(whole):
            raise InputError(f"to: found '{name}', expected a place of the vector or matrix there")
        whole = whole[place]
    return whole


def _replaced(whole: Any, places: Sequence[int], value: float) -> Any:
    if not places:
        return value
    first, *rest = places
    return [_replaced(part, rest, value) if k == first else _listed(part) for k, part in enumerate(whole)]


def _listed(part: object) -> object:
    return [_listed(each) for each in part] if isinstance(part, list | tuple) else part
