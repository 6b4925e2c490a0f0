"""What can be wrong with a robot description: each function spoils a tree in one way, at random.

A function returns whether it found something to spoil. Those of `IN_THE_TEXT` change the bytes of the file.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from description_tree import Node

if TYPE_CHECKING:
    from collections.abc import Callable
    from random import Random

NUMBERS = (
    "nan", "NaN", "inf", "-inf", "1,5", "1.5.2", "0x10", "1e3", "1e400", "-1", "0", "-0.0", "1e-9", "1e-12", "1e9",
    "abc", "", "  ", "1 2", "1_000", ".5", "5.", "+1", "1e", "1d3", "--1", "1.0f", "1.5 m", "1/2", "½", " 1 ", "\t2",
    "1e-400", "0.1", "-0.5", "2", "100", "pi", "true",
)  # fmt: skip
VECTORS = (
    "0 0", "0 0 0 0", "1 2 3 4", "a b c", "", " ", "1,0,0", "0 0 nan", "0  0   1", "\t0\n0 1", "0 0 1 ", "1;2;3", "0 0 inf",
    "0 0 1e400", "0 0 0", "0 0 -1", "1 1 1", "0 0 1.5m", "0 0 x", "1", "0 0 2", "0.001 0 0", "1e-7 0 0", "1e-11 0 0", "0,0,1",
    "0 0 0x1", "1e5 0 0", "0 0 1 z", "0 -0 1",
)  # fmt: skip
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
NAMES = (
    "",
    " ",
    "two words",
    "a/b",
    "/a",
    "a::b",
    "ä",
    "a&b",
    "world",
    "a\tb",
    "a.b",
    "a-b",
    "0",
    "base_link ",
    "__model__",
    "a:b",
    "x" * 300,
    "x" * 1100,
    "名",
    "%s",
    "$(arg n)",
    "a'b",
    "a<b",
    "reference",
)
WORDS = {
    "type": (
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
    ),
}
VECTOR_ATTRIBUTES = {"xyz", "rpy", "size", "scale"}
NUMBER_ATTRIBUTES = {
    "lower", "upper", "effort", "velocity", "damping", "friction", "multiplier", "offset", "value", "ixx", "ixy", "ixz",
    "iyy", "iyz", "izz", "radius", "length",
}  # fmt: skip


def _places(robot: Node, wanted: set[str]) -> list[tuple[Node, str]]:
    return [(node, name) for node in robot.walk() for name, _ in node.attributes if name in wanted]


def _any(rng: Random, robot: Node, *tags: str) -> Node | None:
    found = [node for node in robot.walk() if node.tag in tags]
    return rng.choice(found) if found else None


def attribute_dropped(rng: Random, robot: Node) -> bool:
    nodes = [node for node in robot.walk() if node.attributes]
    if nodes:
        node = rng.choice(nodes)
        node.attributes.pop(rng.randrange(len(node.attributes)))
    return bool(nodes)


def attribute_emptied(rng: Random, robot: Node) -> bool:
    nodes = [node for node in robot.walk() if node.attributes]
    if nodes:
        node = rng.choice(nodes)
        node.set(rng.choice(node.attributes)[0], rng.choice(["", " "]))
    return bool(nodes)


def attribute_twice(rng: Random, robot: Node) -> bool:
    nodes = [node for node in robot.walk() if node.attributes]
    if nodes:
        node = rng.choice(nodes)
        node.attributes.append(rng.choice(node.attributes))
    return bool(nodes)


def attribute_unknown(rng: Random, robot: Node) -> bool:
    node = rng.choice(list(robot.walk()))
    node.attributes.append(rng.choice([("xzy", "0 0 1"), ("Name", "x"), ("foo", "1"), ("frame", "a"), ("a:b", "c")]))
    return True


def attribute_misspelt(rng: Random, robot: Node) -> bool:
    nodes = [node for node in robot.walk() if node.attributes]
    if nodes:
        node = rng.choice(nodes)
        index = rng.randrange(len(node.attributes))
        name, text = node.attributes[index]
        node.attributes[index] = (rng.choice([name.upper(), name + "s", name[:-1] or "x"]), text)
    return bool(nodes)


def number(rng: Random, robot: Node) -> bool:
    if places := _places(robot, NUMBER_ATTRIBUTES):
        # A tag at random first: most numbers of a file are those of inertias.
        node, name = (
            rng.choice(
                [p for p in places if p[0].tag == (t := rng.choice(sorted({p[0].tag for p in places})))] or places
            )
            if False
            else _by_tag(rng, places)
        )
        node.set(name, rng.choice(NUMBERS))
    return bool(places)


def _by_tag(rng: Random, places: list[tuple[Node, str]]) -> tuple[Node, str]:
    tag = rng.choice(sorted({node.tag for node, _ in places}))
    return rng.choice([place for place in places if place[0].tag == tag])


def vector(rng: Random, robot: Node) -> bool:
    if places := _places(robot, VECTOR_ATTRIBUTES):
        node, name = _by_tag(rng, places)
        node.set(name, rng.choice(VECTORS))
    return bool(places)


def colour(rng: Random, robot: Node) -> bool:
    node = _any(rng, robot, "color")
    if node is None:
        visual = _any(rng, robot, "visual")
        if visual is None:
            return False
        node = Node("color", [("rgba", "1 0 0 1")])
        visual.children.append(Node("material", [("name", rng.choice(["paint", "", "red"]))], [node]))
    node.set("rgba", rng.choice(COLOURS))
    return True


def material(rng: Random, robot: Node) -> bool:
    visual = _any(rng, robot, "visual")
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


def element_dropped(rng: Random, robot: Node) -> bool:
    parents = [node for node in robot.walk() if node.children]
    if parents:
        parent = rng.choice(parents)
        parent.children.pop(rng.randrange(len(parent.children)))
    return bool(parents)


def element_twice(rng: Random, robot: Node) -> bool:
    parents = [node for node in robot.walk() if node.children]
    if parents:
        parent = rng.choice(parents)
        new = rng.choice(parent.children).copy()
        if rng.random() < 0.5 and new.get("name"):
            new.set("name", f"{new.get('name')}_2")
        parent.children.insert(rng.randrange(len(parent.children) + 1), new)
    return bool(parents)


def elements_reordered(rng: Random, robot: Node) -> bool:
    parents = [node for node in robot.walk() if len(node.children) > 1]
    if parents:
        rng.shuffle(rng.choice(parents).children)
    return bool(parents)


def element_bare(rng: Random, robot: Node) -> bool:
    """An element without its attributes, such as `<axis/>`."""
    nodes = [node for node in robot.walk() if node.attributes and node is not robot]
    if nodes:
        tag = rng.choice(sorted({node.tag for node in nodes}))
        rng.choice([node for node in nodes if node.tag == tag]).attributes = []
    return bool(nodes)


def element_renamed(rng: Random, robot: Node) -> bool:
    node = rng.choice(list(robot.walk()))
    node.tag = rng.choice(
        [node.tag.capitalize(), node.tag + "s", node.tag + "_", "foo", "xacro:" + node.tag, "ns:" + node.tag]
    )
    return True


def element_unknown(rng: Random, robot: Node) -> bool:
    node = rng.choice(list(robot.walk()))
    new = rng.choice(
        [
            Node("foo"),
            Node("sensor", [("name", "s")]),
            Node("limits", [("lower", "0")]),
            Node("contact", [], [Node("lateral_friction", [("value", "1")])]),
            Node("ns:thing", [("a", "b")]),
        ]
    )
    node.children.insert(rng.randrange(len(node.children) + 1), new)
    return True


def text_inside(rng: Random, robot: Node) -> bool:
    rng.choice(list(robot.walk())).text = rng.choice(
        [
            "hello",
            "a & b",
            "&amp;",
            "<!-- a -- b -->",
            "<!-- fine -->",
            "<![CDATA[x]]>",
            "&nothing;",
            "<?pi x?>",
            "]]>",
            "<!---->",
            "é",
        ]
    )
    return True


def name_changed(rng: Random, robot: Node) -> bool:
    node = _any(rng, robot, "link", "joint", "material", "robot")
    if node is None:
        return False
    old, new = node.get("name"), rng.choice(NAMES)
    node.set("name", new)
    if node.tag == "link" and rng.random() < 0.8:  # the joints follow
        for end in robot.walk():
            if end.tag in {"parent", "child"} and end.get("link") == old:
                end.set("link", new)
    return True


def name_twice(rng: Random, robot: Node) -> bool:
    named = [node for node in robot.all("link", "joint", "material") if node.get("name")]
    if len(named) < 2:
        return False
    one, other = rng.sample(named, 2)
    one.set("name", other.get("name") or "")
    return True


def reference_broken(rng: Random, robot: Node) -> bool:
    places = [
        (n, a)
        for n in robot.walk()
        for a in ("link", "joint")
        if n.tag in {"parent", "child", "mimic"} and n.get(a) is not None
    ]
    if places:
        node, name = rng.choice(places)
        links = [link.get("name") or "" for link in robot.all("link")] or [""]
        node.set(
            name,
            rng.choice(["nowhere", "", "world", rng.choice(links), rng.choice(links), (node.get(name) or "") + " "]),
        )
    return bool(places)


def mimic(rng: Random, robot: Node) -> bool:
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
    limit = _any(rng, robot, "limit")
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
    nodes = [node for node in robot.walk() if node.tag == "inertia"]
    if not nodes:
        return False
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
        rng.choice([nodes[0]]).set(name, value) if len(nodes) == 1 else None
        nodes[0].set(name, value)
    rng.shuffle(nodes)
    return True


def mass(rng: Random, robot: Node) -> bool:
    inertial = _any(rng, robot, "inertial")
    if inertial is None:
        return False
    value = rng.choice(["0", "-1", "0.0", "1e-9", "1e-16", "1e12", "5"])
    if part := inertial.first("mass"):
        part.set("value", value)
    if rng.random() < 0.5 and (tensor := inertial.first("inertia")):
        for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"):
            tensor.set(name, "0")
    return True


def inertial(rng: Random, robot: Node) -> bool:
    """A link without its inertial, or with one of nothing."""
    link = _any(rng, robot, "link")
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
    link = _any(rng, robot, "link")
    if link is None:
        return False
    shapes = [
        Node("capsule", [("radius", "0.05"), ("length", "0.2")]), Node("box", [("size", "0.1 0.1 0.1")]), Node("box", [("size", "0 0.1 0.1")]),
        Node("cylinder", [("radius", "0"), ("length", "1")]), Node("cylinder", [("radius", "-1"), ("length", "1")]), Node("sphere", [("radius", "0")]),
        Node("sphere", [("radius", "1e-5")]), Node("sphere", [("radius", "-1")]), Node("cylinder", [("radius", "0.1")]), Node("plane", [("normal", "0 0 1")]), Node("plane"),
        Node("ellipsoid", [("size", "1 1 1")]), Node("cone", [("radius", "1")]), Node("sphere", [("radius", "0.1")]), Node("cylinder", [("radius", "0.1"), ("length", "0.2")]),
        Node("box"), Node("mesh"), Node("capsule"), Node("capsule", [("radius", "0"), ("length", "0")]),
    ]  # fmt: skip
    geometry = Node("geometry", [], [rng.choice(shapes)])
    if rng.random() < 0.1:
        geometry.children = rng.choice(
            [[], geometry.children + [rng.choice(shapes)], [Node("foo"), *geometry.children]]
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
    link = _any(rng, robot, "link")
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
    link = Node("link", [("name", "stray")])
    if rng.random() < 0.5:
        zeros = Node(
            "inertia", [(n, v) for n, v in zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), "100101", strict=True)]
        )
        link.children.append(Node("inertial", [], [Node("mass", [("value", "1")]), zeros]))
    robot.children.insert(rng.randrange(len(robot.children) + 1), link)
    return True


def joint_type(rng: Random, robot: Node) -> bool:
    joints = robot.all("joint")
    if joints:
        rng.choice(joints).set("type", rng.choice(WORDS["type"]))
    return bool(joints)


def joint_reversed(rng: Random, robot: Node) -> bool:
    joint = _any(rng, robot, "joint")
    parent, child = (joint.first("parent"), joint.first("child")) if joint else (None, None)
    if parent is None or child is None:
        return False
    parent.attributes, child.attributes = child.attributes, parent.attributes
    return True


def extension(rng: Random, robot: Node) -> bool:
    robot.children.append(rng.choice([
        Node("gazebo", [("reference", "nowhere")], [Node("material", text="Gazebo/Red")]), Node("gazebo", [], [Node("plugin", [("name", "p"), ("filename", "p.so")])]),
        Node("ros2_control", [("name", "c"), ("type", "system")]), Node("mujoco", [], [Node("compiler", [("fusestatic", "false"), ("discardvisual", "false")])]),
        Node("mujoco", [], [Node("compiler", [("balanceinertia", "true")])]), Node("mujoco", [], [Node("compiler", [("strippath", "false")])]),
        Node("xacro:property", [("name", "a"), ("value", "1")]), Node("drake:joint", [("name", "x"), ("type", "ball")]), Node("sensor", [("name", "s")]),
        Node("gazebo", [("reference", rng.choice([n.get("name") or "" for n in robot.all("link", "joint")] or [""]))], [Node(rng.choice(["preserveFixedJoint", "disableFixedJointLumping"]), text="true")]),
    ]))  # fmt: skip
    return True


IN_THE_TREE: tuple[Callable[[Random, Node], bool], ...] = (
    attribute_dropped, attribute_emptied, attribute_twice, attribute_unknown, attribute_misspelt, number, number, vector,
    vector, colour, material, element_dropped, element_dropped, element_twice, elements_reordered, element_bare,
    element_renamed, element_unknown, text_inside, name_changed, name_twice, reference_broken, mimic, transmission, limits,
    inertia, mass, inertial, shape, mesh, mesh, world, circle, root_added, joint_type, joint_reversed, extension,
)  # fmt: skip
HEAD = '<?xml version="1.0" encoding="utf-8"?>\n'

IN_THE_TEXT: dict[str, Callable[[str], bytes]] = {
    "plain": lambda text: (HEAD + text).encode(),
    "no declaration": lambda text: text.encode(),
    "BOM": lambda text: b"\xef\xbb\xbf" + (HEAD + text).encode(),
    "UTF-16": lambda text: (HEAD.replace("utf-8", "utf-16") + text).encode("utf-16"),
    "UTF-16 without BOM": lambda text: (HEAD.replace("utf-8", "utf-16") + text).encode("utf-16-le"),
    "UTF-32": lambda text: (HEAD.replace("utf-8", "utf-32") + text).encode("utf-32"),
    "Latin-1": lambda text: (
        HEAD.replace("utf-8", "iso-8859-1") + text.replace("robot", 'robot author="Jos\xe9"', 1)
    ).encode("latin-1", "replace"),
    "Latin-1 undeclared": lambda text: (HEAD + text.replace("robot", 'robot author="Jos\xe9"', 1)).encode(
        "latin-1", "replace"
    ),
    "leading newline": lambda text: ("\n" + HEAD + text).encode(),
    "leading text": lambda text: ("robot:\n" + HEAD + text).encode(),
    "two declarations": lambda text: (HEAD + HEAD + text).encode(),
    "comment first": lambda text: ("<!-- made by hand -->\n" + HEAD + text).encode(),
    "comment with --": lambda text: (HEAD + "<!-- a -- b -->\n" + text).encode(),
    "comment unclosed": lambda text: (HEAD + "<!-- a\n" + text).encode(),
    "DOCTYPE": lambda text: (HEAD + "<!DOCTYPE robot>\n" + text).encode(),
    "DOCTYPE with a DTD": lambda text: (HEAD + '<!DOCTYPE robot SYSTEM "robot.dtd">\n' + text).encode(),
    "entities": lambda text: (HEAD + '<!DOCTYPE robot [ <!ENTITY m "1"> ]>\n' + text).encode(),
    "entity used": lambda text: (
        HEAD + '<!DOCTYPE robot [ <!ENTITY m "1"> ]>\n' + text.replace('"0 0 ', '"0 &m; ', 1)
    ).encode(),
    "bare &": lambda text: (HEAD + text.replace("robot", 'robot author="A & B"', 1)).encode(),
    "unknown entity": lambda text: (HEAD + text.replace("robot", 'robot author="&eacute;"', 1)).encode(),
    "CRLF": lambda text: (HEAD + text).replace("\n", "\r\n").encode(),
    "CR": lambda text: (HEAD + text).replace("\n", "\r").encode(),
    "one line": lambda text: (HEAD + text).replace("\n", " ").encode(),
    "single quotes": lambda text: (HEAD + text).replace('"', "'").encode(),
    "quote missing": lambda text: (HEAD + text.replace('"', "", 1)).encode(),
    "no quotes": lambda text: (HEAD + text.replace('="1"', "=1")).encode(),
    "cut": lambda text: (HEAD + text)[: len(text) * 3 // 4].encode(),
    "end tag missing": lambda text: (HEAD + text.replace("</link>", "", 1)).encode(),
    "end tag wrong": lambda text: (HEAD + text.replace("</link>", "</Link>", 1)).encode(),
    "robot not closed": lambda text: (HEAD + text.rstrip().removesuffix("</robot>")).encode(),
    "text behind": lambda text: (HEAD + text + "hello\n").encode(),
    "comment behind": lambda text: (HEAD + text + "<!-- made by hand -->\n").encode(),
    "two robots": lambda text: (HEAD + text + text).encode(),
    "NUL inside": lambda text: (HEAD + text.replace("\n", "\n\0", 1)).encode(),
    "NUL behind": lambda text: (HEAD + text).encode() + b"\0",
    "control character": lambda text: (HEAD + text.replace("robot", 'robot author="\x01"', 1)).encode(),
    "namespace": lambda text: (
        HEAD + text.replace("<robot", '<robot xmlns:xacro="http://ros.org/wiki/xacro"', 1)
    ).encode(),
    "default namespace": lambda text: (HEAD + text.replace("<robot", '<robot xmlns="http://www.ros.org"', 1)).encode(),
    "prefix undeclared": lambda text: (HEAD + text.replace("</robot>", "<a:b/></robot>")).encode(),
    "wrapped": lambda text: (HEAD + f"<root>{text}</root>").encode(),
    "version 1.1": lambda text: (HEAD.replace("1.0", "1.1") + text).encode(),
    "declaration without version": lambda text: ('<?xml encoding="utf-8"?>\n' + text).encode(),
    "unknown encoding": lambda text: (HEAD.replace("utf-8", "klingon") + text).encode(),
    "processing instruction": lambda text: (HEAD + '<?xml-model href="x"?>\n' + text).encode(),
    "empty": lambda _: b"",
    "blank": lambda _: b"\n\n",
    "less-than in attribute": lambda text: (HEAD + text.replace("robot", 'robot author="a<b"', 1)).encode(),
    "attribute without value": lambda text: (HEAD + text.replace("<robot", "<robot checked", 1)).encode(),
    "no space between attributes": lambda text: (HEAD + text.replace('" ', '"', 1)).encode(),
    "spaces around =": lambda text: (HEAD + text.replace("=", " = ")).encode(),
    "long line": lambda text: (HEAD + text.replace("\n", " " * 9000 + "\n", 1)).encode(),
    "character reference": lambda text: (HEAD + text.replace("robot", 'robot author="&#233;&#x1F600;"', 1)).encode(),
    "bad character reference": lambda text: (HEAD + text.replace("robot", 'robot author="&#xZZ;"', 1)).encode(),
    "version attribute": lambda text: (HEAD + text.replace("<robot", '<robot version="1.0"', 1)).encode(),
    "version 2": lambda text: (HEAD + text.replace("<robot", '<robot version="2.0"', 1)).encode(),
    "version word": lambda text: (HEAD + text.replace("<robot", '<robot version="x"', 1)).encode(),
}
"""Ways to write a tree as the bytes of a file."""
