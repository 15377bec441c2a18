"""Geometric stiffness of shells: work of the stress of their triangles on strains of second order.

Each triangle is seen from axes that follow its rotation r, as in a corotational formulation (C. C. Rankin, F. A. Nour-Omid, The
use of projectors to improve finite element performance, Comput. Struct. 30 (1988) 257-267). Up to second order in the components
of its corners, without products of strains and rotations,

    membrane strain: (u,a . u,b) / 2 with all three displacements u,
    rotation of a corner: -(r_z n x r + r x theta) / 2 relative to the triangle, with the rotation vector theta,
    corner of a warped quadrilateral: theta x (theta x o) / 2 with the arm o from its node.

A rigid rotation causes no strain.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property

import numpy as np

from .shell import AT_ONCE, COMPONENTS, Shell, Triangles

KEPT = 30_000
"""Triangles of a shell up to which their strains are kept between displacements; they take 150 MB."""
PLACES = ((0, 0), (1, 1), (0, 1))
"""Directions of the membrane forces xx, yy, xy."""


class ShellStress:
    """Work of the stress of a shell on its strains of second order."""

    def __init__(self, shell: Shell) -> None:
        self._shell = shell

    def works(self, displacements: np.ndarray, modes: np.ndarray) -> np.ndarray:
        """Return the work of the stress of displacements, shape (6 n, k), on strains of second order, shape (k, m, m).

        These are twice the coefficients of products of the coordinates of modes, shape (6 n, m).
        """
        found = np.zeros((displacements.shape[1], modes.shape[1], modes.shape[1]))
        for triangles in self.parts():
            motion = _Motion(triangles, modes)
            for own, displacement in zip(found, displacements.T, strict=True):
                strain = np.einsum(
                    "tpai,ti->tpa", triangles.strains, triangles.components(displacement[:, None])[..., 0]
                )
                own += motion.work(triangles, triangles.resultants(strain))
        return (found + found.swapaxes(1, 2)) / 2  # type: ignore[no-any-return]

    def second_order_force(self, displacement: np.ndarray) -> np.ndarray:
        """Return the forces on all components of the strains of second order of a displacement, shape (6 n,)."""
        found = np.zeros(len(displacement))
        for triangles in self.parts():
            strain = second_order_strains(triangles, displacement)
            local = np.einsum("tpai,tpa->ti", triangles.strains, triangles.resultants(strain))
            np.add.at(found, triangles.places, triangles.forces(local))
        return found

    def parts(self) -> Iterable[Triangles]:
        """Return the triangles with their strains, in parts."""
        return self._kept if len(self._shell.triangles) <= KEPT else self._computed()

    @cached_property
    def _kept(self) -> tuple[Triangles, ...]:
        return tuple(self._computed())

    def _computed(self) -> Iterator[Triangles]:
        for start in range(0, len(self._shell.triangles), AT_ONCE):
            yield self._shell.part(slice(start, start + AT_ONCE))


def second_order_strains(triangles: Triangles, displacement: np.ndarray) -> np.ndarray:
    """Return the strains of second order of a displacement, shape (6 n,), as those of `Triangles.strains`, (triangles, points, 8)."""
    return _Motion(triangles, displacement[:, None]).strain(triangles)


class _Motion:
    """Motion of triangles in their axes by modes: slopes and rotations, and rotations of their corners."""

    def __init__(self, triangles: Triangles, modes: np.ndarray) -> None:
        corners = triangles.components(modes).reshape(len(triangles.areas), 3, COMPONENTS, -1)
        self.along = np.einsum("tka,tkcn->atcn", triangles.slopes, corners[:, :, :3])
        x, y = self.along
        self.turn = np.stack([y[:, 2], -x[:, 2], (x[:, 1] - y[:, 0]) / 2], axis=1)
        self.of_corners = corners[:, :, 3:]

    def work(self, triangles: Triangles, resultants: np.ndarray) -> np.ndarray:
        """Return the work of resultants at the points, shape (triangles, points, 8), by pairs of modes, shape (m, m)."""
        n, turn = self.turn.shape[-1], self.turn
        forces = np.einsum("tpai,tpa->ti", triangles.strains, resultants).reshape(-1, 3, COMPONENTS)
        xx, yy, xy = resultants[:, :, :3].sum(axis=1).T[:, :, None, None]
        (x, y), flat = self.along, (-1, n)
        found = x.reshape(flat).T @ (xx * x + xy * y).reshape(flat) + y.reshape(flat).T @ (xy * x + yy * y).reshape(
            flat
        )
        moments = forces[:, :, 3:]
        total = moments.sum(axis=1)
        across = total[:, 1, None] * turn[:, 0] - total[:, 0, None] * turn[:, 1]  # (moment x normal) . r
        found -= turn[:, 2].T @ across
        crossed = np.cross(self.of_corners, moments[..., None], axis=2).sum(axis=1)
        found -= turn.reshape(flat).T @ crossed.reshape(flat)
        if triangles.arms.any():
            theta = self.of_corners
            by_arm = np.einsum("tka,tkan->tkn", triangles.arms, theta).reshape(flat)
            by_force = np.einsum("tka,tkan->tkn", forces[:, :, :3], theta).reshape(flat)
            both = np.einsum("tka,tka->tk", triangles.arms, forces[:, :, :3])
            found += by_arm.T @ by_force - theta.reshape(flat).T @ (both[..., None, None] * theta).reshape(flat)
        return found  # type: ignore[no-any-return]

    def strain(self, triangles: Triangles) -> np.ndarray:
        """Return the strains of second order of a single mode, shape (triangles, points, 8)."""
        along, turn, theta = self.along[..., 0], self.turn[..., 0], self.of_corners[..., 0]
        source = np.zeros((len(turn), 3, COMPONENTS))
        source[:, :, :3] = np.cross(theta, np.cross(theta, triangles.arms)) / 2
        across = turn[:, 2, None] * np.stack([-turn[:, 1], turn[:, 0], 0 * turn[:, 2]], axis=1)
        source[:, :, 3:] = -(across[:, None] + np.cross(turn[:, None], theta)) / 2
        found = np.einsum("tpai,ti->tpa", triangles.strains, source.reshape(len(turn), -1))
        for k, (a, b) in enumerate(PLACES):
            found[:, :, k] += ((along[a] * along[b]).sum(axis=1) / (2 if a == b else 1))[:, None]
        return found  # type: ignore[no-any-return]
