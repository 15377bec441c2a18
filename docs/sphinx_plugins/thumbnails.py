"""Make the films of the gallery's cards.

    python docs/sphinx_plugins/thumbnails.py [NAME...]

NAME is the stem of a scene's file in examples/; all of them by default.  The films are WebP, in docs/_static/gallery.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from gallery import examples
from PIL import Image, ImageOps

import stiffmbs
from stiffmbs.show.drawing.deformed import largest_stress
from stiffmbs.show.drawing.derive import drawing_of
from stiffmbs.show.drawing.film import Playback, pictures
from stiffmbs.show.drawing.picture import Shown
from stiffmbs.show.drawing.poses import poses_of
from stiffmbs.show.drawing.view import view_named

FOLDER = Path(__file__).parents[1] / "_static" / "gallery"
LENGTH, RATE = 3.0, 10.0
"""Duration of a film, s, and its pictures per second."""
WIDTH = 360
"""Width of a film, pixels."""


def film(path: Path) -> Iterator[np.ndarray]:
    """Yield the pictures of the run of a scene, without the floor."""
    data = stiffmbs.load_scene(path)
    solution = stiffmbs.run(data)
    poses = {"": poses_of(data, solution.time, solution.channels)}
    drawing = drawing_of(data)
    stress = largest_stress(drawing.parts, poses[""])
    drawing = replace(drawing, name=" ", deformations={}, stress=stress)  # no title
    duration = float(solution.time[-1] - solution.time[0])
    seen = view_named("", drawing.dimensions, drawing.gravity)
    return pictures(
        drawing, poses, seen, Playback(duration / LENGTH, RATE), Shown(names=False, forces=False, clock=False), ()
    )


def cropped(frames: Iterator[np.ndarray]) -> list[Image.Image]:
    """Return pictures without their common margin."""
    found = list(frames)
    ink = np.min([frame.min(axis=2) for frame in found], axis=0) < 250
    rows, columns = np.flatnonzero(ink.any(axis=1)), np.flatnonzero(ink.any(axis=0))
    high, wide = ink.shape
    box = (max(columns[0] - 8, 0), max(rows[0] - 8, 0), min(columns[-1] + 9, wide), min(rows[-1] + 9, high))
    return [Image.fromarray(frame).crop(box) for frame in found]


def write_webp(path: Path, frames: Iterator[np.ndarray]) -> None:
    """Write pictures as an animated WebP of 16 to 10 that repeats forever."""
    size = (WIDTH, WIDTH * 10 // 16)
    images = [ImageOps.pad(image, size, Image.Resampling.LANCZOS, color="white") for image in cropped(frames)]
    images[0].save(path, save_all=True, append_images=images[1:], duration=1000 / RATE, loop=0, quality=60, method=4)


if __name__ == "__main__":
    FOLDER.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[1:] or examples():
        write_webp(FOLDER / f"{name}.webp", film(examples()[name]))
        print(name, (FOLDER / f"{name}.webp").stat().st_size)
