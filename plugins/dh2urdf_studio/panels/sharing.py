"""What can be taken along beside files: a link that holds the table; the scene as a picture, a turntable or glTF."""

from __future__ import annotations

import json
from functools import partial
from typing import TYPE_CHECKING

from nicegui import run, ui

from dh2urdf.errors import Dh2UrdfError
from dh2urdf.output.whole_files import safe_stem
from dh2urdf_studio import dialogs
from dh2urdf_studio.arrivals import ANSWERED
from dh2urdf_studio.drawing import exports
from dh2urdf_studio.drawing.scene import faded
from dh2urdf_studio.editing.edits import kept_table, kept_text
from dh2urdf_studio.editing.save import Saved
from dh2urdf_studio.widgets import lay_menu_item

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.table_text import TableText
    from dh2urdf_studio.editing.session import Session
    from dh2urdf_studio.widgets import ArmView, ShownScene


def lay_items(session: Session, view: ArmView) -> None:
    """Lay out the entries of the studio's menu."""
    lay_scene_items(
        view,
        lambda: (session.table.name, faded(session.drawing, session.opacities), session.joint_values(), session.layers),
    )
    lay_menu_item("Link with this table", lambda: show_link(session.table))


def lay_scene_items(view: ArmView, scene: Callable[[], ShownScene]) -> None:
    """Lay out the entries of a menu that take the scene along; `scene` gives what is shown of it now."""
    for told, transparent in (("Picture (PNG)", False), ("Picture with a transparent ground", True)):
        lay_menu_item(told, lambda clear=transparent: view.save_picture(scene()[0], transparent=clear))  # type: ignore[misc]  # of a default
    lay_menu_item("Turntable (GIF)", partial(_save_turntable, view, scene))
    lay_menu_item("Scene as glTF (GLB)", partial(_save_scene, scene))


async def _save_turntable(view: ArmView, scene: Callable[[], ShownScene]) -> None:
    """Hand over a turn about the arm: the page draws the frames, and what they are made into is made here."""
    name = safe_stem(scene()[0] or "arm")
    note = ui.notification("turntable", spinner=True, timeout=None)
    try:
        frames = []
        async for frame in view.turn(exports.FRAMES, exports.LARGEST):
            frames.append(frame)
            note.message = f"turntable: frame {len(frames)} of {exports.FRAMES}"
        made = await run.io_bound(exports.gif, frames)
        if made is not None:  # as it is while the server ends
            dialogs.hand_over(Saved(f"{name}.gif", made))
    except Dh2UrdfError as error:
        await dialogs.show_error("The turntable cannot be made", error)
    finally:
        note.dismiss()


async def _save_scene(scene: Callable[[], ShownScene]) -> None:
    """Hand over the robots as they are shown, in the pose on the screen."""
    name, drawing, q, layers = scene()
    try:
        made = await run.io_bound(exports.glb, drawing, q, layers, name or "arm")
        if made is not None:  # as it is while the server ends
            dialogs.hand_over(Saved(f"{safe_stem(name or 'arm')}.glb", made))
    except Dh2UrdfError as error:
        await dialogs.show_error("The scene cannot be written", error)


async def show_link(table: TableText) -> None:
    """Show a link that holds a table; it is made in the browser, and goes nowhere but to the clipboard."""
    link = str(await ui.run_javascript(f"return dhPage.link({json.dumps(kept_text(table))})", timeout=ANSWERED))
    with dialogs.card("A link with this table") as dialog:
        ui.label("The link itself holds the whole table: nothing is sent to anybody.").classes("studio-status")
        ui.input(value=link).props('readonly outlined dense aria-label="link"').classes("studio-wide")
        with ui.element("div").classes("studio-row"):
            copy = ui.button("Copy", on_click=lambda: dialog.submit("copied")).props("unelevated autofocus")
            copy.on("click", js_handler=f"() => navigator.clipboard?.writeText({json.dumps(link)})")
            ui.button("Close", on_click=lambda: dialog.submit(None)).props("flat")
    await dialogs.answer_of(dialog)


async def linked_table() -> TableText | None:
    """The table of the link by which the page was opened; None where it was opened without one, or it is damaged."""
    text = await ui.run_javascript("return dhPage.linked()", timeout=ANSWERED)
    if text is None:
        return None
    table = kept_table(str(text))
    if table is None:
        dialogs.warn("This link holds no table that can be read: it may have been cut off on its way.")
    return table
