"""`dh2urdf extract` and `collisions`: the DH table of a description, and its pairs of links that need no check."""

from __future__ import annotations

import json
from operator import methodcaller
from typing import TYPE_CHECKING, Any

import click

from dh2urdf.cli import EXIT_STATUS, shared_options as shared
from dh2urdf.cli.answers import answer
from dh2urdf.cli.convert import print_notices
from dh2urdf.commands.choices import stage_calls
from dh2urdf.commands.extract import chains_of, description_reader, leaves_of, write_extracted
from dh2urdf.documents.text_files import check_file, is_there
from dh2urdf.errors import SCREENFUL, ConfigError, InputError, ManipulatorError
from dh2urdf.kinematics.facts import kinematic_facts
from dh2urdf.manipulator import Convention
from dh2urdf.output.whole_files import refuse_inputs, write_whole
from dh2urdf.plugin_system.calls import a_record, depending_on
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.quantities.units import UNITS
from dh2urdf.report.conversions import counted
from dh2urdf.source import Mark, Messages, printable
from dh2urdf.stages import Annotates, Annotation, Expansion, ReadsDescriptions
from dh2urdf.table_text.texts import table_text, transform_text

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from dh2urdf.commands.extract import Chains
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.plugin_system.calls import Call
    from dh2urdf.stages import Reader

say = Messages(__file__)

_LENGTHS, _ANGLES = click.Choice(("m", "cm", "mm")), click.Choice(("rad", "deg"))


@click.command(
    name="extract",
    cls=shared.StageCommand,
    kinds=("reader",),
    which=methodcaller("can", ReadsDescriptions),
    epilog=EXIT_STATUS,
)
@click.argument("words", nargs=-1, required=True, metavar="ROBOT [NAME:=VALUE…]")
@click.option("-o", "--output", "output", type=shared.PATH, metavar="TABLE", help="A .yaml or .csv file.")
@click.option("--convention", metavar="C", help="standard or modified; without it and without -o, both are printed.")
@click.option("--tips", "lists_tips", is_flag=True, help="List the leaves of ROBOT, and how many joints move each.")
@click.option("--length-unit", type=_LENGTHS, default="m", metavar="UNIT", help="Unit of lengths: m, cm or mm.")
@click.option("--angle-unit", type=_ANGLES, default="rad", metavar="UNIT", help="Unit of angles: rad or deg.")
@click.option("--from", "reader_name", metavar="NAME", help="Reader of ROBOT; by its suffix.")
@shared.package_paths_option
@shared.set_option("Any other option of the reader.")
@shared.quiet_option
@shared.without_option
def extract(
    words: tuple[str, ...],
    output: Path | None,
    convention: str | None,
    *,
    lists_tips: bool,
    quiet: bool,
    **flags: Any,  # noqa: ANN401 - of several options
) -> int:
    """Print the DH table of ROBOT, a URDF, xacro, SDF or MJCF of any origin, or write it; `-` is standard input.

    ROBOT may also be a table: its own arm is printed in either convention, with the rows that a person would write.

    The joints keep their names, order, directions and zeros: T(base → tip) is that of ROBOT for every joint vector. The
    table is measured against ROBOT's chain, and the file that -o writes is read back before it is put in place. What a
    table has no place for is named on standard error, and in the comments of the file. `dh2urdf convert` accepts ROBOT
    and the table alike.

    \b
    dh2urdf extract ur5.urdf
    dh2urdf extract ur5.urdf -o ur5.yaml --tip-link tool0
    dh2urdf extract panda.urdf -o panda.csv --convention modified --length-unit mm --angle-unit deg
    dh2urdf extract ur.urdf.xacro ur_type:=ur10 name:=arm --package-path ~/ws/src
    dh2urdf extract arm.csv --convention modified
    dh2urdf extract robot.urdf --tips
    dh2urdf extract robot.urdf -o chains.yaml --tip-link '*'
    xacro robot.urdf.xacro | dh2urdf extract - --from urdf
    """
    installed = shared.catalog()
    robot, arguments = shared.one_file_and_arguments(words)
    robot, reader = shared.given_table(robot, flags["reader_name"], installed)
    given = shared.given_options(flags).get("reader", {})
    if arguments:
        given["arguments"] = json.dumps(arguments)
    if paths := flags["package_paths"]:
        given["package_paths"] = json.dumps([str(path) for path in paths])
    units = {name: flags[name] for name in ("length_unit", "angle_unit")}

    def call(chosen: str | None = convention) -> Call[Reader[Any]]:
        about: Any = {"reader": reader, "given": {**given, "convention": chosen}, "settings": flags["settings"]}
        return description_reader(installed, robot, COMMAND_LINE, **about)

    if lists_tips:
        if output is not None:
            raise ConfigError(say("tips-write-nothing", COMMAND_LINE, found=str(output)))
        leaves = leaves_of(call(), robot).items()
        answer("\n".join(printable(f"{name}: {counted(count, 'moving joint')}") for name, count in leaves))
        return 0
    if output is not None:
        chains = chains_of(call(), robot)
        lost = write_extracted(chains.arms, output, installed, inputs=shared.files_behind([robot]), **units)
        if not quiet:
            print_notices([*(notice for arm in chains.arms for notice in arm.notices), *lost])
            for arm in chains.arms:
                told = f"{arm.name}: {counted(len(arm.moving_rows), 'moving joint')}, {arm.convention} convention"
                click.echo(printable(f"{told}; written to {output}"), err=True)
        return _print_refused([chains])
    both = [chains_of(call(each), robot) for each in ([convention] if convention else list(Convention))]
    if not quiet:
        print_notices(list(dict.fromkeys(notice for chains in both for arm in chains.arms for notice in arm.notices)))
    answer("\n\n".join("\n".join(map(printable, block)) for block in _blocks(both, **units)))
    return _print_refused(both)


def _print_refused(both: list[Chains]) -> int:
    """Name the chains that have no table on standard error, and why; the exit status."""
    refused = {item.name: item for chains in both for item in chains.refused}
    for name, item in refused.items():
        click.echo("\n".join(map(str, item.problems[:SCREENFUL])), err=True)
        click.echo(printable(f"{name}: no table"), err=True)
    return ManipulatorError.exit_status if refused else 0


def _blocks(both: list[Chains], length_unit: str, angle_unit: str) -> Iterator[list[str]]:
    """What is printed of each chain: its name where there are several, its tables, and what its axes say."""
    chains: dict[str, list[Manipulator]] = {}
    for arm in (arm for each in both for arm in each.arms):
        chains.setdefault(arm.name, []).append(arm)
    for name, same in chains.items():
        if len(chains) > 1 or any(each.refused for each in both):
            yield [name]
        for arm in same:
            yield [*_table(arm, length_unit, angle_unit)]
        if facts := kinematic_facts(same[0]).sentences():
            yield facts


def _table(arm: Manipulator, length_unit: str, angle_unit: str) -> Iterator[str]:
    """A table as people read it: a line for each row, then base and tool where they are not the identity."""
    text = table_text(arm, length_unit, angle_unit)
    fields = ["joint", "type", "a", "alpha", "d", "theta"]
    fields += ["follows"] if any(row.follows for row in arm.rows) else []
    units = {"a": length_unit, "d": length_unit, "alpha": angle_unit, "theta": angle_unit}
    heads = [f"{field} [{units[field]}]" if field in units else field for field in fields]
    cells = [heads, *([row.get(field, "") for field in fields] for row in text.rows)]
    widths = [max(len(row[column]) for row in cells) for column in range(len(fields))]
    yield f"{text.convention} convention"
    for row in cells:
        yield "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
    for name, pose in (("base", arm.base), ("tool", arm.tool)):
        if place := transform_text(pose, UNITS[length_unit], UNITS[angle_unit]):
            yield f"{name}: {place}"


# --- Collisions -------------------------------------------------------------------------------------------------------


@click.command(name="collisions", epilog=EXIT_STATUS)
@click.argument("words", nargs=-1, required=True, metavar="ROBOT [NAME:=VALUE…]")
@click.option("-o", "--output", "output", type=shared.PATH, metavar="SRDF", help="Where to write; what is in it stays.")
@click.option("--update", "earlier", type=shared.PATH, metavar="SRDF", help="Another file to begin with.")
@click.option("--trials", metavar="N", help="Random states in which a pair of Never does not touch; 10000.")
@click.option("--seed", metavar="N", help="Seed of the random states; 0.")
@click.option("--min-distance", metavar="D", help="A pair that comes nearer is not Never [m]; 0.01.")
@shared.package_paths_option
@shared.set_option("Any other option of the emitter.")
@shared.quiet_option
@shared.without_option
def collisions(
    words: tuple[str, ...],
    output: Path | None,
    earlier: Path | None,
    package_paths: tuple[Path, ...],
    settings: tuple[str, ...],
    *,
    quiet: bool,
    **flags: str | None,
) -> int:
    """Find the pairs of links of ROBOT, a URDF or xacro of any origin, whose collisions need no check, for MoveIt.

    The pairs and their reasons are those of MoveIt's setup assistant: Adjacent, Default, Always, Never. The same ROBOT
    and the same seed give the same pairs. The search needs pinocchio: pip install 'dh2urdf[pinocchio]'.

    Where SRDF exists, its pairs are brought up to date, and everything else in it stays as it is: groups, comments,
    formatting, and pairs with a reason of their own, such as User. With --update, the file to begin with is another
    one. Without -o, the SRDF goes to standard output.

    \b
    dh2urdf collisions robot.urdf -o robot.srdf
    dh2urdf collisions robot.urdf --update old.srdf -o new.srdf --seed 7
    dh2urdf collisions ur.urdf.xacro ur_type:=ur10 name:=arm --package-path ~/ws/src -o ur10.srdf
    """
    robot, arguments = shared.one_file_and_arguments(words)
    expansion = Expansion(arguments=arguments, package_paths=package_paths)
    if output is not None:
        refuse_inputs([output], [robot])
        if earlier is None and is_there(output):
            earlier = output
    for file in filter(None, (robot, earlier)):
        check_file(file, InputError)
    installed, target = shared.catalog(), output or earlier
    able: list[Any] = [item.stage for item in installed.provided("emitter") if item.stage.can(Annotates)]
    emitter: Any = (
        installed.emitter_for(target, "choose a name that ends in .srdf") if target else next(iter(able), None)
    )
    annotates: Annotates | None = emitter and emitter.can(Annotates)
    if emitter is None or annotates is None:
        suffixes = sorted({suffix for each in able for suffix in each.suffixes})
        code, mark = ("format-without-pairs", Mark(file=str(target))) if target else ("no-emitter-of-pairs", None)
        raise ConfigError(say(code, mark, suffixes=suffixes))
    (call,) = stage_calls(installed, {"emitter": [emitter]}, COMMAND_LINE, {"emitter": flags}, settings)["emitter"]
    with depending_on(call, "annotate"):
        made: Annotation = a_record(annotates.annotate(robot, expansion, earlier, call.options), Annotation)
    if not quiet:
        print_notices(made.notices)
    if output is None:
        answer(made.content, nl=False)
    else:
        write_whole(output, made.content)
    if not quiet:
        written = f"; written to {output}" if output else ""
        click.echo(printable(f"{robot.name}: {made.summary}{written}"), err=True)
    return 0
