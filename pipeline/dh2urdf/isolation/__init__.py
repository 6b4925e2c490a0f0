"""Functions in a child process, which may crash, hang or leave, and may be shut off from the machine."""

from __future__ import annotations

from dh2urdf import late_names

TYPE_CHECKING = False
if TYPE_CHECKING:
    from dh2urdf.isolation.attribution import unmarked as unmarked
    from dh2urdf.isolation.child_process import (
        Child as Child,
        ChildFailure as ChildFailure,
        last_words as last_words,
        result_of as result_of,
        run_in_child as run_in_child,
    )
    from dh2urdf.isolation.encodings import PICKLED as PICKLED, Data as Data
    from dh2urdf.isolation.fence import enter as enter, tell_of_missing_wall as tell_of_missing_wall
    from dh2urdf.isolation.kept_children import KeptChildren as KeptChildren
    from dh2urdf.isolation.process import claim as claim, is_own as is_own
else:
    __all__, __getattr__, __dir__ = late_names(
        __name__,
        {
            "attribution": "unmarked",
            "child_process": "Child ChildFailure last_words result_of run_in_child",
            "encodings": "PICKLED Data",
            "fence": "enter tell_of_missing_wall",
            "kept_children": "KeptChildren",
            "process": "claim is_own",
        },
    )
