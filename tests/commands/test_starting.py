"""Commands to begin with: examples that are installed, a first scene, versions, and how much is told."""

import json
import logging
import re
import tomllib
from pathlib import Path

import pytest
from click.testing import CliRunner

from stiffmbs.commands import starting as shipped
from stiffmbs.commands.main import main
from stiffmbs.commands.starting import FIRST_SCENE

ROOT = Path(__file__).parents[2]


@pytest.fixture
def call(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return lambda *arguments: CliRunner().invoke(main, [str(argument) for argument in arguments])


def test_all_examples_are_listed_with_what_they_are_about(call, examples):
    listed = json.loads(call("examples", "list", "--json").output)["examples"]
    scenes = [path for path in examples.rglob("*.yaml") if path.parent.name != "parts"]
    assert listed.keys() == {path.stem for path in scenes} and len(listed) == len(scenes)
    assert all(len(words) > 10 for words in listed.values())
    assert listed["cart_pendulum"] in call("examples", "list").output


def test_every_file_of_the_examples_is_put_into_a_wheel(examples):
    patterns = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["data-files"]
    packed = {path for own in patterns.values() for pattern in own for path in ROOT.glob(pattern)}
    assert packed == {path for path in examples.rglob("*") if path.is_file()}
    for place, own in patterns.items():
        assert place.removeprefix("share/stiffmbs/") == own[0].rpartition("/")[0], "as in the source tree"


def test_installed_examples_are_found_by_the_record_of_the_installation(tmp_path, monkeypatch):
    class File(type(Path("x"))):
        def locate(self):
            return tmp_path / self

    (tmp_path / "share/stiffmbs/examples/parts").mkdir(parents=True)
    (tmp_path / "share/stiffmbs/examples/one.yaml").write_text("# One. Two.\n")
    recorded = ["stiffmbs/a.py", "share/stiffmbs/examples/parts/p.yaml", "share/stiffmbs/examples/one.yaml"]
    monkeypatch.setattr(shipped, "__file__", str(tmp_path / "stiffmbs/commands/starting.py"))
    monkeypatch.setattr("importlib.metadata.files", lambda _: [File(name) for name in recorded])
    assert shipped.examples_folder() == tmp_path / "share/stiffmbs/examples"
    assert shipped.first_words(shipped.scene_file("one.yaml")) == "One"
    monkeypatch.setattr("importlib.metadata.files", lambda _: None)
    with pytest.raises(shipped.InputError, match="found no examples"):
        shipped.examples_folder()


def test_examples_are_copied_with_their_parts_and_nothing_is_written_over(call, examples):
    assert call("examples", "copy", "front_axle", "--to", "mine").exit_code == 0
    assert (
        Path("mine/vehicles/front_axle.yaml").read_bytes() == (examples / "vehicles" / "front_axle.yaml").read_bytes()
    )
    assert call("check", "mine/vehicles/front_axle.yaml").exit_code == 0
    again = call("examples", "copy", "front_axle", "--to", "mine")
    assert again.exit_code == 2
    assert "found a file" in again.stderr
    assert call("examples", "copy").exit_code == 0
    copied, installed = (
        {path.relative_to(each) for path in each.rglob("*.*")} for each in (Path("examples"), examples)
    )
    assert copied == installed


def test_a_copy_takes_the_files_that_the_scene_reads_alone(call):
    for name in ("vehicles/half_car_at_rest", "hatchback", "car.yaml"):
        assert call("examples", "copy", name, "--to", "mine").exit_code == 0, name
    found = {str(path.relative_to("mine")) for path in Path("mine").rglob("*.*")}
    assert found == {"car.tir", "car.yaml", "vehicles/half_car_at_rest.yaml", "vehicles/hatchback.yaml"}
    Path("mine/car.yaml").unlink()
    Path("mine/car.tir").write_text("mine")
    refused = call("examples", "copy", "car", "--to", "mine")
    assert refused.exit_code == 2 and "car.tir: found a file" in refused.stderr
    assert Path("mine/car.tir").read_text() == "mine" and not Path("mine/car.yaml").exists()
    assert "(did you mean" in call("examples", "copy", "beams/half_car_at_rest").stderr


def test_an_example_is_run_with_the_options_of_run(call):
    ran = call("examples", "run", "bar_pendulum", "--json", "--duration", "0.1")
    assert ran.exit_code == 0
    assert json.loads(ran.output)["time"] == {"start": 0.0, "end": 0.1}
    refused = call("examples", "run", "bar_pendulums")
    assert refused.exit_code == 2
    assert "'bar_pendulums'" in refused.stderr
    assert "bar_pendulum," in refused.stderr


def test_the_first_scene_runs_and_is_not_written_over(call):
    assert call("init").exit_code == 0
    assert Path("scene.yaml").read_text() == FIRST_SCENE.read_text()
    assert call("check", "scene.yaml").exit_code == 0
    assert call("run", "scene.yaml", "--duration", "0.2", "-o", "out.csv").exit_code == 0
    Path("scene.yaml").write_text("mine")
    assert call("init").exit_code == 2
    assert Path("scene.yaml").read_text() == "mine"
    assert call("init", "no/such/folder.yaml").exit_code == 1


def test_versions_are_those_of_what_a_plain_run_needs(call, monkeypatch):
    stated = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["dependencies"]
    monkeypatch.setattr("importlib.metadata.requires", lambda _: [*stated, 'furo>=2024.8; extra == "docs"'])
    needed = {re.match(r"[\w.-]+", text)[0] for text in stated}
    found = json.loads(call("version", "--json").output)
    assert {"stiffmbs", "python", "platform", *needed} == found.keys()
    assert all(found.values())
    assert found["numpy"] in call("version").output


def test_completion_is_told_in_the_help_and_known_to_the_command(call, monkeypatch):
    assert "_STIFFMBS_COMPLETE=bash_source stiffmbs" in call("--help").output
    script = CliRunner().invoke(main, env={"_STIFFMBS_COMPLETE": "bash_source"}, prog_name="stiffmbs")
    assert "complete" in script.output


@pytest.mark.parametrize(
    ("option", "told"), [("-q", set()), ("-v", {"warned", "informed"}), ("-vv", {"warned", "informed", "detailed"})]
)
def test_logging_is_told_as_loudly_as_asked_for_and_only_by_this_command(call, monkeypatch, option, told):
    from stiffmbs.analyses import load_scene

    logger = logging.getLogger("stiffmbs.analyses")
    read = load_scene.__dict__["load_scene"]

    def telling(*arguments):
        logger.warning("warned"), logger.info("informed"), logger.debug("detailed")
        return read(*arguments)

    monkeypatch.setattr("stiffmbs.commands.run.load_scene", telling)
    before = logging.getLogger("stiffmbs").level, list(logging.getLogger("stiffmbs").handlers)
    ran = call("examples", "run", "bar_pendulum", "--json", "--duration", "0.01", option)
    assert {word for word in ("warned", "informed", "detailed") if word in ran.stderr} == told
    assert json.loads(ran.stdout)["status"] == "done"
    assert (logging.getLogger("stiffmbs").level, list(logging.getLogger("stiffmbs").handlers)) == before
