"""Strains of flat triangles of shells: three nodes with three displacements and three rotations each.

Bending and transverse shear are those of the element DKMT (I. Katili, A new discrete Kirchhoff-Mindlin element based on
Mindlin-Reissner plate theory and assumed shear strain fields, part I, Int. J. Numer. Methods Eng. 36 (1993) 1859-1883). In thin
plates it becomes the discrete Kirchhoff triangle DKT, without shear locking. The membrane with drilling rotations is the element
OPT (C. A. Felippa, A study of optimal membrane triangles with drilling freedoms, Comput. Methods Appl. Mech. Eng. 192 (2003)
2125-2168). Bending in its plane is exact in rectangular units of any aspect ratio.

Axes of a triangle: x along its first side, z along its normal. A rotation (rx, ry, rz) moves a point at the height z of the
normal by z (ry, -rx, 0). Strains are linear over a triangle. They are given in the middles of its sides 0-1, 1-2, 2-0, where a
quadrature with three equal weights is exact for the strain energy.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

SIDES: Final = ((0, 1), (1, 2), (2, 0))
"""Sides of a triangle by the corners at their ends."""
CYCLES: Final = ((0, 1, 2), (1, 2, 0), (2, 0, 1))
"""Each corner with the following ones."""
MIDDLES: Final = np.array([[0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]])
"""Area coordinates of the middles of the sides."""
SHEAR: Final = 5 / 6
"""Shear correction factor of a homogeneous section (E. Reissner, J. Appl. Mech. 12 (1945) A69-A77)."""
LUMPING: Final = 1.5
"""Factor alpha_b of the forces that a constant stress makes on drilling rotations, of OPT (Felippa 2003)."""
NATURAL: Final = np.array([[1.0, 2.0, 1.0], [0.0, 1.0, -1.0], [-1.0, -1.0, -2.0]])
"""Factors beta_1 to beta_9 of OPT: strains along the sides by drilling rotations at a corner."""


class Sections(NamedTuple):
    """Young's modulus, N/m^2, Poisson's ratio and thickness, m, of each triangle, of shape (triangles,)."""

    modulus: np.ndarray
    poisson: np.ndarray
    thickness: np.ndarray

    def membrane(self) -> np.ndarray:
        """Return the membrane forces of membrane strains xx, yy, xy (the engineering strain), shape (triangles, 3, 3)."""
        found = np.zeros((len(self.modulus), 3, 3))
        stretching = self.modulus * self.thickness / (1 - self.poisson**2)
        found[:, 0, 0] = found[:, 1, 1] = stretching
        found[:, 0, 1] = found[:, 1, 0] = self.poisson * stretching
        found[:, 2, 2] = stretching * (1 - self.poisson) / 2
        return found

    def shear(self) -> np.ndarray:
        """Return the transverse shear stiffness, N/m, shape (triangles,)."""
        return SHEAR * self.modulus / (2 * (1 + self.poisson)) * self.thickness  # type: ignore[no-any-return]


def axes_of(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the axes of triangles by rows, shape (triangles, 3, 3), corners in them, (triangles, 3, 2), and areas.

    `corners` of shape (triangles, 3, 3): positions of the corners, m.
    """
    along, across = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(along, across)
    twice = np.linalg.norm(normal, axis=1)
    first = along / np.linalg.norm(along, axis=1)[:, None]
    normal = normal / twice[:, None]
    axes = np.stack([first, np.cross(normal, first), normal], axis=1)
    return axes, np.einsum("tka,tba->tkb", corners - corners[:, :1], axes[:, :2]), twice / 2


def strains(places: np.ndarray, areas: np.ndarray, sections: Sections, least_drilling: float) -> np.ndarray:
    """Return membrane strains (3), curvatures (3) and transverse shear strains (2) by the components of the corners.

    The shape is (triangles, 3 points, 8, 18), in the axes of the triangles. Components: displacements and rotations of
    the first corner, of the second, of the third. `places` of shape (triangles, 3, 2) and `areas`: those of `axes_of`.
    `least_drilling`: bound of the factor of the stiffness of OPT against drilling rotations, which vanishes at nu = 0.5.
    """
    found = np.zeros((len(places), 3, 8, 3, 6))
    slopes = slopes_of(places, areas)
    # the stiffness of OPT has 3/4 beta_0 times the sum over the sides, a quadrature has their mean
    factor = np.sqrt(0.75 * 3 * np.maximum((1 - 4 * sections.poisson**2) / 2, least_drilling))
    found[:, :, :3][..., [0, 1, 5]] = _membrane(places, areas, factor)
    found[:, :, 3:][..., [2, 3, 4]] = _plate(places, slopes, sections)
    return found.reshape(len(places), 3, 8, 18)


def slopes_of(places: np.ndarray, areas: np.ndarray) -> np.ndarray:
    """Return the slopes of the linear shape functions, shape (triangles, 3 corners, 2)."""
    x, y = places[..., 0], places[..., 1]
    following, last = [1, 2, 0], [2, 0, 1]
    return np.stack([y[:, following] - y[:, last], x[:, last] - x[:, following]], axis=2) / (2 * areas[:, None, None])


def _sides(places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the lengths of the sides, shape (triangles, 3), and their directions, shape (triangles, 3, 2)."""
    along = np.stack([places[:, b] - places[:, a] for a, b in SIDES], axis=1)
    lengths = np.linalg.norm(along, axis=2)
    return lengths, along / lengths[..., None]


def _plate(places: np.ndarray, slopes: np.ndarray, sections: Sections) -> np.ndarray:
    """Return curvatures and shear strains by w, rx, ry of the corners, shape (triangles, 3 points, 5, 3 corners, 3)."""
    lengths, along = _sides(places)
    modulus, poisson, thickness = sections
    bending = modulus * thickness**3 / (12 * (1 - poisson**2))
    soft = 12 * (bending / sections.shear())[:, None] / lengths**2  # phi_k of Katili (1993)
    # beta_x = ry, beta_y = -rx of the corners; further rotations on each side by the mean shear along it
    own = np.zeros((len(places), 2, 3, 3, 3))
    for k in range(3):
        own[:, 0, k, k, 2], own[:, 1, k, k, 1] = 1.0, -1.0
    more = np.zeros((len(places), 3, 3, 3))
    for k, (a, b) in enumerate(SIDES):
        scale = -1.5 / (lengths[:, k] * (1 + soft[:, k]))
        more[:, k, a, 0], more[:, k, b, 0] = -scale, scale
        for end in (a, b):
            turned = np.einsum("tc,tcn->tn", along[:, k], own[:, :, end, end])
            more[:, k, end] += (scale * lengths[:, k] / 2)[:, None] * turned
    found, shear = np.zeros((len(places), 3, 5, 3, 3)), _shear_at_corners(along, soft, more)
    linear = np.einsum("tkb,tckin->tcbin", slopes, own)
    for point, at in enumerate(MIDDLES):
        gradient = linear.copy()
        for k, (a, b) in enumerate(SIDES):
            bubble = 4 * (at[a] * slopes[:, b] + at[b] * slopes[:, a])
            gradient += np.einsum("tc,tb,tin->tcbin", along[:, k], bubble, more[:, k])
        found[:, point, 0], found[:, point, 1] = gradient[:, 0, 0], gradient[:, 1, 1]
        found[:, point, 2] = gradient[:, 0, 1] + gradient[:, 1, 0]
        found[:, point, 3:] = np.einsum("k,tkcin->tcin", at, shear)
    return found


def _shear_at_corners(along: np.ndarray, soft: np.ndarray, more: np.ndarray) -> np.ndarray:
    """Return the shear strains at the corners from those along both sides there, shape (triangles, 3 corners, 2, 3, 3)."""
    of_sides = -2 / 3 * soft[..., None, None] * more
    found = []
    for corner in range(3):
        both = [corner, corner - 1]  # the sides that begin and end there
        found.append(np.einsum("tck,tkin->tcin", np.linalg.inv(along[:, both]), of_sides[:, both]))
    return np.stack(found, axis=1)


def _membrane(places: np.ndarray, areas: np.ndarray, factor: np.ndarray) -> np.ndarray:
    """Return membrane strains by u, v, rz of the corners, shape (triangles, 3 points, 3, 3 corners, 3)."""
    x, y = _differences(places)
    constant = np.zeros((len(places), 3, 3, 3))
    for i, j, k in CYCLES:
        constant[:, 0, i, 0] = constant[:, 2, i, 1] = y[j, k]
        constant[:, 1, i, 1] = constant[:, 2, i, 0] = x[k, j]
        constant[:, 0, i, 2] = LUMPING / 6 * y[j, k] * (y[i, k] - y[j, i])
        constant[:, 1, i, 2] = LUMPING / 6 * x[k, j] * (x[k, i] - x[i, j])
        constant[:, 2, i, 2] = LUMPING / 3 * (x[k, i] * y[i, k] - x[i, j] * y[j, i])
    constant /= 2 * areas[:, None, None, None]
    # rotations at the corners, relative to the mean rotation of the displacements
    relative = np.zeros((len(places), 3, 3, 3))
    for i, j, k in CYCLES:
        relative[:, :, i, 0] = (x[k, j] / (4 * areas))[:, None]
        relative[:, :, i, 1] = (y[k, j] / (4 * areas))[:, None]
        relative[:, i, i, 2] = 1.0
    lengths, _ = _sides(places)
    by_sides = _from_sides(places, lengths, areas)
    # strains along the sides 0-1, 1-2, 2-0, of each corner and its cyclic permutations
    corner = [np.roll(np.roll(NATURAL, k, axis=0), k, axis=1) for k in range(3)]
    found = np.zeros((len(places), 3, 3, 3, 3))
    for point, (a, b) in enumerate(SIDES):
        natural = (2 * areas / 3)[:, None, None] * ((corner[a] + corner[b]) / 2) / lengths[:, :, None] ** 2
        higher = np.einsum("tes,tsr,trin->tein", by_sides, natural, relative)
        found[:, point] = constant + factor[:, None, None, None] * higher
    return found


def _differences(places: np.ndarray) -> np.ndarray:
    """Return the differences x_i - x_j and y_i - y_j of the corners, shape (2, 3, 3, triangles)."""
    return np.moveaxis(places[:, :, None] - places[:, None], (3, 1, 2, 0), (0, 1, 2, 3))


def _from_sides(places: np.ndarray, lengths: np.ndarray, areas: np.ndarray) -> np.ndarray:
    """Return strains xx, yy, xy by those along the sides, shape (triangles, 3, 3)."""
    (x, y), found = _differences(places), np.zeros((len(areas), 3, 3))
    for side, (i, j, k) in enumerate(CYCLES):
        found[:, 0, side] = y[j, k] * y[i, k]
        found[:, 1, side] = x[j, k] * x[i, k]
        found[:, 2, side] = y[j, k] * x[k, i] + x[k, j] * y[i, k]
    return found * (lengths**2 / (4 * areas[:, None] ** 2))[:, None]  # type: ignore[no-any-return]
