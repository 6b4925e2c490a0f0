"""The bar above the scene: what is shown, which variant of the arm, from where, and the panels."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

from nicegui import ui

from dh2urdf_studio.editing.session import BOTH
from dh2urdf_studio.layout.scene_tools import LayerBoxes, lay_grasp, lay_opacity, lay_views

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from dh2urdf_studio.editing.session import Session
    from dh2urdf_studio.widgets import ArmView


class ScenePanel(Protocol):
    """A panel below the table, which a button of the bar opens and closes."""

    ICON: str
    TITLE: str

    def switch(self) -> None:
        """Open the panel, or close it."""

    def show(self) -> None:
        """Show the session as it is now."""


class SceneBar:
    """The bar above the scene.

    Args:
        session: the session.
        panels: the panels, for each of which there is a button.
        on_layers: takes the layers that are to be shown.
        on_variant: takes the variant that is to be shown.
        scene: gives the scene, once it is laid out.
    """

    def __init__(
        self,
        session: Session,
        panels: Iterable[ScenePanel],
        *,
        on_layers: Callable[[frozenset[str]], None],
        on_variant: Callable[[str], None],
        scene: Callable[[], ArmView],
    ) -> None:
        self._session = session
        self._filling = False
        self._on_variant = on_variant
        with ui.element("div").classes("studio-bar"):
            self._layers = LayerBoxes(session.layers, on_layers)
            names = session.variants
            both = {BOTH: "side by side"} if len(names) > 1 else {}
            self._variant = ui.toggle({name: name for name in names} | both, on_change=self._choose_variant)
            self._variant.props('dense unelevated no-caps aria-label="variant"').set_visibility(bool(both))
            with ui.element("div").classes("studio-tools"):
                fit = ui.button(icon="center_focus_strong", on_click=lambda: scene().fit())
                fit.props('flat dense round size=sm aria-label="see all of the arm"').tooltip("see all of the arm")
                lay_views(scene)
                lay_grasp(scene)
                lay_opacity({"": "the arm"}, session.opacities, lambda _, opacity: self._fade(scene(), opacity))
                for panel in panels:
                    switch = ui.button(icon=panel.ICON, on_click=panel.switch)
                    switch.props(f'flat dense round size=sm aria-label="{panel.TITLE}"').tooltip(panel.TITLE)

    def show(self) -> None:
        """Show which layers and which variant the session has."""
        self._filling = True
        self._layers.show(self._session.layers)
        self._variant.set_value(self._session.variant)
        self._filling = False

    def _fade(self, scene: ArmView, opacity: float) -> None:
        """Both variants are the arm; a description that is compared with it is not."""
        self._session.opacities = {"": opacity, f"{self._session.variants[-1]}/": opacity}
        scene.fade(self._session.opacities)

    def _choose_variant(self, event: Any) -> None:  # noqa: ANN401 - NiceGUI's
        if not self._filling:
            self._on_variant(event.value)
