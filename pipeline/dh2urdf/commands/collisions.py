"""The file of collision pairs that goes with a robot description of any origin: the work of `dh2urdf collisions`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.commands.options_of_stages import stage_calls
from dh2urdf.documents.text_files import check_file, is_there
from dh2urdf.errors import ConfigError, InputError
from dh2urdf.source import Mark, Problem
from dh2urdf.stage_calls.answers import a_whole_record
from dh2urdf.stage_calls.calls import depending_on
from dh2urdf.stages import Annotation

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from dh2urdf.commands.options_of_stages import Asker, Setting
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.stages import Expansion


def annotation(
    catalog: Catalog,
    description: Path,
    expansion: Expansion,
    asker: Asker,
    *,
    out: Path | None = None,
    earlier: Path | None = None,
    given: Mapping[str, str | None] | None = None,
    settings: Iterable[Setting] = (),
) -> Annotation:
    """The file that goes with a description.

    Args:
        catalog: the stages that there are.
        description: a robot description.
        expansion: how it is expanded, and where its packages are.
        asker: who asks.
        out: the file to write; its suffix chooses the emitter. Where it exists, it is what is brought up to date.
        earlier: another file to bring up to date.
        given: options of the emitter as words.
        settings: further options.

    Raises:
        InputError: a file cannot be read, or no emitter makes such files.
        ConfigError: an option is unknown or its value wrong.
        PluginError: the emitter is at fault, or a package that it needs is not installed.
    """
    check_file(description, InputError)
    if earlier is None and out is not None and is_there(out):
        earlier = out
    if earlier is not None:
        check_file(earlier, InputError)
    emitter = _emitter(catalog, out or earlier)
    (call,) = stage_calls(catalog, {"emitter": [emitter]}, asker, {"emitter": dict(given or {})}, settings)["emitter"]
    with depending_on(call, "annotate"):
        made: Annotation = a_whole_record(emitter.annotate(description, expansion, earlier, call.options), Annotation)
        return made


def _emitter(catalog: Catalog, file: Path | None) -> Any:  # noqa: ANN401 - an emitter that annotates
    """The emitter of a file's format; where there is no file, the first that annotates.

    Raises:
        InputError: the format is one of whole descriptions, or no emitter has it.
    """
    able: list[Any] = [item.stage for item in catalog.provided("emitter") if getattr(item.stage, "annotate", None)]
    chosen: Any = catalog.emitter_for(file, "choose a name that ends in .srdf") if file else next(iter(able), None)
    if chosen is not None and chosen.annotate is not None:
        return chosen
    suffixes = sorted({suffix for each in able for suffix in each.suffixes})
    message = "collision pairs are not written in this format" if file else "no emitter writes collision pairs"
    raise ConfigError(
        Problem(
            message=message,
            mark=Mark(file=str(file)) if file else None,
            accepted=f"a name that ends in {' or '.join(suffixes)}" if suffixes else None,
        )
    )
