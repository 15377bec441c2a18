"""Fast reading of long YAML texts by libyaml, if its result is certain to agree with YAML 1.2.

libyaml provides the structure; ruamel.yaml resolves the scalars by YAML 1.2.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterator
from functools import cache
from typing import Any

import yaml
from ruamel.yaml import YAML, ScalarNode
from yaml import (
    AliasEvent,
    DocumentEndEvent,
    DocumentStartEvent,
    MappingEndEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
    StreamEndEvent,
    StreamStartEvent,
)

from .yaml_content import MOST_NESTED

COMPARED = (0, 2, 5)
"""Version of libyaml whose results were compared with those of ruamel.yaml."""
_READ_OTHERWISE = re.compile(
    r"[^\n -\[\]-~\xa0-\ud7ff]|^(?:%|---|\.\.\.)|&(?![\w-]+[ \n])|(?<!\w):(?![ \n])|(?<![^ \n,\[{])\?", re.MULTILINE
)
"""Text that libyaml may read differently: tabs, backslashes, rare characters, directives, document marks, anchors with
punctuation, colons within words, and ``?`` within words."""
_BLOCKS = frozenset("|>")
_PLAIN_BLOCK = re.compile(r"[|>][-+]?\n *[^ \n#]")
"""Beginnings of block scalars that both libraries read alike."""
MERGE = "<<"
_BEHIND_ALIAS = frozenset(" \n,]}")
"""Characters that end the name of an alias in every reader."""


class NotSureError(Exception):
    """Text that libyaml may read differently from YAML 1.2, or with an error."""


def read_by_libyaml(text: str) -> Any:
    """Read a YAML text, with the result of `stiffmbs.describe.files.yaml_text.read_yaml`.

    Parameters
    ----------
    text : str

    Raises
    ------
    NotSureError
        If the text must be read in Python, which also reports faults, or if this version of libyaml is not installed.
    """
    text = text.replace("\r\n", "\n")  # equivalent in YAML
    if not yaml.__with_libyaml__ or yaml._yaml.get_version() != COMPARED or _READ_OTHERWISE.search(text):
        raise NotSureError
    try:
        return _Content(yaml.parse(text, Loader=yaml.CSafeLoader), text).whole()
    except yaml.YAMLError as error:
        raise NotSureError from error


class _Content:
    """Content of a stream of YAML events."""

    def __init__(self, events: Iterator[Any], text: str) -> None:
        self._events, self._text = events, text
        self._plain = _reader_of_plain()
        self._anchored: dict[str, Any] = {}

    def whole(self) -> Any:
        """Return the content of the single document."""
        self._expect(StreamStartEvent)
        self._expect(DocumentStartEvent)
        found = self._value(next(self._events), 0)
        self._expect(DocumentEndEvent)
        self._expect(StreamEndEvent)
        return found

    def _expect(self, kind: type) -> None:
        if not isinstance(next(self._events), kind):
            raise NotSureError

    def _value(self, event: Any, level: int) -> Any:
        if isinstance(event, AliasEvent):
            return self._of_alias(event)
        if event.tag is not None or level > MOST_NESTED:
            raise NotSureError
        if isinstance(event, ScalarEvent):
            found = self._of_scalar(event)
        elif isinstance(event, SequenceStartEvent):
            found = [self._value(part, level + 1) for part in self._until(SequenceEndEvent)]
        else:
            found = self._mapping(level)
        if event.anchor in self._anchored:
            raise NotSureError
        if event.anchor is not None:
            self._anchored[event.anchor] = found
        return found

    def _of_alias(self, event: Any) -> Any:
        behind = self._text[event.end_mark.index : event.end_mark.index + 1]
        if event.anchor not in self._anchored or (behind and behind not in _BEHIND_ALIAS):
            raise NotSureError
        return self._anchored[event.anchor]

    def _of_scalar(self, event: Any) -> Any:
        if event.style in _BLOCKS and not _PLAIN_BLOCK.match(self._text, event.start_mark.index):
            raise NotSureError
        return self._plain(event.value) if event.implicit[0] else event.value

    def _until(self, end: type) -> Iterator[Any]:
        for event in self._events:
            if isinstance(event, end):
                return
            yield event

    def _mapping(self, level: int) -> dict[Any, Any]:
        found: dict[Any, Any] = {}
        merged: Any = None
        for event in self._until(MappingEndEvent):
            if merged is None and isinstance(event, ScalarEvent) and event.implicit[0] and event.value == MERGE:
                merged = self._value(next(self._events), level + 1)
                if event.anchor is not None or not isinstance(merged, dict):
                    raise NotSureError
                continue
            name = self._value(event, level + 1)
            if not isinstance(name, Hashable) or name in found:
                raise NotSureError
            found[name] = self._value(next(self._events), level + 1)
        return {**(merged or {}), **found}


def _reader_of_plain() -> Callable[[str], Any]:
    """Return a function for the values of unquoted scalars."""
    ruamel = YAML(typ="safe", pure=True)
    text_itself = ruamel.resolver.resolve(ScalarNode, "", (False, True))

    @cache
    def value(text: str) -> Any:
        tag = ruamel.resolver.resolve(ScalarNode, text, (True, False))
        if tag == text_itself:
            return text
        try:
            return ruamel.constructor.construct_document(ScalarNode(tag, text))
        except Exception as error:  # invalid dates and integers raise various Python errors
            raise NotSureError from error

    return value
