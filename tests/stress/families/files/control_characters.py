"""Names with characters that steer a terminal or turn the direction of writing: no command prints them, and JSON gives them back."""

from __future__ import annotations

import json
import unicodedata
from functools import partial
from pathlib import Path

from ...case import Case, Outcome, Verdict
from ...variants.answers import with_files
from ...variants.command_line import command

SCENE = """
name: "a SIGN b"
notes: ["a note SIGN of the scene"]
parameters: {k: 40 N/m}
bodies: {sled: {mass: 2 kg, inertia: 0.1, velocity: [1, 0]}}
joints: {rail: {type: prismatic, i: sled, j: ground}}
forces: {spring: {type: force, i: sled, force: [-k*sled.x, 0]}}
requests: {where: sled.x}
figure: {x: time, y: [where], title: "title SIGN"}
run: {duration: 0.1 s, points: 3}
"""
STEERING = ("Cc", "Cf", "Zl", "Zp", "Co", "Cs")
"""Unicode categories of characters that steer, of lines and paragraphs, and of those without a meaning of their own."""
ASKED = (
    ("\x9b31m", ["run", "SCENE"], 0), ("\u202e", ["check", "SCENE", "--json"], 0), ("\u2066", ["run", "SCENE", "--set", "SIGN=1"], 2),
    ("\u200b", ["run", "SCENE", "--json"], 0), ("\ufeff", ["study", "SCENE", "--vary", "SIGN=40,50"], 2), ("\u2028", ["modes", "SCENE"], 0),
    ("\xad", ["draw", "SCENE", "-o", "OUT.SIGN"], 2), ("\U000e0041", ["SIGN"], 2), ("\x85", ["run", "SCENE", "--from", "SIGN.npz"], 2),
    ("\x1b[31m", ["run", "SIGN.yaml"], 2), ("\x07", ["run", "SIGN.adm"], 2), ("\r", ["check", "SIGN.urdf"], 2), ("\x7f", ["examples", "SIGN"], 2),
    ("\u061c", ["convert", "SCENE", "-o", "OUT.SIGN"], 2),
)  # fmt: skip
"""Characters, a command, and its exit status."""


def _judged(sign: str, words: list[str], status: int, folder: Path) -> Verdict:
    in_yaml = "".join(f"\\U{ord(each):08x}" for each in sign)
    (folder / f"s{sign}.yaml").write_text(SCENE.replace("SIGN", in_yaml), encoding="utf-8")
    (folder / f"{sign}.adm").write_text(f"title {sign}\nPART/{sign}\nEND\n", encoding="utf-8", newline="")
    given = [word.replace("SCENE", f"s{sign}.yaml").replace("OUT", "out").replace("SIGN", sign) for word in words]
    found, out, err = command(folder, given)
    detail = f"exit status {found}: {ascii(out + err)[:300]}"
    printed = {each for each in out + err if unicodedata.category(each) in STEERING and each not in "\n\t"}
    if printed or found != status or "Traceback" in err:
        return Verdict(Outcome.WRONG, detail=f"{', '.join(map(ascii, printed))} {detail}")
    if "--json" in words and json.loads(out.splitlines()[0])["scene"] != f"s{sign}.yaml":
        return Verdict(Outcome.WRONG, detail=f"another name: {detail}")
    return Verdict(Outcome.RIGHT, detail=detail)


CASES = tuple(
    Case(f"{' '.join(words)} with {sign!a}", "what is printed has no such character", partial(with_files, {}, partial(_judged, sign, words, status)))
    for sign, words, status in ASKED
)  # fmt: skip
