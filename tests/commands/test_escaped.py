"""Names with characters that steer a terminal, or turn the direction of writing: none reaches a terminal or a page."""

import json
import re
import unicodedata

import numpy as np
import pytest
from click.testing import CliRunner

from stiffmbs.commands.main import main
from stiffmbs.show.escaped import ESCAPED, console, escaped

SCENE = """
name: "a SIGN b"
notes: ["a note SIGN of the scene"]
parameters: {k: 40 N/m}
inputs: {push: 0 N}
bodies: {sled: {mass: 2 kg, inertia: 0.1, velocity: [1, 0]}}
joints: {rail: {type: prismatic, i: sled, j: ground}}
forces:
  spring: {type: spring_damper, i: {body: sled, point: [0, 0]}, j: {body: ground, point: [-3, 0]}, stiffness: k, damping: 1, free_length: 3}
  pusher: {type: force, i: sled, force: [push, 0]}
requests: {where: sled.x}
figure: {x: time, y: [where], title: "title SIGN"}
run: {duration: 0.2 s, points: 11}
"""
SIGNS = ["\x9b31m", "\u202e", "\u200b", "\u2066", "\ufeff", "\u2028", "\u2029", "\xad", "\U000e0041", "\x85", "\u061c"]
IN_FILES = [*SIGNS, "\x1b[31m", "\x07", "\r", "\x08", "\x7f"]
COMMANDS = [
    ["run", "SCENE"], ["run", "SCENE", "--json"], ["run", "SCENE", "-o", "OUT.csv"], ["run", "SCENE", "--set", "SIGN=1"],
    ["run", "SCENE", "--set", "run.solver=SIGN"], ["run", "SCENE", "--verify"], ["check", "SCENE"], ["check", "SCENE", "--json"],
    ["modes", "SCENE"], ["modes", "SCENE", "--json"], ["equilibrium", "SCENE"], ["equilibrium", "SCENE", "--json"],
    ["response", "SCENE", "--input", "sled.fx", "--output", "sled.x", "--json"], ["study", "SCENE", "--vary", "k=40,50"], ["study", "SCENE", "--vary", "k=40,50", "--json"],
    ["study", "SCENE", "--vary", "SIGN=40,50"], ["study", "SCENE", "--vary", "k=40,50", "--of", "SIGN"],
    ["sensitivities", "SCENE", "--of", "final(where)", "--to", "k"], ["draw", "SCENE", "-o", "OUT.svg"], ["draw", "SCENE", "-o", "OUT.SIGN"],
    ["fmu", "SCENE", "-o", "OUT.fmu"], ["report", "SCENE", "-o", "OUT.html"], ["animate", "SCENE", "-o", "OUT.html"],
    ["convert", "SCENE"], ["convert", "SCENE", "-o", "OUT.adm"], ["plot", "OUT.npz"], ["diff", "OUT.npz", "SCENE"], ["SIGN"],
    ["run", "SCENE", "--SIGN"], ["run", "SCENE", "--from", "SIGN.npz"], ["examples", "SIGN"], ["parts", "SIGN"], ["bench", "SIGN"],
    ["kc", "SCENE"], ["optimise", "SCENE", "--minimise", "SIGN", "--parameter", "k=30:50"],
]  # fmt: skip


def odd_in(text):
    return {sign for sign in text if unicodedata.category(sign) in ESCAPED and sign not in "\n\t"}


def in_yaml(sign):
    return "".join(f"\\U{ord(each):08x}" for each in sign)


@pytest.fixture(scope="module", params=SIGNS[:2], ids=lambda sign: f"U+{ord(sign[0]):04X}")
def files(request, tmp_path_factory):
    folder, sign = tmp_path_factory.mktemp("files"), request.param
    (folder / f"s{sign}.yaml").write_text(SCENE.replace("SIGN", in_yaml(sign)), encoding="utf-8")
    np.savez(folder / "out.npz", **{"time": np.linspace(0, 1, 3), f"x{sign}": np.ones(3)})
    return folder, sign


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_no_command_prints_them(files, command, monkeypatch):
    folder, sign = files
    monkeypatch.chdir(folder)
    words = [word.replace("SCENE", f"s{sign}.yaml").replace("OUT", "out").replace("SIGN", sign) for word in command]
    done = CliRunner().invoke(main, words)
    assert done.exception is None or isinstance(done.exception, SystemExit)
    assert not odd_in(done.output)
    if "--json" in command and done.stdout:
        shown = json.loads(done.stdout.splitlines()[0])
        assert shown["scene"] == f"s{sign}.yaml"  # JSON gives the name back
    if command[-1] == "OUT.html":
        text = (folder / "out.html").read_text(encoding="utf-8")
        assert not odd_in(re.sub("<script.*?</script>", "", text, flags=re.DOTALL))


@pytest.mark.parametrize("sign", IN_FILES, ids=lambda sign: f"U+{ord(sign[0]):04X}")
@pytest.mark.parametrize("ending", ["yaml", "adm", "urdf", "xml"])
def test_names_of_files_are_escaped(tmp_path, sign, ending):
    for content in (None, f"bodies: {sign}", "[", f"ADAMS title {sign}\nPART/{sign}\nEND\n", f"<robot name='{sign}'/>"):
        path = tmp_path / f"a{sign}.{ending}"
        path.unlink(missing_ok=True)
        if content is not None:
            path.write_text(content, encoding="utf-8", newline="")
        done = CliRunner().invoke(main, ["run", str(path)])
        assert isinstance(done.exception, SystemExit)
        assert not odd_in(done.output)


@pytest.mark.parametrize("sign", IN_FILES, ids=lambda sign: f"U+{ord(sign[0]):04X}")
def test_consoles_keep_their_own_codes(sign, capsys):
    shown = console(force_terminal=True, color_system="standard", width=80)
    shown.print(f"a{sign}b", style="red", highlight=False)
    text = capsys.readouterr().out
    assert text.startswith("\x1b[31m")
    assert not odd_in(text.replace("\x1b[31m", "", 1).replace("\x1b[0m", ""))


def test_what_can_be_read_stays():
    text = "Größe µ 10⁻⁶ — ein „Wort“ 日本 naïve\tx\n€"
    assert escaped(text) == text
    assert escaped("\U000e0041") == "\\U000e0041"
    assert json.loads('"' + escaped("a\x9b") + '"') == "a\x9b"
