"""The command ``stiffmbs compare``, and sections of ``stiffmbs report``."""

import json

import pytest
from click.testing import CliRunner

from stiffmbs.commands.main import main

QUICK = ["--duration", "1", "--rtol", "1e-4:1e-7:3:log", "--repeats", "1"]


def invoke(*words):
    return CliRunner().invoke(main, [str(word) for word in words], env={"COLUMNS": "200"})


@pytest.fixture(scope="module")
def compared(examples, tmp_path_factory):
    """The cart-pendulum compared as JSON, with its figure."""
    figure = tmp_path_factory.mktemp("figures") / "cart.svg"
    result = invoke(
        "compare", examples / "cart_pendulum.yaml", *QUICK, "--solver", "bdf,dop853", "-o", figure, "--json"
    )
    assert result.exit_code == 0, result.output
    (line,) = result.stdout.splitlines()
    return json.loads(line), figure.read_text()


@pytest.mark.long
def test_the_json_is_the_one_that_was_agreed_on(compared, examples):
    content, _ = compared
    assert content["scene"] == str(examples / "cart_pendulum.yaml")
    assert len(content["rows"]) == 6
    for row in content["rows"]:
        assert row.keys() == {"solver", "setting", "error", "seconds", "steps"}
    assert [row["setting"] for row in content["rows"][:3]] == ["rtol 0.0001", "rtol 3.16e-06", "rtol 1e-07"]
    assert content["reference"]["by"] == ["bdf at rtol 1e-12", "dop853 at rtol 1e-12"]
    assert content["errors"]["positions"] == [row["error"] for row in content["rows"]]


def test_the_figure_has_a_curve_for_each_solver(compared):
    _, figure = compared
    assert ">dop853<" in figure
    assert ">bdf<" in figure
    assert "largest error in positions, m or rad" in figure


def test_tables_for_a_person(examples):
    result = invoke("compare", examples / "cart_pendulum.yaml", *QUICK, "--solvers", "bdf", "--formulation", "SI2,I3")
    assert result.exit_code == 0, result.output
    for words in ("bdf SI2", "bdf I3", "ms at an error of (m or rad)", "reference: bdf at rtol", "conclusion: at an"):
        assert words in result.output


@pytest.mark.long
def test_over_a_parameter(examples, tmp_path):
    figure = tmp_path / "over.png"
    result = invoke(
        "compare", examples / "half_car.yaml", "--duration", "0.2", "--rtol", "1e-4:1e-6:3:log", "--over", "k_b=1e4:1e6:2", "--error", "1e-5", "--repeats", "1",
        "--solver", "bdf,dop853", "-o", figure,
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    assert "at an error of 1e-05 m or rad in positions" in result.output
    assert "conclusion: at an error of 1e-05 m or rad " in result.output
    assert figure.read_bytes().startswith(b"\x89PNG")


def test_a_scene_from_standard_input_is_read_once_for_all_values(examples):
    text = (examples / "cart_pendulum.yaml").read_text()
    words = ["compare", "-", *QUICK, "--solver", "dop853", "--over", "start=0.1,0.2", "--error", "1e-5", "--json"]
    result = CliRunner().invoke(main, words, input=text)
    assert result.exit_code == 0, result.output
    assert [row["setting"] for row in json.loads(result.stdout)["rows"]] == ["start=0.1", "start=0.2"]


@pytest.mark.long
def test_a_chaotic_motion_is_refused(examples):
    result = invoke(
        "compare", examples / "chain.yaml", "--set", "N=2", "--set", "run.output=0.02", "--duration", "12", "--json"
    )
    assert result.exit_code == 1
    content = json.loads(result.stdout)
    assert content["status"] == "stopped"
    assert "disagree: link" in content["message"]
    assert "no reference" in result.stderr


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--rtol", "tight"], "--rtol: found ['tight'], expected numbers as FROM:TO:COUNT"),
        (["--over", "k_b"], "--over k_b: found no values, expected NAME=FROM:TO:COUNT"),
        (["--over", "stiffness=1:2"], "stiffness"),
        (["--error", "1e-4"], "found no --over"),
        (["--solver", "gear"], "found 'gear', expected some of bdf"),
        (["-o", "figure.txt"], "found the ending '.txt', expected one of .png, .svg, .pdf"),
        (["--rtol", "1:2"], "rtol"),
    ],
)
def test_wrong_words_are_refused(examples, words, message):
    result = invoke("compare", examples / "cart_pendulum.yaml", *words)
    assert result.exit_code == 2, result.output
    assert message in result.stderr
    assert not result.stdout


def test_a_unit_that_does_not_fit_the_parameter_is_refused(examples):
    result = invoke(
        "compare", examples / "cart_pendulum.yaml", "--over", "forces.spring.stiffness=1:10 mm", "--duration", "1"
    )
    assert result.exit_code == 2, result.output
    assert "N/m" in result.stderr


@pytest.mark.long
def test_a_report_with_all_sections(examples, tmp_path):
    page = tmp_path / "page.html"
    result = invoke(
        "report", examples / "cart_pendulum.yaml", "--duration", "1", "--no-verify", "--equilibrium", "--compare",
        "-o", page,
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    text = page.read_text()
    for title in ("<h2>Static equilibrium</h2>", "<h2>Solvers compared</h2>"):
        assert title in text
    assert "agree within" in text


@pytest.mark.long
def test_a_report_says_why_there_is_no_equilibrium(tmp_path):
    page, scene = tmp_path / "page.html", tmp_path / "falling.yaml"
    scene.write_text("{gravity: [0, -9.81], bodies: {ball: {mass: 1, inertia: 1}}, run: {duration: 1, points: 11}}")
    assert invoke("report", scene, "--no-verify", "--equilibrium", "-o", page).exit_code == 0
    assert "<p>none: " in page.read_text()


@pytest.mark.long
def test_a_report_has_no_sections_that_nobody_asks_for(examples, tmp_path):
    page = tmp_path / "page.html"
    assert invoke("report", examples / "bar_pendulum.yaml", "--no-verify", "-o", page).exit_code == 0
    assert "Solvers compared" not in page.read_text()
