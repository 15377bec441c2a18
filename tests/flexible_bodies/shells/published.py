"""Published problems of plates and shells: values of this package relative to the published ones.

Sources: S. Timoshenko, S. Woinowsky-Krieger, Theory of plates and shells; A. Leissa, J. Sound Vib. 31 (1973) 257-293; R. H. MacNeal,
R. L. Harder, A proposed standard set of problems to test finite element accuracy, Finite Elem. Anal. Des. 1 (1985) 3-20; T.
Belytschko et al., Comput. Methods Appl. Mech. Eng. 51 (1985) 221-258 (pinched cylinder) and 77 (1989) 227-251 (thin twisted beam).
"""

from collections.abc import Callable

import numpy as np

from stiffmbs.flexible_bodies.shells.surfaces import surfaces_of

from .meshes import frequencies, places, pressure, shell, surface, under

E, NU, THIN = 1e7, 0.3, 1e-3
"""Of plates with a side of 1."""
MEMBRANE, ALL = [0, 1, 5], range(6)
D = E * THIN**3 / (12 * (1 - NU**2))
"""Bending stiffness of these plates."""


def square(kind, n, thickness=THIN, simple=True):
    """Return a square plate, held in its plane, with the components of a simple or a clamped support, and its nodes."""
    nodes, cells, grid = surface(n, n, lambda a, b: (a, b, 0), kind)
    edges = grid[[0, -1]], grid[:, [0, -1]]
    held = [places(grid, MEMBRANE), *(places(edge, [2]) for edge in edges)]
    for edge, across in zip(edges, (3, 4), strict=True):  # a simple support holds the rotation across the edge
        held.append(places(edge, [across] if simple else [3, 4]))
    return shell(nodes, cells, E, NU, thickness), np.unique(np.concatenate(held)), grid


def plate_deflection(kind, n, simple=True):
    """Return the deflection of a plate under uniform pressure."""
    of, held, grid = square(kind, n, simple=simple)
    found = under(of.stiffness(), held, pressure(of, [0, 0, 1]))[grid[n // 2, n // 2], 2]
    return found * D / (0.00406235 if simple else 0.00126532)


def plate_frequency(kind, n, simple=True):
    """Return the lowest frequency of a plate."""
    of, held, _ = square(kind, n, simple=simple)
    return frequencies(of, held, 1)[0] * np.sqrt(THIN / D) / (2 * np.pi**2 if simple else 35.985)


def plate_stress(kind, n, simple=True):
    """Return the stress of a plate under uniform pressure: in its centre, or at the middle of a clamped edge."""
    of, held, grid = square(kind, n, simple=simple)
    surfaces, motion = surfaces_of(of), under(of.stiffness(), held, pressure(of, [0, 0, 1]))
    at = surfaces.nodes == (grid[n // 2, n // 2] if simple else grid[0, n // 2])
    found = surfaces.stresses(motion.reshape(-1, 1))[0, at, 0]
    return np.abs(found).max() * THIN**2 / 6 / (0.0479 if simple else 0.0513)


def hole(kind, n):
    """Return the stress at a hole in an infinite sheet under tension, 3 (Kirsch 1898): a quarter, moved as the solution at its edge."""

    def place(a, b):
        r, angle = 6.0**a, np.pi / 2 * b
        return r * np.cos(angle), r * np.sin(angle), 0

    nodes, cells, grid = surface(n, n, place, kind)
    of, edge = shell(nodes, cells, E, NU, THIN), grid[-1]
    angle, r = np.pi / 2 * np.linspace(0, 1, n + 1), 6.0
    shear, kappa = E / (2 * (1 + NU)), (3 - NU) / (1 + NU)
    radial = (kappa - 1) * r + 2 / r + 2 * np.cos(2 * angle) * (r + (kappa + 1) / r - r**-3)
    around = -2 * np.sin(2 * angle) * (r + (kappa - 1) / r + r**-3)
    given = np.zeros((len(nodes), 6))
    given[edge, 0] = (radial * np.cos(angle) - around * np.sin(angle)) / (8 * shear)
    given[edge, 1] = (radial * np.sin(angle) + around * np.cos(angle)) / (8 * shear)
    held = [places(grid, [2, 3, 4]), places(edge, [0, 1]), places(grid[:, 0], [1, 5]), places(grid[:, -1], [0, 5])]
    stiffness = of.stiffness()
    motion = under(stiffness, np.unique(np.concatenate(held)), -(stiffness @ given.ravel())) + given
    surfaces = surfaces_of(of)
    return surfaces.stresses(motion.reshape(-1, 1))[0, surfaces.nodes == grid[0, -1], 0].max() / 3.0


def cantilever_frequencies(kind, n):
    """Return five frequencies of a square cantilever plate."""
    nodes, cells, grid = surface(n, n, lambda a, b: (a, b, 0), kind)
    held = np.concatenate([places(grid[0], ALL), places(grid, MEMBRANE)])
    found = frequencies(shell(nodes, cells, E, NU, THIN), held, 5) * np.sqrt(THIN / D)
    return found / [3.4917, 8.5246, 21.429, 27.331, 31.111]


def roof(kind, n):
    """Return the deflection of the roof of Scordelis and Lo: a quarter, with its diaphragm; 0.3024."""
    arc = np.radians(40)
    nodes, cells, grid = surface(n, n, lambda a, b: (25 * np.sin(arc * b), 25 * a, 25 * np.cos(arc * b)), kind)
    of = shell(nodes, cells, 4.32e8, 0.0, 0.25)
    held = [places(grid[0], [1, 3, 5]), places(grid[-1], [0, 2]), places(grid[:, 0], [0, 4, 5])]
    found = under(of.stiffness(), np.concatenate(held), pressure(of, [0, 0, -90]))
    return -found[grid[0, -1], 2] / 0.3024


def pinched_cylinder(kind, n):
    """Return the deflection of an eighth of a pinched cylinder with rigid diaphragms."""
    nodes, cells, grid = surface(
        n, n, lambda a, b: (300 * np.sin(np.pi / 2 * b), 300 * a, 300 * np.cos(np.pi / 2 * b)), kind
    )
    held = [
        places(grid[0], [1, 3, 5]),
        places(grid[-1], [0, 2]),
        places(grid[:, 0], [0, 4, 5]),
        places(grid[:, -1], [2, 3, 4]),
    ]
    force = np.zeros(6 * len(nodes))
    force[6 * grid[0, 0] + 2] = -0.25
    found = under(shell(nodes, cells, 3e6, NU, 3.0).stiffness(), np.concatenate(held), force)
    return -found[grid[0, 0], 2] / 1.8248e-5


TWISTED = {0.32: (1.0, 5.424e-3, 1.754e-3), 0.0032: (1e-6, 5.256e-3, 1.294e-3)}
"""Thickness; force, and its displacement in the plane and out of the plane of the end."""


def twisted_beam(kind, n, thickness=0.32):
    """Return both displacements of a beam twisted by a quarter of a turn, with n elements across and 6 n along."""
    force, *expected = TWISTED[thickness]

    def place(a, b):
        angle, y = np.pi / 2 * a, 1.1 * (b - 0.5)
        return 12 * a, y * np.cos(angle), y * np.sin(angle)

    nodes, cells, grid = surface(6 * n, n, place, kind)
    K, found = shell(nodes, cells, 29e6, 0.22, thickness).stiffness(), []
    for axis in (2, 1):
        forces = np.zeros(6 * len(nodes))
        forces[6 * grid[-1, n // 2] + axis] = force
        found.append(under(K, places(grid[0], ALL), forces)[grid[-1, n // 2], axis])
    return np.array(found) / expected


def hemisphere(kind, n):
    """Return the displacement of a quarter of a hemisphere with a hole of 18 deg; 0.0940."""

    def place(a, b):
        polar, azimuth = np.radians(18 + 72 * b), np.pi / 2 * a
        return 10 * np.sin(polar) * np.cos(azimuth), 10 * np.sin(polar) * np.sin(azimuth), 10 * np.cos(polar)

    nodes, cells, grid = surface(n, n, place, kind)
    one, other = grid[0, -1], grid[-1, -1]
    held = [places(grid[0], [1, 3, 5]), places(grid[-1], [0, 4, 5]), places(one, [2])]
    force = np.zeros(6 * len(nodes))
    force[6 * one], force[6 * other + 1] = 1.0, -1.0
    found = under(shell(nodes, cells, 6.825e7, NU, 0.04).stiffness(), np.concatenate(held), force)
    return found[one, 0] / 0.0940


def straight_beam(kind, n, axis, inclined=0.0):
    """Return the displacement of a slender cantilever of 6 n elements of length 1 / n: along it, in its plane, out of it.

    `inclined`: slope of the sides across it, of one sign and the other in turn, so that elements are trapezoids.
    """

    def place(a, b):
        row = round(6 * n * a)
        return 6 * a + (0 < row < 6 * n) * (-1) ** row * inclined * 0.2 * (b - 0.5), 0.2 * b, 0

    nodes, cells, grid = surface(6 * n, n, place, kind)
    force = np.zeros(6 * len(nodes))
    share = np.full(n + 1, 1 / n)
    share[[0, -1]] /= 2
    force[6 * grid[-1] + axis] = share
    found = under(shell(nodes, cells, 1e7, NU, 0.1).stiffness(), places(grid[0], ALL), force)
    return found[grid[-1], axis].mean() / (3e-5, 0.1081, 0.4321)[axis]


PROBLEMS: dict[str, Callable[[str, int], float | np.ndarray]] = {
    "simple plate, pressure": plate_deflection,
    "clamped plate, pressure": lambda kind, n: plate_deflection(kind, n, simple=False),
    "simple plate, frequency": plate_frequency,
    "clamped plate, frequency": lambda kind, n: plate_frequency(kind, n, simple=False),
    "cantilever plate, frequencies": cantilever_frequencies,
    "Scordelis-Lo roof": roof,
    "pinched cylinder": pinched_cylinder,
    "hemisphere": hemisphere,
}
"""Problems with n elements on each side."""
STRESSES: dict[str, Callable[[str, int], float]] = {
    "simple plate, stress": plate_stress,
    "clamped plate, stress": lambda kind, n: plate_stress(kind, n, simple=False),
    "hole in a sheet, stress": hole,
}
"""Stresses, with n elements on each side."""
BEAMS: dict[str, Callable[[str, int], float | np.ndarray]] = {
    "twisted beam": twisted_beam,
    "thin twisted beam": lambda kind, n: twisted_beam(kind, n, 0.0032),
    "straight beam, in its plane": lambda kind, n: straight_beam(kind, n, 1),
    "straight beam, out of its plane": lambda kind, n: straight_beam(kind, n, 2),
}
"""Beams with n elements across and 6 n along."""
