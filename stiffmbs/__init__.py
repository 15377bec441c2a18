"""A stiff multibody solver: bodies, joints and forces in, motion and the force in every joint out.

Examples
--------
>>> import stiffmbs
>>> solution = stiffmbs.run(stiffmbs.load_scene("examples/cart_pendulum.yaml"), rtol=1e-8)
>>> print(f"the rail carries {solution['rail.fy'].max():.1f} N at most")
the rail carries 108.8 N at most
"""

# ruff: noqa: E402 Ctrl-C is to end the command without a traceback while all of this is imported
from .interrupts import quiet_while_loading

quiet_while_loading()

from typing import Any

from .describe.body import Body
from .describe.element import Force, Joint
from .describe.marker import GROUND as ground
from .describe.marker import Marker
from .describe.model import FORCES, JOINTS
from .describe.model import Model as DescribedModel
from .describe.own_elements import register
from .describe.python_function import PythonFunction
from .describe.scene import read_scene
from .describe.schema import scene_schema
from .describe.settings import RunSettings
from .describe.units import si
from .errors import AssemblyError, InputError, SolverError, StiffmbsError
from .jobs.load_scene import load_scene

__version__ = "0.1.0"

_ELEMENTS = {element.__name__: element for element in (*JOINTS.shipped.values(), *FORCES.shipped.values())}

__all__ = [
    "AssemblyError", "Body", "Force", "InputError", "Joint", "Marker", "Model", "PythonFunction", "RunSettings", "SolverError", "StiffmbsError",
    "check", "compile_model", "ground", "load_scene", "read_scene", "register", "run", "scene_schema", "si", "verify", *_ELEMENTS,
]  # fmt: skip


class Model(DescribedModel):
    __doc__ = DescribedModel.__doc__

    def check(self, **changes: Any) -> Any:
        """Examine the model: degrees of freedom, redundancy.

        Parameters
        ----------
        **changes
            Fields of the settings to change; returns and raises what `stiffmbs.check` does.
        """
        from .jobs.check import check

        return check(self, **changes)


def __getattr__(name: str) -> Any:
    if name in _ELEMENTS:
        return _ELEMENTS[name]
    if name == "run":
        from .jobs.run import run

        return run
    if name == "verify":
        from .verification.verify import verify

        return verify
    if name == "check":
        from .jobs.check import check

        return check
    if name == "compile_model":
        from .compile.compile_model import compile_model

        return compile_model
    if name == "spatial":
        from importlib import import_module

        return import_module(".spatial", __name__)
    raise AttributeError(f"module 'stiffmbs' has no attribute '{name}'")
