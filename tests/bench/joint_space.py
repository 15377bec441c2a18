"""Functions of joint coordinates: time of a call."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np

import stiffmbs

from .benchmark import Row


@dataclass(frozen=True)
class JointSpaceCalls:
    """Mass matrix, bias and inverse dynamics of a robot in an MJCF file, and those of MuJoCo if it is installed.

    Attributes
    ----------
    name : str
    path : Path
    calls, rounds : int
    """

    name: str
    path: Path
    calls: int = 2000
    rounds: int = 7

    def measured(self) -> list[Row]:
        """Medians over rounds, by the processor's time; errors are relative to the results of MuJoCo."""
        space = stiffmbs.joint_space(self.path)
        q, v, a = np.random.default_rng(0).uniform(-1.0, 1.0, (3, len(space.rates)))
        own: dict[str, Callable[[], np.ndarray]] = {
            "mass matrix": lambda: space.mass_matrix(q),
            "bias": lambda: space.bias(q, v),
            "inverse dynamics": lambda: space.inverse_dynamics(q, v, a),
            "forward dynamics": lambda: space.forward_dynamics(q, v, a),
        }
        theirs = _mujoco(self.path, q, v, a) if find_spec("mujoco") else {}
        rows = []
        for what, call in own.items():
            off = float(np.abs(call() - theirs[what]()).max() / np.abs(call()).max()) if what in theirs else 0.0
            rows.append(self._row("stiffmbs", what, off, call, False))
            if what in theirs:
                rows.append(self._row("mujoco", what, 0.0, theirs[what], True))
        return rows

    def glanced(self) -> list[Row]:
        """A few calls."""
        return replace(self, calls=50, rounds=1).measured()

    def _row(self, solver: str, what: str, off: float, call: Callable[[], np.ndarray], peer: bool) -> Row:
        spent = []
        for _ in range(self.rounds):
            begun = time.process_time()
            for _ in range(self.calls):
                call()
            spent.append((time.process_time() - begun) / self.calls)
        seconds = statistics.median(spent)
        return Row(solver, f"{what}: {1e6 * seconds:.1f} us a call", off, seconds, peer)


def _mujoco(path: Path, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> dict[str, Callable[[], np.ndarray]]:
    """Return the same functions of MuJoCo, from new coordinates to an array."""
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(path))
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    data = mujoco.MjData(model)
    M = np.zeros((model.nv, model.nv))

    def mass_matrix() -> np.ndarray:
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_crb(model, data)
        mujoco.mj_fullM(model, data, M)
        return M.copy()

    def inverse_dynamics() -> np.ndarray:
        data.qpos[:], data.qvel[:], data.qacc[:] = q, v, a
        mujoco.mj_inverse(model, data)
        return np.array(data.qfrc_inverse)

    return {"mass matrix": mass_matrix, "inverse dynamics": inverse_dynamics}
