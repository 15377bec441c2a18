"""Text in ASCII for formats that have no other letters."""

from __future__ import annotations

import unicodedata


def in_ascii(text: str) -> str:
    """Return a text with other letters written in ASCII: without accents, by the letter's name, or by its code point.

    Examples
    --------
    >>> in_ascii("Kurbel_ä, Θ, 力")
    'Kurbel_a, Theta, u529b'
    """
    return text if text.isascii() else "".join(letter if letter.isascii() else _letter(letter) for letter in text)


def _letter(letter: str) -> str:
    plain = unicodedata.normalize("NFKD", letter.replace("ß", "ss")).encode("ascii", "ignore").decode()
    if plain:
        return plain
    before, _, name = unicodedata.name(letter, "").partition(" LETTER ")
    if name.isalpha():
        return name.capitalize() if "CAPITAL" in before else name.lower()
    return f"u{ord(letter):04x}" if letter.isalnum() else ""
