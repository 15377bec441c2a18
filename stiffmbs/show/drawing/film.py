"""Films of a mechanism in motion: sequences of pictures, as .gif (needs Pillow) or .mp4 (needs ffmpeg)."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...errors import InputError, not_installed
from ..style import COLORS
from .painted import extent, painted
from .picture import Shown, empty_sheet, explain, paint, prepare, widened, write_names
from .poses import Poses, followed_body, path_of, seen_from
from .scene_graph import Anchor, Drawing
from .view import View

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

MOST_FRAMES = 3_000
SHORTEST_FILM = 4.0
"""Length of a film, s, below which it shows a short run in slow motion unless a speed is given."""
FAINT = 0.4
"""Opacity of the bodies of other runs."""


@dataclass(frozen=True)
class Playback:
    """Time scale and picture rate of a film.

    `speed`: seconds of the model per second of the film; by default 1, or less for a film of at least `SHORTEST_FILM`.
    `rate`: pictures per second of the film.
    """

    speed: float | None = None
    rate: float = 25.0

    def instants(self, start: float, end: float) -> np.ndarray:
        """Return the instants of all pictures, s. Raises InputError if there are more than `MOST_FRAMES` pictures."""
        speed = self.speed or min(1.0, (end - start) / SHORTEST_FILM) or 1.0
        count = int((end - start) / speed * self.rate) + 1
        if count > MOST_FRAMES:
            raise InputError(
                f"animate: found {count} pictures, expected at most {MOST_FRAMES}: a higher --speed, or fewer pictures by --rate"
            )
        return start + np.arange(max(count, 2)) * speed / self.rate


def need_encoder(path: Path) -> None:
    """Check that a film can be encoded, before anything is solved."""
    if path.suffix == ".gif" and find_spec("PIL") is None:
        raise InputError(f"-o {path}: " + not_installed("Pillow", "'stiffmbs[plot]'"))
    if path.suffix == ".mp4" and _ffmpeg() is None:
        raise InputError(
            f"-o {path}: found no ffmpeg, expected it on the path, or imageio-ffmpeg: pip install 'stiffmbs[film]'"
        )


def _ffmpeg() -> str | None:
    found = shutil.which("ffmpeg")
    if found is None and find_spec("imageio_ffmpeg") is not None:
        import imageio_ffmpeg

        return str(imageio_ffmpeg.get_ffmpeg_exe())
    return found


def pictures(
    drawing: Drawing, runs: Mapping[str, Poses], view: View, playback: Playback, shown: Shown, traces: Sequence[Anchor]
) -> Iterator[np.ndarray]:
    """Yield the pictures of a film, shape (height, width, 3), bytes.

    `runs`: runs drawn over each other, by their names in the legend; the first one in full colors. `traces`: points
    whose paths are drawn.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    known = {name: poses.resampled(poses.time) for name, poses in runs.items()}
    first = next(iter(known.values()))
    instants = playback.instants(first.time[0], max(poses.time[-1] for poses in known.values()))
    largest = shown.longest(drawing, first)
    body = followed_body(drawing, first)
    corners = [
        extent(drawing, seen_from(body, drawing, poses) if body else poses, view, largest if poses is first else 0.0)
        for poses in known.values()
    ]
    low, high = np.min([c[0] for c in corners], axis=0), np.max([c[1] for c in corners], axis=0)
    margin = 0.05 * float(np.linalg.norm(high - low))
    low, high = widened(low - margin, high + margin)
    sheet, axes = empty_sheet(low, high)
    canvas = FigureCanvasAgg(sheet)
    axes.set_title(drawing.name or "mechanism", fontsize=11, parse_math=False)
    clock = axes.text(0.01, 0.01, "", transform=axes.transAxes, fontsize=9, family="monospace")
    sheet.set_dpi(90)
    _name_runs(axes, drawing, list(known), largest)
    for number, (poses, anchor) in enumerate((poses, anchor) for anchor in traces for poses in known.values()):
        path = view.seen(poses.path(anchor))
        axes.plot(path[:, 0], path[:, 1], color=COLORS[number % len(COLORS)], linewidth=1.0, alpha=0.8, zorder=1)
    samples = [poses.resampled(instants) for poses in known.values()]
    for k in range(len(instants)):
        artists = _frame(axes, drawing, samples, k, view, largest)
        if shown.names:
            artists += write_names(axes, drawing, samples[0], k, view)
        clock.set_text(f"t = {instants[k]:.3f} s" if shown.clock else "")
        if body:
            along = view.seen(path_of(body, samples[0])[k][None])[0]
            prepare(axes, low + along[:2], high + along[:2])
        canvas.draw()
        yield np.asarray(canvas.buffer_rgba())[:, :, :3].copy()
        for artist in artists:
            artist.remove()


def _frame(axes: Axes, drawing: Drawing, samples: Sequence[Poses], k: int, view: View, largest: float) -> list[Artist]:
    """Draw one instant: the other runs faint and in one color each, the first run over them."""
    artists = []
    for number in range(len(samples) - 1, 0, -1):
        color, patches = COLORS[number % len(COLORS)], painted(drawing, samples[number], k, view)
        in_color = [replace(p, face=color if p.face else "", edge="#333333" if p.face else color) for p in patches]
        artists += paint(axes, in_color, FAINT)
    over = paint(axes, painted(drawing, samples[0], k, view, largest))
    for artist in over:
        artist.set_zorder(artist.get_zorder() + 2)
    return artists + over


def _name_runs(axes: Axes, drawing: Drawing, names: Sequence[str], largest: float) -> None:
    explain(axes, drawing, largest)
    if len(names) > 1:
        from matplotlib.patches import Patch as Key

        colors = ["#56b4e9", *(COLORS[k % len(COLORS)] for k in range(1, len(names)))]
        keys = [
            Key(facecolor=color, alpha=FAINT if k else 1.0, label=name)
            for k, (color, name) in enumerate(zip(colors, names, strict=True))
        ]
        axes.figure.legend(handles=keys, loc="outside upper center", ncols=4, frameon=False, fontsize=8)


def write_gif(path: Path, frames: Iterator[np.ndarray], rate: float) -> None:
    """Write pictures as a film that repeats forever, with one palette for all pictures."""
    from PIL import Image

    images = [Image.fromarray(frame) for frame in frames]
    few = [
        images[k].resize((images[k].width // 2, images[k].height // 2))
        for k in np.linspace(0, len(images) - 1, 4).astype(int)
    ]
    mosaic = Image.new("RGB", (few[0].width * len(few), few[0].height))
    for k, image in enumerate(few):
        mosaic.paste(image, (k * few[0].width, 0))
    palette = mosaic.quantize(255, method=Image.Quantize.MAXCOVERAGE)
    reduced = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    reduced[0].save(path, save_all=True, append_images=reduced[1:], duration=1000 / rate, loop=0, optimize=False)


def write_mp4(path: Path, frames: Iterator[np.ndarray], rate: float) -> None:
    """Write pictures as H.264, which every browser plays. Raises InputError if ffmpeg cannot encode them."""
    first = next(frames)
    height, width = first.shape[0] // 2 * 2, first.shape[1] // 2 * 2
    command = [
        _ffmpeg() or "ffmpeg", "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}",
        "-r", f"{rate:g}", "-i", "-", "-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "20", "-movflags", "+faststart", str(path),
    ]  # fmt: skip
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as encoder:
        assert encoder.stdin is not None and encoder.stderr is not None
        try:
            for frame in (first, *frames):
                encoder.stdin.write(np.ascontiguousarray(frame[:height, :width]).tobytes())
            encoder.stdin.close()
        except BrokenPipeError:
            pass
        reason = encoder.stderr.read().decode(errors="replace").strip().splitlines()
        if encoder.wait():
            raise InputError(f"-o {path}: ffmpeg could not encode it: {reason[-1] if reason else 'no reason given'}")
