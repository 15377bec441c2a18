"""Times of the live page in Chromium: its text, its first answer, from a slider to the new curve, and pictures per second.

    python -m tests.live.times [RUNS]

Prints the median and the range of RUNS pages (5 by default), s, for the cart-pendulum, the half car, and the car over 3 s of motion.  Every
page belongs to a server of its own with a warm cache; a slider is moved five times in each page.
"""

from __future__ import annotations

import shutil
import statistics
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import stiffmbs

from ..show.page import browser

EXAMPLES = Path(__file__).parents[2] / "examples"
SLIDERS = {"cart_pendulum": "L", "half_car": "k_b", "car": "k_b"}
PLAYED = 2.0
"""Duration over which pictures are counted, s."""
POSITIONS = (300, 700, 400, 600, 350)


def main() -> None:
    """Print one line for each scene."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    with tempfile.TemporaryDirectory() as folder, browser.tab(Path(folder)) as tab:
        for tyre in EXAMPLES.glob("*.tir"):
            shutil.copy(tyre, folder)
        for name, slider in SLIDERS.items():
            scene = Path(folder) / f"{name}.yaml"
            text = (EXAMPLES / scene.name).read_text(encoding="utf-8")
            scene.write_text(
                text.replace("duration: 10 s", "duration: 3 s") if name == "car" else text, encoding="utf-8"
            )
            page_times(tab, scene, slider)  # fills the caches
            found = [page_times(tab, scene, slider) for _ in range(runs)]
            shown, solved, moved, rate = zip(*found, strict=True)
            sliders = [seconds for page in moved for seconds in page]
            print(
                f"{name:14}  text {_spread(shown)} s  solved {_spread(solved)} s  slider {_spread(sliders)} s", end=""
            )
            print(f"  {_spread(rate)} pictures/s", flush=True)


def page_times(tab: browser.Tab, scene: Path, slider: str) -> tuple[float, float, list[float], float]:
    """Return the seconds until the text is shown, until the first answer, and of each move; pictures per second of the motion."""
    begun = time.monotonic()
    page = stiffmbs.open(scene, browser=False)
    try:
        tab.do("Page.navigate", url=page.url)
        tab.wait("typeof LIVE === 'object' && LIVE.editor")
        shown = time.monotonic() - begun
        tab.wait("LIVE.answers > 0 && LIVE.complete")
        solved = time.monotonic() - begun
        moved = [_moved(tab, slider, position) for position in POSITIONS]
        rate = _pictures_per_second(tab)
        tab.run("LIVE.saved = LIVE.editor?.state.doc.toString()")  # leaving the page asks nothing
        tab.do("Page.navigate", url="about:blank")
        tab.wait("location.href === 'about:blank' && document.readyState === 'complete'")
    finally:
        page.close()
    return shown, solved, moved, rate


def _pictures_per_second(tab: browser.Tab) -> float:
    tab.run("shown.time.set(shown.time.start); shown.time.playing || shown.time.toggle()")
    first, begun = tab.run("shown.frames"), time.monotonic()
    time.sleep(PLAYED)
    return (tab.run("shown.frames") - first) / (time.monotonic() - begun)


def _moved(tab: browser.Tab, slider: str, position: int) -> float:
    answers = tab.run("LIVE.answers")
    begun = time.monotonic()
    tab.run(
        f"(() => {{ const r = document.getElementById('slider-{slider}'); r.value = {position}; r.dispatchEvent(new Event('input')); }})()"
    )
    tab.wait(f"LIVE.answers > {answers}")
    return time.monotonic() - begun


def _spread(values: Sequence[float]) -> str:
    return f"{statistics.median(values):.2f} ({min(values):.2f} to {max(values):.2f})"


if __name__ == "__main__":
    main()
