"""What can be wrong with joints, bodies, shapes and meshes of a description: more faults of `description_faults`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from description_tree import Node, any_of

if TYPE_CHECKING:
    from random import Random


TYPES = (
    "revolute",
    "continuous",
    "prismatic",
    "fixed",
    "floating",
    "planar",
    "Revolute",
    "hinge",
    "",
    "screw",
    "ball",
    "universal",
    "spherical",
    "fixed ",
    "FIXED",
    "unknown",
)


COLOURS = (
    "255 128 0 255",
    "1 0 0",
    "1 0 0 1 1",
    "0.5 0.5 0.5",
    "-1 0 0 1",
    "2 0 0 1",
    "a b c d",
    "",
    "1,0,0,1",
    "1 1 1 nan",
    "0 0 0 0",
    "1",
    "1 0 0 x",
)


def colour(rng: Random, robot: Node) -> bool:
    """Another text for a colour."""
    node = any_of(rng, robot, "color")
    if node is None:
        visual = any_of(rng, robot, "visual")
        if visual is None:
            return False
        node = Node("color", [("rgba", "1 0 0 1")])
        visual.children.append(Node("material", [("name", rng.choice(["paint", "", "red"]))], [node]))
    node.set("rgba", rng.choice(COLOURS))
    return True


def material(rng: Random, robot: Node) -> bool:
    """Another material of a visual."""
    visual = any_of(rng, robot, "visual")
    if visual is None:
        return False
    visual.children = [child for child in visual.children if child.tag != "material"]
    name = rng.choice(["paint", "red", "grey", ""])
    inner = rng.choice(
        [
            [],
            [Node("color", [("rgba", "1 0 0 1")])],
            [Node("color", [("rgba", "0 1 0 1")])],
            [Node("color")],
            [Node("texture", [("filename", "wood.png")])],
            [Node("texture")],
        ]
    )
    new = Node("material", [("name", name)] if rng.random() < 0.85 else [], inner)
    visual.children.append(new)
    if rng.random() < 0.3:
        robot.children.insert(rng.randrange(len(robot.children) + 1), new.copy())
    return True


def mimic(rng: Random, robot: Node) -> bool:
    """A joint that follows another, itself, or each other."""
    joints = robot.all("joint")
    if not joints:
        return False
    joint, leader = rng.choice(joints), rng.choice(joints)
    attributes = [("joint", leader.get("name") or "")]
    attributes += [
        (name, rng.choice(["1", "-1", "2", "0", "x", ""])) for name in ("multiplier", "offset") if rng.random() < 0.4
    ]
    joint.children.append(Node("mimic", attributes))
    if rng.random() < 0.3:
        leader.children.append(Node("mimic", [("joint", joint.get("name") or "")]))
    return True


def transmission(rng: Random, robot: Node) -> bool:
    """A transmission, whole or in part."""
    names = [joint.get("name") or "" for joint in robot.all("joint")] or [""]
    name = rng.choice([rng.choice(names), rng.choice(names), "nowhere"])
    joint = Node(
        "joint", [("name", name)], rng.choice([[], [Node("hardwareInterface", text="PositionJointInterface")]])
    )
    actuator = Node(
        "actuator",
        [("name", "motor")],
        rng.choice(
            [
                [],
                [Node("mechanicalReduction", text=rng.choice(["1", "50", "0", "x", ""]))],
                [Node("hardwareInterface", text="EffortJointInterface"), Node("mechanicalReduction", text="1")],
            ]
        ),
    )
    kind = rng.choice(
        [
            Node("type", text="transmission_interface/SimpleTransmission"),
            Node("type", text="SimpleTransmission"),
            Node("type", text="x"),
            Node("type"),
        ]
    )
    parts = [part for part in (kind, joint, actuator) if rng.random() < 0.9]
    robot.children.append(Node("transmission", [("name", "t")] if rng.random() < 0.9 else [], parts))
    return True


def limits(rng: Random, robot: Node) -> bool:
    """Other limits."""
    limit = any_of(rng, robot, "limit")
    if limit is None:
        return False
    for changed in rng.choice(
        [
            {"lower": "1", "upper": "1"},
            {"lower": "0", "upper": "0"},
            {"lower": "2", "upper": "-2"},
            {"effort": "0"},
            {"effort": "-10"},
            {"velocity": "0"},
            {"velocity": "-1"},
            {"effort": "inf"},
            {"lower": "-1e10", "upper": "1e10"},
            {"lower": "0.5", "upper": "2"},
            {"lower": "-inf", "upper": "inf"},
        ]
    ).items():
        limit.set(*changed)
    return True


def inertia(rng: Random, robot: Node) -> bool:
    """Another tensor."""
    nodes = [node for node in robot.walk() if node.tag == "inertia"]
    if not nodes:
        return False
    node = rng.choice(nodes)
    tensors = (
        "1 0 0 1 0 0",
        "1 0 0 0 0 1",
        "1 0 0 1 0 1.9999",
        "1 0 0 1 0 2",
        "1 0 0 1 0 2.1",
        "0 0 0 0 0 1e-9",
        "1 2 0 1 0 1",
        "-1 0 0 1 0 1",
        "0.001 0 0 0.001 0 0",
        "1e-12 0 0 1e-12 0 1e-12",
        "0 0.1 0 0 0 0",
        "0 0 0 0 0 0",
        "-1 0 0 -1 0 -1",
        "1 1 0 1 0 1",
        "1e-15 0 0 1e-15 0 1e-15",
        "1 0.5 0.5 1 0.5 1",
    )
    for name, value in zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), rng.choice(tensors).split(), strict=True):
        node.set(name, value)
    return True


def mass(rng: Random, robot: Node) -> bool:
    """Another mass, with or without its inertia."""
    inertial = any_of(rng, robot, "inertial")
    if inertial is None:
        return False
    value = rng.choice(["0", "-1", "0.0", "1e-9", "1e12", "5"])
    if part := inertial.first("mass"):
        part.set("value", value)
    if rng.random() < 0.5 and (tensor := inertial.first("inertia")):
        for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"):
            tensor.set(name, "0")
    return True


def inertial(rng: Random, robot: Node) -> bool:
    """A link without its inertial, or with one of nothing."""
    link = any_of(rng, robot, "link")
    if link is None:
        return False
    link.children = [child for child in link.children if child.tag != "inertial"]
    if rng.random() < 0.3:
        zeros = Node("inertia", [(name, "0") for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")])
        link.children.append(Node("inertial", [], [Node("mass", [("value", "0")]), zeros]))
    elif rng.random() < 0.2:
        link.children.append(Node("inertial"))
    return True


def shape(rng: Random, robot: Node) -> bool:
    """Another shape."""
    link = any_of(rng, robot, "link")
    if link is None:
        return False
    shapes = [
        Node("capsule", [("radius", "0.05"), ("length", "0.2")]),
        Node("box", [("size", "0.1 0.1 0.1")]),
        Node("box", [("size", "0 0.1 0.1")]),
        Node("cylinder", [("radius", "0"), ("length", "1")]),
        Node("cylinder", [("radius", "-1"), ("length", "1")]),
        Node("sphere", [("radius", "0")]),
        Node("sphere", [("radius", "1e-5")]),
        Node("sphere", [("radius", "-1")]),
        Node("cylinder", [("radius", "0.1")]),
        Node("plane", [("normal", "0 0 1")]),
        Node("plane"),
        Node("ellipsoid", [("size", "1 1 1")]),
        Node("cone", [("radius", "1")]),
        Node("sphere", [("radius", "0.1")]),
        Node("cylinder", [("radius", "0.1"), ("length", "0.2")]),
        Node("box"),
        Node("mesh"),
        Node("capsule"),
        Node("capsule", [("radius", "0"), ("length", "0")]),
    ]
    geometry = Node("geometry", [], [rng.choice(shapes)])
    if rng.random() < 0.1:
        geometry.children = rng.choice(
            [[], [*geometry.children, rng.choice(shapes)], [Node("foo"), *geometry.children]]
        )
    link.children.append(Node(rng.choice(["visual", "collision"]), [], [geometry] if rng.random() < 0.95 else []))
    return True


MESHES = (
    "part.obj",
    "part.stl",
    "text.stl",
    "part.STL",
    "part.OBJ",
    "part.dae",
    "part.glb",
    "part.vtk",
    "part.ply",
    "nowhere.obj",
    "nowhere.stl",
    "part",
    "",
    "empty.stl",
    "empty.obj",
    "part.obj ",
    "sub/part.obj",
    "./part.obj",
    "part%20b.obj",
    "part b.obj",
)
ADDRESSES = (
    "{}",
    "{}",
    "package://robots/{}",
    "package://nowhere/{}",
    "package:///{}",
    "file://FOLDER/{}",
    "file:{}",
    "FOLDER/{}",
    "model://robots/{}",
    "http://localhost/{}",
    "package://{}",
    "../robots/{}",
    "package:/robots/{}",
)


def mesh(rng: Random, robot: Node) -> bool:
    """A mesh of some format, at some address."""
    link = any_of(rng, robot, "link")
    if link is None:
        return False
    attributes = [("filename", rng.choice(ADDRESSES).format(rng.choice(MESHES)))]
    if rng.random() < 0.3:
        attributes.append(
            ("scale", rng.choice(["1 1 1", "0.001 0.001 0.001", "1", "-1 1 1", "0 1 1", "1 1", "a b c", "-1 -1 1", ""]))
        )
    link.children.append(
        Node(rng.choice(["visual", "collision"]), [], [Node("geometry", [], [Node("mesh", attributes)])])
    )
    return True


def world(rng: Random, robot: Node) -> bool:
    """A joint from `world`, defined or not, as simulators' examples have it."""
    links = robot.all("link")
    if not links:
        return False
    held = {end.get("link") for end in robot.walk() if end.tag == "child"}
    roots = [link for link in links if link.get("name") not in held] or links
    joint = Node(
        "joint",
        [("name", "world_joint"), ("type", rng.choice(["fixed", "fixed", "floating", "revolute"]))],
        [Node("parent", [("link", "world")]), Node("child", [("link", roots[0].get("name") or "")])],
    )
    robot.children.append(joint)
    if rng.random() < 0.5:
        robot.children.insert(0, Node("link", [("name", "world")]))
    return True


def circle(rng: Random, robot: Node) -> bool:
    """A joint between two links that are connected already, the root often among them."""
    links = [link.get("name") or "" for link in robot.all("link")]
    if not links:
        return False
    child = links[0] if rng.random() < 0.5 else rng.choice(links)
    kind = rng.choice(["fixed", "continuous"])
    robot.children.append(
        Node(
            "joint",
            [("name", "closing"), ("type", kind)],
            [Node("parent", [("link", rng.choice(links))]), Node("child", [("link", child)])],
        )
    )
    return True


def root_added(rng: Random, robot: Node) -> bool:
    """A link that nothing holds."""
    link = Node("link", [("name", "stray")])
    if rng.random() < 0.5:
        zeros = Node(
            "inertia", [(n, v) for n, v in zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), "100101", strict=True)]
        )
        link.children.append(Node("inertial", [], [Node("mass", [("value", "1")]), zeros]))
    robot.children.insert(rng.randrange(len(robot.children) + 1), link)
    return True


def joint_type(rng: Random, robot: Node) -> bool:
    """Another type of joint."""
    joints = robot.all("joint")
    if joints:
        rng.choice(joints).set("type", rng.choice(TYPES))
    return bool(joints)


def joint_reversed(rng: Random, robot: Node) -> bool:
    """Parent and child exchanged."""
    joint = any_of(rng, robot, "joint")
    parent, child = (joint.first("parent"), joint.first("child")) if joint else (None, None)
    if parent is None or child is None:
        return False
    parent.attributes, child.attributes = child.attributes, parent.attributes
    return True


def extension(rng: Random, robot: Node) -> bool:
    """An element of a simulator or of ROS."""
    robot.children.append(
        rng.choice(
            [
                Node("gazebo", [("reference", "nowhere")], [Node("material", text="Gazebo/Red")]),
                Node("gazebo", [], [Node("plugin", [("name", "p"), ("filename", "p.so")])]),
                Node("ros2_control", [("name", "c"), ("type", "system")]),
                Node("mujoco", [], [Node("compiler", [("fusestatic", "false"), ("discardvisual", "false")])]),
                Node("mujoco", [], [Node("compiler", [("balanceinertia", "true")])]),
                Node("mujoco", [], [Node("compiler", [("strippath", "false")])]),
                Node("xacro:property", [("name", "a"), ("value", "1")]),
                Node("drake:joint", [("name", "x"), ("type", "ball")]),
                Node("sensor", [("name", "s")]),
                Node(
                    "gazebo",
                    [("reference", rng.choice([n.get("name") or "" for n in robot.all("link", "joint")] or [""]))],
                    [Node(rng.choice(["preserveFixedJoint", "disableFixedJointLumping"]), text="true")],
                ),
            ]
        )
    )
    return True
