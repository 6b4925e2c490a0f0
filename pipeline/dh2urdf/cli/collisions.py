"""`dh2urdf collisions`: the pairs of links that need no collision check."""

from __future__ import annotations

from pathlib import Path

import click

from dh2urdf.cli import EXIT_STATUS
from dh2urdf.cli.answers import answer
from dh2urdf.cli.convert import print_notices
from dh2urdf.cli.shared_options import PATH, Command, catalog, option, without_option
from dh2urdf.cli.standard_input import refuse_dash
from dh2urdf.cli.tables import ASKER, package_paths_option, settings_of
from dh2urdf.commands.check import given_arguments
from dh2urdf.commands.collisions import annotation
from dh2urdf.documents.text_files import is_there
from dh2urdf.errors import ConfigError
from dh2urdf.output.whole_files import refuse_inputs, write_whole
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.source import Problem, printable
from dh2urdf.stages import Expansion

OPTIONS = ("trials", "seed", "min_distance")


@click.command(cls=Command, name="collisions", epilog=EXIT_STATUS)
@click.argument("words", nargs=-1, required=True, metavar="ROBOT [NAME:=VALUE…]")
@option(
    "-o",
    "--output",
    "output",
    type=PATH,
    metavar="SRDF",
    help="Where to write; what is in it stays.",
)
@option("--update", "earlier", type=PATH, metavar="SRDF", help="Another file to begin with.")
@option("--trials", metavar="N", help="Random states in which a pair of Never does not touch; 10000.")
@option("--seed", metavar="N", help="Seed of the random states; 0.")
@option("--min-distance", metavar="D", help="A pair that comes nearer is not Never [m]; 0.01.")
@package_paths_option
@option("--set", "settings", multiple=True, metavar="KEY=VALUE", help="Any other option of the emitter.")
@option("-q", "--quiet", is_flag=True, help="Say only what fails.")
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
    refuse_dash(words, "collisions")
    arguments = [word for word in words if ":=" in word and not is_there(Path(word))]
    robots = [Path(word) for word in words if word not in arguments]
    if len(robots) != 1:
        message = f"{len(robots)} files are given, and pairs are of one"
        raise ConfigError(Problem(message=message, mark=COMMAND_LINE, accepted="one ROBOT"))
    expansion = Expansion(arguments=given_arguments(arguments, COMMAND_LINE), package_paths=package_paths)
    if output is not None:
        refuse_inputs([output], robots)
    made = annotation(
        catalog(),
        robots[0],
        expansion,
        ASKER,
        out=output,
        earlier=earlier,
        given={name: flags[name] for name in OPTIONS},
        settings=settings_of(settings),
    )
    if not quiet:
        print_notices(made.notices)
    if output is None:
        answer(made.content, nl=False)
    else:
        write_whole(output, made.content)
    if not quiet:
        written = f"; written to {output}" if output else ""
        click.echo(printable(f"{robots[0].name}: {made.summary}{written}"), err=True)
    return 0
