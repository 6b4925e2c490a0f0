"""What mkdocs calls while it builds the site: it puts what is generated into the pages.

A page says where: a line ``<!-- generated: NAME -->`` is replaced by what `GENERATORS` has under the name. So the
repository holds the words of a page, and nothing that could become untrue.
"""

from __future__ import annotations

import re
from functools import cache, partial
from typing import TYPE_CHECKING, Any

import command_pages
import hook_pages
import notebook_pages
import root_pages
import schema_pages
import stage_pages
import vocabulary_pages

if TYPE_CHECKING:
    from collections.abc import Callable

GENERATORS: dict[str, Callable[[], str]] = {
    "changelog": partial(root_pages.root_page, "CHANGELOG.md"),
    "commands": command_pages.commands,
    "contributing": partial(root_pages.root_page, "CONTRIBUTING.md"),
    "hooks": hook_pages.hooks,
    "interface version": hook_pages.interface_version,
    "manifest schema": schema_pages.manifest,
    "notebook": partial(notebook_pages.page, "first-arm"),
    "report schema": schema_pages.report,
    "run file schema": schema_pages.run_file,
    "security policy": partial(root_pages.root_page, "SECURITY.md"),
    "stages": stage_pages.stages,
    "table headers": vocabulary_pages.headers,
    "table languages": vocabulary_pages.languages,
    "table unheld": vocabulary_pages.unheld,
    "table types": partial(vocabulary_pages.words, "types"),
    "table conventions": partial(vocabulary_pages.words, "conventions"),
    "table keys": vocabulary_pages.keys,
    "table no joints": vocabulary_pages.no_joints,
}
PLACE = re.compile(r"^<!-- generated: (?P<name>.+) -->$", re.MULTILINE)


@cache
def generated(name: str) -> str:
    """What is in the place of a name, made once however often a site is built.

    Raises:
        KeyError: a page asks for something that nothing generates.
    """
    return GENERATORS[name]()


def on_page_content(content: str, **_: Any) -> str:  # noqa: ANN401 - mkdocs hands over what it has
    """Called by mkdocs with a page as HTML: the mark of docstrings before an example is none in Markdown."""
    return content.replace("<p>::</p>\n", "")


def on_page_markdown(markdown: str, **_: Any) -> str:  # noqa: ANN401 - mkdocs hands over what it has
    """Called by mkdocs with the text of a page before it is made HTML."""
    return PLACE.sub(lambda place: generated(place["name"]), markdown)
