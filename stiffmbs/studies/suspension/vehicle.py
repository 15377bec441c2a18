"""Numbers of the whole vehicle that measures of an axle refer to."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...errors import InputError
from ...model.model_data import ModelData
from ...model.wheels import Wheel, axle_at, centre_of_mass, marked_or_tyred
from ...reading.marker import GROUND
from .axle import Axle

BRAKE_SHARES = {True: 0.6, False: 0.4}
"""Assumed share of the braking force at a front and at a rear axle; typical of passenger cars."""


@dataclass(frozen=True)
class Vehicle:
    """Numbers of the vehicle for anti-dive, anti-lift, anti-squat and Ackermann."""

    wheelbase: float | None = None  # distance to the other axle, m; None leaves out the measures that need it
    height: float | None = None  # height of the centre of mass of the vehicle above the road, m
    front: bool | None = None  # True for the front axle
    # brake_share, drive_share: share of this axle in the braking and in the driving force
    brake_share: float = 1.0
    drive_share: float = 1.0
    # True if the brakes are on the body, so that their torque does not act on the carriers
    inboard_brakes: bool = False
    # True if the driving torque acts on the carriers, as with a solid axle or motors in the hubs
    outboard_drive: bool = False
    assumed: tuple[str, ...] = ()  # names of the numbers that are assumptions


@dataclass(frozen=True)
class VehicleOptions:
    """Numbers of the vehicle that are given; None leaves them to the scene.

    Attributes
    ----------
    wheelbase, cg_height : float, optional
        m.
    brake_share, drive_share : float, optional
        Share of this axle, 0 to 1.
    inboard_brakes, outboard_drive : bool, optional
    """

    wheelbase: float | None = None
    cg_height: float | None = None
    brake_share: float | None = None
    drive_share: float | None = None
    inboard_brakes: bool = False
    outboard_drive: bool | None = None

    def __post_init__(self) -> None:
        for name in ("wheelbase", "cg_height"):
            value = getattr(self, name)
            if value is not None and not 0 < value < np.inf:
                raise InputError(f"{name}: found {value}, expected a length above zero, m")
        for name in ("brake_share", "drive_share"):
            value = getattr(self, name)
            if value is not None and not 0 <= value <= 1:
                raise InputError(f"{name}: found {value}, expected a share from 0 to 1")


def vehicle_of(model: ModelData, axle: Axle, given: VehicleOptions) -> Vehicle:
    """Return the numbers of the vehicle: as given, else from the scene, else assumptions."""
    own = float(np.mean([wheel.contact[0] for wheel in axle.wheels]))
    wheels = [wheel for wheel in marked_or_tyred(model) if not _is_of(wheel, axle)]
    others = [float((wheel.centre if wheel.patch is None else wheel.patch)[0]) for wheel in wheels]
    one = bool(wheels) and all(any(map(wheel.on_axle_of, axle_at(wheels, "front"))) for wheel in wheels)
    front = bool(own > np.mean(others)) if others and (own > max(others) or own < min(others)) else None
    assumed = []
    if front is None and not others and (front := _by_name(axle)) is not None:
        assumed.append("the front axle" if front else "the rear axle")
    brake = given.brake_share
    if brake is None:
        brake = 1.0 if front is None else BRAKE_SHARES[front]
        assumed.append(f"brake share {brake:g}")
    drive = given.drive_share
    if drive is None:
        drive = 1.0
        assumed.append("drive share 1")
    return Vehicle(
        wheelbase=given.wheelbase or (abs(own - float(np.mean(others))) if one else None),
        height=given.cg_height or _height(model, axle),
        front=front,
        brake_share=brake,
        drive_share=drive,
        inboard_brakes=given.inboard_brakes,
        outboard_drive=axle.solid if given.outboard_drive is None else given.outboard_drive,
        assumed=tuple(assumed),
    )


def _by_name(axle: Axle) -> bool | None:
    """Return True for a front axle and False for a rear one by its name or its steering, if there is no other axle."""
    name = axle.name.rpartition(".")[2]
    if name in ("front", "rear"):
        return name == "front"
    return True if axle.steering is not None else None


def _is_of(wheel: Wheel, axle: Axle) -> bool:
    """Return True for a wheel of an axle, or another wheel next to it."""
    carriers = [own.carrier for own in axle.wheels]
    return wheel.carrier in carriers or any(wheel.on_axle_of(own) for own in axle.wheels)


def _height(model: ModelData, axle: Axle) -> float | None:
    """Return the height of the vehicle's centre of mass above the contacts, or None if the clamped body is ground."""
    if axle.body == GROUND:
        return None
    return float(centre_of_mass(model, axle.body)[2] - np.mean([wheel.contact[2] for wheel in axle.wheels]))
