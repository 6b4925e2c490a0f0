"""What can be taken along beside files: a link that holds the table, and a picture of the scene."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from nicegui import ui

from dh2urdf.studio import dialogs
from dh2urdf.studio.editing.keeping import kept_table, kept_text

if TYPE_CHECKING:
    from dh2urdf.studio.editing.session import Session
    from dh2urdf.studio.widgets import ArmView
    from dh2urdf.table_text import TableText


def lay_items(session: Session, view: ArmView) -> None:
    """Lay out the entries of the menu."""
    ui.menu_item("Picture (PNG)", on_click=lambda: view.save_picture(session.table.name, transparent=False))
    transparent = "Picture with a transparent ground"
    ui.menu_item(transparent, on_click=lambda: view.save_picture(session.table.name, transparent=True))
    ui.menu_item("Link with this table", on_click=lambda: show_link(session.table))


async def show_link(table: TableText) -> None:
    """Show a link that holds a table; it is made in the browser, and goes nowhere but to the clipboard."""
    link = str(await ui.run_javascript(f"return dhPage.link({json.dumps(kept_text(table))})", timeout=10.0))
    with dialogs.card("A link with this table") as dialog:
        ui.label("The link itself holds the whole table: nothing is sent to anybody.").classes("studio-status")
        ui.input(value=link).props('readonly outlined dense aria-label="link"').classes("studio-wide")
        with ui.element("div").classes("studio-row"):
            copy = ui.button("Copy", on_click=lambda: dialog.submit("copied")).props("unelevated autofocus")
            copy.on("click", js_handler=f"() => navigator.clipboard?.writeText({json.dumps(link)})")
            ui.button("Close", on_click=lambda: dialog.submit(None)).props("flat")
    await dialog
    dialog.delete()


async def linked_table() -> TableText | None:
    """The table of the link by which the page was opened; None where it was opened without one.

    A person is told of a link whose table cannot be read.
    """
    text = await ui.run_javascript("return dhPage.linked()", timeout=10.0)
    if text is None:
        return None
    table = kept_table(str(text))
    if table is None:
        dialogs.warn("This link holds no table that can be read: it may have been cut off on its way.")
    return table
