"""What the commands that take one table share: its options, and how messages speak of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.cli.shared_options import PATH, option
from dh2urdf.commands.options_of_stages import Asker, Setting
from dh2urdf.plugin_system.options import COMMAND_LINE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import TypeVar

    F = TypeVar("F", bound=Callable[..., Any])


def _run_command(path: str) -> str:
    import shlex

    return f"dh2urdf run {shlex.quote(path)}"


ASKER = Asker(
    mark=COMMAND_LINE,
    reader="--from ",
    format="--to ",
    robot="--robot ",
    out="-o ",
    meshes="--meshes ",
    convert_meshes="--convert-meshes ",
    edit="--edit ",
    setting="--set ",
    nowhere="this goes to standard output",
    every="`dh2urdf run` with a run file makes all of them",
    run=_run_command,
)


def table_options(function: F) -> F:
    """Gives a command the flags that say which reader, and which manipulator of a table."""
    for give in (
        option("--robot", metavar="NAME", help="Which manipulator of a table that holds several."),
        option("--from", "reader_name", metavar="NAME", help="Reader of TABLE; by its suffix."),
    ):
        function = give(function)
    return function


package_paths_option = option(
    "--package-path",
    "package_paths",
    type=PATH,
    multiple=True,
    metavar="DIR",
    help="A ROS package, or a folder of packages, whose files a xacro may include or meshes are in; repeatable.",
)


def settings_of(words: Iterable[str]) -> list[Setting]:
    """What `--set key=value` says."""
    settings = []
    for word in words:
        key, equals, value = word.partition("=")
        settings.append(Setting(word, key.strip(), value.strip() if equals else None))
    return settings
