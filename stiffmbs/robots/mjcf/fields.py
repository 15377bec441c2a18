"""Non-default fields of MJCF elements, with a record of the requested ones."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ...reading.files.requested import Fields

if TYPE_CHECKING:
    import mujoco

LISTS = {
    "joint": "joints", "body": "bodies", "geom": "geoms", "site": "sites", "actuator": "actuators", "tendon": "tendons",
    "equality": "equalities", "sensor": "sensors", "key": "keys", "exclude": "excludes", "camera": "cameras",
    "light": "lights", "plugin": "plugins",
}  # fmt: skip
"""Names of the lists of each kind of element in MuJoCo's specification."""
NAMELESS = (
    "alt",
    "ialt",
    "classname",
    "compiler",
    "frame",
    "id",
    "info",
    "name",
    "parent",
    "plugin",
    "signature",
    "userdata",
)
"""Attributes of an element of the specification without an effect of their own."""
COMPILED: Mapping[str, tuple[str, ...]] = {
    "body": ("pos", "quat", "ipos", "iquat", "inertia", "fullinertia", "mass", "explicitinertial", "childclass", "simple"),
    "joint": ("springdamper", "align"),
    "geom": (
        "type", "size", "fromto", "pos", "quat", "typeinertia", "mass", "density", "meshname", "hfieldname", "fitscale",
        "contype", "conaffinity",
    ),
    "site": ("type", "fromto", "pos", "quat", "size"),
    "actuator": ("type", "target", "trntype", "slidersite", "refsite", "inheritrange", "ctrlspec"),
    "tendon": ("path", "springlength"),
    "equality": ("name1", "name2", "data", "objtype", "type", "active"),
    "option": ("disableflags", "enableflags"),
}  # fmt: skip
"""Fields that MuJoCo's compiler converts to poses, masses, springs and lengths, which are read."""
ARRAYS: Mapping[str, tuple[str, ...]] = {"joint": ("jnt", "dof"), "equality": ("eq",)}
"""Prefixes of the arrays of a kind in the model, if different from its name."""
RENAMED = {
    ("joint", "ref"): ("qpos0",),
    ("joint", "springref"): ("qpos_spring",),
    ("option", "disableactuator"): ("disableactuator",),
}
DRAWING, SOFT, SOLVER, CONTACTS = (
    "graphics",
    "constraints are exact here, and limits are not enforced",
    "settings of MuJoCo's solver",
    "contacts are left out",
)
REASONS: Mapping[str, Mapping[str, str]] = {
    "*": {
        **dict.fromkeys(("group", "rgba", "material", "width"), DRAWING),
        **dict.fromkeys(("solref", "solimp", "solref_limit", "solimp_limit", "solref_friction", "solimp_friction", "margin"), SOFT),
    },
    "geom": {
        **dict.fromkeys(("condim", "friction", "solref", "solimp", "solmix", "priority", "margin", "gap", "adhesion", "surfacevel"), CONTACTS),
        **dict.fromkeys(("fluid_ellipsoid", "fluid_coefs"), "the fluid is left out"),
    },
    "option": {
        **dict.fromkeys(("wind", "density", "viscosity"), "the fluid is left out"),
        **dict.fromkeys(("o_margin", "o_solref", "o_solimp", "o_friction"), CONTACTS),
        "magnetic": "sensors are left out", "*": SOLVER,
    },
    "flag": {"*": SOLVER},
    "camera": {"*": DRAWING}, "light": {"*": DRAWING}, "exclude": {"*": CONTACTS},
    "sensor": {"*": "requests of the scene measure"}, "key": {"*": "the scene starts as drawn, or by --at"},
}  # fmt: skip

WITH_CONTACTS: Mapping[str, Mapping[str, str]] = {
    **REASONS,
    "geom": {**REASONS["geom"], **dict.fromkeys(("gap", "adhesion", "surfacevel"), "contacts push alone")},
}  # fmt: skip
"""Reasons for models whose contacts are read."""


class RequestedModel:
    """Compiled model with a record of the requested entries of its arrays.

    `requested`: names of arrays with the index of an entry, None for all; options as ``opt.`` and their name.
    """

    def __init__(self, model: object) -> None:
        self._model = model
        self.requested: set[tuple[str, int | None]] = set()

    def __getattr__(self, name: str) -> Any:
        value = getattr(self._model, name)
        if name == "opt":
            return _Options(value, self.requested)
        return _Entries(value, name, self.requested) if isinstance(value, np.ndarray) else value

    @property
    def plain(self) -> object:
        """MuJoCo's own object."""
        return self._model


def name_of(m: RequestedModel, kind: str, k: int) -> str:
    """Return the name of a body, joint or other element of a model, or a generated one."""
    return getattr(m, kind)(k).name or f"{kind}_{k}"


class _Options:
    """Options of a model, with a record of those that are read."""

    def __init__(self, options: object, requested: set[tuple[str, int | None]]) -> None:
        self._options, self._requested = options, requested

    def __getattr__(self, name: str) -> Any:
        self._requested.add((f"option_{name}", None))
        return getattr(self._options, name)


class _Entries:
    """Array of a model, with a record of the entries that are read."""

    def __init__(self, array: np.ndarray, name: str, requested: set[tuple[str, int | None]]) -> None:
        self._array, self._name, self._requested = array, name, requested

    def __getitem__(self, index: Any) -> Any:
        first = index[0] if isinstance(index, tuple) else index
        if isinstance(first, slice):
            self._requested.update((self._name, k) for k in range(*first.indices(len(self._array))))
        else:
            self._requested.add((self._name, int(first)))
        return self._array[index]

    def __len__(self) -> int:
        return len(self._array)


def model_fields(spec: mujoco.MjSpec, model: RequestedModel, contacts: bool = False) -> Iterator[Fields[Any]]:
    """Yield the fields of the elements of a compiled specification, with a record of the requested ones.

    `model`: the compiled model, after reading. `contacts`: True if its excluded pairs of bodies are used.
    """
    defaults = _defaults()
    for kind, several in LISTS.items():
        if kind == "exclude" and contacts:
            continue
        for element in getattr(spec, several, ()):
            if kind not in defaults:
                yield Fields(kind, element.name or "one without a name", {"": 1})
            elif element.id >= 0 and getattr(element, "active", True):
                fields = Fields(kind, element.name or f"{kind}_{element.id}", _values(element), defaults[kind])
                _request(fields, kind, element.id, model)
                yield fields
    options = Fields("option", "", _values(spec.option), defaults["option"])
    _request(options, "option", 0, model)
    yield options


def _request(fields: Fields[object], kind: str, ident: int, model: RequestedModel) -> None:
    """Record the fields whose entries in the compiled model were requested."""
    fields.request(*COMPILED.get(kind, ()))
    for name in fields:
        arrays = RENAMED.get((kind, name)) or tuple(f"{prefix}_{name}" for prefix in ARRAYS.get(kind, (kind,)))
        if any((array, at) in model.requested for array in arrays for at in (None, _at(array, ident, model.plain))):
            fields.request(name)


def _at(array: str, ident: int, model: mujoco.MjModel) -> int:
    """Return the index of an element in an array; joints have arrays over joints, degrees of freedom or coordinates."""
    if array.startswith("dof_"):
        return int(model.jnt_dofadr[ident])
    return int(model.jnt_qposadr[ident]) if array.startswith("qpos") else ident


def _defaults() -> dict[str, dict[str, object]]:
    """Return the default fields of each kind."""
    import mujoco

    spec = mujoco.MjSpec()
    body = spec.worldbody.add_body()
    new = {
        "body": body, "joint": body.add_joint(), "geom": body.add_geom(), "site": body.add_site(),
        "actuator": spec.add_actuator(), "tendon": spec.add_tendon(), "equality": spec.add_equality(), "option": spec.option,
    }  # fmt: skip
    return {kind: _values(element) for kind, element in new.items()}


def _values(element: object) -> dict[str, object]:
    """Return the fields of an element that are numbers, words or sequences of them."""
    found = {}
    for name in dir(element):
        if name.startswith("_") or name in NAMELESS:
            continue
        value = getattr(element, name, None)
        if isinstance(value, bool | int | float | str | np.ndarray) or type(value).__name__.startswith("mjt"):
            found[name] = np.array(value).tolist() if isinstance(value, np.ndarray) else value
    return found
