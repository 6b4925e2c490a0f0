"""The README as a package index shows it: an index has no files beside it, so that relative links lead nowhere there.

With `Source` in `[project.urls]`, relative links and pictures become absolute ones below this address. Without it, only
the words of a link are left, and pictures are left out.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

LINK = re.compile(r"(?P<picture>!)?\[(?P<words>[^\]]*)\]\((?P<target>(?![a-z]+:)[^)#]+)(?P<anchor>#[^)]*)?\)")


def for_an_index(readme: str, source: str = "") -> str:
    """A README without relative links.

    Args:
        readme: the text, as Markdown.
        source: the address of the repository's files, such as `https://example.org/dh2urdf/blob/main`.
    """

    def absolute(link: re.Match[str]) -> str:
        if source:
            raw = "?raw=true" if link["picture"] else ""
            target = f"{source.rstrip('/')}/{link['target']}{raw}{link['anchor'] or ''}"
            return f"{link['picture'] or ''}[{link['words']}]({target})"
        return "" if link["picture"] else str(link["words"])

    return re.sub(r"\n{3,}", "\n\n", LINK.sub(absolute, readme))


class ReadmeHook(MetadataHookInterface):
    """Sets the field `readme` of the package's metadata."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Called by hatchling with the table `project` of pyproject.toml."""
        text = (Path(self.root) / "README.md").read_text("utf-8")
        source = metadata.get("urls", {}).get("Source", "")
        metadata["readme"] = {"content-type": "text/markdown", "text": for_an_index(text, source)}
