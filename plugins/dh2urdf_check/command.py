"""`dh2urdf check`: what each simulator will do with a robot description, and whether it is the arm of a table."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from dh2urdf.cli import SETTLED
from dh2urdf.cli.answers import answer
from dh2urdf.cli.shared_options import (
    DASH,
    NAME,
    PATH,
    StageCommand,
    catalog,
    files_and_arguments,
    given_description,
    given_options,
    given_table,
    option,
    package_paths_option,
    table_options,
    without_option,
)
from dh2urdf.documents.text_files import is_folder
from dh2urdf.errors import ConfigError
from dh2urdf.output.whole_files import write_whole
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.source import Mark, Messages, did_you_mean, printable
from dh2urdf.stages import Expansion
from dh2urdf_check.files import inspect_files, repaired

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from dh2urdf.kinematics.comparison import Agreement
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.robot import Robot
    from dh2urdf.stages import Finding

say = Messages(__file__)

EXIT_STATUS = (
    "Exit status: 0 no errors, and the arm of the table; 1 errors, or another arm; 2 the file or the table cannot be "
    "read, or the command line is wrong; 3 a plugin that is needed is broken."
)


@click.command(name="check", cls=StageCommand, kinds=("reader",), epilog=EXIT_STATUS)
@click.argument("words", nargs=-1, metavar="FILE… [NAME:=VALUE]…")
@package_paths_option
@option("--for", "simulators", multiple=True, metavar="SIMULATOR", help="Only what this one does; repeatable.")
@option("--against", "table", type=PATH, metavar="TABLE", help="Compare the kinematics with a DH table.")
@option("--base-link", metavar="LINK", help="Where the arm begins; the root.")
@option("--tip-link", metavar="LINK", help="Where it ends; tool0, flange, or its last link.")
@table_options
@option("--as", "format_name", metavar="NAME", help="Format of FILE, such as urdf; by FILE's suffix.")
@option("--no-ask", "is_silent", is_flag=True, help="Give the file to no simulator: only foretell what each will do.")
@option("--verbose", "is_whole", is_flag=True, help="Print every finding with all that is known of it.")
@option("--explain", "rule", metavar="RULE", help="Print what a rule means, and check no file.")
@option("--format", "form", type=click.Choice(["text", "json", "sarif"]), default="text", help="What is printed; text.")
@option("--json", "form", flag_value="json", help="The same as --format json.")
@option("--fix", "is_fixed", is_flag=True, help="Fix what is mechanical, write it to -o, and check that.")
@option("-o", "--out", type=PATH, metavar="FILE", help="Where --fix writes.")
@without_option
def command(  # noqa: PLR0917 - click hands everything over by name
    words: tuple[str, ...],
    package_paths: tuple[Path, ...],
    simulators: tuple[str, ...],
    table: Path | None,
    base_link: str | None,
    tip_link: str | None,
    format_name: str | None,
    is_silent: bool,  # noqa: FBT001 - click hands it over by name
    is_whole: bool,  # noqa: FBT001 - as before
    rule: str | None,
    form: str,
    is_fixed: bool,  # noqa: FBT001 - as before
    out: Path | None,
    **flags: str | None,
) -> int:
    """Say what each simulator will do with FILE, a URDF, xacro, SDF or MJCF of any origin.

    FILE may also be a folder: all descriptions and ROS packages in it are checked. The findings of several files are
    grouped by rule.

    With --fix, a URDF is written to -o with unit axes, limits in order, plain names, inertias for masses that have
    none, and an XML declaration; every other byte stays. The command prints what it fixed, and checks the new file.

    With --against, the description is also compared with a DH table, joint by joint: where they differ, it says by
    which base, tool, signs and offsets they would agree, in a form that can be put into the table. FILE or TABLE may
    be -, which is standard input; --as and --from then say its format.

    A xacro is expanded with the values that NAME:=VALUE gives to its arguments, where it can do no harm; it may include
    files of its own package, and of the packages that --package-path names.

    \b
    dh2urdf check robot.urdf
    dh2urdf check robot.urdf.xacro --for pybullet --for mujoco
    dh2urdf check ur.urdf.xacro ur_type:=ur10 --package-path ~/ws/src
    dh2urdf check ur5.urdf --against ur5.csv --tip-link ee_link
    dh2urdf check my_robots/ --format sarif > robots.sarif
    """
    if rule is not None:
        from dh2urdf_check.rules import explanation

        answer(explanation(rule))
        return 0
    if table is None:
        _refuse_without_table({"base_link": base_link, "tip_link": tip_link, **flags})
    installed = catalog()
    files, arguments = files_and_arguments(words)
    if is_fixed or out:
        files = [_fixed(installed, files, format_name, out if is_fixed else None)]
    is_one = len(files) == 1 and not is_folder(files[0])
    if not is_one:
        _refuse_for_several(files, table)
    elif DASH == str(files[0]) == str(table):
        raise ConfigError(say("stdin-twice", COMMAND_LINE))
    else:
        files = [given_description(files[0], format_name, installed)]
    manipulator = _manipulator(installed, table, flags) if table else None
    expansion = Expansion(arguments=arguments, package_paths=package_paths)
    asked = _asked(simulators, is_silent=is_silent)
    found = inspect_files(installed, files, format_name, expansion, asked)
    consumers = _chosen(simulators, found.consumers)
    findings = list(_only(found.findings, consumers))
    comparison = None
    from dh2urdf_check.reports import Report, as_json, as_sarif, comparison_finding, print_report

    if manipulator is not None and table is not None:
        agreement = _agreement(found.robot, manipulator, files[0], base_link, tip_link)
        comparison = (agreement, manipulator, Path(NAME) if str(table) == DASH else table)
        if apart := comparison_finding(agreement, manipulator):
            findings.append(replace(apart, mark=Mark(file=str(files[0]))))
    status = int(any(finding.severity == "error" for finding in findings))
    click.get_current_context().meta[SETTLED] = status  # Nothing can change it any more.
    report = Report(found, findings, consumers, comparison, is_one)
    if form == "json":
        answer(as_json(report))
    elif form == "sarif":
        answer(as_sarif(findings))
    else:
        print_report(report, is_whole=is_whole)
    return status


def _asked(simulators: Sequence[str], *, is_silent: bool) -> Sequence[str] | None:
    """Whom to give the files to; None for nobody, with a notice where the user has not asked for that."""
    if is_silent:
        return None
    from dh2urdf_check.ask.findings import why_unasked

    if why := why_unasked():
        click.echo(f"notice: {say('nobody-asked', reason=why).message}", err=True)
        return None
    return simulators


def _fixed(catalog: Catalog, files: Sequence[Path], format_name: str | None, out: Path | None) -> Path:
    """Writes a fixed file, and says what was fixed."""
    if out is None or len(files) != 1 or str(files[0]) == DASH or is_folder(files[0]):
        raise ConfigError(say("fix-of-one-file", COMMAND_LINE))
    repair = repaired(catalog, files[0], format_name)
    write_whole(out, repair.content)
    for change in repair.changes:
        click.echo(printable(f"{change.mark}: fixed: {change.message}"), err=True)
    count = len(repair.changes)
    click.echo(printable(f"{count or 'no'} fix{'' if count == 1 else 'es'}; written to {out}"), err=True)
    return out


def _refuse_without_table(options: Mapping[str, str | None]) -> None:
    """Options that say how a table is read and compared would do nothing without one."""
    context = click.get_current_context()
    parameters = context.command.get_params(context)
    given = [max(each.opts, key=len) for each in parameters if each.name and options.get(each.name) is not None]
    if given:
        verb = "is" if len(given) == 1 else "are"
        raise ConfigError(say("options-without-table", COMMAND_LINE, options=" and ".join(given), verb=verb))


def _refuse_for_several(files: Sequence[Path], table: Path | None) -> None:
    if not files:
        raise ConfigError(say("no-file", COMMAND_LINE))
    if table is not None:
        raise ConfigError(say("table-for-several", COMMAND_LINE))
    if DASH in map(str, files):
        raise ConfigError(say("stdin-among-several", COMMAND_LINE))


def _chosen(simulators: tuple[str, ...], known: Mapping[str, str]) -> dict[str, str]:
    """The consumers that are asked for, in their own order; all where none is named."""
    if unknown := {name: did_you_mean(name, known) for name in simulators if name not in known}:
        raise ConfigError(
            say("simulator-unknown", COMMAND_LINE, field="--for", found=name, suggestion=near, known=list(known))
            for name, near in unknown.items()
        )
    return {name: title for name, title in known.items() if not simulators or name in simulators}


def _only(findings: Sequence[Finding], consumers: Mapping[str, str]) -> Iterator[Finding]:
    """The findings that matter to some consumers, with their effects on these alone."""
    for finding in findings:
        effects = tuple(effect for effect in finding.effects if effect.consumer in consumers)
        if effects or not finding.effects:
            yield replace(finding, effects=effects)


def _manipulator(catalog: Catalog, table: Path, flags: Mapping[str, str | None]) -> Manipulator:
    from dh2urdf.commands.choices import read_manipulator, reader_call

    table, reader_name = given_table(table, flags["reader_name"], catalog)
    call = reader_call(catalog, table, reader_name, COMMAND_LINE, given_options(flags))
    return read_manipulator(call, table, flags["robot"], COMMAND_LINE)


def _agreement(
    robot: Robot | None, manipulator: Manipulator, file: Path, base_link: str | None, tip_link: str | None
) -> Agreement:
    from dh2urdf.kinematics.comparison import Agreement, compare

    if robot is not None:
        return compare(robot, manipulator, base_link=base_link, tip_link=tip_link)
    return Agreement(
        base_link=base_link or "",
        tip_link=tip_link or "",
        joints=(),
        difference=None,
        first_difference=f"{file.name} has no tree of links that could be compared",
    )
