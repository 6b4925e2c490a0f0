"""The types of plain data: what `dh2urdf.run` returns, and what commands print with ``--json``.

Each class describes an object of a JSON Schema, which `dh2urdf schema` prints::

    from dh2urdf.results import RunReport

    report: RunReport = dh2urdf.run("ur5.yaml")
    for entry in report["manipulators"]:
        print(entry["name"], entry["status"])

A key that is not always there is `NotRequired`, as in the schema.
"""

from __future__ import annotations

from dh2urdf._faces import face

TYPE_CHECKING = False
if TYPE_CHECKING:
    from dh2urdf.results.commands import (
        BriefEntry as BriefEntry,
        BrokenPluginEntry as BrokenPluginEntry,
        ClashEntry as ClashEntry,
        ConversionEntry as ConversionEntry,
        ConversionsReport as ConversionsReport,
        ConvertedFileEntry as ConvertedFileEntry,
        Detail as Detail,
        DistanceEntry as DistanceEntry,
        ErrorReport as ErrorReport,
        FieldEntry as FieldEntry,
        FilledInEntry as FilledInEntry,
        InfoReport as InfoReport,
        JointDetail as JointDetail,
        JointEntry as JointEntry,
        MassEntry as MassEntry,
        OptionEntry as OptionEntry,
        Placement as Placement,
        PluginEntry as PluginEntry,
        PluginsReport as PluginsReport,
        RefusedPluginEntry as RefusedPluginEntry,
        ShadowedEntry as ShadowedEntry,
        StageEntry as StageEntry,
        StatedConvention as StatedConvention,
        StatedValue as StatedValue,
        UnitEntry as UnitEntry,
    )
    from dh2urdf.results.run import (
        ArmAxes as ArmAxes,
        AxesEntry as AxesEntry,
        ConventionName as ConventionName,
        CoverageEntry as CoverageEntry,
        FileEntry as FileEntry,
        InputEntry as InputEntry,
        JointTypeName as JointTypeName,
        KindName as KindName,
        LoadEntry as LoadEntry,
        ManipulatorEntry as ManipulatorEntry,
        MeshEntry as MeshEntry,
        OpwEntry as OpwEntry,
        ProblemEntry as ProblemEntry,
        ProofEntry as ProofEntry,
        Reproduction as Reproduction,
        RunReport as RunReport,
        SimulatorNotice as SimulatorNotice,
        VariationEntry as VariationEntry,
    )
else:
    __all__, __getattr__, __dir__ = face(
        __name__,
        {
            "commands": "BriefEntry BrokenPluginEntry ClashEntry ConversionEntry ConversionsReport ConvertedFileEntry "
            "Detail DistanceEntry ErrorReport FieldEntry FilledInEntry InfoReport JointDetail JointEntry "
            "MassEntry OptionEntry Placement PluginEntry PluginsReport RefusedPluginEntry ShadowedEntry "
            "StageEntry StatedConvention StatedValue UnitEntry",
            "run": "ArmAxes AxesEntry ConventionName CoverageEntry FileEntry InputEntry JointTypeName KindName "
            "LoadEntry ManipulatorEntry MeshEntry OpwEntry ProblemEntry ProofEntry Reproduction RunReport "
            "SimulatorNotice VariationEntry",
        },
    )
