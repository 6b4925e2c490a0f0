"""Pages of the site that are files of the repository's root: changelog, contributing, security policy."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = {
    "README.md": "index.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "SECURITY.md": "security-policy.md",
}
"""Files of the root, and the pages of the site in their place."""
LINK = re.compile(r"\]\((?P<file>[\w./-]+\.md)(?P<anchor>#[\w-]+)?\)")


def root_page(name: str) -> str:
    """A file of the root with its links as they are from docs/."""
    return LINK.sub(_from_docs, (ROOT / name).read_text("utf-8"))


def _from_docs(link: re.Match[str]) -> str:
    file = PAGES.get(link["file"], link["file"].removeprefix("docs/"))
    return f"]({file}{link['anchor'] or ''})"
