"""Plugins: which are installed, what they provide, their options, and whose fault it is when one fails."""

from __future__ import annotations

from dh2urdf import late_names

TYPE_CHECKING = False
if TYPE_CHECKING:
    from dh2urdf.plugin_system.catalog import (
        KINDS as KINDS,
        Catalog as Catalog,
        Provided as Provided,
        load as load,
    )
    from dh2urdf.plugin_system.option_types import WrittenNumber as WrittenNumber, describe_options as describe_options
    from dh2urdf.plugin_system.records import RECORDS as RECORDS
    from dh2urdf.plugin_system.task_window import handed_over as handed_over
else:
    __all__, __getattr__, __dir__ = late_names(
        __name__,
        {
            "catalog": "Catalog KINDS Provided load",
            "option_types": "WrittenNumber describe_options",
            "records": "RECORDS",
            "task_window": "handed_over",
        },
    )
