"""XML from strangers as elements: the one parser of descriptions, meshes and manifests.

Nothing is expanded, fetched or guessed. A document type may declare entities, which name files or unfold to gigabytes,
and an odd encoding may hide one from a reader; so both are refused, as the parser itself has understood them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from lxml import etree

from dh2urdf.source import shown

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Set as AbstractSet

ENCODINGS = frozenset(
    {"utf-8", "utf8", "utf-16", "utf-16le", "utf-16be", "iso-8859-1", "latin1", "latin-1", "us-ascii", "ascii"}
)
"""The names of the encodings that are read, in small letters."""
ACCEPTED_XML = "XML in UTF-8, UTF-16, Latin-1 or ASCII without <!DOCTYPE>"
DOCUMENT_TYPE = "it has a document type (<!DOCTYPE>)"
"""What is wrong with a file that has one."""
_PIECE = 4096  # bytes until the first element, at a time


class ForbiddenXmlError(etree.XMLSyntaxError):
    """XML with a document type, or in another encoding than `ENCODINGS`; the text is a clause about the file."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason, etree.ErrorTypes.ERR_OK, 1, 1)  # type: ignore[call-arg]  # the stubs of lxml


def xml_root(content: bytes, *, is_deep: bool = False, recover: bool = False) -> etree._Element:
    """The outermost element of a text, without comments and processing instructions.

    Args:
        content: the text, in the encoding that it declares.
        is_deep: whether elements may be nested by the hundred, as the bodies of a long arm in MJCF are; lxml takes that
            for an attack otherwise.
        recover: whether what is not XML is passed over.

    Raises:
        etree.XMLSyntaxError: it is not XML; its `error_log` has the faults of this text.
        ForbiddenXmlError: it has a document type, or another encoding.
    """
    declares = _declares(content) if is_deep else None
    if declares:  # A deep tree is parsed without the bounds on what entities become.
        raise ForbiddenXmlError(DOCUMENT_TYPE)
    parser = etree.XMLParser(
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        remove_comments=True,
        remove_pis=True,
        huge_tree=declares is False,
        recover=recover,
    )
    try:
        root = etree.fromstring(content, parser)
    except etree.XMLSyntaxError as error:
        error.error_log = parser.error_log  # Its own has the faults of every text that this thread has parsed.
        raise
    about = root.getroottree().docinfo
    check_encoding(about.encoding)
    if about.internalDTD is not None:
        raise ForbiddenXmlError(DOCUMENT_TYPE)
    return root


def check_encoding(name: str | None) -> None:
    """Check the encoding that a parser has found; None where nothing is declared.

    Raises:
        ForbiddenXmlError: it is none of `ENCODINGS`.
    """
    if name is not None and name.lower() not in ENCODINGS:
        raise ForbiddenXmlError(f"it is encoded in {shown(name)}")


def _declares(content: bytes) -> bool | None:
    """Whether there is a document type before the first element; None where the parser gets to no element."""
    parser = etree.XMLPullParser(events=("start",), resolve_entities=False, no_network=True, load_dtd=False)
    for at in range(0, len(content), _PIECE):
        try:
            parser.feed(content[at : at + _PIECE])
        except etree.XMLSyntaxError:  # which the parser of the whole text reports, or takes
            return None
        for _, element in parser.read_events():
            return element.getroottree().docinfo.internalDTD is not None  # type: ignore[union-attr]  # an element
    return None


# --- Elements of a URDF that are for other programs -------------------------------------------------------------------

# What `ros2_control`, `transmission`, `gazebo` and the like mean is their programs' business. They are carried along as
# they are, but for the names of links and joints: an attribute or a text that is such a name, and nothing else, is one.

DEFINED = {
    "transmission": "name",
    "actuator": "name",
    "leftActuator": "name",
    "rightActuator": "name",
    "ros2_control": "name",
    "sensor": "name",
}
"""Elements that give a name, which is unique in a robot, and the attribute that has it."""
REFERENCES = {
    "gazebo[@reference]": "reference",
    "transmission/joint[@name]": "name",
    "transmission/leftJoint[@name]": "name",
    "transmission/rightJoint[@name]": "name",
    "ros2_control/joint[@name]": "name",
}
"""Elements that name a link or a joint, and the attribute that has the name."""


def lost_references(elements: Iterable[str], names: AbstractSet[str]) -> Iterator[tuple[str, str, str]]:
    """The references to links and joints that there are not: tag, attribute, and the name."""
    for text in elements:
        whole = etree.Element("robot")
        whole.append(etree.fromstring(text))
        for path, attribute in REFERENCES.items():
            for element in whole.iterfind(path):
                if (name := element.get(attribute, "")) not in names:
                    yield str(element.tag), attribute, name


def renamed(
    text: str, names: AbstractSet[str], rename: Callable[[str], str], keep: Callable[[str], str] = str
) -> etree._Element:
    """An element in which every name that it gives, and every name of these, is another one.

    Args:
        text: the element, which comes back without its comments.
        names: the names of links and joints that it may have.
        rename: what a name becomes.
        keep: what any other text becomes, for a format in which texts have a meaning of their own.
    """
    element = etree.fromstring(text)
    etree.strip_elements(element, etree.Comment, etree.ProcessingInstruction, with_tail=False)
    for each in element.iter(etree.Element):
        given = DEFINED.get(str(each.tag))
        if str(each.tag) == "sensor" and element.tag != "ros2_control":
            given = None  # one of Gazebo's, whose name is its link's business
        for attribute, value in each.items():
            is_name = attribute == given or value in names
            each.set(attribute, rename(str(value)) if is_name else keep(str(value)))
        inner = (each.text or "").strip()
        each.text = rename(inner) if inner in names else each.text and keep(each.text)
        each.tail = each.tail and keep(each.tail)
    return element


# --- Elements of an SRDF ----------------------------------------------------------------------------------------------

SRDF_NAMES: dict[str, dict[str, str]] = {
    "group": {"name": "group"},
    "group/link": {"name": "link"},
    "group/joint": {"name": "joint"},
    "group/group": {"name": "group"},
    "group/chain": {"base_link": "link", "tip_link": "link"},
    "group_state": {"group": "group"},
    "group_state/joint": {"name": "joint"},
    "end_effector": {"name": "end effector", "parent_link": "link", "group": "group", "parent_group": "group"},
    "passive_joint": {"name": "joint"},
    "joint_property": {"joint_name": "joint"},
    "disable_default_collisions": {"link": "link"},
    "enable_collisions": {"link1": "link", "link2": "link"},
    "disable_collisions": {"link1": "link", "link2": "link"},
}
"""What attributes name, by the path of their element below the robot (moveit/srdfdom, src/model.cpp)."""


class UnknownName(NamedTuple):
    """A name in an SRDF of what there is not."""

    line: int
    tag: str
    attribute: str
    kind: str  # what it should name: a link, a joint or a group
    name: str


def srdf_elements(content: bytes, known: Mapping[str, AbstractSet[str]]) -> tuple[dict[str, str], list[UnknownName]]:
    """The elements of an SRDF as XML, each with its tag, and their names of what there is not.

    Args:
        content: the text of the file.
        known: the names of all links and joints, by ``link`` and ``joint``.

    Raises:
        SyntaxError: it is no XML, as of `xml_root`, or no SRDF, or it has macros.
    """
    root = xml_root(content)
    if root.tag != "robot":
        raise ForbiddenXmlError(f"its outermost element is {root.tag!s}")
    if any("}" in str(each.tag) for each in root.iter()):
        raise ForbiddenXmlError("it has macros")
    known = {**known, "group": {each.get("name", "") for each in root.iterfind("group")}}
    unknown = [
        UnknownName(int(str(each.sourceline)), str(each.tag), attribute, kind, each.get(attribute, ""))
        for element in root
        for each, attribute, kind in _named(element)
        if not (name := each.get(attribute)) or name not in known.get(kind, {name})
    ]
    return {etree.tostring(each, encoding="unicode", with_tail=False): str(each.tag) for each in root}, unknown


def prefixed_srdf(text: str, prefix: str) -> etree._Element:
    """An element of an SRDF with a prefix before each name in it."""
    element = etree.fromstring(text)
    for each, attribute, _ in [*_named(element)]:
        each.set(attribute, prefix + each.get(attribute, ""))
    return element


def _named(element: etree._Element) -> Iterator[tuple[etree._Element, str, str]]:
    """The attributes of an element of an SRDF that name something, each with its element and what it names."""
    for each in (element, *element):
        path = str(element.tag) if each is element else f"{element.tag!s}/{each.tag!s}"
        for attribute, kind in SRDF_NAMES.get(path, {}).items():
            if each.get(attribute) or attribute != "parent_group":  # the only one that may be absent or empty
                yield each, attribute, kind
