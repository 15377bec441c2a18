"""Options: sections of a part, or of a scene, of which a word chooses one set.

``options: {compliance: {bushing: {forces: ..}, rigid: {joints: ..}}}`` has the choice ``compliance``, whose words are
``bushing`` and ``rigid``.  The first word is chosen unless another is named.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from ...errors import InputError
from ..files.quoted import written

OPTIONS, CHOOSE = "options", "choose"


def choices_of(found: Mapping[str, Any], where: str) -> dict[str, dict[str, Any]]:
    """The options of a part or scene: for each choice its words, and the sections that each stands for.

    Raises
    ------
    InputError
        When they are no mapping of choices to words to sections.
    """
    options = found.get(OPTIONS) or {}
    if not isinstance(options, dict):
        raise InputError(f"{where}: found {written(options)}, expected a mapping of choices to words")
    for name, words in options.items():
        if not isinstance(words, dict) or not words:
            raise InputError(f"{where}.{name}: found {written(words)}, expected a mapping of words to sections")
        for word, sections in words.items():
            if not isinstance(word, str) or not isinstance(sections, dict | None):
                raise InputError(
                    f"{where}.{name}: found {written({word: sections})}, expected a word with its sections"
                )
    return options


def with_chosen(found: dict[str, Any], words: Any, where: str) -> dict[str, Any]:
    """A part or scene with the sections that words choose, and without its options.

    Parameters
    ----------
    found : mapping
    words : mapping of str to str
        By choice; those of choices that it does not have are for others.
    where : str
        The path of its options.

    Raises
    ------
    InputError
        When a word is unknown, or a name stands in what it chooses and elsewhere too.
    """
    choices = choices_of(found, where)
    merged = {key: value for key, value in found.items() if key != OPTIONS}
    for choice, branches in choices.items():
        word = words.get(choice, next(iter(branches)))
        if word not in branches:
            raise InputError(f"{where}.{choice}: found {written(word)}, expected one of {', '.join(branches)}")
        for section, entries in (branches[word] or {}).items():
            merged[section] = _together(merged.get(section), entries, f"{where}.{choice}.{word}.{section}")
    return merged


def words_chosen(found: Any, where: str = CHOOSE) -> dict[str, Any]:
    """What a scene chooses.

    Raises
    ------
    InputError
        When it is no mapping of choices to words.
    """
    if found is None:
        return {}
    if not isinstance(found, dict) or not all(isinstance(word, str) for word in found.values()):
        raise InputError(f"{where}: found {written(found)}, expected a mapping of choices to words")
    return dict(found)


def refuse_unknown_choices(words: Mapping[str, Any], known: Collection[str]) -> None:
    """Refuse a choice that neither the scene nor any of its parts has: misspelt, it would change nothing.

    Raises
    ------
    InputError
        Names the choice and those that there are.
    """
    for choice in words:
        if choice not in known:
            raise InputError(
                f"{CHOOSE}.{choice}: found no such choice, expected one of {', '.join(sorted(known)) or 'none'}"
            )


def _together(before: Any, entries: Any, where: str) -> Any:
    if before is None:
        return entries
    if not isinstance(before, dict) or not isinstance(entries, dict):
        raise InputError(f"{where}: found a section that stands outside of the options too, expected it once")
    for name in entries:
        if name in before:
            raise InputError(f"{where}.{name}: found a name that stands outside of the options too, expected it once")
    return {**before, **entries}
