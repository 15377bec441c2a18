"""A fuzzer whose trials hang, crash and go wrong, by their seeds."""

import os
import signal
import time

from tests.stress.case import Outcome, Verdict, measured

WHAT = "nothing but failures"


def trial(seed: int) -> Verdict:
    match seed:
        case 1:
            while True:
                pass
        case 2:
            os.kill(os.getpid(), signal.SIGSEGV)
        case 3:
            os._exit(7)
        case 4:
            raise ZeroDivisionError("a step of zero")
        case 5:
            return measured(2.0, 1.0, "another mass")
        case 6:
            return Verdict(Outcome.TOLD, detail="refused")
        case 8:
            time.sleep(0.4)
        case 9:
            time.sleep(1000)
    return measured(0.5, 1.0)
