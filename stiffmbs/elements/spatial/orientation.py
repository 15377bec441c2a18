"""Orientations in space: unit quaternions, and their equivalents in scenes.

A quaternion p = (w, x, y, z) transforms a vector from the oriented axes to the reference axes, v = A(p) v'; p and -p
are the same orientation. Conventions of Shoemake (SIGGRAPH 1985); Nikravesh, Computer-Aided Analysis of Mechanical
Systems (1988), chapter 6, calls them Euler parameters.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any, Final

import numpy as np

from ...reading.files.quoted import written
from ...reading.formula.text import FormulaError
from ...reading.units.quantity import in_si
from ..read_by import Context, JsonSchema, ReadBy

Quaternion = tuple[float, float, float, float]

IDENTITY: Final[Quaternion] = (1.0, 0.0, 0.0, 0.0)
AXES = "xyz"
ROUGH = 1e-3
"""Tolerance of a given unit quaternion or rotation matrix, for values written with four digits."""
UNIT = 1e-15
"""Tolerance of the length of a unit quaternion that is not normalised again, so that written quaternions are read
exactly."""


def matrix(p: Sequence[float]) -> np.ndarray:
    """Return the rotation matrix A(p) of a unit quaternion, shape (3, 3); its columns are the oriented axes."""
    w, x, y, z = p
    return np.array([
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ])  # fmt: skip


def product(p: Sequence[float], q: Sequence[float]) -> Quaternion:
    """Return the orientation q given in the axes of p: A(pq) = A(p) A(q)."""
    (a, b, c, d), (w, x, y, z) = p, q
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y + c * w + d * x - b * z,
        a * z + d * w + b * y - c * x,
    )


def conjugate(p: Sequence[float]) -> Quaternion:
    """Return the inverse rotation, A(p)^T."""
    w, x, y, z = p
    return w, -x, -y, -z


def rotated(p: Sequence[float], v: Sequence[float]) -> np.ndarray:
    """Transform a vector from the oriented axes to the reference axes, A(p) v, shape (3,)."""
    return matrix(p) @ np.asarray(v, dtype=float)


def from_matrix(A: np.ndarray) -> Quaternion:
    """Return the quaternion of a rotation matrix, with its largest component positive.

    Shepperd, Quaternion from rotation matrix, J. Guidance and Control 1 (1978) 223-224: of the four products p_k p the
    one with the largest p_k.
    """
    products = np.array([
        [1 + A[0, 0] + A[1, 1] + A[2, 2], A[2, 1] - A[1, 2], A[0, 2] - A[2, 0], A[1, 0] - A[0, 1]],
        [A[2, 1] - A[1, 2], 1 + A[0, 0] - A[1, 1] - A[2, 2], A[1, 0] + A[0, 1], A[0, 2] + A[2, 0]],
        [A[0, 2] - A[2, 0], A[1, 0] + A[0, 1], 1 - A[0, 0] + A[1, 1] - A[2, 2], A[2, 1] + A[1, 2]],
        [A[1, 0] - A[0, 1], A[0, 2] + A[2, 0], A[2, 1] + A[1, 2], 1 - A[0, 0] - A[1, 1] + A[2, 2]],
    ])  # fmt: skip
    return _unit(products[np.argmax(np.diag(products))])


def about(axis: int, angle: float) -> Quaternion:
    """Return a rotation about one of the axes x, y, z (0, 1, 2), rad."""
    p = [math.cos(angle / 2), 0.0, 0.0, 0.0]
    p[1 + axis] = math.sin(angle / 2)
    return p[0], p[1], p[2], p[3]


def _read(found: object, context: Context) -> Quaternion:
    """Return the unit quaternion of an entry of a scene: a quaternion, a matrix, Euler angles, or one or two axes."""
    parameters = (context or {}).get("parameters")
    match found:
        case {"euler": sequence, "angles": angles, **others} if not others:
            return _from_euler(sequence, [in_si(angle, "angle", parameters) for angle in _listed(angles, 3)])
        case dict() if found and set(found) <= set(AXES):
            return _from_axes({
                name: np.array([in_si(part, "value", parameters) for part in _listed(axis, 3)])
                for name, axis in found.items()
            })  # fmt: skip
        case list() | tuple() if len(found) == 4:
            return unit_quaternion([in_si(part, "number", parameters) for part in found])
        case list() | tuple() if len(found) == 3:
            return _from_rows([[in_si(part, "number", parameters) for part in _listed(row, 3)] for row in found])
    raise FormulaError(
        f"found {written(found)}, expected [w, x, y, z], a 3x3 matrix, {{euler: zxz, angles: [..]}}, or one or two axes "
        "such as {z: [..], x: [..]}"
    )


def _schema(_: object) -> JsonSchema:
    number = {"anyOf": [{"type": "number"}, {"type": "string"}]}
    three = {"type": "array", "items": number, "minItems": 3, "maxItems": 3}
    euler = {"euler": {"type": "string", "pattern": "^[xyz]{3}$"}, "angles": three}
    forms: list[dict[str, object]] = [
        {"type": "array", "items": number, "minItems": 4, "maxItems": 4, "description": "unit quaternion w, x, y, z"},
        {"type": "array", "items": three, "minItems": 3, "maxItems": 3, "description": "rotation matrix by rows"},
        {"type": "object", "properties": euler, "required": ["euler", "angles"], "additionalProperties": False},
        {
            "type": "object", "properties": dict.fromkeys(AXES, three), "additionalProperties": False,
            "minProperties": 1, "maxProperties": 2, "description": "one or two axes, the first one exact",
        },
    ]  # fmt: skip
    return {"anyOf": forms, "description": "orientation"}


class OrientationField(ReadBy):
    """Marker of a field for an orientation."""


Orientation = Annotated[Quaternion, OrientationField(_read, _schema)]
"""Unit quaternion (w, x, y, z), given directly or by a matrix, by body-fixed Euler angles, or by axes."""


def _listed(found: object, count: int) -> Any:
    if not isinstance(found, list | tuple | np.ndarray) or len(found) != count:
        raise FormulaError(f"found {written(found)} in an orientation, expected a list of {count} numbers")
    return found


def _unit(p: np.ndarray) -> Quaternion:
    w, x, y, z = (float(part) for part in p / np.linalg.norm(p))
    return w, x, y, z


def unit_quaternion(p: Sequence[float]) -> Quaternion:
    """Return a given quaternion, normalized unless it is exact; raise a FormulaError if it is not one of length 1."""
    length = float(np.linalg.norm(p))
    if abs(length - 1) > ROUGH:
        raise FormulaError(f"found a quaternion of length {length:.6g}, expected one of length 1")
    w, x, y, z = (float(part) for part in p)
    return (w, x, y, z) if abs(length - 1) < UNIT else _unit(np.asarray(p))


def _from_rows(rows: list[list[float]]) -> Quaternion:
    A = np.array(rows)
    if np.max(np.abs(A @ A.T - np.eye(3))) > ROUGH:
        raise FormulaError(f"found the matrix {rows}, expected one of unit columns at right angles to each other")
    if np.linalg.det(A) < 0:
        raise FormulaError(f"found the matrix {rows}, which is a left-handed mirror image, expected a rotation")
    return from_matrix(A)


def _from_euler(sequence: str, angles: list[float]) -> Quaternion:
    """Return the orientation of consecutive rotations about rotated axes (body-fixed, intrinsic)."""
    fits = isinstance(sequence, str) and len(sequence) == 3 and set(sequence) <= set(AXES)
    if not fits or sequence[0] == sequence[1] or sequence[1] == sequence[2]:
        raise FormulaError(
            f"found the sequence {sequence!r}, expected three of x, y, z such as zxz or xyz, none twice in a row"
        )
    p = IDENTITY
    for name, angle in zip(sequence, angles, strict=True):
        p = product(p, about(AXES.index(name), angle))
    return p


def _from_axes(axes: dict[str, np.ndarray]) -> Quaternion:
    for name, axis in axes.items():
        if not np.linalg.norm(axis) > 0:
            raise FormulaError(f"found the axis {name} without a length, expected a direction")
    match list(axes.items()):
        case [(name, axis)]:
            return _shortest(AXES.index(name), axis / np.linalg.norm(axis))
        case [(first, a), (second, b)]:
            return _from_two(first, a / np.linalg.norm(a), second, b / np.linalg.norm(b))
    raise FormulaError(f"found the axes {', '.join(axes)}, expected one or two of them (the third follows)")


def _shortest(k: int, a: np.ndarray) -> Quaternion:
    """Return the shortest rotation of the k-th axis to the unit vector a."""
    e = np.eye(3)[k]
    half = np.array([1 + e @ a, *np.cross(e, a)])
    return _unit(half) if np.linalg.norm(half) > 1e-8 else about((k + 1) % 3, math.pi)


def _from_two(first: str, a: np.ndarray, second: str, b: np.ndarray) -> Quaternion:
    """Return the orientation whose first axis is a, and whose second axis is in the plane of a and b."""
    across = b - (b @ a) * a
    if np.linalg.norm(across) < ROUGH:
        raise FormulaError(f"found the axes {first} and {second} in one direction, expected two that differ")
    k, l = AXES.index(first), AXES.index(second)
    A = np.empty((3, 3))
    A[:, k], A[:, l] = a, across / np.linalg.norm(across)
    A[:, 3 - k - l] = np.cross(A[:, k], A[:, l]) * (1 if l == (k + 1) % 3 else -1)
    return from_matrix(A)
