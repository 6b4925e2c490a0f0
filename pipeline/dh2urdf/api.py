"""The commands as functions: `import dh2urdf` gives all that is here.

What goes wrong is raised as one of `dh2urdf.errors`, with the text that the command line would print.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.commands.arguments import check_arguments, path_or_none, settings_of, several, word_of, words_of
from dh2urdf.commands.choices import reader_call
from dh2urdf.commands.convert import Conversion, plan_conversion
from dh2urdf.commands.given_tables import as_file, read_table
from dh2urdf.conversion.one_manipulator import read_items
from dh2urdf.documents.text_files import check_file
from dh2urdf.errors import ConfigError, InputError
from dh2urdf.manipulator import Manipulator
from dh2urdf.plugin_system.calls import warn_of
from dh2urdf.plugin_system.catalog import load
from dh2urdf.robot import Robot
from dh2urdf.source import Mark, Messages

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from dh2urdf.commands.given_tables import Source, StrPath
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.results import RunReport
    from dh2urdf.stages import Inspection, Rejected

say = Messages(__file__)


def read(table: Source, *, robot: str | None = None, reader: str | None = None, **options: object) -> Manipulator:
    """The manipulator of a table.

    ::

        arm = dh2urdf.read("panda.csv", convention="modified", angle_unit="deg")

    Args:
        table: the table's file; or its text of several lines, its bytes, or a stream such as an open file.
        robot: which manipulator is meant, where the table holds several.
        reader: name of the reader, such as ``csv`` or ``yaml``; without it the file's suffix says it.
        options: options of the reader, such as what the table does not say itself.

    Returns:
        The manipulator. Its notices are also given as `TableWarning`.

    Raises:
        TableError: the manipulator cannot be read, there is none, or which of several is not said.
        ConfigError: an option is unknown or its value wrong, or the file is a run file.
        InputError: no installed reader takes the file.
        PluginError: the reader's plugin is broken, or something it needs is not installed.
    """
    arm = read_table(table, robot, reader, options, Mark(file="dh2urdf.read()"))
    warn_of(arm.notices)
    return arm


def read_all(table: Source, *, reader: str | None = None, **options: object) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a table one by one, none of them held: there may be a million.

    One that cannot be read is a `Rejected` in its place, with its problems, and the others go on. Notices are in
    `notices` only.

    Args:
        table: the table's file; or its text, its bytes, or a stream, as `read` takes them.
        reader: name of the reader; without it the file's suffix says it.
        options: options of the reader.

    Raises:
        TableError: the file as a whole cannot be read, which may show only on the way.
        ConfigError: an option is unknown or its value wrong.
        InputError: no installed reader takes the file.
        PluginError: the reader's plugin is broken, or something it needs is not installed.
    """
    mark, catalog = Mark(file="dh2urdf.read_all()"), load()
    check_arguments("name", mark, reader=reader)
    with ExitStack() as stack:
        path = stack.enter_context(as_file(table, "reader", reader, catalog, "reader=NAME"))
        call = reader_call(catalog, path, reader, mark, {"reader": words_of(options)})
        return _while_open(read_items(call, path), stack.pop_all())


def _while_open(items: Iterator[Manipulator | Rejected], stack: ExitStack) -> Iterator[Manipulator | Rejected]:
    """Items of a file that is there until the last of them."""
    with stack:
        yield from items


def extract(
    description: Source, out: StrPath | None = None, *, reader: str | None = None, **options: object
) -> Manipulator:
    """The DH table of a robot description, as `dh2urdf extract` makes it.

    ::

        arm = dh2urdf.extract("ur5.urdf", tip_link="tool0")
        dh2urdf.extract("panda.urdf", "panda.yaml", convention="modified")

    Args:
        description: the file; or its text of several lines, its bytes, or a stream.
        out: a .yaml or .csv file to write; without it nothing is written.
        reader: name of the reader, such as ``urdf``; without it the file's suffix says it.
        options: options of the reader: ``convention``, ``base_link``, ``tip_link``, ``tolerance``, ``near_parallel``,
            ``rounded_pi``, ``origins``, ``package_paths``; of a xacro also ``arguments``.

    Returns:
        The manipulator. Its notices say how far the table is from the file's chain, and what it and the written file
        leave out.

    Raises:
        TableError: the description cannot be read, or there is no chain, or which one is meant is not said.
        ConfigError: an option is unknown or its value wrong, or the file is a table.
        InputError: no installed reader takes the file.
        OutputError: the table cannot be written.
        PluginError: the reader's plugin is broken, or something it needs is not installed.
    """
    from dh2urdf.commands.extract import description_reader, the_one, write_extracted
    from dh2urdf.fields import replace_unchecked

    mark, catalog = Mark(file="dh2urdf.extract()"), load()
    check_arguments("name", mark, reader=reader)
    target = path_or_none("out", out, mark)
    with as_file(description, "reader", reader, catalog, "reader=NAME") as path:
        arm = the_one(description_reader(catalog, path, mark, reader=reader, given=words_of(options)), path)
        if target is not None:
            others = write_extracted([arm], Path(target), catalog, inputs=[path])
            arm = replace_unchecked(arm, notices=(*arm.notices, *others))
    return arm


def convert(
    table: Source | Manipulator,
    out: StrPath | None = None,
    *,
    formats: str | Iterable[str] = (),
    robot: str | None = None,
    meshes: str | None = None,
    convert_meshes: str | None = None,
    reader: str | None = None,
    transform: str | None = None,
    edits: Iterable[str | Mapping[str, object]] = (),
    without: Iterable[str] = (),
    **options: object,
) -> Conversion:
    """Turn one table into robot descriptions and prove that they are the same arm, as `dh2urdf convert` does.

    ::

        dh2urdf.convert("ur5.csv", "ur5.urdf")
        text = dh2urdf.convert("ur5.csv", frames="dh").text
        dh2urdf.convert(arm, "build/ur5", formats=["urdf", "xacro"])

    Args:
        table: the table's file, its text, bytes or stream as `read` takes them, or a manipulator.
        out: the file to write; its suffix chooses the format where `formats` does not. With several formats it is
            the folder to write into. Without it nothing is written, and each format is a single file of the result.
        formats: the name of an emitter, or several; URDF without any.
        robot: which manipulator is meant, where the table holds several.
        meshes: ``relative`` (copies beside the file), ``file`` (file:// paths) or ``package://NAME``.
        convert_meshes: ``auto`` (OBJ), ``hull`` or ``decomposition`` (OBJ, and what touches is convex), or ``never``.
        reader: name of the reader; without it the table's suffix says it.
        transform: name of the transform.
        edits: names of edits, or mappings such as ``{"payload": {"mass": 2.5}}``.
        without: plugins or distributions to leave out.
        options: any options of the stages: each goes to the stage that has it, `frames` to the transform and
            `convention` to the reader. One that several kinds of stages have is named with its kind:
            ``**{"emitter.profile": "ros"}``.

    Returns:
        The manipulator, its robot, the files and the proofs. Its notices are also given as `TableWarning`; not those of
        a manipulator that was read before.

    Raises:
        TableError: the table cannot be read, or no robot can be made of it.
        ConfigError: an argument is unknown or its value wrong.
        InputError: no installed reader or emitter takes a file's suffix, or none has the name.
        EmitterError: an emitter failed.
        ProofError: what was written is not the arm of the table; it is not put in place.
        OutputError: the files cannot be written.
        PluginError: a plugin that is needed is broken, or something it needs is not installed.
    """
    mark = Mark(file="dh2urdf.convert()")
    chosen = {"reader": reader, "transform": transform, "meshes": meshes, "convert_meshes": convert_meshes}
    check_arguments("name", mark, robot=robot, **chosen)
    target = path_or_none("out", out, mark)
    catalog = _catalog(without, mark)
    with ExitStack() as stack:
        if not isinstance(table, Manipulator):
            table = stack.enter_context(as_file(table, "reader", reader, catalog, "reader=NAME"))
        made = plan_conversion(
            table,
            None if target is None else Path(target),
            mark,
            catalog,
            reader=reader,
            transform=transform,
            formats=several("formats", formats, mark, kind="name"),
            robot=robot,
            settings=settings_of(options),
            meshes=meshes,
            convert_meshes=convert_meshes,
            edits=map(word_of, several("edits", edits, mark, one=(str, Mapping))),
        )()
    # The notices of a manipulator that is given were given with it.
    warn_of(made.robot.notices if isinstance(table, Manipulator) else made.notices)
    return made


def check(
    description: Source | Robot,
    *,
    emitter: str | None = None,
    arguments: Mapping[str, str] | None = None,
    package_paths: Iterable[StrPath] = (),
    ask: bool = False,
    without: Iterable[str] = (),
) -> Inspection:
    """What each simulator will do with a robot description of any origin, as `dh2urdf check` finds it.

    ::

        for finding in dh2urdf.check("robot.urdf").findings:
            print(finding.severity, finding.mark, finding.message)

    Args:
        description: the file; or its text of several lines, its bytes, or a stream; or a robot, as URDF.
        emitter: name of the emitter that knows the format, such as ``urdf``; without it the file's suffix says it.
        arguments: values of a xacro's arguments.
        package_paths: folders of ROS packages, or folders that hold some: a xacro may include their files,
            and ``package://`` addresses are looked for there.
        ask: whether to give the file to the simulators that are installed, as the command does: what they do is seen
            then, and what the others do is foretold.
        without: plugins or distributions to leave out.

    Returns:
        The findings, in the order of the file, and the simulators that were thought of.

    Raises:
        InputError: the file cannot be read.
        ConfigError: files of the format cannot be checked, or the format of a text is not said.
        PluginError: a plugin that is needed is broken.
    """
    from dh2urdf.commands.check import inspect
    from dh2urdf.commands.written import write_description
    from dh2urdf.stages import Expansion

    mark = Mark(file="dh2urdf.check()")
    check_arguments("name", mark, emitter=emitter)
    folders = several("package_paths", package_paths, mark, one=(str, PathLike), kind="path")
    check_arguments("mapping", mark, arguments=arguments)
    catalog = _catalog(without, mark)
    if isinstance(description, Robot):
        usual = catalog.usual("emitter")
        if emitter not in (None, usual.name):
            raise ConfigError(say("robot-checked-as-other", mark, usual=usual.name, emitter=emitter))
        emitter = usual.name
        description = write_description(description, usual.suffixes[0], None, {}, str(mark))
    with as_file(description, "emitter", emitter, catalog, "emitter=NAME") as path:
        check_file(path, InputError)
        expansion = Expansion(
            arguments={name: str(value) for name, value in (arguments or {}).items()},
            package_paths=tuple(map(Path, folders)),
        )
        return inspect(catalog, path, emitter, "`emitter=NAME`", expansion, ask=ask)


def run(
    config: StrPath | Mapping[str, object],
    out: StrPath | None = None,
    *,
    settings: Mapping[str, object] | None = None,
    resume: bool = False,
    dry_run: bool = False,
    keep: bool = False,
    without: Iterable[str] = (),
) -> RunReport:
    """Do the run that a run file describes, as `dh2urdf run` does.

    ::

        report = dh2urdf.run("ur5.yaml", settings={"execution.options.workers": 4})
        report["manipulators"][0]["proof"]["urdf"]["position_error"]

    Args:
        config: the run file; or its contents as a mapping, whose paths start at the working directory.
        out: where to, not where the run file says: a folder or an address such as ``s3://bucket/prefix``.
        settings: changes of the run file, as ``--set`` takes them: ``{"transform.options.frames": "dh"}``.
        resume: keep what an earlier run has finished and what has not changed since.
        dry_run: read and check everything, write nothing.
        keep: leave the files of the last run into the same folder that this one does not write. Without it they are
            removed at the end; a file that was changed meanwhile stays.
        without: plugins or distributions to leave out.

    Returns:
        The report, which is the content of `report.json`; `dh2urdf.results` has the types. Its `exit_status` is 0 where
        all is done, and 1 where a manipulator failed: the others are written, and you decide what to do about it.

    Raises:
        ConfigError: something in the run file is wrong; all problems are reported at once, before anything is written.
        TableError: nothing could be read at all.
        OutputError: nothing can be written where it should go.
        ExecutorError: nobody does the work.
        PluginError: the run needs a plugin that is broken, or something it needs is not installed.
    """
    from dh2urdf.running.run import execute, load_plan

    mark, root = Mark(file="dh2urdf.run()"), None
    check_arguments("flag", mark, resume=resume, dry_run=dry_run, keep=keep)
    check_arguments("mapping", mark, settings=settings)
    output = path_or_none("out", out, mark)
    catalog = _catalog(without, mark)
    if isinstance(config, Mapping):
        from dh2urdf.documents.document import load_yaml

        root = load_yaml(word_of(config), str(mark), ConfigError)
        config = "run"
    check_arguments("path", mark, config="" if config is None else config)
    plan = load_plan(Path(config), catalog, settings_of(settings), output, root, mark=mark)
    _, report = execute(plan, resume=resume, dry_run=dry_run, keep=keep)
    return report


def _catalog(without: Iterable[str], mark: Mark) -> Catalog:
    """What is installed, without what is to be left out."""
    try:
        return load(several("without", without, mark, kind="name"))
    except ConfigError as error:
        raise ConfigError(replace(problem, mark=mark, field="without") for problem in error.problems) from None
