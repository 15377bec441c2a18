"""The header ``model.h`` of an FMU's library: sizes, offsets, relocations, and the image of the tables."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from ....compile.machine.image import Image
from ....compile.machine.layout import CACHE_LINE
from ....dynamics.native.layouts import JUDGED
from ....dynamics.native.parameters import CONSISTENCY
from ....solve.events.chattering import CHATTERING
from ....solve.explicit.integration import REASONS
from .model import ExportedModel

OF_STEPS = (
    "t", "t_before", "rtol", "last_error", "distance", "distance_of_end", "started", "at_event", "uncertain", "stiff_steps",
)  # fmt: skip
"""Cells of the steps that the C code reads or sets."""


def header(model: ExportedModel, token: str, symbols: Mapping[str, str], functions: Iterable[str]) -> str:
    """Return the text of the header.

    `token`: GUID of the FMU. `symbols`: names of the routines in the object code, by their names in the C code. `functions`: names of the
    functions of the image in the object code, in its order.
    """
    image, dynamics = model.image, model.dynamics
    system, work, watch = dynamics.system, model.work, model.work.watch
    start = model.job.start
    functions, algebraic = list(functions), system.algebraic_coordinates.tolist()
    at = {
        "DYNAMICS": image.at(dynamics.table), "STATUS": image.cell(dynamics.table, "status"),
        "EXPLICIT": image.at(work.table), "WATCH": image.at(watch.table), "BEGUN": image.cell(watch.table, "begun"),
        "ATOL": _place(image, work.atol), "Y": _place(image, work.y), "LAM": _place(image, work.lam),
        "END_RATES": _place(image, work.end_rates), "FOUND": _place(image, watch.found),
        **{name.upper(): image.cell(work.table, name) for name in OF_STEPS},
    }  # fmt: skip
    sizes = {
        "N_Q": system.n_q, "N_U": system.n_u, "N_C": system.n_c, "N_OUTPUT": system.n_values("output"), "N_JUDGED": len(JUDGED),
        "KINETIC": JUDGED.index("kinetic"), "POTENTIAL": JUDGED.index("potential"), "N_EVENTS": system.n_event_functions,
        "FIRST_LIMIT": system.first_limit, "N_FOUND": len(watch.found), "N_INPUTS": len(model.inputs), "N_NUMBERS": len(model.numbers),
        "N_BREAKS": len(model.breakpoints), "OF_TIME": int(model.depends_on_time), "N_LINKS": len(image.links), "N_CALLS": len(image.calls),
        "N_STATES": len(model.states), "N_ALGEBRAIC": len(algebraic), "N_OWN": len(image.own), "N_OWNED": image.n_owned, "IMAGE_SIZE": image.size, "IMAGE_CONTENT": len(image.content),
        "ALIGNMENT": CACHE_LINE, "FIRST_OUTPUT": model.first_output, "FIRST_DERIVATIVE": model.first_derivative, "FIRST_INPUT": model.first_input, "TIME": model.time,
        "EVENTS_OF_A_WINDOW": CHATTERING.window, **{f"AT_{name}": place for name, place in at.items()},
    }  # fmt: skip
    numbers = {
        "START_TIME": model.job.grid.start, "STOP_TIME": model.job.grid.end, "ASIDE": model.aside,
        "POSITION_TOLERANCE": CONSISTENCY.position_tolerance, "MOST_EVENTS": CHATTERING.too_many,
    }  # fmt: skip
    x = np.concatenate([start.q, start.u])
    number_rows = [
        f"{{{image.at(each.numbers) + 8 * each.place}, {each.input}, {each.offset!r}, {each.slope!r}}}"
        for each in model.numbers
    ]
    lines = [
        *(f"#define {name} {value}" for name, value in sizes.items()),
        *(f"#define {name} {float(value)!r}" for name, value in numbers.items()),
        *(f"#define {name} {symbol}" for name, symbol in symbols.items()),
        f'#define TOKEN "{token}"',
        f"#define REASONS {', '.join(_quoted(reason) for reason in _reasons())}",
        *(f"extern void {name}(void);" for name in dict.fromkeys(functions)),
        _array("double", "start_x", map(repr, x.tolist())),
        _array("double", "nominal_x", map(repr, np.maximum(np.abs(x), 1.0).tolist())),
        _array("int", "states", map(str, model.states)),
        _array("int", "algebraic", map(str, algebraic)),
        _array("double", "start_inputs", map(repr, model.inputs.values())),
        _array("double", "breaks", map(repr, model.breakpoints.tolist())),
        "typedef struct { long long at, to; } relocation;",
        _array("relocation", "links", (f"{{{a}, {b}}}" for a, b in image.links.tolist())),
        _array("relocation", "calls", (f"{{{a}, {b}}}" for a, b in image.calls.tolist())),
        _array("void (*const", "functions", functions, ")(void)"),
        _array("long long", "own", map(str, image.own.tolist())),
        "typedef struct { long long at; int input; double offset, slope; } affine_number;",
        _array("affine_number", "numbers", number_rows),
        _array("long long", "image", (f"{word}LL" if word > -(2**63) else "(-9223372036854775807LL - 1)" for word in np.frombuffer(image.content, dtype=np.int64).tolist())),
    ]  # fmt: skip
    return "\n".join(lines) + "\n"


def _place(image: Image, array: np.ndarray) -> int:
    """Return the offset of an array, 0 for an empty one."""
    return image.at(array) if array.size else 0


def _reasons() -> list[str]:
    """Return the reasons of failures by status, from -1 on."""
    return [REASONS.get(-k, "the computation failed") for k in range(1, 1 - min(REASONS))]


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _array(kind: str, name: str, items: Iterable[str], after: str = "") -> str:
    """Return the definition of a constant array; of one zero if there are no items."""
    found = list(items) or ["{0}" if kind in ("relocation", "affine_number") else "0"]
    const = "" if "const" in kind else "const "
    return f"static {const}{kind} {name}[]{after} = {{\n" + ",\n".join(found) + "};"
