"""Pictures in SVG without a background, in light and dark colours as the reader's system prefers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from html import escape

COLORS: Mapping[str, tuple[str, str]] = {
    "text": ("#1f2328", "#e6edf3"), "soft": ("#59636e", "#9da7b3"), "grid": ("#e6e9ed", "#2b3138"), "own": ("#0072b2", "#5cb3ea"),
    "peak": ("#c44e00", "#f2915a"), "peer": ("#7b848e", "#848d97"), "green": ("#00805e", "#3cc79b"), "face": ("#7db8de", "#1f5f8b"),
    "tyre": ("#3b4148", "#59616b"), "rim": ("#c9ced4", "#c9ced4"), "earth": ("#eceff2", "#1b2027"),
}  # fmt: skip
"""Colours on a light and on a dark page; text has a contrast of at least 4.5 with both."""
RULES = """\
text { font: 14px system-ui, -apple-system, "Segoe UI", sans-serif; fill: var(--text) }
.soft { fill: var(--soft); font-size: 13px } .strong { font-weight: 600 }
path, line, circle.ring { fill: none; stroke-linejoin: round; stroke-linecap: round }
.grid { stroke: var(--grid) } .axis { stroke: var(--soft) }
"""


def picture(width: int, height: int, title: str, rules: str, content: Iterable[str]) -> str:
    """Return a picture of a size in pixels, with its title for readers who do not see it, and its own style rules."""
    light, dark = ("".join(f"--{name}: {pair[k]}; " for name, pair in COLORS.items()) for k in (0, 1))
    themes = f":root {{ {light}}}\n@media (prefers-color-scheme: dark) {{ :root {{ {dark}}} }}\n"
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img" aria-label="{escape(title)}">'
    return "\n".join([head, f"<style>\n{themes}{RULES}{rules}</style>", *content, "</svg>\n"])


def label(x: float, y: float, text: str, kind: str = "", anchor: str = "start") -> str:
    """Return text at a point."""
    return f'<text x="{x:.1f}" y="{y:.1f}" class="{kind}" text-anchor="{anchor}">{escape(text)}</text>'


def line(x1: float, y1: float, x2: float, y2: float, kind: str) -> str:
    """Return a straight line."""
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" class="{kind}"/>'


def path(points: Iterable[Iterable[float]], kind: str, close: bool = False) -> str:
    """Return a line through points."""
    corners = "L".join(",".join(f"{value:.5g}" for value in point) for point in points)
    return f'<path class="{kind}" d="M{corners}{"Z" * close}"/>'


def spread(places: Iterable[float], least: float) -> list[float]:
    """Return places in their order, each at least a distance from the last, as near to where they were as that allows."""
    found = sorted((place, k) for k, place in enumerate(places))
    groups: list[tuple[float, list[int]]] = []  # middle, and members at the distance from each other
    for place, k in found:
        groups.append((place, [k]))
        while len(groups) > 1 and _end(groups[-2], least, 1) + least > _end(groups[-1], least, -1):
            (a, first), (b, second) = groups[-2:]
            middle = (a * len(first) + b * len(second)) / (len(first) + len(second))
            groups[-2:] = [(middle, [*first, *second])]
    placed = {k: middle + least * (n - (len(group) - 1) / 2) for middle, group in groups for n, k in enumerate(group)}
    return [placed[k] for k in range(len(found))]


def _end(group: tuple[float, list[int]], least: float, side: int) -> float:
    return group[0] + side * least * (len(group[1]) - 1) / 2
