"""Names of rows that are no joints: totals, bases, flanges and tools, in a table that has no types."""

from __future__ import annotations

import re

NO_JOINTS = frozenset(
    "total totals totale totali gesamt sum summe somme suma somma mean average mittelwert moyenne media promedio base "  # noqa: SIM905
    "world ground basis sockel welt socle monde suelo mundo mondo podstawa taban tool tools tcp flange ee eef tip end "
    "endeffector gripper toolflange flansch werkzeug endeffektor greifer outil bride herramienta brida utensile "
    "flangia 合计 合計 平均 итого среднее razem toplam 합계 基座 底座 основание ベース 베이스 末端 工具 法兰 фланец "
    "инструмент narzędzie flanş フランジ ツール 플랜지 툴".split()
)
"""Whole names of rows that hardly are joints, without case, blanks and the word joint, link or frame."""
_BESIDE = r"(?i)[\s_.:-]+|(?<=.)(?:joint|link|frame|point|offset)$|^(?:joint|link|frame)(?=[^\W\d_])"
_LONGEST = 60


def is_no_joint(name: str) -> bool:
    """Whether a row is called like a total, a base or a tool: ``Total``, ``tool frame``, ``TCP``."""
    return len(name) <= _LONGEST and re.sub(_BESIDE, "", re.sub(r"[\s_.:-]+", "", name)).casefold() in NO_JOINTS
