"""``python -m stiffmbs``."""

from __future__ import annotations

import os
import sys

from .interrupts import QuickEnd, collect_from_now_on


def start(address: str = "") -> None:
    """Run the command ``stiffmbs``; report a failed import, as for lack of memory.

    `address`: of the socket from which a resident process takes its commands.
    """
    end = QuickEnd.of_the_command()
    if not address and "STIFFMBS_RESIDENT" in os.environ:
        from .commands.resident import passed_on

        if (status := passed_on()) is not None:
            with end.noted():
                sys.exit(status)
    # otherwise pydantic searches all installed packages for plugins, which takes time
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    try:
        from .commands.main import main

        if address:
            from .commands.serving import wait_for_a_command

            wait_for_a_command(address)
    except (MemoryError, ImportError, OSError) as error:
        print(f"stiffmbs: the program cannot be loaded ({type(error).__name__}: {error})", file=sys.stderr)
        sys.exit(1)
    collect_from_now_on()
    with end.noted():
        main()


if __name__ == "__main__":
    start()
