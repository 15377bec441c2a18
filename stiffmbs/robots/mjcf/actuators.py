"""Actuators and tendons of a compiled MJCF model."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ...reading.files.requested import Fields
from ...reading.files.yaml_text import Content
from ..robot import RobotFault, Segment, Transmission
from .fields import RequestedModel, name_of

OF_PASSIVE = ("SPRING", "DAMPER")
"""Flags that older versions of MuJoCo combine as PASSIVE."""


class Disabled:
    """Disable flags of a compiled model by name, with a record of the requested ones."""

    def __init__(self, m: RequestedModel) -> None:
        import mujoco

        off, on = (_bits(kind) for kind in (mujoco.mjtDisableBit, mujoco.mjtEnableBit))
        self._off = Fields("flag", "", {name: "disabled" for name, bit in off.items() if m.opt.disableflags & bit})
        self._on = Fields("flag", "", {name: "enabled" for name, bit in on.items() if m.opt.enableflags & bit})

    def __call__(self, *names: str) -> bool:
        """Return True if any of the features is disabled."""
        found = [name in self._off or (name in OF_PASSIVE and "PASSIVE" in self._off) for name in names]
        return any(found)

    def all(self, *names: str) -> bool:
        """Return True if all of the features are disabled."""
        found = [self(name) for name in names]
        return all(found)

    def fields(self) -> tuple[Fields[str], Fields[str]]:
        """Return the disable and the enable flags that are set."""
        return self._off, self._on


def _bits(kind: object) -> dict[str, int]:
    """Return the flags of an enumeration by name, without prefix."""
    return {name[7:]: int(getattr(kind, name)) for name in dir(kind) if name.startswith(("mjDSBL_", "mjENBL_"))}


def transmissions(m: RequestedModel, disabled: Disabled) -> Iterator[Transmission]:
    """Yield the transmissions of joints: actuators with inputs, and springs and dampers of tendons."""
    for k in () if disabled("ACTUATION") else range(m.nactuator if hasattr(m, "nactuator") else m.nu):
        if not _in_disabled_group(m, k):
            yield _actuator(m, k, disabled)
    for k in range(m.ntendon):
        yield from _tendon(m, k, disabled)


def disabled_actuators(m: RequestedModel, disabled: Disabled) -> Iterator[str]:
    """Yield a note on actuators that the file disables."""
    count = m.nactuator if hasattr(m, "nactuator") else m.nu
    off = [k for k in range(count) if disabled("ACTUATION") or _in_disabled_group(m, k)]
    if off:
        yield f"disabled actuators are ignored: {', '.join(name_of(m, 'actuator', k) for k in off)}"


def _in_disabled_group(m: RequestedModel, k: int) -> bool:
    group = int(m.actuator_group[k])
    return group >= 0 and bool(int(m.opt.disableactuator) >> group & 1)


def _actuator(m: RequestedModel, k: int, disabled: Disabled) -> Transmission:
    import mujoco

    name = name_of(m, "actuator", k)
    gain, bias, dynamics = (
        mujoco.mjtGain(m.actuator_gaintype[k]),
        mujoco.mjtBias(m.actuator_biastype[k]),
        mujoco.mjtDyn(m.actuator_dyntype[k]),
    )
    lags = {
        mujoco.mjtDyn.mjDYN_NONE: None,
        mujoco.mjtDyn.mjDYN_INTEGRATOR: 0.0,
        mujoco.mjtDyn.mjDYN_FILTER: float(m.actuator_dynprm[k, 0]),
        mujoco.mjtDyn.mjDYN_FILTEREXACT: float(m.actuator_dynprm[k, 0]),
    }
    known = gain in (mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtGain.mjGAIN_AFFINE) and bias in (
        mujoco.mjtBias.mjBIAS_NONE,
        mujoco.mjtBias.mjBIAS_AFFINE,
    )
    inputs, outputs = (getattr(m, key, None) for key in ("actuator_ctrlnum", "actuator_outnum"))
    one = (inputs is None or inputs[k] == 1) and (outputs is None or outputs[k] == 1)
    if not known or not one or dynamics not in lags:
        kinds = ", ".join(kind.name.split("_")[1].lower() for kind in (gain, bias, dynamics))
        raise RobotFault(
            f"actuator {name}: found gain, bias and dynamics {kinds}, expected fixed or affine ones, and none, a filter or an integrator"
        )
    for key in ("actuator_damping", "actuator_dampingpoly", "actuator_armature", "actuator_delay"):
        if hasattr(m, key) and np.any(getattr(m, key)[k]):
            raise RobotFault(f"actuator {name}: found a {key.split('_')[1]} of the actuator, expected it at the joint")
    fixed = gain == mujoco.mjtGain.mjGAIN_FIXED
    gains = (float(m.actuator_gainprm[k, 0]), 0.0, 0.0) if fixed else tuple(map(float, m.actuator_gainprm[k, :3]))
    affine = bias == mujoco.mjtBias.mjBIAS_AFFINE
    return Transmission(
        name,
        **_geared(m, k, name),
        gain=gains,
        bias=tuple(map(float, m.actuator_biasprm[k, :3])) if affine else (0.0, 0.0, 0.0),
        control=None if disabled("CLAMPCTRL") else bounds(m.actuator_ctrllimited[k], m.actuator_ctrlrange[k]),
        force=bounds(m.actuator_forcelimited[k], m.actuator_forcerange[k]),
        lag=lags[dynamics],
        **_tendon_of(m, k),
    )


def _tendon_of(m: RequestedModel, k: int) -> Content:
    """Return the tendon of an actuator, and the bounds of the total force of all actuators on it."""
    import mujoco

    tendon = int(m.actuator_trnid[k, 0])
    if mujoco.mjtTrn(m.actuator_trntype[k]) != mujoco.mjtTrn.mjTRN_TENDON:
        return {}
    total = bounds(m.tendon_actfrclimited[tendon], m.tendon_actfrcrange[tendon])
    return {"tendon": name_of(m, "tendon", tendon), "total": total} if total else {}


def bounds(limited: object, ends: Sequence[float]) -> tuple[float, float] | None:
    """Return the bounds of a limited range, else None."""
    return (float(ends[0]), float(ends[1])) if limited else None


def _geared(m: RequestedModel, k: int, name: str) -> Content:
    """Return the length of an actuator: gears of joint coordinates, or segments of a tendon."""
    import mujoco

    kind, target = mujoco.mjtTrn(m.actuator_trntype[k]), int(m.actuator_trnid[k, 0])
    gear = float(m.actuator_gear[k, 0])
    if kind in (mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_JOINTINPARENT):
        return {"gears": {_of_one_coordinate(m, target, f"actuator {name}"): gear}}
    if kind == mujoco.mjtTrn.mjTRN_TENDON:
        return _along(m, target, f"actuator {name}", gear)
    raise RobotFault(
        f"actuator {name}: found that it acts on a {kind.name.split('_')[1].lower()}, expected a joint or tendon"
    )


def _tendon(m: RequestedModel, k: int, disabled: Disabled) -> Iterator[Transmission]:
    """Yield the linear spring and damper of a tendon; a nonlinear one or a dead band raises `RobotFault`."""
    name = name_of(m, "tendon", k)
    stiffness = 0.0 if disabled("SPRING") else float(m.tendon_stiffness[k])
    damping = 0.0 if disabled("DAMPER") else float(m.tendon_damping[k])
    for key in ("stiffnesspoly", "dampingpoly", "springyield", "armature", "frictionloss"):
        values = getattr(m, f"tendon_{key}", None)
        if values is not None and np.any(values[k]):
            raise RobotFault(f"tendon {name}: found {key}, expected a linear spring and damper")
    if stiffness == 0 and damping == 0:
        return
    low, high = map(float, m.tendon_lengthspring[k])
    if stiffness and low != high:
        raise RobotFault(f"tendon {name}: found a spring that rests from {low:g} to {high:g} m, expected one length")
    along = _along(m, k, f"tendon {name}", 1.0)
    yield Transmission(name, **along, gain=None, bias=(stiffness * low, -stiffness, -damping))


def _along(m: RequestedModel, tendon: int, where: str, gear: float) -> Content:
    """Return the joints of a fixed tendon with their gears, or the segments between the sites of one through space."""
    import mujoco

    gears: dict[str, float] = {}
    segments: list[Segment] = []
    site, share = None, gear
    for k in range(m.tendon_adr[tendon], m.tendon_adr[tendon] + m.tendon_num[tendon]):
        kind, ident, value = mujoco.mjtWrap(m.wrap_type[k]), int(m.wrap_objid[k]), float(m.wrap_prm[k])
        if kind == mujoco.mjtWrap.mjWRAP_JOINT:
            name = _of_one_coordinate(m, ident, where)
            gears[name] = gears.get(name, 0.0) + gear * value
        elif kind == mujoco.mjtWrap.mjWRAP_PULLEY:
            site, share = None, gear / value
        elif kind == mujoco.mjtWrap.mjWRAP_SITE:
            if site is not None:
                segments.append(Segment(*_site(m, site), *_site(m, ident), share))
            site = ident
        else:
            raise RobotFault(
                f"{where}: found a tendon that wraps around a geom, expected one of sites and pulleys, or of joints"
            )
    return {"gears": gears, "segments": tuple(segments)}


def _site(m: RequestedModel, site: int) -> tuple[str | None, tuple[float, ...]]:
    """Return the link of a site (None: the world) and its position in the link's frame."""
    body = int(m.site_bodyid[site])
    return (name_of(m, "body", body) if body else None), tuple(map(float, m.site_pos[site]))


def _of_one_coordinate(m: RequestedModel, joint: int, where: str) -> str:
    import mujoco

    name = name_of(m, "joint", joint)
    if mujoco.mjtJoint(m.jnt_type[joint]) not in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE):
        raise RobotFault(f"{where}: found that it acts on {name}, expected a hinge or slide")
    return name
