"""Merge the joints and drives that hold only at the start (``at_start``) into the joints of a scene."""

from __future__ import annotations

from dataclasses import replace

from ...errors import InputError
from .quoted import quoted
from .written_scene import WrittenScene

AT_START = "at_start"


def with_held(scene: WrittenScene) -> WrittenScene:
    """Return the scene with the initial-condition joints among its own.

    Raises
    ------
    InputError
        If one of them has the name of a permanent joint.
    """
    content = dict(scene.content)
    held, joints = content.pop(AT_START), dict(content.get("joints") or {})
    twice = next((name for name in held if name in joints), None)
    if twice is not None:
        raise InputError(
            f"{scene.source}: {AT_START}: found '{quoted(twice)}', a joint of the scene, expected another name"
        )
    changes = tuple((_of_joint(path), value) for path, value in scene.changes)
    return replace(scene, content={**content, "joints": {**joints, **held}}, changes=changes)


def _of_joint(path: str) -> str:
    section, dot, name = path.partition(".")
    return f"joints.{name}" if section == AT_START and dot else path
