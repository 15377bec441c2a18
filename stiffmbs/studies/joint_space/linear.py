"""Linearised equations in joint coordinates, from those of all bodies.

`stiffmbs.transfer` gives z' = A z + B p with outputs y = C z + D p in variations z of all bodies. With the coordinates, their rates and
accelerations as outputs, x = T z, and the rows of x' in z, times T^-1, are A and B in joint coordinates.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...analyses.linearised.transfer import transfer
from ...compile.bodies import QUATERNION
from ...errors import InputError
from ...linear_analysis.transfer import Transfer
from ...model.model_data import ModelData
from ...model.settings import RunSettings
from ...reading.did_you_mean import did_you_mean
from ...results.saved_state import SavedState

LABELS = {
    "vx": ("x", "ax"), "vy": ("y", "ay"), "vz": ("z", "az"), "omega": ("angle", "alpha"),
    "wx": ("rotation_x", "wdx"), "wy": ("rotation_y", "wdy"), "wz": ("rotation_z", "wdz"),
}  # fmt: skip
"""Displacement and acceleration of each velocity of a body."""


@dataclass(frozen=True)
class Rate:
    """Channels of a rate, its displacement and its acceleration. `axis`: that of an angular velocity in space, else None."""

    rate: str
    displacement: str
    acceleration: str
    axis: int | None

    @classmethod
    def named(cls, rate: str) -> Rate:
        """Return the channels of a rate of a joint's coordinate or of a body."""
        owner, _, label = rate.rpartition(".")
        if label.endswith("_rate"):
            coordinate = rate.removesuffix("_rate")
            return cls(rate, coordinate, f"{coordinate}_acceleration", None)
        displacement, acceleration = LABELS[label]
        axis = "xyz".index(label[1]) if label.startswith("w") else None
        return cls(rate, f"{owner}.{displacement}", f"{owner}.{acceleration}", axis)

    @property
    def body(self) -> str:
        """Name of the body of an angular velocity."""
        return self.rate.rpartition(".")[0]


@dataclass(frozen=True)
class LinearInputs:
    """Inputs of a linearisation in their order: `along` has the number of a rate for an effort, None for an input of the scene."""

    names: tuple[str, ...]
    along: tuple[int | None, ...]

    @classmethod
    def of(cls, given: Sequence[str] | None, data: ModelData, rates: tuple[str, ...]) -> LinearInputs:
        """Return the given inputs, or the default ones."""
        coordinates = [Rate.named(rate).displacement for rate in rates]
        places = {name: k for names in (coordinates, rates) for k, name in enumerate(names)}
        if given is None:
            own = [name for name, value in data.inputs.items() if isinstance(value, float)]
            given = own or coordinates
        return cls(tuple(given), tuple(None if name in data.inputs else places.get(name) for name in given))

    @property
    def of_scene(self) -> list[str]:
        """Inputs of the scene and forces on bodies."""
        return [name for name, k in zip(self.names, self.along, strict=True) if k is None]


def refuse_reactions(outputs: Sequence[str], known: Sequence[str]) -> None:
    """Raise an InputError if an output may depend on the way in which an effort acts."""
    for name in outputs:
        if name not in known:
            raise InputError(
                f"output '{name}': found no coordinate, rate, or position or velocity of a body{did_you_mean(name, known)}; accelerations and "
                "reactions depend on how an effort acts, so choose inputs of the scene for them"
            )


def joint_equations(
    data: ModelData,
    settings: RunSettings,
    state: SavedState,
    rates: tuple[str, ...],
    inputs: LinearInputs,
    outputs: Sequence[str] | None,
    inverse_mass: np.ndarray,
) -> Transfer:
    """Return the linearised equations in joint coordinates at a state.

    `rates`: independent rates. `inverse_mass` of shape (n, n): accelerations by efforts on them.
    """
    channels = [Rate.named(rate) for rate in rates]
    wanted = dict.fromkeys(name for c in channels for name in (c.rate, c.acceleration))
    wanted |= dict.fromkeys(c.displacement for c in channels if c.axis is None)
    turning = dict.fromkeys(c.body for c in channels if c.axis is not None)
    wanted |= dict.fromkeys(f"{body}.{label}" for body in turning for label in (*QUATERNION, "wx", "wy", "wz"))
    wanted |= dict.fromkeys(outputs or ())
    found = transfer(data, inputs.of_scene, list(wanted), settings=settings, start_from=state)
    row = {name: k for k, name in enumerate(found.outputs)}
    turns = {body: _rotations(found, [row[f"{body}.{label}"] for label in QUATERNION]) for body in turning}
    spins = {body: found.at[[row[f"{body}.{label}"] for label in ("wx", "wy", "wz")]] for body in turning}
    displaced, moving = [], []
    for c in channels:
        of_rate = found.c[row[c.rate]]
        if c.axis is None:
            displaced.append(found.c[row[c.displacement]])
            moving.append(of_rate)
        else:  # a rotation in turning axes: x' = dw - w x x
            displaced.append(turns[c.body][c.axis])
            moving.append(of_rate - np.cross(spins[c.body], turns[c.body].T).T[c.axis])
    n, n_z = len(rates), len(found.a)
    of_states = slice(2 * n, n_z)
    from_z = np.vstack([*displaced, *(found.c[row[c.rate]] for c in channels), np.eye(n_z)[of_states]])
    rows = np.vstack([*moving, *(found.c[row[c.acceleration]] for c in channels), found.a[of_states]])
    back = np.linalg.inv(from_z)
    accelerated = [row[c.acceleration] for c in channels]
    b = np.zeros((n_z, len(inputs.names)))
    d = np.zeros((len(found.outputs), len(inputs.names)))
    scene = iter(range(len(inputs.of_scene)))
    for column, k in enumerate(inputs.along):
        if k is None:
            own = next(scene)
            b[n : 2 * n, column], b[of_states, column] = found.d[accelerated, own], found.b[of_states, own]
            d[:, column] = found.d[:, own]
        else:
            b[n : 2 * n, column] = inverse_mass[:, k]
    own_outputs = tuple(c.displacement for c in channels) + rates
    chosen = [row[name] for name in outputs or ()]
    at = (
        found.at[chosen]
        if outputs is not None
        else np.array([*(_at(found, row, c) for c in channels), *found.at[[row[rate] for rate in rates]]])
    )
    return replace(
        found,
        a=rows @ back,
        b=b,
        c=found.c[chosen] @ back if outputs is not None else np.eye(2 * n, n_z),
        d=d[chosen] if outputs is not None else np.zeros((2 * n, len(inputs.names))),
        inputs=inputs.names,
        outputs=tuple(outputs) if outputs is not None else own_outputs,
        at=at,
    )


def _at(found: Transfer, row: dict[str, int], channel: Rate) -> float:
    """Return a coordinate at the state; 0 for a rotation, which is relative to it."""
    return 0.0 if channel.axis is not None else float(found.at[row[channel.displacement]])


def _rotations(found: Transfer, rows: list[int]) -> np.ndarray:
    """Return small rotations about own axes by z, from the changes of a quaternion: 2 conj(p) dp."""
    (p0, *p), (first, *rest) = found.at[rows], found.c[rows]
    vector, change = np.array(p), np.array(rest)
    turned: np.ndarray = 2.0 * (p0 * change - np.outer(vector, first) - np.cross(vector, change.T).T)
    return turned
