"""``python -m stiffmbs``."""

from __future__ import annotations

import os
import sys

from .interrupts import QuickEnd, collect_from_now_on


def start() -> None:
    """Run the command ``stiffmbs``; report a failed import, as for lack of memory."""
    end = QuickEnd.of_the_command()
    # otherwise pydantic searches all installed packages for plugins, which takes time
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    try:
        from .commands.main import main
    except (MemoryError, ImportError, OSError) as error:
        print(f"stiffmbs: the program cannot be loaded ({type(error).__name__}: {error})", file=sys.stderr)
        sys.exit(1)
    collect_from_now_on()
    with end.noted():
        main()


if __name__ == "__main__":
    start()
