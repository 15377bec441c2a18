"""Cases that ask a solver for more than is fair, and what came of each: right, told, or silently wrong."""
