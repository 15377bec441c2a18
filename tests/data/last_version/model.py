"""A model of the last version, written with its classes."""

from stiffmbs import Body, Model, Prismatic, Revolute, SpringDamper


def model():
    """A cart with a pendulum."""
    found = Model("Cart-pendulum", gravity=(0, -9.81))
    cart = found.add("cart", Body(mass=10, inertia=1))
    bar = found.add("bar", Body(mass=1, inertia=0.03, position=(0.3, 0)))
    found.add("rail", Prismatic(i=cart, j="ground"))
    found.add("hinge", Revolute(i=bar.at(-0.3, 0), j=cart))
    found.add("spring", SpringDamper(i=cart.at(0, 0.1), j="ground", stiffness=270, damping=5, free_length=0.2))
    return found
