"""The distribution of a new plugin: `dh2urdf new-plugin`.

The templates are beside this module, a folder for each kind of stage and one for what all have in common; `minimal` has
the same folders once more. Their paths are those of the files, in which `__package__` is replaced by the import package
and `dot_` by a dot.
"""

from __future__ import annotations

import keyword
import re
import shutil
import sys
import tempfile
import tomllib
from importlib.util import find_spec
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Any

from dh2urdf._version import __version__
from dh2urdf.documents.text_files import is_folder, is_there
from dh2urdf.errors import ConfigError
from dh2urdf.output.whole_files import reporting_os_errors
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.source import Messages, Problem, shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.stages import Kind

say = Messages(__file__)

TEMPLATES = Path(__file__).with_name("templates")
LONGEST = 40
"""Characters of a name: it is that of a folder, a distribution, a package and a stage."""
_ENDING = ".template"
_NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")


def write_plugin(
    name: str, kind: Kind, folder: Path, catalog: Catalog, *, minimal: bool = False
) -> tuple[Path, list[str]]:
    """Write a distribution with one stage, all of its files or nothing: its folder, and the names of the files in it.

    Args:
        name: name of the folder, of the distribution and, without ``dh2urdf-``, of the stage.
        kind: the kind of stage.
        folder: where the distribution's own folder is made.
        catalog: the stages that are installed, none of which is to have the name.
        minimal: whether it is the smallest one: a module, its contract test, and what installs it.

    Raises:
        ConfigError: the name cannot be given, or its folder is there.
    """
    place = folder / name
    if problems := list(_problems(name, kind, place, catalog)):
        raise ConfigError(problems)
    templates, values = TEMPLATES / "minimal" if minimal else TEMPLATES, _values(name, kind)
    written = []
    with reporting_os_errors(place):
        # Inside, so that it can be moved to its place; an interruption leaves nothing half-written.
        half = Path(tempfile.mkdtemp(prefix=f".{name}-", dir=folder))
        try:
            for part in (templates / "common", templates / kind):
                for source in part.rglob(f"*{_ENDING}"):
                    inner = source.relative_to(part).as_posix().removesuffix(_ENDING)
                    inner = re.sub(r"(^|/)dot_", r"\1.", inner).replace("__package__", values["package"])
                    (half / inner).parent.mkdir(parents=True, exist_ok=True)
                    text = Template(source.read_text("utf-8")).substitute(values)
                    (half / inner).write_text(text, "utf-8", newline="\n")
                    written.append(inner)
            half.chmod(0o755)  # mkdtemp makes it for its owner alone
            half.rename(place)
        except BaseException:
            shutil.rmtree(half, ignore_errors=True)
            raise
    return place, sorted(written)


def stage_name(name: str) -> str:
    """The name of the stage that a distribution of this name provides."""
    return name.removeprefix("dh2urdf-")


def _values(name: str, kind: Kind) -> dict[str, str]:
    """What the templates leave open."""
    about = tomllib.loads((TEMPLATES / "kinds.toml").read_text("utf-8"))[kind]
    stage = stage_name(name)
    suffix = Template(about.get("suffix", "")).substitute(stage=stage)
    return {
        "name": name,
        "package": name.replace("-", "_"),
        "stage": stage,
        "kind": kind,
        "record": kind.capitalize(),
        "constant": kind.upper(),
        "suffix": suffix,
        "summary": about["summary"],
        "usage": Template(about["usage"]).substitute(stage=stage, suffix=suffix),
        "version": ".".join(__version__.split(".")[:2]),
    }


def _problems(name: str, kind: Kind, place: Path, catalog: Catalog) -> Iterator[Problem]:
    """All that keeps a name from being given."""

    def problem(code: str, field: str | None = "NAME", **values: Any) -> Problem:  # noqa: ANN401 - of a message
        return say(code, COMMAND_LINE, field=field, found=name if field == "NAME" else None, **values)

    if not _NAME.fullmatch(name) or len(name) > LONGEST:
        yield problem("plugin-name-wrong", longest=LONGEST)
        return
    package, stage = name.replace("-", "_"), stage_name(name)
    if keyword.iskeyword(package) or package in sys.stdlib_module_names or find_spec(package):
        yield problem("plugin-name-taken", package=package, name=name)
    for item in catalog.provided(kind):
        if item.stage.name == stage:
            taken = ", ".join(other.stage.name for other in catalog.provided(kind))
            yield problem("stage-name-taken", kind=kind, stage=stage, owner=item.plugin.distribution, taken=taken)
    if is_there(place) or place.is_symlink():
        yield problem("folder-there", None, path=str(place))
    elif not is_folder(place.parent):
        yield problem("no-folder", "--dir", folder=shown(str(place.parent)), suggestion="name a folder that is there")
