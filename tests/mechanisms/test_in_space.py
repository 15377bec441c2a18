"""Planar models in the x-y plane of space give the planar numbers, by both integrators."""

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs import InputError, spatial
from stiffmbs.analyses.job import prepare
from stiffmbs.commands.main import main
from stiffmbs.elements.element import Element
from stiffmbs.elements.planar_kinds import FORCES, JOINTS
from stiffmbs.elements.spatial import spatial_kinds
from stiffmbs.model.embedding.elements import element_in_space
from stiffmbs.model.read_scene import read_scene

from ..conftest import EXAMPLE_SCENES, EXAMPLES

RTOL, STIFF_RTOL = 1e-10, 1e-11
"""Of stiff scenes a tighter one: accelerations beside 1e9 N/m take 1e-10 m for 0.2 m/s^2."""
AGREES = 1e-7
"""Largest difference, relative to the largest value of its sort in the model, of state, accelerations, reactions and
energies alike.  Most runs by bdf agree to 1e-8, most by dop853 to 1e-10."""
AFTER_CORNERS = 1e-6
"""The same where forces have breakpoints, as in contacts and friction, or are stiff."""
BDF, DOP853 = {"solver": "bdf"}, {"solver": "projected", "scheme": "dop853"}
SORTS = {
    "x": "place", "y": "place", "vx": "speed", "vy": "speed", "ax": "acceleration", "ay": "acceleration",
    "angle": "angle", "omega": "rate", "alpha": "rate of rate", "fx": "force", "fy": "force", "torque": "torque",
    "n1": "force", "n2": "force", "m3": "torque",
    "displacement": "place", "displacement_rate": "speed", "displacement_acceleration": "acceleration",
    "angle_rate": "rate", "angle_acceleration": "rate of rate",
}  # fmt: skip
NAMES = {"omega": "wz", "alpha": "wdz", "torque": "tz"}
ENERGIES = ("kinetic", "potential", "total")
ACROSS = ("z", "q1", "q2", "vz", "wx", "wy", "az", "wdx", "wdy")


def both(scene, **settings):
    """The same run in the plane and in space."""
    settings = {"rtol": RTOL} | settings
    return stiffmbs.run(scene, **settings), stiffmbs.run(spatial.in_space(scene), **settings)


def in_space_as(name, solution):
    """What a planar channel is in space; angles from quaternions, up to whole turns."""
    owner, _, channel = name.rpartition(".")
    if channel == "angle" and f"{owner}.q3" in solution:
        return 2 * np.unwrap(np.arctan2(solution[f"{owner}.q3"], solution[f"{owner}.q0"]))
    return solution[f"{owner}.{NAMES.get(channel, channel)}" if owner else name]


def check_same(scene, plane, space, energies=ENERGIES, agrees=AGREES):
    """Every channel of the plane is the same in space, and nothing leaves the plane."""
    assert plane.outcome.name == space.outcome.name == "DONE", (plane.message, space.message)
    np.testing.assert_array_equal(plane.time, space.time)
    largest, differs = {}, {}
    for name, values in plane.items():
        owner, _, channel = name.rpartition(".")
        if owner == "constraint" or (owner == "energy" and channel not in energies):
            continue
        if owner in scene.joints and channel.partition("_")[0] == "angle" and f"{owner}.angle" not in space:
            continue  # a point on a line has no angle in space
        others, size = in_space_as(name, space), np.nanmax(np.abs(values))
        if owner == "energy":  # potentials are counted from where preloads and angles are
            values, others, sort = values - values[0], others - others[0], "energy"
        elif channel == "angle" and owner:
            others, sort = others + 2 * np.pi * np.round((values[0] - others[0]) / (2 * np.pi)), "angle"
        else:
            sort = SORTS.get(channel, name) if owner and name not in plane.requested else name
        largest[sort] = max(largest.get(sort, 1e-3), size)
        differs[name] = (sort, np.nanmax(np.abs(values - others)))
    wrong = {
        name: (much, largest[sort]) for name, (sort, much) in differs.items() if not much <= agrees * largest[sort]
    }
    assert not wrong
    for body in scene.bodies:
        for channel in ACROSS:
            np.testing.assert_allclose(space[f"{body}.{channel}"], 0, atol=1e-10)
    assert not [name for name in space.not_unique if name.rpartition(".")[2] in ("fx", "fy", "tz")]


PLANAR = [path for path in EXAMPLE_SCENES.values() if "\ndimensions: 3" not in path.read_text(encoding="utf-8")]
DURATIONS = {
    "bar_pendulum": 1.0, "simple_pendulum": 1.0, "cart_pendulum": 1.0, "four_bars": 0.5, "chain": 0.6,
    "half_car": 0.3, "stick_slip": 0.8, "bouncing_ball": 0.6, "cam_follower": 0.05, "dead_centres": 0.3,
    "elastic_bearing": 0.01, "front_axle": 0.6,
}  # fmt: skip
LONG = ("half_car", "half_car_at_rest", "stick_slip")
STIFF = ("elastic_bearing", "half_car", "cam_follower", "leaf_spring", "stick_slip")
WITHOUT_POTENTIAL = ("andrews",)
"""A constant torque has a potential in the plane, and none in space."""


def runs():
    for path in PLANAR:
        kinematic = "solver: kinematic" in path.read_text(encoding="utf-8")
        long = pytest.mark.long if path.stem in LONG else ()
        yield pytest.param(
            path, {} if kinematic else BDF, id=f"{path.stem}-{'kinematic' if kinematic else 'bdf'}", marks=long
        )
        if not kinematic and path.stem not in STIFF:
            yield pytest.param(path, DOP853, id=f"{path.stem}-dop853", marks=long)


@pytest.mark.sampled(9)
@pytest.mark.long
@pytest.mark.parametrize(("path", "settings"), list(runs()))
def test_an_example_is_the_same_in_space(path, settings):
    scene, stiff = stiffmbs.load_scene(path), path.stem in STIFF
    duration = min(scene.run.duration, DURATIONS.get(path.stem, scene.run.duration))
    plane, space = both(scene, duration=duration, rtol=STIFF_RTOL if stiff else RTOL, **settings)
    energies = ("kinetic",) if path.stem in WITHOUT_POTENTIAL else ENERGIES
    check_same(scene, plane, space, energies, AFTER_CORNERS if stiff else AGREES)


BODIES = """
gravity: [0.3, -9.81]
markers: {anchor: {point: [0.4, -0.2], angle: 0.7}}
bodies:
  a:
    mass: 2
    inertia: 0.1
    position: [0.1, 0.2]
    angle: 2.5
    velocity: [0.1, -0.2]
    omega: 0.8
    markers: {end: {point: [0.3, -0.1], angle: 0.4}}
  b:
    mass: 1
    inertia: 0.05
    position: [0.9, 0.5]
    angle: -4.0
    omega: -1.5
    markers: {end: {point: [-0.2, 0.15], angle: -0.3}}
"""
HINGES = """
  pin: {type: revolute, i: a, j: {body: ground, point: [0.1, 0.2]}}
  other: {type: revolute, i: b, j: {body: ground, point: [0.9, 0.5], angle: 7}}
"""
SLIDES = """
  pin: {type: revolute, i: a, j: {body: ground, point: [0.1, 0.2]}}
  slide: {type: prismatic, i: {body: b, angle: 4.5}, j: {body: ground, point: [0.9, 0.5], angle: 0.5}}
"""
LAWS = "spring_law: {table: [[-2, -30], [-1, -12], [0, 0], [1, 15], [2, 25]]}, damper_law: 3*v + v^3"
CASES = {
    "revolute": "joints: {x: {type: revolute, i: a.end, j: ground.anchor}, y: {type: revolute, i: b.end, j: a}}",
    "prismatic": "joints: {x: {type: prismatic, i: {body: a, angle: -1.8}, j: ground.anchor}}",
    "fixed": "joints: {x: {type: fixed, i: {body: a, point: [0.5, 0], angle: -6.4}, j: b}}",
    "distance": "joints: {x: {type: distance, i: a.end, j: b.end, length: 0.7}}",
    "point_on_line": "joints: {x: {type: point_on_line, i: a.end, j: b.end}}",
    "point_on_curve": """
joints:
  x: {type: point_on_curve, i: a.end, j: b.end, y: 0.3*x^2 - 0.1}
  y: {type: point_on_curve, i: a, j: ground.anchor, radius: 0.5 + 0.05*sin(2*angle)}
""",
    "gear": f"joints:\n{HINGES}\n  x: {{type: gear, joint_1: pin, joint_2: other, ratio: 1.3, offset: -11.7}}",
    "rack_and_pinion": f"joints:\n{SLIDES}\n  x: {{type: rack_and_pinion, rack: slide, pinion: pin, pitch_radius: 0.2}}",
    "coupler": f"joints:\n{HINGES}\n  x: {{type: coupler, joint_1: pin, joint_2: other, scale: -0.7}}",
    "drive": f"joints:\n{HINGES}\n  x: {{type: drive, joint: pin, position: 2.5 + 3*t + t^2}}\n"
    "  y: {type: drive, coordinate: b.angle - 0.5*a.angle, velocity: 2*cos(3*t)}",
    "equation": "joints: {x: {type: equation, zero: [b.angle + 2*a.angle - 1 - 0.1*sin(t), 'dx(a.end, b.end) + 0.5']}}",
    "velocity_equation": "joints: {x: {type: velocity_equation, zero: a.vy*cos(a.angle) - a.vx*sin(a.angle) + 0.1*b.omega}}",
    "spring_damper": f"forces: {{x: {{type: spring_damper, i: a.end, j: b.end, stiffness: 40, free_length: 0.5, {LAWS}}}}}",
    "torsion_spring": f"forces: {{x: {{type: torsion_spring, i: a, j: b.end, stiffness: 4, free_angle: 5, preload: 2, {LAWS}}}}}",
    "bushing": """
forces:
  x:
    type: bushing
    i: a.end
    j: {body: b, point: [-0.5, 0], angle: 5.9}
    stiffness: [[300, 20, 5], [20, 200, -4], [5, -4, 8]]
    damping: [3, 2, 0.1]
    preload: [1, 2, 0.3]
    law_x: 50*s^3
    law_angle: 2*s^3
  z: {type: bushing, axes: ground, i: a.end, j: b.end, stiffness: [30, 20, 0], damping: [3, 2, 0]}
  y: {type: bushing, axes: ground, i: a, j: ground.anchor, stiffness: [200, 100, 3], damping: [[3, 1, 0], [1, 2, 0], [0, 0, 0.2]]}
""",
    "exact_beam": """
forces:
  x:
    type: exact_beam
    i: a.end
    j: {body: b, point: [-0.5, 0], angle: 6.5}
    length: 0.8
    stiffness: [[300, 0, 4], [0, 200, 0], [4, 0, 8]]
    unloaded: [1, 0.05, 0.4]
    damping_ratio: 0.01
  z: {type: exact_beam, i: a, j: ground.anchor, length: 0.6, stiffness: [300, 200, 5]}
""",
    "beam_section": """
forces:
  x:
    type: beam_section
    nodes: [a.end, {body: b, point: [-0.5, 0], angle: 6.5}, ground.anchor]
    reference: 1
    shapes: [0.4, 0.5, 0.1]
    slopes: [-1.2, 0.9, 0.3]
    length: 0.8
    stiffness: [[300, 0, 4], [0, 200, 0], [4, 0, 8]]
    unloaded: [1, 0.05, 0.4]
    damping_ratio: 0.01
""",
    "force": """
forces:
  x: {type: force, i: a.end, force: [3, -2]}
  y: {type: force, i: b.end, j: a, axes: body, force: [1 + 2*sin(a.angle), "-3*vy(b.end, a.end) - a.omega"]}
""",
    "torque": """
forces:
  x: {type: torque, i: a, j: b, torque: "2 - 0.5*wz(a, b) - 3*az(a.end, b.end)"}
  y: {type: torque, i: b, torque: sin(3*b.angle)}
""",
    "line_force": 'forces: {x: {type: line_force, i: a.end, j: b, force: "-20*(dm(a.end, b) - 1) - 2*vr(a.end, b)"}}',
    "contact": """
forces:
  x: {type: contact, i: a.end, j: {body: ground, point: [0, -0.3], angle: 0.2}, radius: 0.2, stiffness: 1e4, dissipation: 0.5, friction: 0.3}
  y: {type: contact, i: a, j: b, radius: 0.4, surface: circle, surface_radius: 0.44, stiffness: 1e4, friction: 0.2}
  z: {type: contact, i: b, j: ground.anchor, radius: 0.1, surface: hole, surface_radius: 0.95, stiffness: 1e4, friction: 0.2}
""",
    "joint_friction": f"""
joints:
{SLIDES}
forces:
  x: {{type: joint_friction, joint: pin, friction: 0.2, radius: 0.03, stiction_velocity: 0.01}}
  y: {{type: joint_friction, joint: slide, friction: 0.1, static_friction: 0.2, length: 0.3, stiction_velocity: 0.05}}
  pull: {{type: spring_damper, i: a.end, j: b.end, stiffness: 50}}
""",
}  # fmt: skip
OTHER_POTENTIALS = ("torque", "force")
WITH_CORNERS = ("contact", "joint_friction")


def case(kind):
    requests = "{turned: 'az(a.end, b.end)', fast: a.omega + b.angle, way: 'dx(a.end, b, b.end)'}"
    return read_scene(f"{BODIES}{CASES[kind]}\nrequests: {requests}")


def assembled(scene):
    """The scene with its bodies drawn where assembly brings them."""
    places = prepare(scene).start.q.reshape(-1, 3)
    drawn = {
        name: body.model_copy(update={"position": (x, y), "angle": angle})
        for (name, body), (x, y, angle) in zip(scene.bodies.items(), places.tolist(), strict=True)
    }
    return scene.model_copy(update={"bodies": drawn})


@pytest.mark.long
@pytest.mark.parametrize("settings", [BDF, DOP853], ids=["bdf", "dop853"])
@pytest.mark.parametrize("kind", CASES)
@pytest.mark.sampled(21)
def test_each_kind_is_the_same_in_space(kind, settings):
    scene = assembled(case(kind))
    plane, space = both(scene, duration=0.4, points=41, **settings)
    energies = ("kinetic",) if kind in OTHER_POTENTIALS else ENERGIES
    check_same(scene, plane, space, energies, AFTER_CORNERS if kind in WITH_CORNERS else AGREES)


@pytest.mark.sampled(5)
@pytest.mark.long
@pytest.mark.parametrize("kind", ["revolute", "fixed", "distance", "point_on_line", "point_on_curve", "equation"])
def test_assembly_moves_bodies_as_in_the_plane(kind):
    """By the least amount in m and rad: the same to first order in moves that go up to half a metre and one radian."""
    scene = case(kind)
    planar, spatial_ = prepare(scene).start, prepare(spatial.in_space(scene)).start
    place, there = planar.q.reshape(-1, 3), spatial_.q[:14].reshape(-1, 7)
    assert np.abs(place - [body.coordinates() for body in scene.bodies.values()]).max() > 0.03
    np.testing.assert_allclose(there[:, :2], place[:, :2], atol=3e-4)
    np.testing.assert_allclose(np.sin(np.arctan2(there[:, 6], there[:, 3]) - place[:, 2] / 2), 0, atol=3e-4)


@pytest.mark.parametrize(("plane", "space"), [(JOINTS, spatial_kinds.JOINTS), (FORCES, spatial_kinds.FORCES)])
def test_a_kind_without_a_case_has_a_namesake_with_the_same_fields(plane, space):
    """A Python function stands in no file; `tests/elements/test_python_functions.py` has its case."""
    for kind, element in plane.items():
        own = element_in_space.dispatch(element) is not element_in_space.dispatch(Element)
        if not own and kind in space:
            assert not {*element.model_fields} - {*space[kind].model_fields}
        elif own:
            assert kind in {*CASES, "python_force"}


@pytest.mark.parametrize(
    ("element", "words"),
    [
        (
            "joints: {x: {type: prismatic, i: {body: a, angle: 0.5}, j: ground}}",
            "joints.x: found its markers drawn 171.9 degrees",
        )
    ],
)
def test_what_has_no_counterpart_is_refused(element, words):
    with pytest.raises(InputError, match=words):
        spatial.in_space(read_scene(BODIES + element))


def test_only_planar_models_are_put_in_space():
    scene = stiffmbs.load_scene(EXAMPLES / "heavy_top.yaml")
    for wrong in (scene, spatial.Model(), "bar_pendulum.yaml"):
        with pytest.raises(InputError, match="expected a planar"):
            spatial.in_space(wrong)


def test_a_model_built_in_python_becomes_one_that_more_can_be_added_to():
    model = stiffmbs.Model("swing", gravity=(0, -9.81))
    bar = model.add("bar", stiffmbs.Body(mass=1, inertia=0.03, position=(0.3, 0)))
    model.add("hinge", stiffmbs.Revolute(i=bar.at(-0.3, 0), j="ground"))
    in_space = spatial.in_space(model)
    in_space.add("wind", spatial.AppliedForce(i="bar", force=(0, 0, 2)))
    plane, space = stiffmbs.run(model, duration=0.5), stiffmbs.run(in_space, duration=0.5)
    np.testing.assert_allclose(space["hinge.fy"], plane["hinge.fy"], atol=1e-3)
    np.testing.assert_allclose(space["hinge.fz"], -2, atol=1e-9)
    assert in_space.check().sound


@pytest.mark.parametrize("name", ["crank_slider", "elastic_bearing", "cam_follower", "half_car"])
def test_a_scene_is_converted_to_the_file_of_the_one_in_space(name, tmp_path):
    path, written = EXAMPLES / f"{name}.yaml", tmp_path / "scene.yaml"
    assert CliRunner().invoke(main, ["convert", str(path), "--in-space", "-o", str(written)]).exit_code == 0
    assert stiffmbs.load_scene(written) == spatial.in_space(stiffmbs.load_scene(path))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["heavy_top.yaml", "--in-space"], "found a scene in space, expected a planar one"),
        (["bar_pendulum.yaml"], "found a scene, expected an Adams/Solver dataset"),
    ],
)
def test_what_cannot_be_converted_is_told(arguments, words):
    name, *options = arguments
    result = CliRunner().invoke(main, ["convert", str(EXAMPLES / name), *options])
    assert result.exit_code == 2
    assert words in result.stderr


@pytest.mark.long
@pytest.mark.parametrize("settings", [{}, {"solver": "projected", "scheme": "rk4", "step": 1e-3}, {"presolve": False}])
def test_other_solvers_give_the_planar_numbers_too(settings):
    """With explicit steps of fixed length errors of both are those of the step."""
    scene = stiffmbs.load_scene(EXAMPLES / "dead_centres.yaml")
    plane, space = both(scene, duration=0.1, points=21, **settings)
    check_same(scene, plane, space, agrees=1e-5)


@pytest.mark.parametrize(("name", "loops"), [("dead_centres", 1), ("four_bars", 2), ("andrews", 3)])
def test_each_closed_loop_has_three_equations_too_many_and_leaves_forces_across_the_plane_open(name, loops):
    scene = stiffmbs.load_scene(EXAMPLES / f"{name}.yaml")
    solution = stiffmbs.run(spatial.in_space(scene), duration=1e-3, points=2)
    open_ = {f"{joint}.{part}" for joint in scene.joints for part in ("fz", "tx", "ty")}
    assert set(solution.not_unique) == open_
    assert len(prepare(spatial.in_space(scene)).redundancy.redundant) == 3 * loops


@pytest.mark.long
def test_a_scene_that_starts_in_equilibrium_does_so_in_space():
    """With parts, of which the instances have other parameters."""
    planar = stiffmbs.load_scene(EXAMPLES / "vehicles" / "front_axle.yaml")
    found = spatial.in_space(planar)
    first, second = (stiffmbs.run(scene, duration=0.3, points=3, rtol=1e-9) for scene in (planar, found))
    for channel in ("front.right.knuckle.y", "front.left.knuckle.y", "front.right.camber"):
        assert second[channel] == pytest.approx(first[channel], abs=1e-6)


STAGES_WITHOUT_A_DURATION = """
bodies: {a: {mass: 1, inertia: 0.1}}
joints: {p: {type: revolute, i: {body: a, point: [0, 0.3]}, j: {body: ground, point: [0, 0.3]}}}
gravity: [0, -9.81]
forces: {f: {type: torque, i: a, torque: "sin(10*t)"}}
run: {duration: 1, points: 11}
stages:
  - {analysis: static}
  - {run: {duration: 0.5}}
  - {end: 0.7 s}
"""


def test_stages_end_in_space_when_they_do_in_the_plane():
    scene = stiffmbs.read_scene(STAGES_WITHOUT_A_DURATION)
    plane, space = stiffmbs.run(scene), stiffmbs.run(spatial.in_space(scene))
    np.testing.assert_allclose(space.time, plane.time, atol=1e-12)
    np.testing.assert_allclose(space["p.angle"], plane["p.angle"], atol=1e-5)
