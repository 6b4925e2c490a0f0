"""What the pages show of tables and arms, and what they call it: the entries of page.toml."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

PAGE: dict[str, Any] = tomllib.loads(Path(__file__).with_name("page.toml").read_text("utf-8"))
