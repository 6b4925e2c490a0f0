"""The menu by which a person chooses how the pages look; what is chosen stays in the browser."""

from __future__ import annotations

from nicegui import ui

from dh2urdf_studio.panels.clicks import Menu

SCHEMES = {"system": "as the system", "light": "light", "dark": "dark"}
"""The colour schemes."""
_TOLD = "light, dark, projector"
_SMOOTH = "smooth edges"
_LARGE = "projector: larger text and lines"


def lay_look() -> None:
    """Lay out the menu, where a head is being laid out."""
    with ui.button(icon="contrast").props(f'flat dense no-caps color=white aria-label="{_TOLD}"') as button:
        button.tooltip(_TOLD)
        with Menu(items=True).props(f'aria-label="{_TOLD}"') as menu:
            for scheme, told in SCHEMES.items():
                item = (
                    ui.menu_item(told, auto_close=False)
                    .classes("studio-look")
                    .props(f'data-scheme="{scheme}" role=menuitem')
                )
                item.on("click", js_handler=f"() => dhLook.choose('{scheme}')")
            ui.separator()
            large = (
                ui.menu_item(_LARGE, auto_close=False).classes("studio-look").props('data-size="large" role=menuitem')
            )
            large.on("click", js_handler="() => dhLook.magnify()")
            smooth = (
                ui.menu_item(_SMOOTH, auto_close=False)
                .classes("studio-look")
                .props('data-edges="smooth" role=menuitem')
            )
            smooth.on("click", js_handler="() => dhLook.smooth()")
        menu.on("show", js_handler="() => dhLook.mark()")
