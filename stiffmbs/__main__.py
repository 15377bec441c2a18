"""``python -m stiffmbs``."""

from .command_line import main

main()
