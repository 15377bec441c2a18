"""Adams/Solver datasets with a command file, something changed in either: listed, read, checked and run for a moment."""

from __future__ import annotations

import tempfile
import warnings
from pathlib import Path
from random import Random
from typing import Any

import numpy as np

from stiffmbs.adams.listing import listed_statements
from stiffmbs.adams.load import convert_file, load_adams
from stiffmbs.analyses.check import check
from stiffmbs.analyses.run import run
from stiffmbs.errors import StiffmbsError
from stiffmbs.model.read_scene import read_scene
from stiffmbs.results.solution import Solution
from stiffmbs.solve.trajectory import Outcome as Ending

from ..case import Outcome, Verdict
from ..file_bases import DATASETS
from ..simulation import patience
from .files import CHANGES, MOMENT, PATIENCE, shown, told, unsaid_channels

WHAT = (
    "a dataset or its command file with bytes, numbers, words or lines changed: refused in a sentence, or run with finite results "
    "that the converted scene has too"
)
ALIKE = 1e-6
"""Part of a channel's largest value by which the converted scene may differ: its text has all digits."""
SYSTEMS = """\
systems
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND
PART/1, GROUND
MARKER/10, PART=1, REULER=0,90D,0
PART/2, QG=1,0,0, MASS=2, CM=21, IP=0.1,0.2,0.3
MARKER/21, PART=2
MARKER/20, PART=2, QP=-1,0,0, REULER=0,90D,0
JOINT/1, REVOLUTE, I=20, J=10
MOTION/1, ROTATIONAL, JOINT=1, FUNCTION=SIN(2*TIME)
SPRINGDAMPER/1, TRANSLATIONAL, I=21, J=10, K=50, C=1, LENGTH=0.5
VARIABLE/1, FUNCTION=DX(21,10)+YAW(21,10)
ARRAY/1, X
ARRAY/2, U, VARIABLES=1
ARRAY/3, Y
TFSISO/1, X=1, U=2, Y=3, NUMERATOR=1, DENOMINATOR=1, 0.02, 0.3
DIFF/1, IC=0.5, FUNCTION=-DIF(1)+ARYVAL(3,1)
MATRIX/1, FULL=RORDER, M=2, N=2, VALUES=0,1,-1,-0.1
ARRAY/4, X
LSE/1, X=4, A=1
SFORCE/1, TRANSLATIONAL, I=21, J=10, FUNCTION=DIF(1)+IMPACT(DM(21,10),VR(21,10),0.1,100,1.5,1,0.01)
REQUEST/1, F2=YAW(21,10)\\, F3=ARYVAL(4,1)\\, F4=JOINT(1,0,2,0)
ACCGRAV/KGRAV=-9.80665
END
"""
WATCHED = """\
watched
UNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND
PART/1, GROUND
MARKER/11, PART=1
PART/2, MASS=2, CM=21, IP=0.1,0.1,0.1, VZ=0.3
MARKER/21, PART=2
JOINT/1, TRANSLATIONAL, I=21, J=11
FRICTION/1, JOINT=1, MU_STATIC=0.3, MU_DYNAMIC=0.2, STICTION_TRANSITION_VELOCITY=0.01, INPUTS=(PRELOAD:REACTION_FORCE)
, FRICTION_FORCE_PRELOAD=0.1, EFFECT=ALL
VARIABLE/1, FUNCTION=5
PINPUT/1, VARIABLES=1
SFORCE/1, TRANSLATIONAL, ACTIONONLY, I=21, J=11, FUNCTION=VARVAL(1)-0.1*JOINT(1,0,2,0)
SENSOR/1, FUNCTION=DZ(21,11), VALUE=0.002, ERROR=1E-4, GE, RETURN, CODGEN
SENSOR/2, FUNCTION=VZ(21,11), VALUE=0.302, ERROR=1E-4, GE, EVALUATE=DZ(21,11), DT=0.002
SFORCE/2, TRANSLATIONAL, ACTIONONLY, I=21, J=11, FUNCTION=SENVAL(2)
REQUEST/1, F2=JOINT(1,0,1,0)\\, F3=PINVAL(1,1)
ACCGRAV/JGRAV=-9.80665
END
"""
COMMANDS = (
    "",
    "SIM/DYN, END=0.02, STEPS=4\nDEACTIVATE/SENSOR, ID=1\nDEACTIVATE/JOINT, ID=1\nSIM/DYN, END=0.02, STEPS=4\n",
    "model\nSIM/DYN, END=0.01, STEPS=4\nSTOP\n",
    "FILE/MODEL=model\nINTEGRATOR/GSTIFF, ERROR=1E-4, HMAX=0.005\nSIM/DYN, END=0.01, DTOUT=0.002\n"
    "DEACTIVATE/MOTION, ID=1\nACCGRAV/KGRAV=-5\nSIM/DYN, DURATION=0.01, STEPS=5\nSPRINGDAMPER/1, K=80\nSIM/STAT\n",
    "SIM/STATICS\nDEACTIVATE/SPRINGDAMPER, ID=1\nSIM/KINEMATICS, END=0.01, STEPS=2\nACTIVATE/SPRINGDAMPER, ID=1\nPART/2, MASS=3\n"
    "SIM/TRANSIENT, END=0.02, STEPS=3\n",
)


def trial(seed: int) -> Verdict:
    """One dataset and its commands made from the seed, and what came of them."""
    random = Random(seed)
    files = [random.choice((SYSTEMS, SYSTEMS, WATCHED, WATCHED, *DATASETS)).encode(), random.choice(COMMANDS).encode()]
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        k = random.choice((0, 0, 1))
        files[k] = random.choices(*zip(*CHANGES, strict=True))[0](files[k], random)
    try:
        with warnings.catch_warnings(), tempfile.TemporaryDirectory() as folder:
            warnings.simplefilter("error")
            return _tried(Path(folder), *files)
    except StiffmbsError as error:
        return told(str(error))
    except Exception as error:  # whatever it is, no user should have seen it
        return Verdict(Outcome.WRONG, detail=f"{type(error).__name__}: {str(error)[:200]}")


def _tried(folder: Path, dataset: bytes, commands: bytes) -> Verdict:
    path = folder / "model.adm"
    path.write_bytes(dataset)
    if commands:
        path.with_suffix(".acf").write_bytes(commands)
    listed_statements(path)
    scene = load_adams(path)
    str(check(scene))
    settings: dict[str, Any] = {} if scene.stages else {"duration": min(MOMENT, scene.run.duration), "points": 5}
    solution = run(scene, watch=patience(PATIENCE), **settings)
    shown(solution)
    if solution.outcome is not Ending.DONE:
        return told(solution.message)
    unsaid = [] if scene.stages else unsaid_channels(solution)
    if unsaid:
        return Verdict(
            Outcome.WRONG, detail=f"done, but {unsaid[0]} is no number at some time; notes: {solution.notes}"
        )
    other = another_channel(solution, run(read_scene(convert_file(path)), watch=patience(PATIENCE), **settings))
    if other:
        return Verdict(Outcome.WRONG, detail=f"the converted scene has another {other}")
    return Verdict(Outcome.RIGHT, detail="; ".join(solution.notes))


def another_channel(one: Solution, other: Solution) -> str:
    """The first channel that is other in a second solution; nothing where all are alike."""
    if other.outcome is not Ending.DONE or len(other.time) != len(one.time):
        return "ending"
    for name, values in one.channels.items():
        found = other.channels.get(name, np.empty(0))
        if found.shape != values.shape or not np.allclose(
            found,
            values,
            rtol=0,
            atol=ALIKE * np.max(np.abs(values), initial=1e-9, where=np.isfinite(values)),
            equal_nan=True,
        ):
            return name
    return ""
