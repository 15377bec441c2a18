"""Derivatives by Young's modulus, density, thickness and damping of flexible bodies."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

from stiffmbs import load_scene, run, sensitivities
from stiffmbs.analyses.job import prepare
from stiffmbs.commands.main import main
from stiffmbs.compile.directional.direction import Direction, unchanged
from stiffmbs.compile.state import State
from stiffmbs.errors import InputError
from stiffmbs.flexible_bodies.read import read_flexible_body
from stiffmbs.flexible_bodies.reduced import reduced_body
from stiffmbs.model.flexible import with_same_modes
from stiffmbs.studies.sensitivities.parameters import Parameter, Scenes
from stiffmbs.studies.sensitivities.set_up import SetUp

from .bars import mesh_of_bar

SCENE = """
dimensions: 3
gravity: [0, 0, -9.81]
parameters: {ratio: 0.02, weight: -9.81}
bodies:
  one:
    type: flexible
    mesh: square.vtu
    units: {length: 1 mm}
    material: {E: 2e8, nu: 0.3, density: 1200}
    interfaces:
      a: {plane: {point: [0, 0, 0], normal: [1, 0, 0]}}
      b: {plane: {point: [0.4, 0, 0], normal: [1, 0, 0]}}
    modes: 2
    damping: ratio
    thickness: {normal: [0, 0, 1]}
  two:
    type: flexible
    mesh: square.vtu
    units: {length: 1 mm}
    material: {E: 1e8, nu: 0.3, density: 1500}
    interfaces:
      a: {plane: {point: [0, 0, 0], normal: [1, 0, 0]}}
    modes: 1
    damping: {mass: 0.3/s, stiffness: 1e-5 s}
    thickness: {normal: [0, 1, 1], scale: 1.1}
    position: [0.4, 0, 0]
joints:
  base: {type: revolute, i: one.a, j: {body: ground, point: [0, 0.015, 0.015]}}
  elbow: {type: spherical, i: one.b, j: two.a}
run: {duration: 20 ms, points: 5, rtol: 1e-8, solver: radau}
"""
PARAMETERS = [
    "bodies.one.material.E", "bodies.one.material.density", "bodies.one.thickness.scale", "ratio",
    "bodies.two.material.E", "bodies.two.material.nu", "bodies.two.thickness.scale", "bodies.two.damping.mass",
    "bodies.two.damping.stiffness", "gravity.2",
]  # fmt: skip


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """Return the file of a double pendulum of two bars with square sections: all bending frequencies are twofold."""
    folder = tmp_path_factory.mktemp("bars")
    mesh = mesh_of_bar("hexahedron", along=3, across=1)
    mesh.points[:, 2] *= 1.5
    mesh.write(folder / "square.vtu")
    (folder / "two.yaml").write_text(SCENE)
    return folder / "two.yaml"


@pytest.fixture(scope="module")
def job(path):
    return prepare(load_scene(path), load_scene(path).run.model_copy(update={"presolve": False, "formulation": "SI2"}))


@pytest.mark.long
@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", PARAMETERS)
def test_terms_change_as_between_two_scenes(path, job, name):
    """Accelerations and energies at a deformed state, by central differences of compiled systems with the same modes."""
    set_up = SetUp(job, Parameter(Scenes.of_model(path), name))
    system, state, random = job.dynamics.system, job.dynamics.state, np.random.default_rng(1)
    q, u = system.q + 1e-2 * random.standard_normal(system.n_q), random.standard_normal(system.n_u)
    for term_set, names in (("motion", ("f", "inertia", "J")), ("output", ("potential", "kinetic", "power"))):
        direction = Direction(state, term_set, set_up.numbers)
        _take(state, q, u)
        direction.evaluate(0.0)
        values = []
        for other in map(State, set_up._systems):
            other.load(term_set)
            _take(other, q, u)
            other.evaluate(term_set, 0.0)
            values.append(other.values[term_set].copy())
        wanted = set_up.derivative(values)
        for term in names:
            places = system.term(term_set, term).source
            rounding = 1e-8 * np.abs(values[0][places]).max(initial=0.0) / abs(set_up.parameter.value)
            assert direction.values[places] == pytest.approx(wanted[places], rel=1e-6, abs=rounding), term


def _take(state, q, u):
    state.q[:], state.u[:] = q, u


def test_terms_change_along_a_motion(job):
    """The directional derivative of accelerations by the state is that of differences of the state."""
    system, dynamics, random = job.dynamics.system, job.dynamics, np.random.default_rng(2)
    direction = Direction(dynamics.state, "motion", unchanged(system))
    q, u = system.q + 1e-2 * random.standard_normal(system.n_q), random.standard_normal(system.n_u)
    along_q, along_u = random.standard_normal(system.n_q), random.standard_normal(system.n_u)
    dynamics.state.q[:], dynamics.state.u[:] = q, u
    direction.q[:], direction.u[:] = along_q, along_u
    direction.evaluate(0.0)
    sides = []
    for side in (-1e-6, 1e-6):
        dynamics.state.q[:], dynamics.state.u[:] = q + side * along_q, u + side * along_u
        dynamics.state.evaluate("motion", 0.0)
        sides.append(dynamics.state.values["motion"].copy())
    for term in ("f", "inertia"):
        places = system.term("motion", term).source
        wanted = (sides[1] - sides[0])[places] / 2e-6
        assert direction.values[places] == pytest.approx(wanted, rel=1e-6, abs=1e-6 * np.abs(wanted).max())


@pytest.mark.long
def test_derivatives_are_those_of_runs(path):
    """Richardson's extrapolation of differences of runs: two bodies, stiffness, mass, thickness and damping."""
    names = ["bodies.one.material.E", "bodies.two.material.density", "bodies.one.thickness.scale", "ratio"]
    found = sensitivities(path, names, "final(two.frame.z)", duration=0.05)
    scenes = Scenes.of_model(path)
    for name in names:
        parameter = Parameter(scenes, name)

        def difference(step, parameter=parameter):
            ends = [
                run(parameter.scene(parameter.value * (1 + side * step)), rtol=1e-10, duration=0.05)["two.frame.z"][-1]
                for side in (-1, 1)
            ]
            return (ends[1] - ends[0]) / (2 * step * parameter.value)

        wanted = (4 * difference(1e-3) - difference(2e-3)) / 3
        assert found.to[name] == pytest.approx(wanted, rel=1e-3 if name == "ratio" else 1e-5)


@pytest.mark.long
def test_command(path):
    result = CliRunner().invoke(main, [
        "sensitivities", str(path), "--to", "bodies.two.material.E", "--of", "final(two.frame.z)", "--json",
    ])  # fmt: skip
    assert result.exit_code == 0, result.output
    assert json.loads(result.stdout)["to"]["bodies.two.material.E"] != 0


def test_other_number_of_modes_is_refused(path):
    one, other = load_scene(path), load_scene(path, [("bodies.two.modes", 3)])
    with pytest.raises(InputError, match=r"^bodies.two: found other modes .* choose another number of modes$"):
        with_same_modes([other], one)


def test_thickness_is_a_stretch_of_the_mesh(path):
    """A bar of twice the thickness: mass, inertia and bending frequencies are those of a mesh of that size."""
    body = "mesh: {0}.vtu\nunits: {{length: 1 mm}}\nmaterial: {{E: 2e8, nu: 0.3, density: 1200}}\ninterfaces: {{a: {{plane: {{point: [0, 0, {1}], normal: [0, 0, 1]}}}}}}\nmodes: 4\n"
    folder = path.parent
    mesh = mesh_of_bar("hexahedron", along=3, across=1)
    mesh.points[:, 2] *= 1.5
    mesh.points[:, 2] = 15 + 2 * (mesh.points[:, 2] - 15)
    mesh.write(folder / "thick.vtu")
    (folder / "a.yaml").write_text(body.format("square", 0) + "thickness: {normal: [0, 0, 1], scale: 2}\n")
    (folder / "b.yaml").write_text(body.format("thick", -0.015))
    one, other = (reduced_body(read_flexible_body(str(folder / f"{name}.yaml")), folder) for name in "ab")
    assert one.mass == pytest.approx(other.mass, rel=1e-12)
    assert one.inertia == pytest.approx(other.inertia, abs=1e-12)
    assert one.frequencies == pytest.approx(other.frequencies, rel=1e-9)
    assert one.points == pytest.approx(other.points, abs=1e-12)
