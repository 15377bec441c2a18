"""Texts of Simscape Multibody XML files."""

IDENTITY = "1 0 0 0 1 0 0 0 1"
UNITS = '<ModelUnits mass="kilogram" length="millimeter"/><DataUnits mass="kilogram" length="meter"/>'


def instance(name, part, place="0 0 0", turned=IDENTITY, below="", **attributes):
    """An instance of a part or subassembly, with others below it."""
    more = " ".join(f'{key}="{value}"' for key, value in attributes.items())
    pose = f"<Transform><Rotation>{turned}</Rotation><Translation>{place}</Translation></Transform>"
    return f'<Instance name="{name}" uid="{name}" entityUid="{part}" {more}>{pose}{below}</Instance>'


def path(uids):
    """A path of uids, separated by blanks."""
    return f"<InstancePath>{''.join(f'<Uid>{uid}</Uid>' for uid in uids.split())}</InstancePath>"


def shape(kind, uids, place, axis=""):
    """A geometry of a constraint."""
    along = f"<Axis>{axis}</Axis>" if axis else ""
    return f'<ConstraintGeometry geomType="{kind}">{path(uids)}<Position>{place}</Position>{along}</ConstraintGeometry>'


def constraint(kind, name, *shapes):
    """A constraint between two shapes."""
    return f'<{kind} name="{name}">{"".join(shapes)}</{kind}>'


def joint(kind, name, base, follower, place_b="0 0 0", place_f="0 0 0", turned=IDENTITY):
    """A joint between frames of a base and a follower."""
    ends = ""
    for tag, uids, place in (("BaseFrame", base, place_b), ("FollowerFrame", follower, place_f)):
        pose = f"<Transform><Rotation>{turned}</Rotation><Translation>{place}</Translation></Transform>"
        ends += f"<{tag}>{path(uids)}{pose}</{tag}>"
    return f'<{kind} name="{name}">{ends}</{kind}>'


def part(name, mass="2", centre="0.1 0 0", inertia="0.01 0.02 0.03 0 0 0", units=""):
    """A part with its mass properties."""
    own = f"<Mass>{mass}</Mass><CenterOfMass>{centre}</CenterOfMass><Inertia>{inertia}</Inertia>"
    return f'<Part name="{name}" uid="{name}">{units}<MassProperties>{own}</MassProperties></Part>'


def document(instances, constraints="", joints="", parts="", assemblies="", units=UNITS):
    """A file."""
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n<SimscapeMultibodyImportXML version="2.0" '
        f'xmlns="urn:mathworks:SimscapeMultibody:import">{units}\n<RootAssembly name="rig" uid="rig"><InstanceTree>{instances}'
        f"</InstanceTree><Constraints>{constraints}</Constraints><Joints>{joints}</Joints></RootAssembly>\n"
        f"<Assemblies>{assemblies}</Assemblies><Parts>{parts}</Parts></SimscapeMultibodyImportXML>\n"
    )


BASE = instance("base", "block", grounded="true")
CART = document(
    BASE + instance("cart", "block", "0.3 0 0.2") + instance("bob", "arm", "0.3 0.1 0.2", "0 -1 0 1 0 0 0 0 1"),
    constraint("Concentric", "rail", shape("cylinder", "base", "0 0 0.2", "1 0 0"), shape("cylinder", "cart", "0.1 0 0", "-2 0 0"))
    + constraint("Coincident", "track", shape("plane", "base", "0 0 0.15", "0 0 1"), shape("plane", "cart", "0 0 -0.05", "0 0 -1"))
    + constraint("Concentric", "pin", shape("cylinder", "cart", "0 0.1 0", "0 0 1"), shape("cylinder", "bob", "0 0 0.3", "0 0 1"))
    + constraint("Coincident", "face", shape("plane", "cart", "0.5 0.5 0.1", "0 0 1"), shape("plane", "bob", "0 0 0.1", "0 0 -1")),
    parts=part("block", "3", "0 0 0") + part("arm"),
)  # fmt: skip
"""A cart on a rail along x with a pendulum about z, held by mates of cylinders and planes."""
