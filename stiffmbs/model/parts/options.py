"""Options of a part or scene: alternative sets of sections, selected by a word.

``options: {compliance: {bushing: {forces: ..}, rigid: {joints: ..}}}`` defines the choice ``compliance`` with the words
``bushing`` and ``rigid``. The first word is the default.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from ...errors import InputError
from ...reading.did_you_mean import did_you_mean, instead_of
from ...reading.fields import mapping
from ...reading.files.quoted import written
from ...reading.files.yaml_text import Content

OPTIONS, CHOOSE = "options", "choose"


def choices_of(found: Mapping[str, object], where: str) -> dict[str, Content]:
    """Return the options of a part or scene: for each choice its words with their sections.

    Raises InputError if they are not a mapping of choices to words to sections.
    """
    options = mapping(found.get(OPTIONS) or {}, where, "choices to words")
    for name, words in options.items():
        if not isinstance(words, dict) or not words:
            raise InputError(f"{where}.{name}: found {written(words)}, expected a mapping of words to sections")
        for word, sections in words.items():
            if not isinstance(word, str) or not isinstance(sections, dict | None):
                raise InputError(
                    f"{where}.{name}: found {written({word: sections})}, expected a word with its sections"
                )
    return options


def with_chosen(found: dict[str, object], words: Any, where: str) -> Content:
    """Return a part or scene with the chosen sections merged, without its options.

    `words`: word by choice; unknown choices are ignored. `where`: path of its options. Raises InputError if a word is
    unknown, or a chosen section defines a name that also exists elsewhere.
    """
    choices = choices_of(found, where)
    merged = {key: value for key, value in found.items() if key != OPTIONS}
    for choice, branches in choices.items():
        word = words.get(choice, next(iter(branches)))
        if word not in branches:
            raise InputError(f"{where}.{choice}: found {written(word)}{instead_of(word, branches)}")
        for section, entries in (branches[word] or {}).items():
            merged[section] = _together(merged.get(section), entries, f"{where}.{choice}.{word}.{section}")
    return merged


def words_chosen(found: object, where: str = CHOOSE) -> dict[str, object]:
    """Return the choices of a scene. Raises InputError if they are not a mapping of choices to words."""
    if found is None:
        return {}
    if not isinstance(found, dict) or not all(isinstance(word, str) for word in found.values()):
        raise InputError(f"{where}: found {written(found)}, expected a mapping of choices to words")
    return dict(found)


def refuse_unknown_choices(words: Mapping[str, object], known: Collection[str]) -> None:
    """Refuse choices that neither the scene nor any of its parts has; a misspelt choice would have no effect.

    Raises InputError: The message lists the known choices.
    """
    for choice in words:
        if choice not in known:
            raise InputError(
                f"{CHOOSE}.{choice}: found no such choice{did_you_mean(choice, known)}, expected one of "
                f"{', '.join(sorted(known)) or 'none'}"
            )


def _together(before: object, entries: object, where: str) -> Any:
    if before is None:
        return entries
    if not isinstance(before, dict) or not isinstance(entries, dict):
        raise InputError(f"{where}: found a section that stands outside of the options too, expected it once")
    for name in entries:
        if name in before:
            raise InputError(f"{where}.{name}: found a name that stands outside of the options too, expected it once")
    return {**before, **entries}
