"""Files from strangers: YAML with the place of every value, and text in whatever encoding."""

from __future__ import annotations

from dh2urdf import late_names

TYPE_CHECKING = False
if TYPE_CHECKING:
    from dh2urdf.documents.archives import BROKEN_ARCHIVE as BROKEN_ARCHIVE
    from dh2urdf.documents.document import load_yaml as load_yaml, stream_yaml as stream_yaml
    from dh2urdf.documents.measures import MOST_TURNS as MOST_TURNS, measured as measured
    from dh2urdf.documents.nodes import Item as Item, Node as Node
    from dh2urdf.documents.text_files import (
        check_file as check_file,
        decoded as decoded,
        is_file as is_file,
        is_folder as is_folder,
        is_there as is_there,
        kind_of_file as kind_of_file,
        read_bytes as read_bytes,
        refuse_other_kind as refuse_other_kind,
    )
    from dh2urdf.documents.xml_elements import (
        ACCEPTED_XML as ACCEPTED_XML,
        DOCUMENT_TYPE as DOCUMENT_TYPE,
        SRDF_NAMES as SRDF_NAMES,
        ForbiddenXmlError as ForbiddenXmlError,
        check_encoding as check_encoding,
        lost_references as lost_references,
        prefixed_srdf as prefixed_srdf,
        renamed as renamed,
        srdf_elements as srdf_elements,
        xml_root as xml_root,
    )
    from dh2urdf.source import LONG_PATH as LONG_PATH
else:
    __all__, __getattr__, __dir__ = late_names(
        __name__,
        {
            "archives": "BROKEN_ARCHIVE",
            "document": "load_yaml stream_yaml",
            "measures": "MOST_TURNS measured",
            "nodes": "Item Node",
            "text_files": "LONG_PATH check_file decoded is_file is_folder is_there kind_of_file read_bytes "
            "refuse_other_kind",
            "xml_elements": "ACCEPTED_XML DOCUMENT_TYPE ForbiddenXmlError SRDF_NAMES check_encoding lost_references "
            "prefixed_srdf renamed srdf_elements xml_root",
        },
    )
