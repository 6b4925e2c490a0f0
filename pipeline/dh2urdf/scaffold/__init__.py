"""Files to begin with: the distribution of a new plugin (`dh2urdf new-plugin`), and tables (`example`, `init`).

The templates are beside this module, a folder for each kind of stage and one for what all have in common; `minimal` has
the same folders once more. Their paths are those of the files, in which `__package__` is replaced by the import package
and `dot_` by a dot.
"""

from __future__ import annotations

import keyword
import os
import re
import shutil
import sys
import tempfile
import tomllib
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Any

from dh2urdf._version import __version__
from dh2urdf.conversion.one_manipulator import in_format, read_items
from dh2urdf.documents.text_files import encoded, is_file, is_folder, is_there
from dh2urdf.errors import ConfigError, OutputError
from dh2urdf.manipulator import Convention, Manipulator
from dh2urdf.output.spooled import spooled
from dh2urdf.output.whole_files import make_folder, reporting_os_errors
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.source import Messages, Problem, did_you_mean, shown
from dh2urdf.table_text import TableText
from dh2urdf.table_text.texts import yaml_word

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.plugin_system.calls import Call
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.stages import Kind, Reader

say = Messages(__file__)

TEMPLATES = Path(__file__).with_name("templates")
LONGEST = 40  # characters of a name: it is that of a folder, a distribution, a package and a stage
_ENDING = ".template"
_NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")


def write_plugin(
    name: str, kind: Kind, folder: Path, catalog: Catalog, *, minimal: bool = False
) -> tuple[Path, list[str]]:
    """Write a distribution with one stage, all of its files or nothing: its folder, and the names of the files in it.

    `name` is that of the folder, of the distribution and, without ``dh2urdf-``, of the stage: one that no stage of the
    catalog has. The smallest one (`minimal`) is a module, its contract test, and what installs it.
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


def _values(name: str, kind: Kind) -> dict[str, str]:
    """What the templates leave open."""
    about = tomllib.loads((TEMPLATES / "kinds.toml").read_text("utf-8"))[kind]
    stage = name.removeprefix("dh2urdf-")
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
    package, stage = name.replace("-", "_"), name.removeprefix("dh2urdf-")
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


# --- Tables -----------------------------------------------------------------------------------------------------------


MOST_AXES = 100  # joints of a template at most
_PRODUCTS = {
    Convention.STANDARD: "standard (classic, distal): a row is Rz(theta) Tz(d) Tx(a) Rx(alpha)",
    Convention.MODIFIED: "modified (Craig, proximal): a row is Rx(alpha) Tx(a) Rz(theta) Tz(d)",
}
_IN_A_WHEEL = Path(__file__).parents[1] / "tables"
_IN_A_CLONE = Path(__file__).parents[3] / "configs" / "tables"


def shipped_tables() -> dict[str, Path]:
    """The tables by name; of a clone of the repository those in `configs/tables`, of which a wheel holds a copy."""
    folder = _IN_A_WHEEL if is_folder(_IN_A_WHEEL) else _IN_A_CLONE
    return {path.stem: path for path in sorted(folder.iterdir()) if is_file(path)} if is_folder(folder) else {}


def shipped_table(name: str) -> Path:
    """The table of a name, which a ConfigError says is none."""
    tables = shipped_tables()
    if name not in tables:
        near = did_you_mean(name, tables)
        raise ConfigError(say("example-unknown", COMMAND_LINE, found=name, names=tuple(tables), suggestion=near))
    return tables[name]


def table_template(
    call: Call[Reader[Any]], convention: Convention, joints: Sequence[str], name: str, file: Path
) -> bytes:
    """A table of an arm that stands upright, with comments, which the reader writes and reads back.

    In either convention it is the same arm. Without a name, the manipulator is named by the file.
    """
    comments = Template((TEMPLATES / "table.txt").read_text("utf-8")).substitute(
        count=len(joints), file=file.name, stem=file.stem, convention=_PRODUCTS[convention]
    )
    # A waist, links side by side, and a wrist from the fourth joint on: a [mm], alpha [deg], d [mm], standard.
    links = [(0, 90, 300), (200, 0, 0), (150, 0, 0)][: len(joints)]
    step = min(100, 4000 // len(joints))  # an arm of 5 m would be worth a notice
    links += [(0, 90 if number % 2 else -90, step) for number in range(3, len(joints))]
    links[-1] = (0, 0, links[-1][2] or 80)
    if convention is Convention.MODIFIED:  # a and alpha are those of the link before
        before = [(0, 0, 0), *links]
        links = [(a, alpha, d) for (a, alpha, _), (_, _, d) in zip(before, links, strict=False)]
    ends = {"theta": "0", "lower": "-170", "upper": "170"}
    text = TableText(
        name=name,
        convention=str(convention),
        length_unit="mm",
        angle_unit="deg",
        rows=tuple(
            {"joint": joint, "type": "revolute", "a": str(a), "alpha": str(alpha), "d": str(d), **ends}
            for joint, (a, alpha, d) in zip(joints, links, strict=True)
        ),
    )
    content = encoded(comments) + in_format([text], call).content
    with spooled(content, str(file), file.suffix) as path:
        (item,) = read_items(call, path)
    if not isinstance(item, Manipulator):
        raise ConfigError([replace(problem, mark=COMMAND_LINE) for problem in item.problems])
    return content


def run_template(table: Path, run: Path) -> bytes:
    """A run file for a table, with comments; the table is named by its path from the place of the run file."""
    path = os.path.relpath(table, run.parent).replace(os.sep, "/")
    text = Template((TEMPLATES / "run.yaml").read_text("utf-8"))
    return encoded(text.substitute(run=run.name, table=yaml_word(path)))


def write_new(files: dict[Path, bytes]) -> None:
    """Write files that are not there yet: all of them, or none."""
    if there := [path for path in map(str, files) if os.path.lexists(path)]:
        raise OutputError(say("file-there", COMMAND_LINE, found=path, path=shown(path, 200)) for path in there)
    written: list[Path] = []
    try:
        for path, content in files.items():
            make_folder(path.parent)
            with reporting_os_errors(path), path.open("xb") as file:
                written.append(path)
                file.write(content)
    except BaseException:
        for path in written:
            path.unlink(missing_ok=True)
        raise
