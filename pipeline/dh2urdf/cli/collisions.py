"""`dh2urdf collisions`: the pairs of links that need no collision check."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from dh2urdf.cli import EXIT_STATUS
from dh2urdf.cli.answers import answer
from dh2urdf.cli.convert import print_notices
from dh2urdf.cli.shared_options import (
    PATH,
    catalog,
    one_file_and_arguments,
    option,
    package_paths_option,
    quiet_option,
    set_option,
    without_option,
)
from dh2urdf.commands.choices import stage_calls
from dh2urdf.documents.text_files import check_file, is_there
from dh2urdf.errors import ConfigError, InputError
from dh2urdf.output.whole_files import refuse_inputs, write_whole
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.source import Mark, Messages, printable
from dh2urdf.stage_calls.calls import a_record, depending_on
from dh2urdf.stages import Annotates, Annotation, Expansion

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.plugin_system.catalog import Catalog

say = Messages(__file__)

OPTIONS = ("trials", "seed", "min_distance")


@click.command(name="collisions", epilog=EXIT_STATUS)
@click.argument("words", nargs=-1, required=True, metavar="ROBOT [NAME:=VALUE…]")
@option("-o", "--output", "output", type=PATH, metavar="SRDF", help="Where to write; what is in it stays.")
@option("--update", "earlier", type=PATH, metavar="SRDF", help="Another file to begin with.")
@option("--trials", metavar="N", help="Random states in which a pair of Never does not touch; 10000.")
@option("--seed", metavar="N", help="Seed of the random states; 0.")
@option("--min-distance", metavar="D", help="A pair that comes nearer is not Never [m]; 0.01.")
@package_paths_option
@set_option("Any other option of the emitter.")
@quiet_option
@without_option
def command(  # noqa: PLR0917 - click hands everything over by name
    words: tuple[str, ...],
    output: Path | None,
    earlier: Path | None,
    package_paths: tuple[Path, ...],
    settings: tuple[str, ...],
    quiet: bool,  # noqa: FBT001 - click hands flags over so
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
    robot, arguments = one_file_and_arguments(words)
    expansion = Expansion(arguments=arguments, package_paths=package_paths)
    if output is not None:
        refuse_inputs([output], [robot])
        if earlier is None and is_there(output):
            earlier = output
    for file in filter(None, (robot, earlier)):
        check_file(file, InputError)
    installed = catalog()
    emitter, annotates = _emitter(installed, output or earlier)
    given = {"emitter": {name: flags[name] for name in OPTIONS}}
    (call,) = stage_calls(installed, {"emitter": [emitter]}, COMMAND_LINE, given, settings)["emitter"]
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


def _emitter(catalog: Catalog, file: Path | None) -> tuple[Any, Annotates]:
    """The emitter of a file's format; where there is no file, the first that annotates."""
    able: list[Any] = [item.stage for item in catalog.provided("emitter") if item.stage.can(Annotates)]
    chosen: Any = catalog.emitter_for(file, "choose a name that ends in .srdf") if file else next(iter(able), None)
    if chosen is not None and (annotates := chosen.can(Annotates)):
        return chosen, annotates
    suffixes = sorted({suffix for each in able for suffix in each.suffixes})
    if file is None:
        raise ConfigError(say("no-emitter-of-pairs", suffixes=suffixes))
    raise ConfigError(say("format-without-pairs", Mark(file=str(file)), suffixes=suffixes))
