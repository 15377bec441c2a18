"""The command as a process: signals, standard input and output, names that hold markup, little memory."""

import json
import os
import signal
import subprocess
import sys
import time
import weakref
from pathlib import Path

import click
import numpy as np
import pytest
from click.testing import CliRunner

from stiffmbs.commands.main import main
from stiffmbs.commands.process import INTERRUPTED, Process

SCENE = "name: '%s'\nnotes: ['%s']\nbodies: {b: {mass: 1, inertia: 1}}\nrun: {duration: 0.1}\nfigure: {title: '%s', y: [b.x]}\n"
COMMAND = [sys.executable, "-m", "stiffmbs"]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scene.yaml").write_text(SCENE % ("plain", "plain", "plain"))
    return tmp_path


def invoke(*arguments, **options):
    return CliRunner().invoke(main, list(arguments), **options)


@pytest.mark.parametrize("name", ["Cart [v2]", "x [/] y", "[bold]x[/bold] [red", ":smile: [x]", "\\[a]", "[link=x]"])
def test_names_that_read_as_markup_are_shown_as_they_are(folder, name):
    (folder / "scene.yaml").write_text(SCENE % (name, f"note {name}", name))
    result = invoke("run", "scene.yaml", "--figure", "out.svg")
    assert result.exit_code == 0, result.output
    assert result.output.startswith(f"{name}: 0 s to 0.1 s")
    assert f". note {name}\n" in result.output
    assert invoke("check", "scene.yaml").output.startswith(f"{name}: ")


@pytest.mark.parametrize("title", ["$\\frac{1}$", "$x", "$\\foo{$ $", "$$", "100 $", "$\\alpha$"])
def test_a_title_that_is_no_formula_is_drawn_as_it_is(folder, title):
    (folder / "scene.yaml").write_text(SCENE % (title, "", title))
    result = invoke("run", "scene.yaml", "--figure", "out.png")
    assert result.exit_code == 0, result.output
    assert (folder / "out.png").stat().st_size > 1000
    assert not list(folder.glob(".part-*"))


@pytest.mark.long
@pytest.mark.parametrize(
    "command", [["run", "--json"], ["check"], ["report", "--no-verify"], ["convert", "--in-space"]]
)
def test_a_scene_is_read_from_standard_input(folder, command):
    text = (folder / "scene.yaml").read_text()
    assert invoke(*command, "-", input=text).exit_code == 0
    wrong = invoke(*command, "-", input="bodies: {b: 3}\n")
    assert wrong.exit_code == 2
    assert "standard input, line 1, bodies.b: found 3" in wrong.output
    assert invoke("run", "-", input=text).output.endswith("results      stdin.results.npz\n")


def test_a_dataset_is_converted_from_standard_input(folder):
    text = "title\nUNITS/FORCE=NEWTON,MASS=KILOGRAM,LENGTH=METER,TIME=SECOND\nPART/1,GROUND\nPART/2,MASS=1,CM=3,IP=1,1,1\nMARKER/3,PART=2\nEND\n"
    assert "PART_2" in invoke("convert", "-", input=text).output


def test_no_input_is_written_over(folder):
    text = "t\nPART/1,GROUND\nPART/2,MASS=1,CM=3,IP=1,1,1\nMARKER/3,PART=2\nEND\n"
    (folder / "set.adm").write_text(text)
    (folder / "link.yaml").symlink_to("set.adm")
    os.link("set.adm", "hard.yaml")
    (folder / "sub").mkdir()
    for output in ("set.adm", "./set.adm", "sub/../set.adm", str(folder / "set.adm"), "link.yaml", "hard.yaml"):
        result = invoke("convert", "set.adm", "-o", output)
        assert result.exit_code == 2
        assert "found the file that is read" in result.output
    os.link("scene.yaml", "scene.npz")
    os.link("scene.yaml", "scene.png")
    os.link("scene.yaml", "scene.html")
    assert invoke("run", "scene.yaml", "-o", "scene.npz").exit_code == 2
    assert invoke("run", "scene.yaml", "--figure", "scene.png").exit_code == 2
    assert invoke("report", "scene.yaml", "-o", "scene.html").exit_code == 2
    assert invoke("modes", "scene.yaml", "-o", "scene.html").exit_code == 2
    for command in (("kc", "scene.yaml"), ("response", "scene.yaml", "--input", "m", "--output", "m")):
        assert "found the file that is read" in invoke(*command, "-o", "scene.yaml").output
    assert (folder / "set.adm").read_text() == text
    assert "plain" in (folder / "scene.yaml").read_text()
    assert invoke("convert", "set.adm", "-o", "new.yaml").exit_code == 0


def started(*arguments, **options):
    return subprocess.Popen([*COMMAND, *arguments], stderr=subprocess.PIPE, text=True, **options)


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
@pytest.mark.parametrize(
    "arguments", [["check", "scene.yaml"], ["run", "scene.yaml", "--json"], ["schema"], ["--help"]]
)
@pytest.mark.parametrize("buffered", [True, pytest.param(False, marks=pytest.mark.long)])
def test_a_full_standard_output_is_told(folder, arguments, buffered):
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    with open("/dev/full", "w") as full:
        process = started(
            *arguments, stdout=full, env=environment if buffered else environment | {"PYTHONUNBUFFERED": "1"}
        )
        _, errors = process.communicate()
    assert process.returncode == 1
    assert errors.count("\n") == 1
    assert "standard output: " in errors
    assert "No space left on device" in errors


@pytest.mark.long
def test_a_closed_standard_output_is_told_and_results_are_written(folder):
    done = subprocess.run(
        ["sh", "-c", '"$0" -m stiffmbs run scene.yaml -o out.npz >&-', sys.executable], capture_output=True, text=True
    )
    assert done.returncode == 1
    assert done.stderr == "stiffmbs: standard output is closed: nothing is shown\n"
    with np.load("out.npz") as results:
        assert len(results["time"]) == 1001
    quiet = subprocess.run(["sh", "-c", '"$0" -m stiffmbs check nowhere.yaml >&- 2>&- <&-', sys.executable])
    assert quiet.returncode == 2


def until_begun(process):
    """Wait until a process has had the time of a processor that a run needs to begin, on a busy machine too."""
    of_process = Path(f"/proc/{process.pid}/stat")
    for _ in range(600):
        time.sleep(0.1)
        assert process.poll() is None
        ticks = sum(map(int, of_process.read_text().rpartition(")")[2].split()[11:13]))
        if ticks > 5.0 * os.sysconf("SC_CLK_TCK"):
            return


LONG = """\
gravity: [0, -9.81]
bodies: {a: {mass: 1, inertia: 1e-3, position: [1, 0]}, b: {mass: 1, inertia: 1e-3, position: [2, 0]}}
joints: {h: {type: revolute, i: {body: a, point: [-1, 0]}, j: ground}, k: {type: revolute, i: a, j: {body: b, point: [-1, 0]}}}
run: {duration: 100000, points: 100001, rtol: 1e-10}
"""


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_what_was_computed_is_kept_when_a_run_is_asked_to_end(folder, number):
    (folder / "long.yaml").write_text(LONG)
    assert started("run", "long.yaml", "--duration", "0.1", "-o", "warm.npz", stdout=subprocess.DEVNULL).wait() == 0
    process = started("run", "long.yaml", "-o", "out.npz", "--json", stdout=subprocess.PIPE)
    until_begun(process)
    process.send_signal(number)
    output, errors = process.communicate()
    assert process.returncode == 1, errors
    assert json.loads(output)["status"] == "interrupted"
    with np.load("out.npz") as results:
        assert 1 < len(results["time"]) < 100_001


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("delay", [0.15, 0.4, 0.8, 1.2, 2.0])
def test_ctrl_c_ends_without_a_traceback_at_any_moment(folder, delay):
    process = started(
        "check", "scene.yaml", stdout=subprocess.DEVNULL, env={**os.environ, "STIFFMBS_CACHE": str(folder)}
    )
    time.sleep(delay)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate()
    # before Python has a handler of its own, the signal ends the process
    assert process.returncode in (0, INTERRUPTED, -signal.SIGINT)
    assert "Traceback" not in errors
    assert "Error" not in errors


def test_ctrl_c_within_a_callback_is_not_lost(capfd):
    @click.command(cls=Process, invoke_without_command=True)
    def command():
        def interrupt(_):
            raise KeyboardInterrupt

        short_lived = {0}
        watched = weakref.ref(short_lived, interrupt)
        del short_lived
        assert watched() is None
        time.sleep(10.0)

    with pytest.raises(SystemExit) as ended:
        command.main([])
    assert ended.value.code == INTERRUPTED
    assert capfd.readouterr().err.strip() == "stiffmbs: interrupted"


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("kilobytes", [200_000, 400_000, 700_000, 1_000_000])
def test_little_memory_is_told(folder, kilobytes):
    done = subprocess.run(
        ["sh", "-c", f'ulimit -v {kilobytes}; exec "$0" -m stiffmbs check scene.yaml', sys.executable],
        capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
    )  # fmt: skip
    assert done.returncode in (0, 1, 2)
    assert "Traceback" not in done.stderr
