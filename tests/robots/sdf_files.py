"""Random SDFormat files, with the poses of their frames in the world by homogeneous matrices."""

import numpy as np

INERTIAL = (
    "<inertial><pose>{centre} {turn}</pose><mass>{mass!r}</mass><inertia><ixx>{ixx!r}</ixx><ixy>0.001</ixy><ixz>0</ixz>"
    "<iyy>{iyy!r}</iyy><iyz>-0.002</iyz><izz>{izz!r}</izz></inertia></inertial>"
)


def joined(values):
    return " ".join(repr(float(x)) for x in values)


def rotation(roll, pitch, yaw):
    """Rotation about the fixed axes x, then y, then z."""
    (cx, cy, cz), (sx, sy, sz) = (f(np.array([roll, pitch, yaw])) for f in (np.cos, np.sin))
    x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    return np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]]) @ y @ x


def matrix(xyz, rpy):
    """Homogeneous matrix of a frame in the one that its pose is given in."""
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = rotation(*rpy), xyz
    return found


def quaternion(rpy):
    """Components x, y, z, w by half angles."""
    (cx, cy, cz), (sx, sy, sz) = (f(np.array(rpy) / 2) for f in (np.cos, np.sin))
    return (sx * cy * cz - cx * sy * sz, cx * sy * cz + sx * cy * sz, cx * cy * sz - sx * sy * cz, cx * cy * cz + sx * sy * sz)  # fmt: skip


def random_pose(rng):
    return rng.uniform(-0.5, 0.5, 3), rng.normal(size=3)


def pose_text(rng, xyz, rpy, relative_to=None, version=(1, 12)):
    """A <pose> in one of the forms of its version."""
    key = "relative_to" if version >= (1, 7) else "frame"
    base = "" if relative_to is None else f' {key}="{relative_to}"'
    form = rng.integers(3) if version >= (1, 9) else 0
    if form == 1:
        return f'<pose{base} degrees="true">{joined(xyz)} {joined(np.degrees(rpy))}</pose>'
    if form == 2:
        return f'<pose{base} rotation_format="quat_xyzw">{joined(xyz)}\n {joined(quaternion(rpy))}</pose>'
    return f"<pose{base}> {joined(xyz)}  {joined(rpy)} </pose>"


def random_inertial(rng):
    ixx, iyy, izz = (float(x) for x in rng.uniform(0.09, 0.12, 3))
    return INERTIAL.format(
        centre=joined(rng.uniform(-0.2, 0.2, 3)), turn=joined(rng.normal(size=3)), mass=float(rng.uniform(0.5, 2)), ixx=ixx, iyy=iyy, izz=izz
    )  # fmt: skip


class FrameGraph:
    """Model with links, joints, frames and nested models in random frames.

    `links`, `axes`: homogeneous matrices of links, and point and direction of joints, in the world, by name.
    """

    def __init__(self, rng, depth=1):
        self.links, self.axes = {}, {}
        placed = random_pose(rng)
        text, _ = self._model(rng, depth, "", "whole", *placed, None)
        self.text = f'<sdf version="1.12"><world name="w">{text}</world></sdf>'
        shift = matrix(*placed)
        self.links = {name: shift @ M for name, M in self.links.items()}
        self.axes = {name: (shift[:3, :3] @ p + shift[:3, 3], shift[:3, :3] @ a) for name, (p, a) in self.axes.items()}

    def _model(self, rng, depth, prefix, name, xyz, rpy, base):
        """Text of a model and its frames in its own frame; `base` places it."""
        frames, parts, links = {"__model__": np.eye(4)}, [], []
        own_links, own_axes = {}, {}
        for k in range(7):
            onto = str(rng.choice(list(frames)))
            relative = onto if rng.random() < 0.8 else None
            pose = random_pose(rng)
            base_matrix = frames[onto] if relative else np.eye(4)
            kind = rng.choice(["link", "frame", "joint", "model"], p=[0.35, 0.25, 0.25, 0.15])
            if k == 0 or (kind == "joint" and len(links) < 2) or (kind == "model" and depth == 0):
                kind = "link"
            if kind == "link":
                new = f"l{k}"
                frames[new] = base_matrix @ matrix(*pose)
                parts.append(f'<link name="{new}">{pose_text(rng, *pose, relative)}{random_inertial(rng)}</link>')
                links.append(new)
                own_links[new] = frames[new]
            elif kind == "frame":
                new, attached = f"f{k}", str(rng.choice(links))
                frames[new] = (base_matrix if relative else frames[attached]) @ matrix(*pose)
                parts.append(f'<frame name="{new}" attached_to="{attached}">{pose_text(rng, *pose, relative)}</frame>')
            elif kind == "joint":
                new, child = f"j{k}", links[-1]
                parent = links[-2]
                frames[new] = (base_matrix if relative else frames[child]) @ matrix(*pose)
                axis, expressed = rng.normal(size=3), str(rng.choice(["", *frames]))
                turn = frames[expressed or new][:3, :3]
                given = f' expressed_in="{expressed}"' if expressed else ""
                own_axes[new] = frames[new][:3, 3], turn @ axis / np.linalg.norm(axis)
                parts.append(
                    f'<joint name="{new}" type="revolute">{pose_text(rng, *pose, relative)}<parent>{parent}</parent><child>{child}</child>'
                    f"<axis><xyz{given}>{joined(axis)}</xyz></axis></joint>"
                )
                links.append(f"l{k}b")  # a link has one parent: the next joint has another child
                frames[links[-1]] = np.eye(4)
                own_links[links[-1]] = np.eye(4)
                parts.append(f'<link name="{links[-1]}">{random_inertial(rng)}</link>')
            else:
                new = f"m{k}"
                inner = FrameGraph.__new__(FrameGraph)
                inner.links, inner.axes = {}, {}
                text, below = inner._model(rng, depth - 1, f"{prefix}{new}::", new, *pose, relative)
                placement = inner.placement
                frames[new] = (
                    base_matrix @ matrix(*pose) @ (np.linalg.inv(below[placement]) if placement else np.eye(4))
                )
                frames |= {f"{new}::{one}": frames[new] @ M for one, M in below.items() if one != "__model__"}
                own_links |= {f"{new}::{one}": frames[new] @ M for one, M in inner.links.items()}
                shift = frames[new]
                own_axes |= {
                    f"{new}::{one}": (shift[:3, :3] @ p + shift[:3, 3], shift[:3, :3] @ a)
                    for one, (p, a) in inner.axes.items()
                }
                parts.append(text)
        self.links, self.axes = own_links, own_axes
        self.placement = str(rng.choice(list(frames))) if prefix and rng.random() < 0.5 else None
        placement = f' placement_frame="{self.placement}"' if self.placement else ""
        order = rng.permutation(len(parts))
        body = "".join(parts[k] for k in order)
        return f'<model name="{name}"{placement}>{pose_text(rng, xyz, rpy, base)}{body}</model>', frames


def of_urdf(root, rng, version=(1, 12)):
    """The tree of a URDF file as SDFormat; its poses are given in the model's or in other frames at random."""
    poses = {"world": np.eye(4)}
    links = {link.get("name"): link for link in root.findall("link")}
    parts = []
    for joint in root.findall("joint"):
        name, parent, child = joint.get("name"), joint.find("parent").get("link"), joint.find("child").get("link")
        origin = joint.find("origin")
        xyz, rpy = (np.array([float(x) for x in origin.get(key).split()]) for key in ("xyz", "rpy"))
        poses[child] = poses[parent] @ matrix(xyz, rpy)
        placed = pose_text(rng, xyz, rpy, None if parent == "world" else parent, version)
        axis = [float(x) for x in joint.find("axis").get("xyz").split()]
        old = "<use_parent_model_frame>false</use_parent_model_frame>" if (1, 5) <= version < (1, 7) else ""
        if version < (1, 5):
            axis = poses[child][:3, :3] @ axis
        inertial = links[child].find("inertial")
        at, mass, inertia = inertial.find("origin"), inertial.find("mass").get("value"), inertial.find("inertia")
        moments = "".join(f"<{key}>{value}</{key}>" for key, value in inertia.attrib.items())
        parts.append(
            f'<link name="{child}">{placed}<inertial><pose>{at.get("xyz")} {at.get("rpy")}</pose><mass>{mass}</mass>'
            f"<inertia>{moments}</inertia></inertial></link>"
        )
        parts.append(
            f'<joint name="{name}" type="{joint.get("type")}"><parent>{parent}</parent><child>{child}</child>'
            f"<axis><xyz>{joined(axis)}</xyz>{old}<limit><lower>-9</lower><upper>9</upper><effort>1e6</effort></limit></axis></joint>"
        )
    body = "".join(parts[k] for k in rng.permutation(len(parts)))
    number = ".".join(map(str, version))
    gravity = "<gravity>0 0 -9.81</gravity>" if version >= (1, 6) else "<physics><gravity>0 0 -9.81</gravity></physics>"
    return f'<?xml version="1.0"?><sdf version="{number}"><world name="w">{gravity}<model name="tree">{body}</model></world></sdf>'
