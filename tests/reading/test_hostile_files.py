"""Scenes and datasets that are wrong, strange or hostile: one sentence, and no hang."""

import os

import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs.adams.load import read_adams
from stiffmbs.commands.main import main
from stiffmbs.errors import InputError
from stiffmbs.reading.files.quoted import MOST_QUOTED, quoted, written
from stiffmbs.reading.files.text_file import decoded, lines
from stiffmbs.reading.files.yaml_text import read_yaml

BODY = "bodies: {b: {mass: 1, inertia: 1}}\n"
FORCE = "forces: {f: {type: force, i: b, force: ['%s', 0]}}\n"
HEAD = """title
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND
PART/1, GROUND
MARKER/1, PART=1
PART/2, MASS=1, CM=3, IP=1,1,1, QG=1,0,0
MARKER/3, PART=2
"""


def laughs(depth):
    """Aliases each of which stands for nine of the one before."""
    rows = ["a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    rows += [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]" for k in range(1, depth)]
    return "".join(f"  {row}\n" for row in rows)


REFUSED = {
    "aliases nine deep": ("bodies:\n" + laughs(10), "aliases that stand for"),
    "alias within itself": ("bodies: &b {b: {mass: 1, x: *b}}\n", "alias within what it stands for"),
    "list within itself": (BODY + "notes: &n [*n]\n", "alias within what it stands for"),
    "merge of no mapping": ("bodies: {b: {mass: 1, <<: 3}}\n", "not YAML"),
    "300 nested maps": ("bodies: " + "{a: " * 300 + "1" + "}" * 300, "nested 41 deep"),
    "600 nested lists": ("bodies: " + "[" * 600 + "]" * 600, "nested too deep"),
    "deep by aliases": (
        "x0: &x0 [1]\n" + "".join(f"x{k}: &x{k} [*x{k - 1}]\n" for k in range(1, 60)) + BODY, "deep",
    ),
    "half of a surrogate pair": ('name: "x \\ud800"\n' + BODY, "U+D800"),
    "half of a surrogate pair as a number": ('bodies: {b: {mass: "\\udfff", inertia: 1}}\n', "U+DFFF"),
    "what steers a terminal": ('name: "\\e[31m"\n' + BODY, "U+001B"),
    "a truth value that is none": ("bodies: !!bool abc\n", "does not fit its tag"),
    "an ordered mapping with one name twice": ("bodies: !!omap [a: 1, a: 2]\n", "does not fit its tag"),
    "a whole number of 400 digits": ("bodies: {b: {mass: " + "9" * 400 + ", inertia: 1}}\n", "beyond 1e308"),
    "a whole number of 5000 digits": ("bodies: {b: {mass: " + "9" * 5000 + ", inertia: 1}}\n", "4300 digits"),
    "points without end": (BODY + "run: {points: 1" + "0" * 300 + "}\n", "output times"),
    "tower of powers": ("bodies: {b: {mass: 9**9**9, inertia: 1}}\n", "overflows"),
    "tower of powers in a force": (BODY + FORCE % "9**9**9", "no finite real value"),
    "a mapping in place of a formula": (
        "bodies: {b: {mass: 1, inertia: 1}}\nforces: {f: {type: torque, i: b, torque: {a: 1}}}\n", "expected a formula",
    ),
    "a number that is too long to be quoted": ("bodies: {b: {mass: '" + "9" * 1000 + "', inertia: 1}}\n", " ... "),
}  # fmt: skip


@pytest.mark.parametrize(("text", "words"), REFUSED.values(), ids=REFUSED.keys())
def test_hostile_scenes_are_refused_in_one_sentence(text, words):
    with pytest.raises(InputError) as refused:
        stiffmbs.check(stiffmbs.read_scene(text))
    assert words in str(refused.value)
    assert len(str(refused.value)) < 300
    assert "\n" not in str(refused.value)


def test_an_unknown_body_behind_a_spring_that_measures_the_mechanism():
    forces = "forces: {s: {type: spring_damper, i: b, j: {body: ground, point: [1, 0]}, stiffness: 1, free_length: 1}, f: {type: force, i: bb, force: [1, 0]}}\n"
    with pytest.raises(InputError, match=r"forces\.f\.i: found the unknown body 'bb'"):
        stiffmbs.read_scene(BODY + forces)


def test_aliases_that_stand_for_little_are_read():
    scene = stiffmbs.read_scene("bodies: {a: &m {mass: 1, inertia: 2}, b: *m, c: {<<: *m, mass: 3}}\n")
    assert (scene.bodies["b"].mass, scene.bodies["c"].mass, scene.bodies["c"].inertia) == (1, 3, 2)


def test_numbers_from_python_are_bounded_too():
    with pytest.raises(InputError, match="beyond 1e308"):
        stiffmbs.Body(mass=10**400, inertia=1)
    with pytest.raises(InputError, match="beyond 1e308"):
        stiffmbs.read_scene(BODY, [("bodies.b.mass", "1" + "0" * 400)])


@pytest.mark.parametrize("end", ["\x85", "\u2028", "\u2029"])
def test_a_comment_of_a_scene_ends_with_its_line_alone(end):
    scene = stiffmbs.read_scene(f"# before: {end} bodies: {{x: {{mass: 7, inertia: 1}}}}\n{BODY}name: a{end}b\n")
    assert list(scene.bodies) == ["b"]
    with pytest.raises(InputError, match=r"line 2, bodies\.b\.mass"):
        stiffmbs.read_scene(f"# before {end}\nbodies: {{b: {{mass: -1, inertia: 1}}}}\n")


@pytest.mark.parametrize("sign", ["\x85", "\x0c", "\x0b", "\x1c", "\u2028", "\u2029"])
def test_a_comment_of_a_dataset_ends_with_its_line_alone(sign):
    scene = read_adams(HEAD + f"! before {sign}ACCGRAV/KGRAV=-5\nACCGRAV/KGRAV=-9.81\nEND\n")
    assert scene.gravity == (0, 0, -9.81)


@pytest.mark.parametrize("end", ["\n", "\r", "\r\n"])
def test_lines_end_at_cr_and_lf(end):
    assert lines(end.join(["a", "", "b"]) + end) == ["a", "", "b"]
    scene = read_adams((HEAD + "ACCGRAV/KGRAV=-9.81\nEND\n").replace("\n", end))
    assert list(scene.bodies) == ["PART_2"]
    with pytest.raises(InputError, match="line 5"):
        read_adams(HEAD.replace("MASS=1", "MASS=-1").replace("\n", end) + "END")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32"])
@pytest.mark.parametrize("text", [HEAD + "END\n", BODY])
def test_unicode_in_all_its_forms_is_read(encoding, text):
    assert decoded(text.encode(encoding), "file") == text
    assert decoded(("\ufeff" + text).encode(encoding), "file").lstrip("\ufeff") == text


def test_what_is_no_text_is_named(tmp_path):
    for content, words in (
        (b"name: T\xfcr\n" + BODY.encode(), "not UTF-8 text"),
        (BODY.encode("utf-16")[:-1], "not UTF-16 text"),
        (BODY.encode() + b"name: a\0b\n", "line 2: found a zero byte"),
        (b"\x80" + os.urandom(50) + b"\0\0x", "."),
    ):
        with pytest.raises(InputError, match=words):
            read_yaml(decoded(content, "file"), "file")
    assert decoded(HEAD.encode() + b"\x1a\0\0", "file") == HEAD
    assert "Tür" in decoded("Tür".encode("latin-1"), "file", "latin-1")
    with pytest.raises(InputError, match="line 2: found a zero byte"):
        read_adams(HEAD.replace("UNITS", "UN\0ITS"))


MOTION = HEAD + "JOINT/1, REVOLUTE, I=3, J=1\nMOTION/1, JOINT=1, ROTATION, %s\nEND\n"
FUNCTIONS = {
    "tower of powers": "FUNCTION=9**9**9",
    "tower of powers of time": "ACCEL, FUNCTION=TIME**9**9**9",
    "tower of powers in a condition": "ACCEL, FUNCTION=IF(9**9**9-TIME: 1, 2, 3)",
    "tower of powers as an initial velocity": "VELOCITY, ICDISP=1, FUNCTION=9**9**9",
    "a number beyond all": "FUNCTION=1E400*TIME",
    "a number of 5000 digits": "FUNCTION=" + "9" * 5000,
    "no real power": "FUNCTION=(-8)**(1/3)",
    "5000 parentheses": "FUNCTION=" + "(" * 5000 + "TIME" + ")" * 5000,
}


def test_a_power_too_high_to_integrate_as_a_formula_is_a_state():
    """A power of a sum would be expanded to 100 000 terms."""
    states = read_adams(MOTION % "ACCEL, FUNCTION=(1+TIME)**100000").states
    assert states["MOTION_1_velocity"].rate.text == "(1 + t) ** 100000"


@pytest.mark.parametrize("function", FUNCTIONS.values(), ids=FUNCTIONS.keys())
def test_hostile_functions_of_datasets_are_refused_in_one_sentence(function):
    with pytest.raises(InputError, match="line 8") as refused:
        read_adams(MOTION % function)
    assert len(str(refused.value)) < 400


def test_powers_of_numbers_are_values():
    scene = read_adams(MOTION % "FUNCTION=2**3*TIME + 4**0.5")
    (position,) = (joint.prescribed_position for name, joint in scene.joints.items() if name.startswith("MOTION"))
    assert position.text == "8.0 * t + 2.0"


def test_variables_that_double_each_other_are_bounded():
    chain = "".join(f"VARIABLE/{k}, FUNCTION=VARVAL({k + 1})+VARVAL({k + 1})\n" for k in range(1, 40))
    with pytest.raises(InputError, match=r"variables.VARIABLE_.*expected at most 2000"):
        read_adams(
            HEAD + chain + "VARIABLE/40, FUNCTION=TIME\nSFORCE/1, I=3, J=1, TRANSLATIONAL, FUNCTION=VARVAL(1)\nEND\n"
        )


def test_numbers_of_statements_are_bounded():
    with pytest.raises(InputError, match="expected the number of a statement"):
        read_adams(HEAD.replace("PART/2", "PART/" + "9" * 5000) + "END\n")


def test_a_mechanism_too_far_from_the_origin_is_refused():
    scene = "bodies: {b: {mass: 1, inertia: 1, position: [%s, 0]}}\njoints: {h: {type: revolute, i: {body: b, point: [-1, 0]}, j: {body: ground, point: [%s, 0]}}}\n"
    with pytest.raises(
        InputError, match=r"bodies.b.position: found 1e\+12 m in a mechanism of 1 m.*nearer to the origin"
    ):
        stiffmbs.check(stiffmbs.read_scene(scene % ("1e12", "1e12 - 1")))
    assert stiffmbs.check(stiffmbs.read_scene(scene % ("1e6", "1e6 - 1"))).degrees_of_freedom == 1


def test_quotations_are_short():
    assert quoted("9" * 10_000).startswith("999")
    assert len(written("9" * 10_000)) == MOST_QUOTED
    assert written(10**5000) == "a large int"


def test_long_names_of_files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.yaml").write_text(BODY)
    long = "x" * 300
    for arguments in (
        ["run", f"{long}.yaml"], ["check", "a\0b"], ["run", "scene.yaml", "-o", f"{long}.npz"],
        ["run", "scene.yaml", "--figure", f"{long}.png"], ["report", "scene.yaml", "-o", f"{long}.html"],
        ["convert", f"{long}.adm"],
    ):  # fmt: skip
        result = CliRunner().invoke(main, arguments)
        assert result.exit_code == 2, result.output
        assert result.output.count("\n") == 1
