"""Files that are dropped on the page."""

from __future__ import annotations

import json
from contextlib import suppress
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

from nicegui import run, ui

from dh2urdf_studio import dialogs, words
from dh2urdf_studio.connection import ANSWERED
from dh2urdf_studio.editing.opening import tables_of

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf_studio.editing.opening import Opened


def lay_drop(page: ui.element, catalog: Catalog, on_table: Callable[[Opened | None], Awaitable[None]]) -> None:
    """A file that is dropped anywhere on a page is opened as if it had been chosen.

    Args:
        page: the page; parts of it that take files themselves come before it.
        catalog: the installed stages.
        on_table: takes the table, with what is to be known of it, or None where a person has chosen none of several.
    """

    async def take(event: Any) -> None:  # noqa: ANN401 - NiceGUI's
        if event.file.size() > dialogs.LARGEST_FILE:
            dialogs.warn(told["too much"])
            return
        name = unquote(event.file.name)
        with page:
            busy = ui.notification(words.busy(name, event.file.size()), spinner=True, timeout=None)
        try:
            tables = await run.io_bound(tables_of, name, await event.file.read(), catalog, dialogs.MOST_CHOICES + 1)
        finally:
            busy.dismiss()
        if isinstance(tables, str):
            dialogs.warn(tables)
            return
        # What is being typed, and what is on its way by the socket, belongs to the table that is still there.
        with suppress(TimeoutError):
            await page.client.run_javascript("dhPage.leave()", timeout=ANSWERED)
        if not page.is_deleted:
            await on_table(await dialogs.choose(tables))

    suffixes = dialogs.table_suffixes(catalog)
    with page:
        upload = ui.upload(on_upload=take).style("display: none")
    told = {
        "none": f"This is not a file that can be opened. Accepted: one of {', '.join(suffixes)}.",
        "too much": f"Drop one file, of at most {dialogs.LARGEST_FILE // 2**20} MB. Descriptions with their meshes "
        "can be dropped on the panel that compares them with the table.",
        "lost": dialogs.LOST,
    }
    ui.on("dh-no-table", lambda event: dialogs.warn(told[str(event.args)]))
    wanted = json.dumps({"ends": suffixes, "most": 1, "largest": dialogs.LARGEST_FILE, "refused": "dh-no-table"})
    page.on("drop", js_handler=f"event => dhPage.drop(event, {json.dumps(upload.props['url'])}, {wanted})")
