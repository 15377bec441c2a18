"""Decisions of the cache."""

from __future__ import annotations

from unittest.mock import patch

from stiffmbs.cache import contents
from tests.decisions.common import Record, nothing
from tests.solve.test_parameter_thresholds import DOUBLES, count_while

DAY = 86400.0


class Root:
    """Directory whose entries were last looked through some time ago."""

    def __init__(self, ago):
        self._ago = ago

    def __truediv__(self, name):
        return Record(stat=lambda: Record(st_mtime=-self._ago), touch=lambda mode: None)


def is_removed(size=1, age=0.0, ago=1e9):
    """Return whether an entry of a size, bytes, and an age, s, is removed."""
    removed = []
    files = [contents._File(-age, size, "kernel-0")]
    replaced = {
        "_folders": lambda _: [(Record(name="entries"), None)],
        "_files": lambda *_: files,
        "_remove_empty": nothing,
    }
    with (
        patch.multiple(contents, time=Record(time=lambda: 0.0), **replaced),
        patch.object(contents.os, "unlink", removed.append),
    ):
        contents.tend(Root(ago))
    return bool(removed)


def is_marked(age):
    marked = []
    with patch.object(contents, "time", Record(time=lambda: 0.0)), patch.object(contents.os, "utime", marked.append):
        contents.mark_used(Record(stat=lambda: Record(st_mtime=-age)))
    return bool(marked)


DECISIONS = {
    "cache.contents:MOST_BYTES": lambda: count_while(lambda size: not is_removed(size=1e7 * size), DOUBLES),
    "cache.contents:MOST_AGE": lambda: count_while(lambda days: not is_removed(age=DAY * days), DOUBLES),
    "cache.contents:STALE": lambda: count_while(lambda hours: not is_marked(3600.0 * hours), DOUBLES),
    "cache.contents:INTERVAL": lambda: count_while(lambda t: not is_removed(age=1e9, ago=t), DOUBLES),
}
EXPECTED = {
    "cache.contents:MOST_BYTES": 31, "cache.contents:MOST_AGE": 26, "cache.contents:STALE": 19, "cache.contents:INTERVAL": 24,
}  # fmt: skip
