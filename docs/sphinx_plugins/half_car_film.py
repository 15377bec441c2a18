"""Draw the half car over its bump, and the force of its front bushing, as a moving picture of the README.

    python docs/sphinx_plugins/half_car_film.py

It solves and verifies ``examples/half_car.yaml`` and draws ``docs/_static/half_car.svg``, to scale.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from themed_svg import label, line, path, picture

import stiffmbs
from stiffmbs.model.scene import Scene
from stiffmbs.reading.marker import MarkerReference
from stiffmbs.results.solution import Solution, channel_ranges
from stiffmbs.show.drawing.poses import Poses, placed, poses_of
from stiffmbs.show.drawing.scene_graph import Anchor
from stiffmbs.show.force_table import with_bar

DOCS = Path(__file__).parents[1]
SCENE, TARGET = DOCS.parent / "examples" / "half_car.yaml", DOCS / "_static" / "half_car.svg"
CHANNEL = "front_bushing.fy"
BEFORE, AFTER, STEP = 0.2, 1.0, 0.01
"""Times that are shown before the bump, where the car is at rest, and after its begin; instants of the film, s."""
SLOWER = 5.0
"""Factor of the duration of the film."""
WIDTH, HEIGHT, METRE, LEVEL = 640, 318, 72.0, 138.0
"""Size of the picture, a metre, and the road's place, pixels."""
LEFT, RIGHT, TOP, BOTTOM, LARGEST = 34, 616, 206, 286, 6.0
"""Sides of the plot, pixels, and its largest force, kN."""
RULES = """\
.face { fill: var(--face); stroke: var(--own); stroke-width: 2 } .tyre { fill: var(--tyre) } .rim { fill: var(--rim) }
.arm { stroke: var(--peak); stroke-width: 6 } .ring { stroke: var(--peak); stroke-width: 3 } .spring { stroke: var(--green); stroke-width: 2 }
path.earth { fill: var(--earth) } .curve { stroke: var(--own); stroke-width: 2 }
.spring path { vector-effect: non-scaling-stroke } .dot { fill: var(--text) } text.peak { fill: var(--peak); font-weight: 600 }
"""


def film(scene: Scene, solution: Solution) -> str:
    """Return the picture as SVG."""
    time = np.arange(0.0, BEFORE + AFTER + STEP / 2, STEP) - BEFORE
    poses = poses_of(scene, solution.time, solution.channels).resampled(np.maximum(time, 0.0))
    moving = [*_moving(scene, poses, time), ('<circle r="5" class="dot"/>', _along_curve(solution, time))]
    names = {f"m{k}": steps for k, (_, steps) in enumerate(moving)}
    peak = (channel_ranges(solution)[CHANNEL]["t_max"] + BEFORE) * SLOWER
    rules = "".join(_animation(name, steps, peak) for name, steps in names.items())
    content = [
        *_axes(solution),
        *(f'<g class="{name}">{shape}</g>' for name, (shape, _) in zip(names, moving, strict=True)),
    ]
    title = "A half car on stiff bushings runs over a bump; below, the force of its front bushing over time"
    return picture(WIDTH, HEIGHT, title, RULES + rules, content)


def _moving(scene: Scene, poses: Poses, time: np.ndarray) -> list[tuple[str, list[str]]]:
    """Return shapes in pixels, each with its transform at the instants of the film, those behind first."""
    distance = scene.parameters["V"] * time * METRE
    front = poses.path(_anchor(scene, scene.forces["front_tyre"].i))[0][0]
    return [
        (_road(front), [f"translate({-value:.1f}px,0px)" for value in distance]),
        *((_body(scene, name), _transforms(poses, name)) for name in ("chassis", "front", "rear")),
        *((_spring(), _stretched(scene, poses, end)) for end in ("front", "rear")),
        *((_bushing(scene, end), _transforms(poses, "chassis")) for end in ("front", "rear")),
    ]


def _anchor(scene: Scene, marker: MarkerReference) -> Anchor:
    return Anchor(marker.body, placed(scene, marker)[0])


def _screen(points: np.ndarray) -> np.ndarray:
    """Return points of the ground, m, in pixels."""
    return np.asarray(points)[..., :2] * [METRE, -METRE] + [WIDTH / 2, LEVEL]


def _transforms(poses: Poses, body: str) -> list[str]:
    turns = -np.degrees(2 * np.arctan2(poses.orientations[body][:, 3], poses.orientations[body][:, 0]))
    return [
        f"translate({x:.2f}px,{y:.2f}px) rotate({turn:.3f}deg)"
        for (x, y), turn in zip(_screen(poses.points[body]), turns, strict=True)
    ]


def _stretched(scene: Scene, poses: Poses, end: str) -> list[str]:
    """Return the transforms of a spring of unit length between the seats of an arm and of the chassis."""
    spring = scene.forces[f"{end}_spring"]
    below, above = (_screen(poses.path(_anchor(scene, marker))) for marker in (spring.i, spring.j))
    along = above - below
    turns = np.degrees(np.arctan2(along[:, 0], -along[:, 1]))
    return [
        f"translate({x:.2f}px,{y:.2f}px) rotate({turn:.3f}deg) scale(1,{length:.3f})"
        for (x, y), turn, length in zip(below, turns, np.hypot(*along.T), strict=True)
    ]


def _body(scene: Scene, name: str) -> str:
    """Return the shapes of a body around its centre of mass."""
    found = []
    for shape in scene.bodies[name].geometry:
        if shape.type == "cylinder":
            (x, y), radius = np.multiply(shape.point, [METRE, -METRE]), shape.radius * METRE
            circles = ((radius / 2, "rim"), (radius, "tyre"))
            found += [f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{r:.2f}" class="{kind}"/>' for r, kind in circles]
        else:
            corners = np.multiply(shape.points, [METRE, -METRE])
            found.append(path(corners, "face" if shape.closed else "arm", shape.closed))
    return "".join(reversed(found))


def _bushing(scene: Scene, end: str) -> str:
    x, y = _anchor(scene, scene.forces[f"{end}_bushing"].j).point[:2] * [METRE, -METRE]
    return f'<circle cx="{x:.2f}" cy="{y:.2f}" r="6" class="ring"/>'


def _spring() -> str:
    turns = [(0.0, 0.0), (0.0, 0.12), *((7.0 * (-1) ** k, 0.16 + 0.085 * k) for k in range(9)), (0.0, 0.88), (0.0, 1.0)]
    return f'<g class="spring">{path([(x, -y) for x, y in turns], "")}</g>'


def _road(begin: float) -> str:
    """Return the road with the bump of the scene, from its place at time zero, m."""
    s = np.linspace(0.0, 2.0, 41)
    bump = np.column_stack([begin + s, 0.05 * (1 - np.cos(np.pi * s))])
    far = 40.0
    surface = _screen(np.vstack([[[-far, 0.0]], bump, [[far, 0.0]]]))
    edge = [(surface[-1][0], LEVEL + 16), (surface[0][0], LEVEL + 16)]
    return path([*surface, *edge], "earth", True) + path(surface, "axis")


def _place(t: float, force: float) -> tuple[float, float]:
    """Return the place of a force, kN, on the curve."""
    return LEFT + (RIGHT - LEFT) * (t + BEFORE) / (BEFORE + AFTER), BOTTOM - (BOTTOM - TOP) * force / LARGEST


def _along_curve(solution: Solution, time: np.ndarray) -> list[str]:
    forces = np.interp(time, solution.time, solution[CHANNEL] / 1e3)
    return [f"translate({x:.1f}px,{y:.1f}px)" for x, y in map(_place, time, forces)]


def _axes(solution: Solution) -> Iterator[str]:
    """Yield the curve of the force with its axes and its peak."""
    force = solution[CHANNEL] / 1e3
    yield label(0, 184, "vertical force of the front bushing, kN", "strong")
    yield label(RIGHT, 184, "time, s; five times slower than real", "soft", "end")
    for value in np.arange(0.0, LARGEST + 1, 2.0):
        y = _place(0.0, value)[1]
        yield line(LEFT, y, RIGHT, y, "axis" if value == 0 else "grid")
        yield label(LEFT - 8, y + 5, f"{value:g}", "soft", "end")
    for t in np.arange(-BEFORE, AFTER + STEP, 0.2):
        yield label(_place(t, 0.0)[0], BOTTOM + 20, f"{t:.1f}".replace("-", "\N{MINUS SIGN}"), "soft", "middle")
    shown = solution.time <= AFTER
    yield path([_place(-BEFORE, force[0]), *map(_place, solution.time[shown], force[shown])], "curve")
    found, bar = channel_ranges(solution)[CHANNEL], solution.errors[CHANNEL].greatest
    x, y = _place(found["t_max"], found["max"] / 1e3)
    yield f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5" class="ring"/>'
    yield label(x + 14, y + 6, f"peak {with_bar(found['max'] / 1e3, bar / 1e3)} kN", "peak")


def _animation(name: str, steps: list[str], paused: float) -> str:
    """Return the keyframes of a shape; without motion, for readers who prefer that, it stays at a time in s."""
    frames = "".join(
        f"{100 * k / (len(steps) - 1):.2f}%{{transform:{step}}}"
        for k, step in enumerate(steps)
        if not 0 < k < len(steps) - 1 or not steps[k - 1] == step == steps[k + 1]
    )
    still = f"@media (prefers-reduced-motion: reduce) {{ .{name} {{ animation-play-state: paused; animation-delay: {-paused:.2f}s }} }}\n"
    duration = (BEFORE + AFTER) * SLOWER
    return f"@keyframes {name} {{{frames}}}\n.{name} {{ animation: {name} {duration:g}s linear infinite }}\n{still}"


if __name__ == "__main__":
    loaded = stiffmbs.load_scene(SCENE)
    TARGET.write_text(film(loaded, stiffmbs.verify(loaded)), encoding="utf-8")
    print(TARGET, TARGET.stat().st_size)
