"""Decisions on input: sizes of files, texts and formulas, quotations, similar names."""

from __future__ import annotations

from pathlib import Path
from unittest.mock import patch

from stiffmbs.errors import InputError
from stiffmbs.reading import did_you_mean, variation
from stiffmbs.reading.files import files_read, include, quoted, read_before, yaml_text
from stiffmbs.reading.formula import dimension, size
from stiffmbs.reading.units import quantity
from tests.decisions.common import Reached, Record, executed, nothing, reach, reached, refused
from tests.solve.test_parameter_thresholds import DOUBLES, count_while

WHOLE = [round(100 * x) for x in DOUBLES[:80]]
"""Increasing whole numbers."""


def least_similarity():
    with patch("difflib.get_close_matches", lambda *args: reach(args[-1])):
        return reached(lambda: did_you_mean.did_you_mean("a", ["b"]))


def largest_file():
    with patch.object(files_read, "_check", lambda _status, _path, largest: reach(largest)):
        return reached(lambda: files_read.content_of(__file__))


def most_included_files():
    def accepts(count):
        own = Record(sources=Record(texts=range(count)), folder=Path())
        with patch.object(include, "_check_file", lambda *_: reach(None)):
            try:
                include._Including._content(own, Path("file"), "", (), ())
            except InputError:
                return False
            except Reached:
                return True

    return count_while(accepts, range(1, 500))


def largest_included_file():
    def accepts(size_of_file):
        file = Record(is_file=lambda: True, stat=lambda: Record(st_size=size_of_file))
        return not refused(lambda: include._check_file(file, ""))

    return count_while(lambda length: accepts(1e4 * length), DOUBLES)


def largest_cached_file():
    """Return the size of an entry of a file, in 1e5 bytes, up to which it is cached."""

    def is_cached(size):
        written = []
        replaced = {
            "json": Record(dumps=lambda _: range(round(1e5 * size))), "read_yaml": nothing,
            "entries": Record(name_of=nothing, digest=str, read=lambda _: None, write=lambda *_: written.append(1)),
        }  # fmt: skip
        with patch.multiple(read_before, **replaced):
            read_before.read_yaml_file("a", "", Record(resolve=str))
        return bool(written)

    return count_while(is_cached, DOUBLES)


def deepest_content():
    def accepts(depth):
        found = 1
        for _ in range(depth):
            found = [found]
        return not refused(lambda: yaml_text.check_content(found, "scene"))

    return count_while(accepts, range(200))


def most_aliases():
    def accepts(values):
        walk = Record(extent=lambda *_: Record(values=round(values)), written=0)
        with patch.object(yaml_text, "_Walk", lambda: walk):
            return not refused(lambda: yaml_text.check_content(None, "scene"))

    return count_while(lambda values: accepts(1e4 * values), DOUBLES)


def widest_line():
    return max(map(len, yaml_text.scene_text({"a": [*range(400)]}).splitlines()))


def accepts_levels(*levels):
    with patch.object(size, "_levels", lambda _: levels):
        return not refused(lambda: size.check_size(None, str))


DECISIONS = {
    "reading.variation:EVENLY": lambda: variation.numbers_of(
        Record(values=(), range=Record(low=1.0, high=2.0, log=False, spread=int)), 4
    ),
    "reading.did_you_mean:LEAST": least_similarity,
    "reading.files.files_read:LARGEST": largest_file,
    "reading.files.include:MOST_FILES": most_included_files,
    "reading.files.include:LARGEST": largest_included_file,
    "reading.files.quoted:MOST_QUOTED": lambda: len(quoted._shortened(1000 * "a")),
    "reading.files.quoted:MOST_LISTED": lambda: quoted.listed(100 * ["x"]).count("x"),
    "reading.files.read_before:LARGEST": largest_cached_file,
    "reading.files.yaml_text:MOST_NESTED": deepest_content,
    "reading.files.yaml_text:MOST_BY_ALIASES": most_aliases,
    "reading.files.yaml_text:WIDTH": widest_line,
    "reading.formula.dimension:SAME_EXPONENT": lambda: count_while(
        lambda apart: dimension.same((0.0,), (1e-11 * apart,)), DOUBLES
    ),
    "reading.formula.size:MOST_PARTS": lambda: count_while(lambda count: accepts_levels(range(count)), WHOLE),
    "reading.formula.size:DEEPEST": lambda: count_while(lambda depth: accepts_levels(*(depth + 1) * [()]), range(500)),
    "reading.units.quantity:TEXTS": lambda: executed("reading.units.quantity")._parsed.cache_info().maxsize,
    "reading.units.quantity:LARGEST": lambda: count_while(
        lambda value: not refused(lambda: quantity._of_ordinary_size(1e95 * value, "length")), DOUBLES
    ),
    "reading.variation:MOST_VALUES": lambda: count_while(
        lambda count: not refused(lambda: variation.Range(0.0, 1.0, count=round(1e4 * count))), DOUBLES
    ),
}  # fmt: skip
EXPECTED = {
    "reading.variation:EVENLY": 5,
    "reading.did_you_mean:LEAST": 0.65, "reading.files.files_read:LARGEST": 500000000, "reading.files.include:MOST_FILES": 100,
    "reading.files.include:LARGEST": 44, "reading.files.quoted:MOST_QUOTED": 80, "reading.files.quoted:MOST_LISTED": 5,
    "reading.files.read_before:LARGEST": 36, "reading.files.yaml_text:MOST_NESTED": 41,
    "reading.files.yaml_text:MOST_BY_ALIASES": 27, "reading.files.yaml_text:WIDTH": 141, "reading.formula.dimension:SAME_EXPONENT": 27,
    "reading.formula.size:MOST_PARTS": 18, "reading.formula.size:DEEPEST": 61, "reading.units.quantity:TEXTS": 4096,
    "reading.units.quantity:LARGEST": 67, "reading.variation:MOST_VALUES": 40,
}  # fmt: skip
