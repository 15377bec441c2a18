"""Static equilibrium of a model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Unpack

import numpy as np

from ..describe.scene import Scene
from ..describe.settings import RunSettings, Settings, takes_settings
from ..results.channels import channels_of
from ..solve.initial import InitialValues
from .run import Runnable, data_of, prepare
from .settled import settled


@dataclass(frozen=True)
class EquilibriumFound:
    """A static equilibrium.

    Attributes
    ----------
    name : str
        Of the model.
    t : float
        At which forces and drives are taken, s.
    channels : dict of str to float
        Poses of bodies, forces and torques of elements, energies, requests.
    moves : int
        That led there.
    imbalance : float
        Largest generalised force that is left, relative to the largest that acts.
    moved : dict of str to (float, float)
        How far each body is from its described pose: its centre of mass, m, and its rotation, rad.
    free : tuple of str
        Bodies that take part in motions that nothing holds; the first one each, with its coordinate.
    notes : tuple of str
    start : InitialValues
        For a run from there.
    """

    name: str
    t: float
    channels: dict[str, float]
    moves: int
    imbalance: float
    moved: dict[str, tuple[float, float]]
    free: tuple[str, ...]
    notes: tuple[str, ...]
    start: InitialValues

    def as_dict(self, scene: str) -> dict[str, Any]:
        """The content of ``stiffmbs equilibrium --json``.

        Parameters
        ----------
        scene : str
            The file, or what else the scene is called.
        """
        return {
            "scene": scene, "status": "done", "message": f"at rest in equilibrium after {self.moves} moves",
            "imbalance": self.imbalance, "moved": self.moved, "channels": self.channels,
            "t": self.t, "free": list(self.free), "notes": list(self.notes),
        }  # fmt: skip


@takes_settings
def equilibrium(model: Runnable, settings: RunSettings | None = None, **changes: Unpack[Settings]) -> EquilibriumFound:
    """The pose at rest in which all forces balance, sought from the described one.

    Parameters
    ----------
    model : Model, Scene, str or Path
        A model, a scene, or a scene's file.
    settings : RunSettings, optional
        Its start is the instant at which forces and drives are taken.
    **changes
        Fields of the settings to change.

    Returns
    -------
    EquilibriumFound

    Raises
    ------
    InputError, AssemblyError
        As for `stiffmbs.run`.
    SolverError
        Where there is none, or none is found; names the body with the largest imbalance.
    """
    data = data_of(model)
    if isinstance(data, Scene):
        data = data.model_copy(update={"start": "described"})
    job = prepare(data, settings, **changes)
    found = settled(job.dynamics, job.start, job.grid.start)
    rows = job.dynamics.report(np.array([job.grid.start]), found.start.q[None], found.start.u[None], project=False)
    channels = channels_of(job.data, job.dynamics.system, rows)
    kept = {name: float(values[0]) for name, values in channels.items()}
    system = job.dynamics.system
    moves = system.move(job.start.q, found.start.q).reshape(len(system.bodies), -1)
    straight, turned = (np.linalg.norm(part, axis=1) for part in np.split(moves, [system.of_body.linear], axis=1))
    moved = dict(zip(system.bodies, zip(straight.tolist(), turned.tolist(), strict=True), strict=True))
    return EquilibriumFound(
        job.data.name, job.grid.start, kept, found.moves, found.imbalance, moved, found.free, found.notes, found.start
    )
