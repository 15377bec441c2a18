"""``python -m stiffmbs``."""

from __future__ import annotations

import os
import sys

from .interrupts import QuickEnd, collect_from_now_on


def start() -> None:
    """The command ``stiffmbs``; also where there is too little memory to load it."""
    end = QuickEnd.of_the_command()
    # pydantic would look for plugins among all installed packages: 10 to 20 ms, and none is of use here
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
