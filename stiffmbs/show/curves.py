"""Charts of a page as SVG: curves over a common abscissa, and paths of vectors in polar form.

The colours are those of the page (`report.css`): a chart has no background of its own.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from typing import Final

import numpy as np

from .escaped import escaped

CHART: Final = (460, 250)
AXES: Final = (44, 450, 34, 212)
"""Width and height of a chart of curves, and the left, right, upper and lower side of its axes, pixels."""
DIAGRAM: Final = (236, 84)
"""Width of a polar diagram, and radius of its outer circle, pixels."""
(WIDTH, HEIGHT), (LEFT, RIGHT, TOP, BOTTOM), (SIDE, RADIUS) = CHART, AXES, DIAGRAM
MOST_POINTS = 800
"""Number of intervals along a curve. The least and the greatest value in each are drawn, so that peaks are kept."""
LEAST_SPAN = 1e-9
"""Least span of an axis relative to its values: a smaller one is rounding."""
CHARACTER = 7
"""Width of a character of a label, pixels."""
MOST_STEPS = 6
"""Number of steps of an axis."""
BOLD = 0.9
"""Part of the peak above which a path is drawn bold."""


@dataclass(frozen=True, eq=False)
class Curve:
    """A curve with its name; values of shape (n,)."""

    name: str
    x: np.ndarray
    y: np.ndarray
    style: str = ""  # class of the style sheet; by default that of its place among the curves of a chart


def round_step(span: float) -> float:
    """Return the least step of 1, 2 or 5 times a power of ten that divides a span into few parts."""
    least = span / MOST_STEPS
    power = 10.0 ** np.floor(np.log10(least))
    return float(next(power * k for k in (1, 2, 5, 10) if power * k >= least * (1 - 1e-9)))


NO_MARKS = np.empty((0, 2))


def curve_chart(
    curves: Sequence[Curve],
    title: str,
    abscissa: str,
    peak: str = "",
    step_x: float | None = None,
    marks: np.ndarray = NO_MARKS,
    includes_zero: bool = True,
) -> str:
    """Return curves in one chart.

    `title`, `abscissa`: quantities with their units. `peak`: words at the peak of the first curve. `step_x`: distance of
    the numbers below the chart. `marks`: points with triangles, shape (n, 2). `includes_zero`: False for an
    axis that need not contain zero.
    """
    x = np.concatenate([*(curve.x for curve in curves), marks[:, 0]])
    known = np.concatenate([*(curve.y[np.isfinite(curve.y)] for curve in curves), marks[:, 1]])
    low, high = _range(np.append(known, 0.0) if includes_zero or not len(known) else known)
    step_y = round_step(high - low)
    low, high = step_y * np.floor(low / step_y + 1e-9), step_y * np.ceil(high / step_y - 1e-9)
    start, end = _range(x[np.isfinite(x)])
    marked_y = np.arange(round(low / step_y), round(high / step_y) + 1) * step_y
    left = max(LEFT, *(int(9 + CHARACTER * len(_number(value, step_y))) for value in marked_y))

    def place(values_x: np.ndarray, values_y: np.ndarray) -> np.ndarray:
        across = left + (RIGHT - left) * (values_x - start) / (end - start)
        return np.column_stack([across, BOTTOM - (BOTTOM - TOP) * (values_y - low) / (high - low)])

    def content() -> Iterator[str]:
        """Yield the parts of the figure."""
        yield _text(0, 13, title, "strong")
        for value in marked_y:
            ((_, y),) = place(np.array([start]), np.array([value]))
            yield f'<line x1="{left}" x2="{RIGHT}" y1="{y:.1f}" y2="{y:.1f}" class="{"axis" if abs(value) < step_y / 2 else "grid"}"/>'
            yield _text(left - 7, y + 4, _number(value, step_y), "soft", "end")
        step = step_x or round_step(end - start)
        for value in np.arange(np.ceil(start / step - 1e-9), np.floor(end / step + 1e-9) + 1) * step:
            ((across, _),) = place(np.array([value]), np.array([low]))
            yield _text(across, BOTTOM + 17, _number(value, step), "soft", "middle")
        yield _text(RIGHT, HEIGHT - 4, abscissa, "soft", "end")
        for k, curve in enumerate(curves):
            yield f'<path class="curve {curve.style or f"c{k}"}" d="{_path(place(*_thinned(curve.x, curve.y)))}"/>'
        for across, y in place(*marks.T):
            yield f'<path class="mark" d="M{across - 4:.1f},{y + 4:.1f}L{across + 4:.1f},{y + 4:.1f}L{across:.1f},{y - 4:.1f}Z"/>'
        if peak and np.isfinite(curves[0].y).any():
            yield from _marked(place, curves[0], peak)

    return _svg(WIDTH, HEIGHT, f"{title} over {abscissa}", content())


def _range(values: np.ndarray) -> tuple[float, float]:
    """Return the least and greatest value, apart by more than rounding."""
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    size = max(abs(low), abs(high))
    if high - low > LEAST_SPAN * size:
        return low, high
    return (low, low + (0.1 * size or 1.0))


def _marked(place: object, curve: Curve, words: str) -> Iterator[str]:
    """Yield a circle at the peak of a curve, with words on the side that has more room."""
    k = int(np.nanargmax(curve.y))
    ((x, y),) = place(curve.x[k : k + 1], curve.y[k : k + 1])  # type: ignore[operator]
    yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5" class="peak"/>'
    right = x < (LEFT + RIGHT) / 2
    yield _text(x + (10 if right else -10), y - 7, words, "peak", "start" if right else "end")


def polar_chart(vectors: np.ndarray, largest: float, title: str, below: str, unit: str) -> str:
    """Return the path of a vector of shape (n, 2), with circles at half and all of a largest value.

    Parts above `BOLD` of the peak are bold, and the peak is a dot with a line from the centre.
    """
    middle, floor = SIDE / 2, 44 + RADIUS + 14
    points = vectors[np.isfinite(vectors).all(axis=1)] * [RADIUS, -RADIUS] / largest + [middle, floor]
    sizes = np.hypot(*vectors[np.isfinite(vectors).all(axis=1)].T)

    def content() -> Iterator[str]:
        """Yield the parts of the figure."""
        yield _text(0, 13, title, "strong") + _text(0, 29, below, "soft")
        for part in (0.5, 1.0):
            yield f'<circle cx="{middle}" cy="{floor}" r="{part * RADIUS:.1f}" class="grid"/>'
        for k in range(0, 180, 30):
            x, y = RADIUS * np.cos(np.radians(k)), RADIUS * np.sin(np.radians(k))
            yield f'<line x1="{middle - x:.1f}" y1="{floor + y:.1f}" x2="{middle + x:.1f}" y2="{floor - y:.1f}" class="grid"/>'
        for angle, dx, dy, anchor in (
            (0, 6, 4, "start"),
            (90, 0, -5, "middle"),
            (180, -6, 4, "end"),
            (270, 0, 14, "middle"),
        ):
            x, y = RADIUS * np.cos(np.radians(angle)), RADIUS * np.sin(np.radians(angle))
            yield _text(middle + x + dx, floor - y + dy, f"{angle}\N{DEGREE SIGN}", "soft", anchor)
        yield _text(SIDE, floor + RADIUS + 14, unit, "soft", "end")
        if len(points):
            k = int(sizes.argmax())
            bold = np.where((sizes >= BOLD * sizes[k])[:, None], points, np.nan)
            yield f'<path class="curve c0" d="{_path(points)}"/><path class="bold" d="{_path(bold)}"/>'
            yield f'<line x1="{middle}" y1="{floor}" x2="{points[k, 0]:.1f}" y2="{points[k, 1]:.1f}" class="arrow"/>'
            yield f'<circle cx="{points[k, 0]:.1f}" cy="{points[k, 1]:.1f}" r="4" class="dot"/>'

    return _svg(SIDE, int(floor + RADIUS + 20), f"{title}, {below}: path of the load", content())


def spark_line(load: np.ndarray, time: np.ndarray) -> str:
    """Return a small curve without axes, from zero to its peak."""
    x, y = _thinned(time, load, 60)
    span, high = float(time[-1] - time[0]) or 1.0, float(np.nanmax(load, initial=0.0)) or 1.0
    points = np.column_stack([1 + 98 * (x - time[0]) / span, 25 - 23 * y / high])
    return _svg(100, 26, "", [f'<path class="curve c0" d="{_path(points)}"/>'])


def _thinned(x: np.ndarray, y: np.ndarray, most: int = MOST_POINTS) -> tuple[np.ndarray, np.ndarray]:
    """Return the least and the greatest value within each of many intervals, and the first and last point."""
    if len(x) <= 2 * most:
        return x, y
    rows = {0, len(x) - 1}
    for part in np.array_split(np.arange(len(x)), most):
        if np.isfinite(y[part]).any():
            rows |= {int(part[np.nanargmin(y[part])]), int(part[np.nanargmax(y[part])])}
    kept = sorted(rows)
    return x[kept], y[kept]


def _path(points: np.ndarray) -> str:
    """Return the commands of a line that is interrupted where a point is nan."""
    drawn, words = False, []
    for x, y in points:
        if np.isfinite(x) and np.isfinite(y):
            words.append(f"{'L' if drawn else 'M'}{x:.1f},{y:.1f}")
        drawn = bool(np.isfinite(x) and np.isfinite(y))
    return "".join(words)


def _number(value: float, step: float) -> str:
    """Return the number at a mark of an axis, with as many digits as distinguish it from the next one."""
    if abs(value) < step / 2:
        return "0"
    digits = max(6, int(np.ceil(np.log10(abs(value) / step))) + 1)
    return f"{value:.{digits}g}".replace("-", "\N{MINUS SIGN}")


def _text(x: float, y: float, text: str, kind: str, anchor: str = "start") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" class="{kind}" text-anchor="{anchor}">{escape(escaped(text))}</text>'


def _svg(width: int, height: int, title: str, content: Iterator[str] | list[str]) -> str:
    named = f' role="img" aria-label="{escape(escaped(title))}"' if title else ' aria-hidden="true"'
    return f'<svg viewBox="0 0 {width} {height}"{named}>{"".join(content)}</svg>'
