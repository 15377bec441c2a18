"""Scenes and datasets with something changed in their text: read, checked and run for a moment.

Nothing is known of the right answer, but of what must not come: an error that is not the package's own, a message of more
than a sentence, numbers that are none in a run that calls itself done.
"""

from __future__ import annotations

import io
import re
import warnings
from random import Random

import numpy as np

from stiffmbs.adams.load import ENCODING, read_adams
from stiffmbs.analyses.check import check
from stiffmbs.analyses.run import run
from stiffmbs.errors import StiffmbsError
from stiffmbs.model.read_scene import read_scene
from stiffmbs.model.scene import Scene
from stiffmbs.reading.files.text_file import decoded
from stiffmbs.results.solution import Solution
from stiffmbs.show.summary import as_json, check_as_json, print_summary
from stiffmbs.solve.trajectory import Outcome as Ending

from ..case import Outcome, Verdict
from ..file_bases import DATASETS, SCENES
from ..simulation import patience

WHAT = (
    "a scene or dataset with bytes, numbers, words or lines changed: refused in a sentence, or run with finite results"
)
LONGEST_MESSAGE = 1500
"""Characters of a sentence; lists of what is expected are long."""
PATIENCE = 8.0
"""Time, s, after which a run is interrupted, as its user would."""
MOMENT = 0.02
"""Duration of runs, s."""
EXTREMES = (
    "0", "-1", "1", "-0.0", "nan", ".nan", "inf", ".inf", "-.inf", "1e308", "-1e308", "1e400", "1e-320", "1e-308", "1e12", "-1e12",
    "1e100", "1e-100", "9" * 25, "9" * 400, "9**9**9", "2**0.5", "1/0", "0/0", "''", "~", "true", "[]", "{}", "x", "t", "1D0", "90D",
    "1 m", "1 kg", "3 %", "0x10", "1_000", "1e5", "1e-5", "2", "-3", "1e3", "12345678901234567890",
)  # fmt: skip
SIGNS = "\0\x0c\x1b\x85\xa0\xff\"'`$%&!#*,;:[](){}<>|\\/~^@+-=\t\r\n \u2028\ud800"
_NUMBER = re.compile(r"(?<![\w.])-?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_WORD = re.compile(r"[A-Za-z_]\w*")


def trial(seed: int) -> Verdict:
    """One file made from the seed, and what came of it."""
    random = Random(seed)
    dataset = random.random() < 0.4
    base = random.choice(DATASETS if dataset else SCENES)
    content = base.encode()
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        content = random.choices(*zip(*CHANGES, strict=True))[0](content, random)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return _tried(content, dataset)
    except StiffmbsError as error:
        return told(str(error))
    except Exception as error:  # whatever it is, no user should have seen it
        return Verdict(Outcome.WRONG, detail=f"{type(error).__name__}: {str(error)[:200]}")


def told(message: str) -> Verdict:
    """A message that is one sentence, or what is wrong with it."""
    if not message or "\n" in message or len(message) > LONGEST_MESSAGE:
        return Verdict(Outcome.WRONG, detail=f"no sentence, {len(message)} characters: {message[:200]!r}")
    return Verdict(Outcome.TOLD, detail=message)


def _tried(content: bytes, dataset: bool) -> Verdict:
    scene = _read(content, dataset)
    report = check(scene)
    check_as_json("scene", report)
    str(report)
    solution = run(scene, watch=patience(PATIENCE), duration=min(MOMENT, scene.run.duration), points=5)
    shown(solution)
    if solution.outcome is not Ending.DONE:
        return told(solution.message)
    bad = _without_numbers(solution)
    unsaid = unsaid_channels(solution)
    if unsaid:
        return Verdict(Outcome.WRONG, detail=f"done, but {bad[0]} is no number at some time; notes: {solution.notes}")
    if bad:
        return Verdict(Outcome.TOLD, detail="; ".join(solution.notes))
    return Verdict(Outcome.RIGHT, detail="; ".join(solution.notes))


def _without_numbers(solution: Solution) -> list[str]:
    return [name for name, values in solution.channels.items() if not np.all(np.isfinite(values))]


def unsaid_channels(solution: Solution) -> list[str]:
    """Channels without a number somewhere, of which the notes tell nothing."""
    told_of_all = "not finite at" in " ".join(solution.notes)
    return [] if told_of_all else _without_numbers(solution)


def _read(content: bytes, dataset: bool) -> Scene:
    text = decoded(content, "file", ENCODING if dataset else "")
    return read_adams(text, source="file") if dataset else read_scene(text, source="file")


def shown(solution: Solution) -> None:
    """Print a solution in both forms, to nobody."""
    from rich.console import Console

    as_json("scene", solution)
    print_summary("scene", solution, "nowhere", Console(file=io.StringIO()))


def _number_changed(content: bytes, random: Random) -> bytes:
    """A number replaced by an extreme one, or by something else."""
    return _replaced(content, random, _NUMBER, lambda old: random.choice(EXTREMES))


def _number_scaled(content: bytes, random: Random) -> bytes:
    """A number times a power of ten, or with the other sign."""
    factor = random.choice((-1, 10, 0.1, 1e3, 1e-3, 1e6, 1e-6, 1e9, 1e-9, 1e15, 1e-15))
    return _replaced(content, random, _NUMBER, lambda old: repr(float(old) * factor))


def _word_changed(content: bytes, random: Random) -> bytes:
    """A word replaced by another of the file, or misspelt."""
    words = _WORD.findall(_text(content)) or ["x"]
    return _replaced(content, random, _WORD, lambda old: random.choice((random.choice(words), old[:-1], old + "x")))


def _words_swapped(content: bytes, random: Random) -> bytes:
    """Two words in each other's places."""
    text = _text(content)
    found = list(_WORD.finditer(text))
    if len(found) < 2:
        return content
    a, b = sorted(random.sample(found, 2), key=lambda match: match.start())
    return _bytes(text[: a.start()] + b[0] + text[a.end() : b.start()] + a[0] + text[b.end() :])


def _replaced(content: bytes, random: Random, pattern: re.Pattern[str], by: object) -> bytes:
    text = _text(content)
    found = list(pattern.finditer(text))
    if not found:
        return content
    match = random.choice(found)
    return _bytes(text[: match.start()] + by(match[0]) + text[match.end() :])  # type: ignore[operator]


def _byte_changed(content: bytes, random: Random) -> bytes:
    at = random.randrange(len(content) + 1)
    return content[:at] + bytes([random.randrange(256)]) + content[at + 1 :]


def _sign_put_in(content: bytes, random: Random) -> bytes:
    text = _text(content)
    at = random.randrange(len(text) + 1)
    return _bytes(text[:at] + random.choice(SIGNS) + text[at:])


def _stretch_left_out(content: bytes, random: Random) -> bytes:
    at = random.randrange(len(content) + 1)
    return content[:at] + content[at + random.choice((1, 1, 2, 5, 20)) :]


def _cut_off(content: bytes, random: Random) -> bytes:
    return content[: random.randrange(len(content) + 1)]


def _line_moved(content: bytes, random: Random) -> bytes:
    """A line twice, missing, or in another's place."""
    lines = content.split(b"\n")
    line = lines[random.randrange(len(lines))]
    match random.randrange(3):
        case 0:
            lines.insert(random.randrange(len(lines)), line)
        case 1:
            lines.remove(line)
        case _:
            lines.remove(line)
            lines.insert(random.randrange(len(lines) + 1), line)
    return b"\n".join(lines)


def _nested(content: bytes, random: Random) -> bytes:
    """A number within functions, lists or mappings, up to far too many."""
    before, after = random.choice((("(", ")"), ("[", "]"), ("{a: ", "}"), ("sin(", ")"), ("-", ""), ("abs(", ")")))
    depth = random.choice((1, 2, 5, 30, 300))
    return _replaced(content, random, _NUMBER, lambda old: f"{before * depth}{old}{after * depth}")


def _encoded_anew(content: bytes, random: Random) -> bytes:
    encoding = random.choice(("utf-16", "utf-16-le", "utf-16-be", "utf-32", "utf-8-sig"))
    ends = random.choice(("\n", "\r", "\r\n"))
    return _text(content).replace("\n", ends).encode(encoding, "replace")


def _text(content: bytes) -> str:
    return content.decode(errors="surrogateescape")


def _bytes(text: str) -> bytes:
    return text.encode(errors="surrogatepass") if "\ud800" in text else text.encode(errors="surrogateescape")


CHANGES = (
    (_number_changed, 30), (_number_scaled, 12), (_word_changed, 10), (_words_swapped, 8), (_byte_changed, 10), (_sign_put_in, 8),
    (_stretch_left_out, 8), (_cut_off, 4), (_line_moved, 8), (_nested, 4), (_encoded_anew, 2),
)  # fmt: skip
"""Ways to change a file, and how often each of them is taken."""
