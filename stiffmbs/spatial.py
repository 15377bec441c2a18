"""Mechanisms in space: bodies, markers, joints and forces of three dimensions, used as those of `stiffmbs` are.

Examples
--------
>>> from stiffmbs.spatial import Body, Model, Spherical
>>> model = Model("top", gravity=(0, 0, -9.81))
>>> top = model.add("top", Body(mass=1, inertia=(0.03, 0.03, 0.01), omega=(0, 0, 100)))
>>> model.add("tip", Spherical(i=top.at(0, 0, -0.2), j="ground"))
"""

from typing import Any

from .describe.element import Force, Joint
from .describe.spatial.body import Body
from .describe.spatial.marker import Marker
from .describe.spatial.model import FORCES, JOINTS
from .describe.spatial.model import Model as DescribedModel

_ELEMENTS = {element.__name__: element for element in (*JOINTS.shipped.values(), *FORCES.shipped.values())}

__all__ = ["Body", "Force", "Joint", "Marker", "Model", "in_space", *_ELEMENTS]


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


def in_space(planar: Any) -> Any:
    """A planar model or scene in space: in the x-y plane of the ground, element by element.

    A model built in Python becomes a model of this module, to which more can be added; a scene becomes a scene.

    Names stay, and so do numbers.  Revolute joints turn about z, prismatic joints slide along the axes of their markers,
    circles in contact become spheres.  Moments of inertia about x and y are taken as large as that about z: they do
    nothing in the plane.  Bodies that no revolute, prismatic or fixed joint keeps in the plane are kept there by a
    `planar` joint, ``NAME_in_plane``.  The forces are those of the plane; of closed loops those across the plane are not
    unique, as in any overconstrained mechanism.  In formulas ``bar.angle`` becomes ``az(bar, ground)`` and ``bar.omega``
    ``wz(bar)``.

    Parameters
    ----------
    planar : Model or Scene
        Of the plane.

    Returns
    -------
    Model or Scene
        Of space.

    Raises
    ------
    InputError
        When it is no planar model, or holds an element that has no counterpart in space; names it.
    """
    from .describe.model import PlanarData
    from .describe.model_builder import ModelBuilder
    from .errors import InputError
    from .jobs.in_space import built, embedded

    if isinstance(planar, ModelBuilder) and planar.data_type is PlanarData:
        return built(planar, Model())
    if isinstance(planar, PlanarData):
        return embedded(planar)
    raise InputError(f"found {planar!r}, expected a planar Model or scene")


def __getattr__(name: str) -> Any:
    if name in _ELEMENTS:
        return _ELEMENTS[name]
    raise AttributeError(f"module 'stiffmbs.spatial' has no attribute '{name}'")
