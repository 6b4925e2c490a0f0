"""XML of unknown origin: what every reader refuses."""

from pathlib import Path

import pytest
from lxml import etree

from dh2urdf.documents.xml_elements import ForbiddenXmlError, xml_root
from dh2urdf.errors import Dh2UrdfError
from dh2urdf.meshes import load_scene
from dh2urdf_plugins.formats import foreign_mjcf, foreign_sdf, foreign_urdf, foreign_xacro

SEVEN = '<?xml version="1.0" encoding="UTF-7"?>\n'
FORBIDDEN = {
    "type": ('<!DOCTYPE {0}><{0} name="é"/>', "utf-8", "it has a document type"),
    "type in UTF-16": ('<!DOCTYPE {0}><{0} name="é"/>', "utf-16", "it has a document type"),
    "type in UTF-7": (
        SEVEN + '+ADwAIQ-DOCTYPE {0} [+ADwAIQ-ENTITY e "1">]><{0} name="&e;"/>',
        "ascii",
        "'UTF-7'|document type",
    ),
    "UTF-7": (SEVEN + '<{0} name="r"/>', "ascii", "it is encoded in 'UTF-7'"),
    "Windows": (
        '<?xml version="1.0" encoding="windows-1252"?>\n<{0} name="é"/>',
        "cp1252",
        "it is encoded in 'windows",
    ),
    "UTF-32": ('<{0} name="r"/>', "utf-32", "it is encoded in 'UTF-32"),
}


@pytest.mark.parametrize("is_deep", [False, True])
@pytest.mark.parametrize("kind", FORBIDDEN)
def test_forbidden_xml_is_refused(kind: str, *, is_deep: bool) -> None:
    """A document type is found in every encoding, and every encoding but four is refused."""
    text, encoding, _ = FORBIDDEN[kind]
    with pytest.raises(ForbiddenXmlError):
        xml_root(text.format("robot").encode(encoding), is_deep=is_deep)


@pytest.mark.parametrize(
    ("encoding", "name"),
    [
        ("utf-8", "UTF-8"),
        ("utf-8-sig", "utf-8"),
        ("utf-16", "UTF-16"),
        ("latin-1", "ISO-8859-1"),
        ("latin-1", "latin1"),
    ],
)
def test_four_encodings_are_read(encoding: str, name: str) -> None:
    """UTF-8 and UTF-16, with a mark or without, and Latin-1: the letters are what they were."""
    text = f'<?xml version="1.0" encoding="{name}"?>\n<robot name="é"/>'
    assert xml_root(text.encode(encoding)).get("name") == "é"
    assert xml_root(b'<?xml version="1.0" encoding="US-ASCII"?><robot name="e"/>').get("name") == "e"


@pytest.mark.parametrize("is_deep", [False, True])
def test_entities_of_the_first_element_are_no_memory(*, is_deep: bool) -> None:
    """A bomb in an attribute of the outermost element is refused before it goes off, in a deep tree too."""
    levels = "".join(f'<!ENTITY e{i + 1} "{f"&e{i};" * 10}">' for i in range(11))
    with pytest.raises(etree.XMLSyntaxError):
        xml_root(f'<!DOCTYPE r [<!ENTITY e0 "ha">{levels}]><r name="&e11;"/>'.encode(), is_deep=is_deep)


READERS = {
    "urdf": (foreign_urdf, "robot"),
    "xacro": (foreign_xacro, "robot"),
    "sdf": (foreign_sdf, "sdf"),
    "mjcf": (foreign_mjcf, "mujoco"),
}


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize("kind", ["type", "type in UTF-7", "UTF-7", "Windows"])
def test_every_description_is_refused_in_one_sentence(tmp_path: Path, reader: str, kind: str) -> None:
    """Readers of URDF, xacro, SDF and MJCF refuse the same, and name the file."""
    text, encoding, said = FORBIDDEN[kind]
    read, tag = READERS[reader]
    path = tmp_path / f"arm.{reader}"
    path.write_bytes(text.format(tag).encode(encoding))
    with pytest.raises(Dh2UrdfError, match=said) as caught:
        read(path)
    assert str(caught.value).startswith(f"{path}: error: ")


@pytest.mark.parametrize("entity", ['"0 0 0 1 0 0 0 1 0"', 'SYSTEM "file:///etc/hostname"'])
def test_mesh_with_a_hidden_entity_is_refused(entity: str) -> None:
    """A COLLADA mesh whose document type is written in UTF-7 is refused by its encoding: nothing of it is expanded."""
    pytest.importorskip("collada")
    text = SEVEN + f"<!DOCTYPE c [<!ENTITY x {entity}>]><COLLADA>&x;</COLLADA>".replace("<!", "+ADwAIQ-")
    with pytest.raises(ValueError, match="it is encoded in 'UTF-7'"):
        load_scene(text.encode(), ".dae", process=False)
