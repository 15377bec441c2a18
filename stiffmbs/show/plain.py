"""Text and tables in files and pipes, as rich writes them there; rich takes longer to load than a summary to print."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TextIO

from .escaped import escaped


class PlainConsole:
    """Console that prints lines of any length without colours; other options of `rich.console.Console.print` have no effect."""

    def __init__(self, file: TextIO, width: int) -> None:
        self.file, self.width = file, width

    def print(self, text: str, **_: object) -> None:
        """Print a text, escaped."""
        self.file.write(escaped(text) + "\n")


def boxed(rows: Sequence[Sequence[str]]) -> str:
    """Return a table in a box: the first row holds the heads, the first column is left-justified, the others right."""
    cells = [[text.split("\n") for text in row] for row in rows]
    widths = [max(len(line) for cell in column for line in cell) for column in zip(*cells, strict=True)]

    def border(left: str, fill: str, between: str, right: str) -> str:
        return left + between.join(fill * (width + 2) for width in widths) + right

    def lines(row: Sequence[Sequence[str]], bar: str) -> Iterator[str]:
        """Yield the lines of a row of cells."""
        for k in range(max(map(len, row))):
            first, *others = (
                cell[k].ljust(width) if k < len(cell) else " " * width for cell, width in zip(row, widths, strict=True)
            )
            justified = (text.rstrip().rjust(len(text)) for text in others)
            yield bar + bar.join(f" {text} " for text in (first, *justified)) + bar

    body = [line for row in cells[1:] for line in lines(row, "│")]
    return "\n".join(
        [
            border("┏", "━", "┳", "┓"),
            *lines(cells[0], "┃"),
            border("┡", "━", "╇", "┩"),
            *body,
            border("└", "─", "┴", "┘"),
        ]
    )
