"""Decisions on flexible bodies: checks of matrices and meshes, elimination, modes, cached bodies."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np
from scipy.sparse import csc_array, csr_array, diags_array, eye_array, kron

from stiffmbs.flexible_bodies import (
    cholesky,
    finite_elements,
    matrix_files,
    mesh_checks,
    reduced,
    reduction,
    solid,
    static_solver,
)
from stiffmbs.flexible_bodies.shells import checks as shell_checks
from stiffmbs.flexible_bodies.shells import shell, stress, surfaces, welds
from stiffmbs.results import flexible_motion
from tests.decisions.common import BELOW, Record, nothing, reach, reached, refused
from tests.solve.test_parameter_thresholds import DOUBLES, count_while


def parts_of_a_chain():
    """Return the number of parts into which the elimination divides 300 nodes in a row."""
    ones = np.ones(300)
    chain = diags_array([ones[1:], ones, ones[1:]], offsets=[-1, 0, 1])
    points = np.column_stack([np.arange(300.0), np.zeros((300, 2))])
    return len(cholesky.dissection(csc_array(kron(chain, np.ones((3, 3)))), points))


def additions_of_columns():
    """Return the number of times that columns of a matrix of 1000 are added."""
    shapes = []
    numbers = Record(zeros=lambda shape, *_: shapes.append(shape) or np.zeros(shape))
    with patch.object(cholesky, "np", numbers):
        cholesky._add_lower(np.zeros((1000, 1000)), np.arange(1000), np.zeros((1000, 1000)))
    return len(shapes)


def body(asymmetry=0.0, across=0.0):
    """Return a node of unit stiffness and mass, with an entry on one side of the diagonal or a greater mass along y."""
    matrices = {
        "stiffness": csr_array(np.eye(3) + asymmetry * np.eye(3, k=1)),
        "mass": csr_array(np.diag([1.0, 1.0 + across, 1.0])),
    }
    return Record(
        nodes=np.zeros((1, 3)), size=3, components=3, displacements=lambda _: np.arange(3), _check_parts=nothing, _check_diagonals=nothing, _check_mass=nothing, _check_rigid_modes=nothing,
        **matrices,
    )  # fmt: skip


def largest_rotational_entry():
    def accepts(entry):
        matrix = csr_array(np.diag([1.0, 1.0, 1.0, 0.0, 0.0, entry]))
        return not refused(lambda: matrix_files._placed(matrix, None, Record(numbers=np.array([1]))))

    return count_while(lambda entry: accepts(1e-11 * entry), DOUBLES)


def flattest_element():
    def accepts(height):
        nodes = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.6, 0.0, height]])
        nodes[3, 0] = np.sqrt(1.0 - height**2)
        return not refused(lambda: mesh_checks.check_volumes(nodes, np.arange(4)[None], "tetra"))

    return count_while(accepts, BELOW)


def largest_difference_of_frequencies():
    """Return the difference of squares of frequencies, in quarter octaves of 1e-11, that counts as none."""

    def are_equal(apart):
        separated = []
        with patch.object(reduction, "eigh", lambda _: separated.append(1) or (None, np.eye(2))):
            reduction._separated(
                Record(mass=np.eye(3), components=3, nodes=range(1)), np.array([1.0, 1.0 + apart]), np.eye(3, 2)
            )
        return bool(separated)

    return count_while(lambda apart: are_equal(1e-11 * apart), DOUBLES)


def smallest_independent_mode():
    def is_kept(square):
        shapes = np.diag([np.sqrt(square), 1.0])
        return reduction._independent(shapes, Record(mass=np.eye(2)))[0].shape[1] == 2

    return count_while(is_kept, BELOW)


def lowest_elastic_frequency():
    """Return the lowest frequency, in quarter octaves of that of rigid modes, that is refused."""

    def is_refused(frequency):
        eye = np.eye(1)
        solver = Record(static_modes=lambda: eye)
        with patch.multiple(
            reduction, check_interfaces=nothing, rigid_body=lambda _: (1.0, 0.0, 0.0), static_solver=lambda *_: (solver, True),
            _normal_modes=lambda *_: (np.ones(1), eye), _independent=lambda *_: (eye, 1.0),
            _free_modes=lambda *_: (np.array([frequency]), eye), _rigid_frequencies=lambda *_: np.ones(1),
            _marker_modes=nothing, _moments=lambda *_: (), _of_loads=lambda *_: (), second_order=nothing, ReducedBody=nothing,
        ):  # fmt: skip
            return refused(
                lambda: reduction.reduce(
                    Record(
                        mass=eye, rigid_modes=lambda _: eye, cells={}, parts="", unused="", components=3, shell=None
                    ),
                    [],
                    1,
                )
            )

    return count_while(is_refused, DOUBLES[:40])


def most_unknowns_of_dense_modes():
    def is_dense(n):
        solver = Record(
            free=np.arange(n), _functionals=[], _solve=nothing, _massless=lambda _: 0, _model=Record(size=n, mass=eye_array(n, format="csr"))
        )  # fmt: skip
        with patch.multiple(static_solver, _dense_modes=lambda *_: reach(True), _lanczos_modes=lambda *_: reach(False)):
            return reached(lambda: static_solver.StaticSolver.normal_modes(solver, 1))

    return count_while(is_dense, (20 * DOUBLES[:40]).astype(int))


def lanczos(squares):
    """Return the widths of the blocks of static solutions for the lowest mode of unit masses with these stiffnesses."""
    widths = []

    def solve(force):
        widths.append(force.shape[1])
        return force / squares[:, None]

    static_solver._lanczos_modes(solve, eye_array(len(squares), format="csr"), 1)
    return widths


def independent_shapes():
    """Return the angle between two shapes, in quarter octaves of 1 rad, down to which they are independent."""

    def are_two(angle):
        shapes = np.array([[1.0, np.cos(angle)], [0.0, np.sin(angle)]])
        return static_solver._orthonormal(shapes, eye_array(2, format="csr"))[0].shape[1] == 2

    return count_while(are_two, BELOW)


def drilling_without_membrane():
    """Return the stiffness of a triangle with nu = 0.5 against equal rotations of its corners about its normal."""
    nodes = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    ones, kind = np.ones(1), "triangle"
    material = shell.ElementMaterials(ones, 0.5 * ones, ones)
    stiffness = shell.of_elements(nodes, {kind: np.arange(3)[None]}, {kind: material}, {kind: ones}).stiffness()
    turned = np.tile([0.0, 0.0, 0.0, 0.0, 0.0, 1.0], 3)
    return float(turned @ (stiffness @ turned))


def most_warped_quadrilateral():
    def accepts(height):
        nodes = np.array([[0.0, 0.0, height], [1.0, 0.0, -height], [1.0, 1.0, height], [0.0, 1.0, -height]])
        return not refused(lambda: shell_checks.check_shells(nodes, {"quad": np.arange(4)[None]}))

    return count_while(lambda height: accepts(0.01 * height), DOUBLES)


def parts_of_a_shell():
    one = shell.Shell(*(np.zeros((10**4, *shape)) for shape in ((3,), (3,), (3, 3), (), (), (), ())))
    parts = []
    pairs = Record(zeros=lambda _: reached, add=lambda *_: parts.append(1), columns=0, starts=0, count=0)
    with (
        patch.multiple(shell, bsr_array=lambda *_, **__: 0, csr_array=nothing),
        patch.multiple(shell.Shell, pairs=pairs, _of_triangles=nothing),
    ):
        one.stiffness()
    return len(parts)


def most_kept_triangles():
    def are_kept(count):
        of = Record(_shell=Record(triangles=range(count)), _kept=True, _computed=lambda: False)
        return stress.ShellStress.parts(of)

    return count_while(are_kept, (1000 * DOUBLES).astype(int))


def parts_of_stresses():
    """Return the number of parts in which the peaks of stresses at 200 000 instants are found, of a body of 1000 modes."""
    lengths = []

    def stress(part):
        lengths.append(part)
        return np.zeros((1, 1, 6))

    body = Record(
        stress_nodes=np.arange(333), t=np.zeros(200_000), stress=stress, model=Record(nodes=np.zeros((333, 3)))
    )
    flexible_motion.FlexibleMotion.peaks(body)
    return len(lengths)


def sharpest_fold():
    """Return the angle between two triangles, in steps of 0.01 rad, up to which they have common points on both surfaces."""

    def is_smooth(steps):
        angle = 0.01 * steps
        nodes = np.array([[0, 0, 0], [0, 1, 0], [-1, 0, 0], [np.cos(angle), 0, np.sin(angle)]], dtype=float)
        ones = np.ones(2)
        of = shell.of_elements(
            nodes,
            {"triangle": np.array([[0, 1, 2], [0, 3, 1]])},
            {"triangle": shell.ElementMaterials(ones, 0 * ones, ones)},
            {"triangle": ones},
        )
        return len(surfaces.surfaces_of(of).nodes) == 8

    return count_while(is_smooth, DOUBLES)


def coarsest_shell_without_a_note():
    def is_noted(square):
        body = Record(coarseness=square, elements="quad", parts="", unused="")
        return bool(reduction.ReducedBody.notes.fget(body))

    return count_while(lambda square: not is_noted(0.1 * square), DOUBLES)


def spring_of_a_rotation(node):
    """Return the stiffness of the rotation of a node of a tetrahedron, on whose edge between nodes 0 and 1 a shell stands."""
    nodes = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, -1, -1]], dtype=float)
    material, ones = shell.ElementMaterials(np.ones(1), np.zeros(1), np.ones(1)), np.ones(1)
    of = shell.of_elements(nodes, {"triangle": np.array([[0, 1, 4]])}, {"triangle": material}, {"triangle": ones})
    body = solid.Solid((solid.Block("tetra", nodes, np.arange(4)[:, None], material),))
    return float(welds.rotations(body, of)[6 * node + 3, 6 * node + 3])


DECISIONS = {
    "flexible_bodies.shells.welds:SOFT": lambda: spring_of_a_rotation(2),
    "flexible_bodies.shells.welds:STIFF": lambda: spring_of_a_rotation(0),
    "flexible_bodies.reduction:COARSE": coarsest_shell_without_a_note,
    "flexible_bodies.shells.stress:KEPT": most_kept_triangles,
    "flexible_bodies.shells.surfaces:FOLD": sharpest_fold,
    "results.flexible_motion:AT_ONCE": parts_of_stresses,
    "flexible_bodies.shells.shell:LEAST_DRILLING": drilling_without_membrane,
    "flexible_bodies.shells.shell:WARPED": most_warped_quadrilateral,
    "flexible_bodies.shells.shell:AT_ONCE": parts_of_a_shell,
    "flexible_bodies.cholesky:LARGEST_PART": parts_of_a_chain,
    "flexible_bodies.cholesky:COLUMNS": additions_of_columns,
    "flexible_bodies.finite_elements:SYMMETRY": lambda: count_while(
        lambda entry: not refused(lambda: finite_elements.FiniteElements.check(body(asymmetry=1e-10 * entry))), DOUBLES
    ),
    "flexible_bodies.finite_elements:PRECISION": lambda: count_while(
        lambda more: not refused(lambda: finite_elements.FiniteElements._check_mass(body(across=1e-8 * more))), DOUBLES
    ),
    "flexible_bodies.matrix_files:NO_ROTATION": largest_rotational_entry,
    "flexible_bodies.mesh_checks:FLAT": flattest_element,
    "flexible_bodies.reduced:SAME_MASS": lambda: count_while(
        lambda more: not refused(lambda: reduced._check_mass(Record(mass=1.0, mesh=None), 1.0 + 0.001 * more)), DOUBLES
    ),
    "flexible_bodies.reduction:SAME_FREQUENCY": largest_difference_of_frequencies,
    "flexible_bodies.reduction:DEPENDENT": smallest_independent_mode,
    "flexible_bodies.reduction:ZERO": lowest_elastic_frequency,
    "flexible_bodies.reduction:MORE_MODES": lambda: reached(
        lambda: reduction._normal_modes(Record(normal_modes=reach), None, 1.0)
    ),
    "flexible_bodies.solid:LARGEST_PART": lambda: len(
        [*solid.NodePairs.parts(Record(_places=[np.broadcast_to(0.0, (10**6, 100))]), 0)]
    ),
    "flexible_bodies.static_solver:DENSE": most_unknowns_of_dense_modes,
    "flexible_bodies.static_solver:BLOCK": lambda: lanczos(np.arange(1.0, 101.0))[0],
    "flexible_bodies.static_solver:CONVERGED": lambda: len(lanczos(np.linspace(1.0, 10.0, 3000))),
    "flexible_bodies.static_solver:DEPENDENT": independent_shapes,
}  # fmt: skip
EXPECTED = {
    "flexible_bodies.reduction:COARSE": 14, "flexible_bodies.shells.welds:SOFT": 4.21875e-07, "flexible_bodies.shells.welds:STIFF": 421.875,
    "flexible_bodies.shells.stress:KEPT": 20, "flexible_bodies.shells.surfaces:FOLD": 23, "results.flexible_motion:AT_ONCE": 8,
    "flexible_bodies.shells.shell:LEAST_DRILLING": 1 / 90, "flexible_bodies.shells.shell:WARPED": 18, "flexible_bodies.shells.shell:AT_ONCE": 4,
    "flexible_bodies.cholesky:LARGEST_PART": 15, "flexible_bodies.cholesky:COLUMNS": 4, "flexible_bodies.finite_elements:SYMMETRY": 27,
    "flexible_bodies.finite_elements:PRECISION": 27, "flexible_bodies.matrix_files:NO_ROTATION": 27, "flexible_bodies.mesh_checks:FLAT": 119,
    "flexible_bodies.reduced:SAME_MASS": 23,
    "flexible_bodies.reduction:SAME_FREQUENCY": 27, "flexible_bodies.reduction:DEPENDENT": 133, "flexible_bodies.reduction:ZERO": 14,
    "flexible_bodies.reduction:MORE_MODES": 20, "flexible_bodies.solid:LARGEST_PART": 91, "flexible_bodies.static_solver:DENSE": 18,
    "flexible_bodies.static_solver:BLOCK": 8, "flexible_bodies.static_solver:CONVERGED": 50, "flexible_bodies.static_solver:DEPENDENT": 96,
}  # fmt: skip
