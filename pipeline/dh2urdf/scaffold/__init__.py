"""Writes the distribution of a new plugin: `dh2urdf new-plugin`.

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
import unicodedata
from importlib.util import find_spec
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING

from dh2urdf._version import __version__
from dh2urdf.documents.text_files import is_folder, is_there
from dh2urdf.errors import ConfigError
from dh2urdf.late_dataclasses import dataclass
from dh2urdf.output.whole_files import reporting_os_errors, safe_stem
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.source import Problem, shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.stages import Kind

TEMPLATES = Path(__file__).with_name("templates")
LONGEST = 40
"""Characters of a name: it is that of a folder, a distribution, a package and a stage."""
_ENDING = ".template"
_NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")


@dataclass(frozen=True, slots=True, kw_only=True)
class _About:
    """What is particular to a kind.

    Attributes:
        summary: what the stage of the template does, in one line.
        usage: the sections of a run file that name it.
    """

    summary: str
    usage: str


_KINDS: dict[Kind, _About] = {
    "reader": _About(
        summary="DH tables as JSON, a manipulator in each line",
        usage="inputs: arms$suffix\nemitters: [urdf]",
    ),
    "transform": _About(
        summary="a ball for each row, with the frames of the DH table",
        usage="inputs: arm.csv\ntransform: {stage: $stage, options: {radius: 0.02}}\nemitters: [urdf]",
    ),
    "edit": _About(
        summary="a ball that every arm carries at tool0",
        usage="inputs: arm.csv\nedits:\n  - {stage: $stage, options: {mass: 2.5}}\nemitters: [urdf]",
    ),
    "emitter": _About(
        summary="the joints of a robot as a table, for people and spreadsheets",
        usage="inputs: arm.csv\nemitters:\n  - urdf\n  - {stage: $stage, options: {delimiter: semicolon}}",
    ),
    "loader": _About(
        summary="reads a URDF and compares the arm with the table",
        usage="inputs: arm.csv\nemitters: [urdf]\nloaders:\n  - {stage: $stage, options: {poses: 25}}",
    ),
    "executor": _About(
        summary="threads of this process",
        usage="inputs: arms.csv\nemitters: [urdf]\nexecution: {stage: $stage, options: {workers: 4}}",
    ),
}


def write_plugin(
    name: str, kind: Kind, folder: Path, catalog: Catalog, *, minimal: bool = False
) -> tuple[Path, list[str]]:
    """Write a distribution with one stage: all of its files, or nothing.

    Args:
        name: name of the folder, of the distribution and, without ``dh2urdf-``, of the stage.
        kind: the kind of stage.
        folder: where the distribution's own folder is made.
        catalog: the stages that are installed, none of which is to have the name.
        minimal: whether it is the smallest one: a module, its contract test, and what installs it.

    Returns:
        The distribution's folder, and the names of its files in it.

    Raises:
        ConfigError: the name cannot be given, or its folder is there.
        OutputError: the files cannot be written.
    """
    place = folder / name
    if problems := list(_problems(name, kind, place, catalog)):
        raise ConfigError(problems)
    with reporting_os_errors(place):
        # Inside, so that it can be moved to its place; an interruption leaves nothing half-written.
        half = Path(tempfile.mkdtemp(prefix=f".{name}-", dir=folder))
        try:
            written = [_write(half, *source, name, kind) for source in _sources(kind, minimal=minimal)]
            half.chmod(0o755)  # mkdtemp makes it for its owner alone
            half.rename(place)
        except BaseException:
            shutil.rmtree(half, ignore_errors=True)
            raise
    return place, sorted(written)


def stage_name(name: str) -> str:
    """The name of the stage that a distribution of this name provides."""
    return name.removeprefix("dh2urdf-")


def _package(name: str) -> str:
    """The name of the import package of a distribution of this name."""
    return name.replace("-", "_")


def _problems(name: str, kind: Kind, place: Path, catalog: Catalog) -> Iterator[Problem]:
    """All that keeps a name from being given."""
    if not _NAME.fullmatch(name) or len(name) > LONGEST:
        yield Problem(
            message=f"a plugin cannot be named {shown(name)}",
            mark=COMMAND_LINE,
            field="NAME",
            found=name,
            accepted=f"lower-case letters, digits and single dashes, from a letter on, at most {LONGEST} characters",
            suggestion=_proposal(name),
        )
        return
    if reason := _taken(_package(name)):
        yield Problem(
            message=f"{_package(name)!r} {reason}",
            mark=COMMAND_LINE,
            field="NAME",
            found=name,
            accepted="a name that no package has",
            suggestion=f"`dh2urdf-{name}` names the distribution so, and the stage {name!r}",
        )
    stage = stage_name(name)
    for item in catalog.provided(kind):
        if item.stage.name == stage:
            taken = ", ".join(other.stage.name for other in catalog.provided(kind))
            yield Problem(
                message=f"the {kind} {stage!r} is provided by {item.plugin.distribution}",
                mark=COMMAND_LINE,
                field="NAME",
                found=name,
                accepted=f"a name besides {taken}",
            )
    if is_there(place) or place.is_symlink():
        yield Problem(
            message=f"{shown(str(place))} is there already",
            mark=COMMAND_LINE,
            accepted="a folder that is not there yet",
            suggestion="choose another name or another folder with `--dir`; nothing is overwritten",
        )
    elif not is_folder(place.parent):
        yield Problem(
            message=f"there is no folder {shown(str(place.parent))}",
            mark=COMMAND_LINE,
            field="--dir",
            accepted="a folder that is there",
        )


def _taken(package: str) -> str | None:
    """Why no package can have a name; None where one can."""
    if keyword.iskeyword(package):
        return "is a keyword of Python, which no package can be called"
    if package in sys.stdlib_module_names:
        return "is a module of Python's standard library"
    if safe_stem(package) != package:
        return "is a device of Windows, which no folder there can be called"
    return "is a package that is installed here" if find_spec(package) else None


def _proposal(name: str) -> str | None:
    """The sentence that names an acceptable name near to one that is not."""
    plain = re.sub(r"[\u0300-\u036f]", "", unicodedata.normalize("NFKD", name))  # letters without their accents
    words = "-".join(re.findall(r"[a-z0-9]+", re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "-", plain).lower()))[:LONGEST]
    near = words.lstrip("0123456789-").rstrip("-")
    return f"did you mean {near!r}?" if near else None


def _sources(kind: Kind, *, minimal: bool) -> list[tuple[Path, str]]:
    """The templates of a distribution, and their paths in it."""
    templates = TEMPLATES / "minimal" if minimal else TEMPLATES
    return [
        (path, path.relative_to(part).as_posix())
        for part in (templates / "common", templates / kind)
        for path in sorted(part.rglob(f"*{_ENDING}"))
    ]


def _write(folder: Path, source: Path, inner: str, name: str, kind: Kind) -> str:
    """Fills in one template; its name in the distribution."""
    values = _values(name, kind)
    inner = inner.removesuffix(_ENDING)
    inner = re.sub(r"(^|/)dot_", r"\1.", inner).replace("__package__", values["package"])
    path = folder / inner
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(Template(source.read_text("utf-8")).substitute(values), "utf-8", newline="\n")
    return inner


def _values(name: str, kind: Kind) -> dict[str, str]:
    """What the templates leave open."""
    stage = stage_name(name)
    suffix = {"reader": f".{stage}.jsonl", "emitter": f".{stage}.csv"}.get(kind, "")
    return {
        "name": name,
        "package": _package(name),
        "stage": stage,
        "kind": kind,
        "record": kind.capitalize(),
        "constant": kind.upper(),
        "suffix": suffix,
        "summary": _KINDS[kind].summary,
        "usage": Template(_KINDS[kind].usage).substitute(stage=stage, suffix=suffix),
        "version": ".".join(__version__.split(".")[:2]),
    }
