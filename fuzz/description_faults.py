"""What can be wrong with a robot description: each function spoils a tree in one way, at random.

A function returns whether it found something to spoil.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import robot_faults
from description_tree import Node, any_of

if TYPE_CHECKING:
    from collections.abc import Callable
    from random import Random

NUMBERS = (
    "nan",
    "NaN",
    "inf",
    "-inf",
    "1,5",
    "1.5.2",
    "0x10",
    "1e3",
    "1e400",
    "-1",
    "0",
    "-0.0",
    "1e-9",
    "1e-12",
    "1e9",
    "abc",
    "",
    "  ",
    "1 2",
    "1_000",
    ".5",
    "5.",
    "+1",
    "1e",
    "1d3",
    "--1",
    "1.0f",
    "1.5 m",
    "1/2",
    "½",
    " 1 ",
    "\t2",
    "1e-400",
    "0.1",
    "-0.5",
    "2",
    "100",
    "pi",
    "true",
)
VECTORS = (
    "0 0",
    "0 0 0 0",
    "1 2 3 4",
    "a b c",
    "",
    " ",
    "1,0,0",
    "0 0 nan",
    "0  0   1",
    "\t0\n0 1",
    "0 0 1 ",
    "1;2;3",
    "0 0 inf",
    "0 0 1e400",
    "0 0 0",
    "0 0 -1",
    "1 1 1",
    "0 0 1.5m",
    "0 0 x",
    "1",
    "0 0 2",
    "0.001 0 0",
    "1e-7 0 0",
    "1e-11 0 0",
    "0,0,1",
    "0 0 0x1",
    "1e5 0 0",
    "0 -0 1",
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
VECTOR_ATTRIBUTES = {"xyz", "rpy", "size", "scale"}
NUMBER_ATTRIBUTES = {
    "lower",
    "upper",
    "effort",
    "velocity",
    "damping",
    "friction",
    "multiplier",
    "offset",
    "value",
    "ixx",
    "ixy",
    "ixz",
    "iyy",
    "iyz",
    "izz",
    "radius",
    "length",
}


def _places(robot: Node, wanted: set[str]) -> list[tuple[Node, str]]:
    return [(node, name) for node in robot.walk() for name, _ in node.attributes if name in wanted]


def attribute_dropped(rng: Random, robot: Node) -> bool:
    """An attribute is gone."""
    nodes = [node for node in robot.walk() if node.attributes]
    if nodes:
        node = rng.choice(nodes)
        node.attributes.pop(rng.randrange(len(node.attributes)))
    return bool(nodes)


def attribute_emptied(rng: Random, robot: Node) -> bool:
    """An attribute is empty or blank."""
    nodes = [node for node in robot.walk() if node.attributes]
    if nodes:
        node = rng.choice(nodes)
        node.set(rng.choice(node.attributes)[0], rng.choice(["", " "]))
    return bool(nodes)


def attribute_twice(rng: Random, robot: Node) -> bool:
    """An attribute stands twice."""
    nodes = [node for node in robot.walk() if node.attributes]
    if nodes:
        node = rng.choice(nodes)
        node.attributes.append(rng.choice(node.attributes))
    return bool(nodes)


def attribute_unknown(rng: Random, robot: Node) -> bool:
    """An attribute that there is not."""
    node = rng.choice(list(robot.walk()))
    node.attributes.append(rng.choice([("xzy", "0 0 1"), ("Name", "x"), ("foo", "1"), ("frame", "a"), ("a:b", "c")]))
    return True


def attribute_misspelt(rng: Random, robot: Node) -> bool:
    """An attribute with another name."""
    nodes = [node for node in robot.walk() if node.attributes]
    if nodes:
        node = rng.choice(nodes)
        index = rng.randrange(len(node.attributes))
        name, text = node.attributes[index]
        node.attributes[index] = (rng.choice([name.upper(), name + "s", name[:-1] or "x"]), text)
    return bool(nodes)


def number(rng: Random, robot: Node) -> bool:
    """Another text for a number."""
    if places := _places(robot, NUMBER_ATTRIBUTES):
        node, name = _by_tag(rng, places)
        node.set(name, rng.choice(NUMBERS))
    return bool(places)


def _by_tag(rng: Random, places: list[tuple[Node, str]]) -> tuple[Node, str]:
    """A tag at random first: most numbers of a file are those of inertias."""
    tag = rng.choice(sorted({node.tag for node, _ in places}))
    return rng.choice([place for place in places if place[0].tag == tag])


def vector(rng: Random, robot: Node) -> bool:
    """Another text for a vector."""
    if places := _places(robot, VECTOR_ATTRIBUTES):
        node, name = _by_tag(rng, places)
        node.set(name, rng.choice(VECTORS))
    return bool(places)


def element_dropped(rng: Random, robot: Node) -> bool:
    """An element is gone."""
    parents = [node for node in robot.walk() if node.children]
    if parents:
        parent = rng.choice(parents)
        parent.children.pop(rng.randrange(len(parent.children)))
    return bool(parents)


def element_twice(rng: Random, robot: Node) -> bool:
    """An element stands twice."""
    parents = [node for node in robot.walk() if node.children]
    if parents:
        parent = rng.choice(parents)
        new = rng.choice(parent.children).copy()
        if rng.random() < 0.5 and new.get("name"):
            new.set("name", f"{new.get('name')}_2")
        parent.children.insert(rng.randrange(len(parent.children) + 1), new)
    return bool(parents)


def elements_reordered(rng: Random, robot: Node) -> bool:
    """Elements in another order."""
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
    """An element with another name."""
    node = rng.choice(list(robot.walk()))
    node.tag = rng.choice(
        [node.tag.capitalize(), node.tag + "s", node.tag + "_", "foo", "xacro:" + node.tag, "ns:" + node.tag]
    )
    return True


def element_unknown(rng: Random, robot: Node) -> bool:
    """An element that there is not."""
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
    """A text, comment or the like in an element."""
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
    """Another name."""
    node = any_of(rng, robot, "link", "joint", "material", "robot")
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
    """Two of one name."""
    named = [node for node in robot.all("link", "joint", "material") if node.get("name")]
    if len(named) < 2:
        return False
    one, other = rng.sample(named, 2)
    one.set("name", other.get("name") or "")
    return True


def reference_broken(rng: Random, robot: Node) -> bool:
    """A reference to what is not there, or to something else."""
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


IN_THE_TREE: tuple[Callable[[Random, Node], bool], ...] = (
    attribute_dropped,
    attribute_emptied,
    attribute_twice,
    attribute_unknown,
    attribute_misspelt,
    number,
    number,
    vector,
    vector,
    robot_faults.colour,
    robot_faults.material,
    element_dropped,
    element_dropped,
    element_twice,
    elements_reordered,
    element_bare,
    element_renamed,
    element_unknown,
    text_inside,
    name_changed,
    name_twice,
    reference_broken,
    robot_faults.mimic,
    robot_faults.transmission,
    robot_faults.limits,
    robot_faults.inertia,
    robot_faults.mass,
    robot_faults.inertial,
    robot_faults.shape,
    robot_faults.mesh,
    robot_faults.mesh,
    robot_faults.world,
    robot_faults.circle,
    robot_faults.root_added,
    robot_faults.joint_type,
    robot_faults.joint_reversed,
    robot_faults.extension,
)
