"""Models of SDFormat files: included, nested, static and several ones, versions, defaults, and what is not used or refused."""

import copy
import random
from xml.etree import ElementTree

import numpy as np
import pytest
import yaml
from click.testing import CliRunner

import stiffmbs
from stiffmbs.commands.main import main
from stiffmbs.errors import InputError
from stiffmbs.robots.load import convert_robot, load_robot

from .sdf_files import FrameGraph, rotation
from .test_sdf import placed, written
from .test_sdf_joints import joint, link

SDF = '<sdf version="{}">{}</sdf>'


def model(body, name="m", version="1.12", more=""):
    return SDF.format(version, f'<model name="{name}"{more}>{body}</model>')


def scene_of(path):
    return yaml.safe_load(convert_robot(path))


def read(tmp_path, text, name="robot.sdf"):
    return scene_of(written(tmp_path, text, name))


def notes_of(tmp_path, text):
    return "; ".join(load_robot(written(tmp_path, text)).notes)


AXIS = {
    ("1.4", ""): "model", ("1.4", "<use_parent_model_frame>0</use_parent_model_frame>"): "model", ("1.5", ""): "joint", ("1.6", ""): "joint",
    ("1.5", "<use_parent_model_frame>1</use_parent_model_frame>"): "model", ("1.6", "<use_parent_model_frame>true</use_parent_model_frame>"): "model",
    ("1.7", ""): "joint", ("1.7", "__model__"): "model", ("1.7", "b"): "child", ("1.7", "p"): "parent",
}  # fmt: skip


@pytest.mark.parametrize(("version", "given"), AXIS)
def test_the_frame_of_an_axis_is_that_of_the_version(tmp_path, version, given):
    """The turns about z are 0.1 of the model, 0.2 of the parent, 0.3 of the child and 0.4 of the joint on it."""
    expressed = f' expressed_in="{given}"' if given and given[0] != "<" else ""
    axis = f"<xyz{expressed}>1 0 0</xyz>{given if given[:1] == '<' else ''}"
    body = (
        "<pose>0 0 0 0 0 0.1</pose>" + link("p", "0 0 0 0 0 0.2") + link("b", "1 0 0 0 0 0.3")
        + joint("j", "revolute", "p", "b", axis, pose="<pose>0 0 0 0 0 0.4</pose>")
    )  # fmt: skip
    scene = read(tmp_path, model(body, version=version))
    turn = placed(scene["bodies"]["b"])[0] @ placed(scene["bodies"]["b"]["markers"]["j"])[0]
    expected = {"model": 0.1, "parent": 0.3, "child": 0.4, "joint": 0.8}[AXIS[version, given]]
    assert np.arctan2(turn[1, 2], turn[0, 2]) == pytest.approx(expected)


def test_included_models_are_those_in_one_file(tmp_path):
    """By folder and configuration, by file, nested and merged, with another name, pose and placement frame."""
    arm = link("l", "0 0.1 0 0.1 0 0") + '<frame name="tip" attached_to="l"><pose>0.3 0 0 0 0.5 0</pose></frame>'
    hand = link("hand", "0.1 0 0 0 0 0.3")
    written(
        tmp_path,
        model(arm + "<include><uri>model://claw</uri><pose relative_to='tip'>0 0 1 0 0 0</pose></include>"),
        "models/arm/old.sdf",
    )
    written(
        tmp_path,
        "<model><name>arm</name><sdf version='1.4'>none.sdf</sdf><sdf version='1.10'>old.sdf</sdf></model>",
        "models/arm/model.config",
    )
    written(tmp_path, model(hand, "claw", "1.6"), "models/claw/model.sdf")
    include = "<include{}><uri>{}</uri><name>{}</name><pose>1 2 3 0.1 0.2 0.3</pose><placement_frame>tip</placement_frame></include>"
    hinge = joint("j", "revolute", "a::l", "a::claw::hand", "<xyz>0 0 1</xyz>")
    found = read(tmp_path, model(include.format("", "model://arm", "a") + hinge, "whole"), "world/robot.sdf")
    claw = f'<model name="claw"><pose relative_to="tip">0 0 1 0 0 0</pose>{hand}</model>'
    inner = f'<model name="a" placement_frame="tip"><pose>1 2 3 0.1 0.2 0.3</pose>{arm}{claw}</model>'
    expected = read(tmp_path, model(inner + hinge, "whole"), "flat.sdf")
    assert found == expected and list(found["bodies"]) == ["a__l", "a__claw__hand"]
    merged = read(
        tmp_path,
        model(include.format(" merge='true'", "../models/arm/old.sdf", "a") + hinge.replace("a::", "")),
        "world/merged.sdf",
    )
    assert list(merged["bodies"]) == ["l", "claw__hand"]
    for one, other in zip(merged["bodies"].values(), expected["bodies"].values(), strict=True):
        assert one["position"] == other["position"]


def test_names_in_older_files_may_begin_with_the_model(tmp_path):
    body = link("a") + f'<model name="n">{link("b")}</model>' + joint("j", "fixed", "m::a", "m::n::b")
    assert list(load_robot(written(tmp_path, model(body, version="1.5"))).joints) == ["n__b_fixed"]
    with pytest.raises(InputError, match="found the frame m::a"):
        load_robot(written(tmp_path, model(body, version="1.8")))


def test_included_lights_and_actors_are_noted(tmp_path):
    for name in ("light", "actor"):
        written(tmp_path, SDF.format("1.6", f"<{name} name='x'/>"), f"{name}/model.sdf")
    include = "<include><uri>model://light</uri></include><include><uri>model://actor</uri></include>"
    found = notes_of(
        tmp_path, SDF.format("1.6", f"<world name='w'>{include}<model name='m'>{link('l')}</model></world>")
    )
    assert "(graphics): sdf <light>, sdf <actor>" in found


def test_several_models_of_a_world(tmp_path):
    """Links and joints have the names of their models; static ones are fixed to ground."""
    pendulum = link("l", centre="0.1 0 0") + joint("j", "revolute", "world", "l", "<xyz>0 1 0</xyz>")
    world = (
        f'<world name="w"><gravity>0 0 -5</gravity><model name="a">{pendulum}</model><model name="b"><pose>1 0 0 0 0 0</pose>{pendulum}</model>'
        f'<model name="house"><static>true</static>{link("wall", "0 3 0 0 0 0")}<model name="room">{link("table")}</model></model>'
        f'<model name="ball">{link("l", more="<gravity>0</gravity>")}</model></world>'
    )  # fmt: skip
    path = written(tmp_path, SDF.format("1.9", world))
    scene = scene_of(path)
    assert list(scene["bodies"]) == ["a__l", "b__l", "ball__l"] and list(scene["joints"]) == ["a__j", "b__j"]
    assert scene["gravity"] == [0, 0, -5] and scene["name"] == "w"
    notes = "; ".join(scene["notes"])
    assert "links of static models are fixed to ground: house::wall, house::room::table" in notes
    assert "links that no joint connects with the world move freely: ball::l" in notes
    run = stiffmbs.run(load_robot(path), duration=1e-6, output=1e-6)
    assert run["a__l.az"][0] == pytest.approx(-5 * 2 * 0.1**2 / (0.3 + 2 * 0.1**2))
    assert run["ball__l.az"][0] == pytest.approx(0, abs=1e-12)


def test_joints_to_static_models_and_of_worlds(tmp_path):
    rail = f'<model name="rail"><static>1</static><pose>0 0 2 0 0 0</pose>{link("bar")}</model>'
    cart = f'<model name="cart"><pose>0 0 2 0 0 0</pose>{link("box")}</model>'
    slide = joint("s1", "prismatic", "cart::box", "rail::bar", "<xyz>1 0 0</xyz>")
    scene = load_robot(written(tmp_path, SDF.format("1.11", f'<world name="w">{rail}{cart}{slide}</world>')))
    assert list(scene.bodies) == ["cart__box"] and list(scene.joints) == ["s1"]


@pytest.mark.parametrize(
    ("version", "world", "expected"),
    [
        ("1.9", "<gravity>1 0 -2</gravity>", [1, 0, -2]), ("1.5", "<physics><gravity>0 0 -3</gravity></physics>", [0, 0, -3]),
        ("1.9", "", [0, 0, -9.8]), ("1.4", "", [0, 0, -9.8]),
    ],
)  # fmt: skip
def test_gravity(tmp_path, version, world, expected):
    assert (
        read(tmp_path, SDF.format(version, f'<world name="w">{world}<model name="m">{link("l")}</model></world>'))[
            "gravity"
        ]
        == expected
    )


def test_missing_masses_have_the_defaults_of_the_format(tmp_path):
    text = model(
        '<link name="a"/><link name="b"><inertial><mass>3</mass></inertial></link><link name="c"><inertial><inertia><iyy>2</iyy></inertia></inertial></link>'
    )
    scene = read(tmp_path, text)
    assert [(body["mass"], body["inertia"]) for body in scene["bodies"].values()] == [
        (1, [1, 1, 1]),
        (3, [1, 1, 1]),
        (1, [1, 2, 1]),
    ]
    assert any("defaults of SDF, 1 kg and 1 kg m^2: a, b, c" in note for note in scene["notes"])


def test_inertia_is_turned_with_its_pose(tmp_path):
    inertial = "<inertial><pose>0.1 0 0 0 0 0.5</pose><mass>2</mass><inertia><ixx>1</ixx><iyy>2</iyy><izz>2.5</izz></inertia></inertial>"
    body = read(tmp_path, model(f'<link name="a">{inertial}</link>'))["bodies"]["a"]
    c, s = np.cos(0.5), np.sin(0.5)
    expected = [[c**2 + 2 * s**2, -c * s, 0], [-c * s, s**2 + 2 * c**2, 0], [0, 0, 2.5]]
    np.testing.assert_allclose(body["inertia"], expected, atol=1e-15)
    assert body["center_of_mass"] == [0.1, 0, 0]


PLANAR = """
bodies:
  crank: {mass: 0.1, inertia: 1e-4, position: [0.05, 0], markers: {in: {point: [-0.05, 0]}, out: {point: [0.05, 0]}}}
  coupler: {mass: 0.5, inertia: 1e-3, position: [0.2, 0.2], markers: {crank_end: {point: [-0.1, -0.2]}, middle: {}}}
  rocker: {mass: 0.25, inertia: 5e-4, position: [0.2, 0.1], markers: {foot: {point: [0, -0.125]}, head: {point: [0, 0.1]}}}
joints:
  shaft: {type: revolute, i: crank.in, j: ground}
  pin: {type: revolute, i: coupler.crank_end, j: crank.out}
  knee: {type: revolute, i: coupler.middle, j: rocker.head}
  pivot: {type: revolute, i: rocker.foot, j: {body: ground, point: [0.2, -0.025]}}
gravity: [0, -9.81]
run: {duration: 1, points: 11, rtol: 1e-10}
"""


def test_a_four_bar_moves_as_the_planar_scene(tmp_path):
    """The closing joint has a child with two parents."""
    bodies = {
        "crank": (0.1, 1e-4, "0.05 0 0 0 0 0"),
        "coupler": (0.5, 1e-3, "0.2 0 0.2 0 0.5 0"),
        "rocker": (0.25, 5e-4, "0.2 0 0.1 1 2 3"),
    }
    links = "".join(link(name, pose, mass, (inertia,) * 3) for name, (mass, inertia, pose) in bodies.items())
    joints = "".join(
        joint(name, "revolute", *ends, '<xyz expressed_in="__model__">0 -1 0</xyz>', pose=f'<pose relative_to="__model__">{at} 0 0 0</pose>')
        for name, *ends, at in (
            ("shaft", "world", "crank", "0 0 0"), ("pin", "crank", "coupler", "0.1 0 0"), ("pivot", "world", "rocker", "0.2 0 -0.025"),
            ("knee", "rocker", "coupler", "0.2 0 0.2"),
        )
    )  # fmt: skip
    world = f'<world name="w"><gravity>0 0 -9.81</gravity><model name="bars">{links}{joints}</model></world>'
    path = written(tmp_path, SDF.format("1.8", world))
    assert "joints that close loops: knee" in "; ".join(load_robot(path).notes)
    flat = stiffmbs.run(stiffmbs.load_scene(written(tmp_path, PLANAR, "planar.yaml")))
    space = stiffmbs.run(load_robot(path), duration=1, points=11, rtol=1e-10)
    for name in bodies:
        for x, z in (("x", "x"), ("y", "z"), ("ax", "ax"), ("ay", "az")):
            expected = flat[f"{name}.{x}"]
            np.testing.assert_allclose(space[f"{name}.{z}"], expected, atol=1e-6 * max(1, np.abs(expected).max()))


LINK = link("l", more="MORE")
UNUSED = {
    "<visual name='v'/>": "(graphics): link <visual> of l", "<sensor name='x'/>": "(requests of the scene measure): link <sensor> of l",
    "<collision name='c'/>": "(shapes and contacts are left out): link <collision> of l", "<velocity_decay/>": "link <velocity_decay> of l",
    "<kinematic>1</kinematic>": "(all links follow the forces): link <kinematic> of l", "<drake:x/>": "link <drake:x> of l",
    "<self_collide>false</self_collide>": "",
}  # fmt: skip


@pytest.mark.parametrize("given", UNUSED)
def test_what_is_not_used_of_a_link_is_noted(tmp_path, given):
    found = notes_of(tmp_path, model(LINK.replace("MORE", given)))
    assert UNUSED[given] in found and (UNUSED[given] or "not used" not in found)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (model(link("l") + "<plugin name='p' filename='f'/>"), "(plugins are programs of the simulator): model <plugin> of m"),
        (model(link("l") + joint("j", "revolute", "world", "l", "<xyz>0 0 1</xyz><limit><stiffness>3</stiffness></limit>")), "(limits are not held): joint/axis/limit <stiffness> of j"),
        (model(link("l") + joint("j", "revolute", "world", "l", "<xyz>0 0 1</xyz>", more="<physics/>")), "(settings of the simulator): joint <physics> of j"),
        (SDF.format("1.9", f"<world name='w'><light name='sun'/><state/><model name='m'>{link('l')}</model></world>"), "(graphics): world <light> of w"),
        (SDF.format("1.9", f"<world name='w'><state/><model name='m'>{link('l')}</model></world>"), "(models start where their poses place them): world <state> of w"),
        (SDF.format("1.9", f"<world name='w'><include><uri>model://sun</uri></include><model name='m'>{link('l')}</model></world>"), "scenery that is not next to the file is left out: model://sun"),
    ],
)  # fmt: skip
def test_what_is_not_used_is_noted(tmp_path, text, said):
    assert said in notes_of(tmp_path, text)


BOX = model(link("l"))
REFUSED = {
    "an uri of no file": ("1.9", "<include><uri>model://nothing</uri></include>", "model m: the include model://nothing: found no such file, expected it next to the file"),
    "an uri of the network": ("1.9", "<include><uri>https://fuel.gazebosim.org/1.0/x/models/y</uri></include>", "found the uri https://fuel.gazebosim.org/1.0/x/models/y of a network, expected a file"),
    "no uri": ("1.9", "<include/>", "model m: found an <include> without <uri>"),
    "a file that includes itself": ("1.9", "<include><uri>robot.sdf</uri></include>", "which includes itself"),
    "a URDF file": ("1.9", "<include><uri>r.urdf</uri></include>", "r.urdf: found <robot>, expected <sdf"),
    "an included file of another version": ("1.9", "<include><uri>old.sdf</uri></include>", "old.sdf: found version='0.9' of <sdf>, expected 1.3 to 1.12"),
    "an included file that is no XML": ("1.9", "<include><uri>no.sdf</uri></include>", "no.sdf: found no well-formed XML"),
    "an included file without a model": ("1.9", "<include><uri>empty.sdf</uri></include>", "found no models in"),
    "a newer version": ("1.13", "", "found version='1.13' of <sdf>, expected 1.3 to 1.12: convert the file by 'gz sdf -p'"),
    "an included file with two models": ("1.9", "<include><uri>two.sdf</uri></include>", "two.sdf, expected one"),
    "static models alone": ("1.9", "<static>1</static>" + link("l"), "found static models alone, expected a link that moves"),
    "no link": ("1.9", "", "found no link, expected <link name=...> in a <model>"),
    "a name that no frame has": ("1.9", link("l", "0 0 0 0 0 0").replace("<pose>", "<pose relative_to='x'>", 1), "link l: found the frame x, expected a link, joint, frame or model of model m: l"),
    "a circle of frames": ("1.9", link("l").replace("<pose>", "<pose relative_to='f'>", 1) + "<frame name='f' attached_to='l'/>", "is relative to itself, expected no circle"),
    "a frame attached to itself": ("1.9", link("l") + "<frame name='f' attached_to='g'/><frame name='g' attached_to='f'/>" + joint("j", "fixed", "world", "f"), "itself, expected no circle"),
    "two links of a name": ("1.9", link("l") + link("l"), "model m: found two links l, expected one of each name"),
    "two models of a name": ("1.9", link("l") + 2 * "<model name='x'/>", "model m: found two models x"),
    "a link without a name": ("1.9", "<link/>", "model m: found a link without a name, expected <link name=...>"),
    "five numbers": ("1.9", link("l", "0 0 0 0 0"), "link l: found '0 0 0 0 0' in <pose>, expected 6 finite numbers"),
    "a quaternion of zeros": ("1.9", link("l", "0 0 0 0 0 0 0").replace("<pose>", "<pose rotation_format='quat_xyzw'>", 1), "link l: found a quaternion of length 0 in"),
    "another form of rotation": ("1.9", link("l").replace("<pose>", "<pose rotation_format='axis'>", 1), "link l: found rotation_format='axis'"),
    "a mass below zero": ("1.9", link("l", mass=-1), "link l: found a mass of -1"),
    "no number": ("1.9", link("l", mass="heavy"), "link l: found 'heavy' in <mass>, expected a finite number"),
    "an inertia below zero": ("1.9", link("l", moments=(-1, 1, 1)), "link l: found the principal moments of inertia -1"),
    "an inertia of shapes": ("1.9", "<link name='l'><inertial auto='true'/></link>", "link l: found shapes with a mass of 0 kg, expected a positive one of <collision>"),
    "a macro": ("1.9", link("l", mass="${m}"), "run xacro"),
    "no truth value": ("1.9", "<static>perhaps</static>" + link("l"), "model m: found 'perhaps' in <static>, expected true or false"),
    "a frame of a model without links": ("1.9", link("l") + "<model name='x'/>" + joint("j", "fixed", "l", "x"), "joint j: found model x without a link"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_wrong_is_named(tmp_path, case):
    version, body, message = REFUSED[case]
    for name, text in (
        ("r.urdf", "<robot name='r'/>"),
        ("old.sdf", SDF.format("0.9", "")),
        ("no.sdf", "<sdf"),
        ("empty.sdf", SDF.format("1.9", "")),
        ("two.sdf", SDF.format("1.9", "<model name='a'/><model name='b'/>")),
    ):
        written(tmp_path, text, name)
    with pytest.raises(InputError) as error:
        load_robot(written(tmp_path, model(body, version=version)))
    assert message in str(error.value)


def test_other_files_are_refused(tmp_path):
    for text, message in (("<robot/>", "found <robot>, expected <sdf version=...>"), ("<sdf/>", "found version='' of <sdf>"),
                          (SDF.format("1.9", "<world name='a'/><world name='b'/>"), "found 2 worlds, expected one")):  # fmt: skip
        with pytest.raises(InputError, match=message):
            load_robot(written(tmp_path, text))


def test_included_files_are_bounded(tmp_path):
    """Each file includes the next one twice."""
    for k in range(30):
        twice = "".join(f"<include><uri>m{k + 1}.sdf</uri><name>{name}</name></include>" for name in "ab")
        written(tmp_path, model(twice, "x"), f"m{k}.sdf")
    written(tmp_path, BOX, "m30.sdf")
    with pytest.raises(InputError, match="found more than 1000 included files"):
        load_robot(tmp_path / "m0.sdf")


def test_elements_nested_too_deeply_are_refused(tmp_path):
    deep = "".join(f'<model name="m{k}">' for k in range(3000)) + link("l") + 3000 * "</model>"
    with pytest.raises(InputError, match="nested too deeply"):
        load_robot(written(tmp_path, SDF.format("1.9", deep)))


def test_entities_are_not_expanded_without_bound(tmp_path):
    entities = "".join(f'<!ENTITY e{k + 1} "{10 * f"&e{k};"}">' for k in range(9))
    bomb = f'<!DOCTYPE sdf [<!ENTITY e0 "0">{entities}]>' + model(link("l", mass="&e9;"))
    with pytest.raises(InputError, match="no well-formed XML"):
        load_robot(written(tmp_path, bomb))


@pytest.mark.parametrize("declared", ['[<!ENTITY x SYSTEM "file://SECRET">]', 'SYSTEM "SECRET"'])
@pytest.mark.parametrize("suffix", ["sdf", "urdf"])
def test_entities_of_other_files_are_refused(tmp_path, declared, suffix):
    """Their text is neither read nor taken as empty, which stands for the default."""
    secret = written(tmp_path, "7", "secret.txt")
    text = f"<!DOCTYPE sdf {declared.replace('SECRET', str(secret))}>" + model(link("l", mass="&x;"))
    with pytest.raises(
        InputError, match=r"no well-formed XML|found the entity &x; without a value in the file, expected a"
    ):
        load_robot(written(tmp_path, text, f"robot.{suffix}"))


def test_commands_take_files_of_both_names(tmp_path):
    """`convert` writes a scene; `check` and `run` read the file itself."""
    text = model(link("l", centre="0.1 0 0") + joint("j", "revolute", "world", "l", "<xyz>0 1 0</xyz>"))
    for name in ("robot.sdf", "ROBOT.WORLD"):
        path = written(tmp_path, text, name)
        scene = tmp_path / f"{name}.yaml"
        for arguments in (
            ["convert", path, "-o", scene, "--at", "j=0.5"],
            ["check", path],
            ["run", path],
            ["run", scene],
        ):
            result = CliRunner().invoke(main, [str(one) for one in arguments])
            assert result.exit_code == 0, result.output
        assert "j: {type: revolute" in scene.read_text()


WORDS = [
    "-1",
    "0",
    "1e300",
    "nan",
    "",
    "world",
    "__model__",
    "::",
    "l0",
    "j1::l",
    "true",
    "1.4",
    "fixed",
    "ball",
    "\u00e9" * 30,
    "a" * 5000,
    "x\x00y",
]


EVERYTHING = (
    link("l0", centre="0.1 0 0") + link("l1", "0 0 1 0 0 0") + link("l2", "0 1 0 0 0 0", more="<visual name='v'/>")
    + '<frame name="f" attached_to="l1"><pose relative_to="j0">0 0 1 0.3 0 0</pose></frame>'
    + joint("j0", "universal", "world", "l0", "<xyz>1 0 0</xyz>", "<xyz expressed_in='f'>0 1 0</xyz><dynamics><damping>1</damping></dynamics>")
    + joint("j1", "screw", "l0", "f", "<xyz>0 0 1</xyz>", more="<screw_thread_pitch>0.2</screw_thread_pitch>")
    + joint("j2", "revolute", "l0", "l2", "<xyz>1 0 0</xyz><limit><lower>-1</lower><effort>3</effort></limit>")
    + joint("j3", "ball", "l1", "l2") + joint("j4", "revolute", "world", "inner::l3", "<xyz>0 0 1</xyz><mimic joint='j2'><multiplier>2</multiplier></mimic>")
    + f'<model name="inner" placement_frame="l3"><pose relative_to="f" degrees="true">0 1 0 10 20 30</pose>{link("l3")}</model>'
    + "<include merge='1'><uri>box.sdf</uri><name>box</name><pose>1 0 0 0 0 0</pose></include>"
)  # fmt: skip


@pytest.mark.parametrize("part", range(10))
def test_mutated_files_are_read_or_refused_with_a_message(tmp_path, part):
    """50 files in each part: characters, words and elements of valid files are deleted, doubled or exchanged."""
    rng = random.Random(part)
    written(tmp_path, model(link("boxed")), "box.sdf")
    for k in range(50):
        whole = model(EVERYTHING) if k % 2 else FrameGraph(np.random.default_rng(50 * part + k), depth=1).text
        change = mutated if rng.random() < 0.3 else with_other_elements
        for _ in range(rng.choice((1, 1, 2, 6))):
            whole = change(whole, rng)
        path = written(tmp_path, whole.replace("\x00", "&#1;"))
        try:
            scene = load_robot(path)
        except InputError as error:
            assert len(str(error)) < 1500
        else:
            assert scene.bodies


def with_other_elements(text, rng):
    """Text with one element deleted, doubled or moved, or with another name, text or attribute."""
    root = ElementTree.fromstring(text)
    parents = [element for element in root.iter() if len(element)]
    if len(parents) < 3:
        return text
    parent = rng.choice(parents)
    k = rng.randrange(len(parent))
    child, other = parent[k], rng.choice(list(root.iter()))
    match rng.randrange(7):
        case 0:
            parent.remove(child)
        case 1:
            parent.append(copy.deepcopy(child))
        case 2:
            parent.remove(child)
            rng.choice([one for one in parents if one is not child and one not in list(child.iter())]).append(child)
        case 3:
            child.tag = other.tag
        case 4:
            child.text = rng.choice([*WORDS[:-1], other.text])
        case 5:
            child.set(
                rng.choice([*other.keys(), "name", "relative_to"]), rng.choice([*other.attrib.values(), *WORDS[:-1]])
            )
        case 6:
            parent.insert(0, copy.deepcopy(other))
    return ElementTree.tostring(root, encoding="unicode")


def mutated(text, rng):
    """Text with some of its characters deleted, doubled or exchanged."""
    at = rng.randrange(len(text))
    end = min(len(text), at + rng.choice((1, 1, 5, 40)))
    words = text.replace("<", " <").replace(">", "> ").split()
    match rng.randrange(4):
        case 0:
            return text[:at] + text[end:]
        case 1:
            return text[:end] + text[at:]
        case 2:
            return text.replace(rng.choice(words), rng.choice(words), 1)
    return text.replace(rng.choice(words), "", rng.choice((1, 100)))


SHAPES = {
    "<box><size>0.2 0.3 0.4</size></box>": lambda x, y, z: (abs(x) < 0.1) & (abs(y) < 0.15) & (abs(z) < 0.2),
    "<sphere><radius>0.3</radius></sphere>": lambda x, y, z: x**2 + y**2 + z**2 < 0.09,
    "<cylinder><radius>0.2</radius><length>0.5</length></cylinder>": lambda x, y, z: (x**2 + y**2 < 0.04) & (abs(z) < 0.25),
    "<capsule><radius>0.2</radius><length>0.3</length></capsule>": lambda x, y, z: x**2 + y**2 + np.maximum(abs(z) - 0.15, 0) ** 2 < 0.04,
    "<ellipsoid><radii>0.1 0.2 0.3</radii></ellipsoid>": lambda x, y, z: (x / 0.1) ** 2 + (y / 0.2) ** 2 + (z / 0.3) ** 2 < 1,
}  # fmt: skip


@pytest.mark.parametrize("shape", SHAPES)
def test_inertia_of_shapes(tmp_path, shape):
    """Against sums over the points of a grid; a second, small shape has another density."""
    side = np.linspace(-0.4, 0.4, 161)[:-1] + 0.0025
    x, y, z = np.meshgrid(side, side, side, indexing="ij")
    points = np.array([axis[SHAPES[shape](x, y, z)] for axis in (x, y, z)]).T
    turn = rotation(0.3, 0.2, 0.5)
    points = points @ turn.T + [1, 0, 2]
    masses = np.full(len(points), 700 * 0.005**3)
    points, masses = np.vstack([points, [0, 0, 1]]), np.append(masses, 20.0)
    centre = masses @ points / masses.sum()
    r = points - centre
    inertia = np.einsum(
        "k,kij->ij", masses, np.einsum("ki,ki,ab->kab", r, r, np.eye(3)) - np.einsum("ka,kb->kab", r, r)
    )
    small = f"<sphere><radius>{(20 / (2e6 * 4 / 3 * np.pi)) ** (1 / 3)}</radius></sphere>"
    body = (
        f'<link name="l"><inertial auto="true"><density>700</density></inertial><collision name="c"><pose relative_to="f">0 0 2 0.3 0.2 0.5</pose>'
        f'<geometry>{shape}</geometry></collision><collision name="s"><density>2e6</density><pose relative_to="f">-1 0 1 0 0 0</pose><geometry>{small}</geometry></collision></link>'
        '<frame name="f"><pose>1 0 0 0 0 0</pose></frame>'
    )
    found = read(tmp_path, model(body, version="1.11"))["bodies"]["l"]
    assert found["mass"] == pytest.approx(masses.sum(), rel=0.01)
    assert found["center_of_mass"] == pytest.approx(centre, abs=0.01)
    np.testing.assert_allclose(found["inertia"], inertia, rtol=0.02, atol=0.02 * np.abs(inertia).max())
    scaled = model(body.replace("<density>700", "<mass>5</mass><density>700", 1), version="1.11")
    half = read(tmp_path, scaled)["bodies"]["l"]
    assert half["mass"] == pytest.approx(5)
    np.testing.assert_allclose(
        np.array(half["inertia"]) / 5, np.array(found["inertia"]) / found["mass"], rtol=1e-9, atol=1e-12
    )
