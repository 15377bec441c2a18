"""Layout of the arrays of a beam section in compiled loops."""

NODE = {
    "R": 9, "C": 9, "A": 9, "point": 3, "origin": 3, "v": 3, "w": 3, "carried": 3, "e": 4, "turned": 4, "twist": 6,
    "screw": 6, "inverse": 3, "margin": 1, "P": 36, "Q": 36,
}  # fmt: skip
"""Values of a node: rotation matrices of the body, of the marker on it, and of the marker; the marker's point on the body,
and in space; velocity and angular velocity of the body, and that velocity in its axes; 2 p/|p|^2; marker's angle or
quaternion, and twist; screw from the reference node, with the factor e of its inverse
tangent and derivatives, its margin and tangents."""
OF_NODE = sum(NODE.values())
SCREW = sum(list(NODE.values())[: list(NODE).index("screw")])
