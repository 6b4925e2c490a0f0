"""What a simulator has of an arm, measured and compared with the robot that was written."""

from __future__ import annotations

from dh2urdf import late_names

TYPE_CHECKING = False
if TYPE_CHECKING:
    from dh2urdf.measuring.comparison import (
        DOUBLE as DOUBLE,
        DOUBLE_PRECISION as DOUBLE_PRECISION,
        Body as Body,
        Comparison as Comparison,
        Precision as Precision,
        pose_error as pose_error,
    )
    from dh2urdf.measuring.opened_arm import load_function as load_function
else:
    __all__, __getattr__, __dir__ = late_names(
        __name__,
        {
            "comparison": "Body Comparison DOUBLE DOUBLE_PRECISION Precision pose_error",
            "opened_arm": "load_function",
        },
    )
