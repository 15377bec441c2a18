"""Steady state of a tyre of a property file at arrays of loads, slips, camber angles, pressures and speeds.

The equations are those of the element, evaluated by NumPy.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import InputError
from ..element import Expr
from .file_fields import PLAUSIBLE
from .property_file import VERSIONS

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

STATE = ("load", "kappa", "alpha", "gamma", "speed", "direction", "friction", "dpi", "turn", "rolling")
"""Arguments of the compiled equations of forces."""
OF_RADIUS = ("loaded", "free", "spin", "dpi", "gamma", "fx", "fy")
"""Arguments of the compiled equations of deflection and load."""
MOST_ITERATIONS = 200
"""Limit of the iterations for rolling and loaded radius; bisection of an interval takes about 60."""
LEAST_LOAD = 1e-9
"""Smallest load of the search for the loaded radius, N, so that a tyre without load touches the road."""
UNCARRIED = 1e-9
"""Largest error of the load that a loaded radius carries, relative; beyond it there is no such radius."""
BEYOND = 1.2
"""Upper end of the search for the loaded radius, in free radii: a cambered tyre touches the road with its edge."""
CONTACT = {
    "load": (0.0, math.inf, " N"), "friction factor": (0.0, math.inf, ""),
    **dict.fromkeys(("slip angle", "camber"), (-math.pi / 2, math.pi / 2, " rad")),
}  # fmt: skip
"""Least and largest value of the state of the contact, and its unit; of angles by geometry."""
IN_RANGE = {**CONTACT, "pressure": (*PLAUSIBLE["INFLPRES"], " Pa")}
"""The same with the inflation pressure."""
OfArray = Callable[[np.ndarray], np.ndarray]
Numbers = Mapping[str, Any]
"""Numbers of a tyre by the symbols of the Magic Formula, with its version, ellipse of friction and load curve."""


def steady_state(
    numbers: Numbers, contact: Sequence[ArrayLike], p: ArrayLike | None, Vx: ArrayLike | None, phit: ArrayLike | None
) -> dict[str, np.ndarray]:
    """Return the steady state of a tyre by the symbols of the Magic Formula; see `TyreProperties.steady_state`.

    `contact`: Fz, kappa, alpha, gamma, and the friction factor of the road.
    """
    nominal = numbers["NOMPRES"]
    pressure = p if p is not None or nominal is None else numbers["INFLPRES"]
    turn = None if phit is None else np.asarray(phit, dtype=float)
    speed = numbers["LONGVL"] if Vx is None else Vx
    given = (1.0 if pressure is None else pressure, speed, 0.0 if turn is None else turn)
    Fz, kappa, alpha, gamma, friction, pressure, speed, turned = (
        np.array(x, dtype=float) for x in np.broadcast_arrays(*contact, *given)
    )
    _check((Fz, friction, alpha, gamma), None if p is None else pressure)
    dpi = 0 * Fz if nominal is None else pressure / nominal - 1
    rolled = _rolling(numbers, Fz, kappa, speed, dpi)
    rolling = (1 + kappa) * np.cos(alpha) * np.sign(speed) / rolled["Re"]
    state = (Fz, kappa, alpha, gamma, np.abs(speed) / numbers["LONGVL"], np.sign(speed), friction, dpi, turned, rolling)
    with np.errstate(divide="ignore", invalid="ignore"):  # relaxation lengths without stiffnesses
        found = _forces(numbers, turn is not None)(*_values(numbers), *state)
    forces = {name: np.broadcast_to(x, Fz.shape).astype(float) for name, x in found.items()}
    for name in ("sigma_x", "sigma_y"):
        forces[name] = np.where(np.isfinite(forces[name]), forces[name], 0.0)
    deflected = _deflected(numbers, Fz, gamma, dpi, forces | rolled)
    del rolled["free"]
    return forces | rolled | deflected


def _check(contact: Sequence[np.ndarray], pressure: np.ndarray | None) -> None:
    """Refuse a state without meaning: most often one in other units."""
    given = zip(CONTACT, contact, strict=True) if pressure is None else zip(IN_RANGE, (*contact, pressure), strict=True)
    for name, x in given:
        least, most, unit = IN_RANGE[name]
        wrong = x[~((x >= least) & (x <= most) & np.isfinite(x))]
        if wrong.size:
            limits = f"{least:.6g} to {most:.6g}{unit}" if math.isfinite(most) else "zero or a positive number"
            raise InputError(f"found a {name} of {wrong.flat[0]:g}{unit}, expected {limits}")


def _names(numbers: Numbers) -> tuple[str, ...]:
    return tuple(name for name, value in numbers.items() if isinstance(value, float))


def _values(numbers: Numbers) -> list[float]:
    return [numbers[name] for name in _names(numbers)]


def _rolling(
    numbers: Numbers, Fz: np.ndarray, kappa: np.ndarray, speed: np.ndarray, dpi: np.ndarray
) -> dict[str, np.ndarray]:
    """Return the effective radius, the spin and the free radius, by iteration to rest.

    The radius grows with the spin: omega = (1 + kappa) Vx/Re.
    """
    radius = _compiled("rolling", *_key(numbers))
    values, forward = _values(numbers), speed + kappa * np.abs(speed)
    if not VERSIONS[numbers["formula"]].is_6:
        Re = radius(*values, _deflection_at(numbers, Fz, dpi))["Re"]
        return {"Re": Re + 0 * forward, "omega": forward / Re, "free": numbers["UNLOADED_RADIUS"] + 0 * forward}
    omega = forward / numbers["UNLOADED_RADIUS"]
    for _ in range(MOST_ITERATIONS):
        found = radius(*values, Fz, omega, dpi)
        before, omega = omega, forward / found["Re"]
        if np.all(np.abs(omega - before) <= 1e-15 * np.abs(omega)):
            break
    return {name: np.broadcast_to(x, Fz.shape).astype(float) for name, x in found.items()} | {"omega": omega}


def _deflected(
    numbers: Numbers, Fz: np.ndarray, gamma: np.ndarray, dpi: np.ndarray, found: Mapping[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """Return deflection and loaded radius by those of a free tyre and by forces, by iteration for 6.1 and 6.2."""
    free = found["free"]
    if not VERSIONS[numbers["formula"]].is_6:
        rho = _deflection_at(numbers, Fz, dpi)
        return {"rho": rho, "Rl": free - rho}
    load = _compiled("load", *_key(numbers))
    values = _values(numbers)

    def carrying(loaded: np.ndarray) -> dict[str, np.ndarray]:
        return load(*values, loaded, free, found["omega"], dpi, gamma, found["Fx"], found["Fy"])

    Fz = np.maximum(Fz, LEAST_LOAD)
    Rl = falling_root(lambda x: carrying(x)["load"] - Fz, lambda x: carrying(x)["slope"], 0.0 * free, BEYOND * free)
    carried = carrying(Rl)
    Rl = np.where(np.abs(carried["load"] - Fz) < UNCARRIED * (Fz + numbers["FNOMIN"]), Rl, np.nan)
    return {"rho": carried["rho"] + 0 * Rl, "Rl": Rl}


def _deflection_at(numbers: Numbers, Fz: np.ndarray, dpi: np.ndarray) -> np.ndarray:
    """Return the deflection at a load and pressure by the linear stiffness or by [DEFLECTION_LOAD_CURVE]."""
    curve = numbers["deflection_load"]
    Fz = Fz / (1 + numbers.get("QPFZ1", 0.0) * dpi)
    if curve is None:
        return Fz / numbers["VERTICAL_STIFFNESS"]
    from scipy.interpolate import PchipInterpolator

    at, loads = np.array(curve.table).T
    inner, slopes = PchipInterpolator(at, loads), PchipInterpolator(at, loads).derivative()

    def excess(x: np.ndarray) -> np.ndarray:
        within = np.clip(x, at[0], at[-1])
        return Fz - inner(within) - slopes(within) * (x - within)

    last = max(float(slopes(at[-1])), 1e-9)
    longest = at[-1] + np.maximum(Fz - loads[-1], 0) / last + 0 * Fz
    return falling_root(excess, lambda x: -slopes(np.clip(x, at[0], at[-1])), 0 * Fz + min(at[0], 0.0), longest)


def falling_root(function: OfArray, slope: OfArray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return the zeros of decreasing functions within intervals by Newton's method with bisection; high without one."""
    x = (low + high) / 2
    for _ in range(MOST_ITERATIONS):
        value = function(x)
        low, high = np.where(value >= 0, x, low), np.where(value >= 0, high, x)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = x - value / slope(x)
        inside = (step > low) & (step < high)
        new = np.where(inside, step, (low + high) / 2)
        if np.all((np.abs(new - x) <= 1e-16 + 4e-16 * np.abs(x)) | (value == 0)):
            break
        x = np.where(value == 0, x, new)
    return np.asarray(x)


def _key(numbers: Numbers) -> tuple[tuple[str, ...], str, str, bool]:
    return _names(numbers), numbers["formula"], numbers["ellipse"], False


def _forces(numbers: Numbers, turns: bool) -> Callable[..., dict[str, np.ndarray]]:
    return _compiled("forces", *_key(numbers)[:-1], turns)


@lru_cache(maxsize=16)
def _compiled(
    of: str, names: tuple[str, ...], formula: str, ellipse: str, turns: bool
) -> Callable[..., dict[str, np.ndarray]]:
    """Return the equations of forces, of the load, or of the rolling radius as a function of numbers and state."""
    import sympy as sp

    numbers = sp.symbols(names, real=True)
    p = SimpleNamespace(**dict(zip(names, numbers, strict=True)), formula=formula, ellipse=ellipse)
    of_radius = ("load", "spin", "dpi")[: 3 if VERSIONS[formula].is_6 else 1]
    arguments = {"forces": STATE, "load": OF_RADIUS, "rolling": of_radius}
    symbols = [sp.Symbol(name, real=True) for name in arguments[of]]
    outputs = {"forces": _force_outputs, "load": _load_outputs, "rolling": _radius_outputs}[of](p, symbols, turns)
    function = sp.lambdify([*numbers, *symbols], list(outputs.values()), "numpy", cse=True)
    return lambda *values: dict(zip(outputs, function(*values), strict=True))


def _force_outputs(p: SimpleNamespace, symbols: list[Expr], turns: bool) -> dict[str, object]:
    from . import magic_formula, magic_formula_6

    (*basic, turn, rolling), load, gamma, dpi = symbols, symbols[0], symbols[3], symbols[7]
    equations = VERSIONS[p.formula].equations
    more: dict[str, object] = {}
    if equations.relaxation_lengths is not None:
        forces = equations.wrench(p, magic_formula.Slip(*basic), _same, p.ellipse)
        lengths = equations.relaxation_lengths(p, load, gamma, _same)
    else:
        from .deflection_6 import contact_patch

        state = magic_formula_6.PressedSlip(*(*basic, turn if turns else None, rolling))
        forces = equations.wrench(p, state, _same, p.ellipse)
        lengths = magic_formula_6.relaxation_lengths(p, load, dpi, gamma, _same)
        dfz = magic_formula.increment(p, load, _same)
        more |= dict(zip("ab", contact_patch(p, load, dpi), strict=True))
        more["Kyg0"] = magic_formula_6.camber_stiffness(p, load, dpi, dfz)
    return {
        **dict(zip(("Fx", "Fy", "Mx", "My", "Mz"), forces.wrench, strict=True)),
        "Kya": forces.y.stiffness, "Kxk": forces.x.stiffness, "mux": forces.x.mu, "muy": forces.y.mu,
        "t": forces.torque.trail, "Mzr": forces.torque.residual, "sigma_x": lengths[0], "sigma_y": lengths[1], **more,
    }  # fmt: skip


def _load_outputs(p: object, symbols: list[Expr], turns: bool) -> dict[str, object]:
    from .deflection_6 import deflection, stiffening

    loaded, free, spin, dpi, gamma, fx, fy = symbols
    load = stiffening(p, loaded, free, spin, dpi, gamma).load(fx, fy)
    return {"load": load, "slope": load.diff(loaded), "rho": deflection(p, loaded, free, gamma)}


def _radius_outputs(p: SimpleNamespace, symbols: list[Expr], turns: bool) -> dict[str, object]:
    equations = VERSIONS[p.formula].equations
    if equations.rolling_radius is not None:
        return {"Re": equations.rolling_radius(p, symbols[0], _same)}
    from .deflection_6 import effective_radius, free_radius

    load, spin, dpi = symbols
    free = free_radius(p, spin)
    return {"Re": effective_radius(p, load, dpi, free), "free": free}


def _same(x: Expr) -> Expr:
    return x
