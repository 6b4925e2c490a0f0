"""Whether there can be a `report.html`: without an import of what makes it, which a run without one is spared."""

from __future__ import annotations

from importlib.util import find_spec

from dh2urdf.errors import pip_install

PAGE = "report.html"
HOW_TO_GET = f"a page with pictures of it, report.html, needs jinja2 and matplotlib: {pip_install('dh2urdf[report]')}"
"""The message where the page cannot be written."""


def can_write_html() -> bool:
    """Whether jinja2, matplotlib and what it draws pixels with are installed; they are not imported."""
    return all(find_spec(package) for package in ("jinja2", "matplotlib", "PIL"))
