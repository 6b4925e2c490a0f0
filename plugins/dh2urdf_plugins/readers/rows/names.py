"""Names of rows that hardly are joints that turn: totals, bases, flanges and tools, notes, and joints that slide.

A word counts only where the whole name consists of such words: `tool_joint` and `EE frame` do, `wrist_flange_rotation`
and `base_yaw` do not. A type behind a name counts always: `J2 prismatic`, `Joint 2 (P)`.
"""

from __future__ import annotations

import math
import re
import unicodedata
from functools import lru_cache
from typing import TYPE_CHECKING, Literal

from dh2urdf.manipulator import JointType
from dh2urdf.source import Problem, shown
from dh2urdf_plugins.readers.words.fields import joint_type
from dh2urdf_plugins.readers.words.word_keys import without_separators

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from dh2urdf.manipulator import DHRow

RowKind = Literal["total", "frame", "slide"]


def _key(name: str) -> str:
    """A name without case, accents and separators."""
    if name.isascii():
        return without_separators(name.lower())
    letters = unicodedata.normalize("NFKD", name).casefold()
    return without_separators("".join(letter for letter in letters if not unicodedata.combining(letter)))


def _words(text: str) -> frozenset[str]:
    return frozenset(word if word.isascii() else _key(word) for word in text.split())


_TOTALS = _words("""
    total totals totale totali gesamt gesamtsumme sum sums summe summen somme sommes suma somma subtotal zwischensumme
    mean means average avg mittelwert mittel durchschnitt moyenne media promedio median mediana max maximum maximo
    massimo min minimum minimo std stddev stdev deviation variance varianz rms count anzahl range spannweite σ
    result results ergebnis resultat resultado risultato overall totalt totaal error errors fehler erreur tolerance
    tolerances toleranz uncertainty accuracy reach reichweite portee alcance
    合计 总计 总和 平均 平均值 合計 合計値 総計 итого всего сумма среднее razem srednia toplam ortalama 합계 총계 평균
""")
_OF_TOTALS = _words("""
    length lengths laenge lange longueur longitud lunghezza maximum arm robot value values wert
    werte grand mass weight height of all joints links rows mm cm m deg rad kg
""")
_BASES = _words("""
    base basis ground world root origin pedestal foundation mounting mount sockel fundament gestell boden welt socle
    bati monde suelo tierra mundo raiz terra mondo basamento fixed 基座 底座 基坐标系 основание база стойка podstawa
    taban zemin ベース 基台 베이스 받침
""")
_TURNING_BASES = _BASES & _words("""
    base basis pedestal sockel socle basamento 基座 底座 основание база podstawa taban ベース 基台 베이스
""")
_FRAMES = _BASES | _words("""
    flange toolflange tool tools ee eef tcp gripper hand tip end effector flansch werkzeug effektor endeffektor greifer
    spitze outil effecteur terminal pince bride herramienta pinza brida efector final utensile flangia organe organo
    terminale punta adapter sensor ftsensor camera kamera garra ferramenta 末端 末端执行器 工具 法兰 夹爪 手爪
    фланец инструмент схват захват kołnierz narzędzie chwytak końcówka flanş takım tutucu uç
    フランジ ツール 手先 ハンド グリッパ エンドエフェクタ 플랜지 툴 말단 그리퍼 엔드이펙터
    fix fixe fest fijo fisso starr static rigid dummy virtual none null nan nil note notes remark remarks comment
    comments source quelle hinweis anmerkung unit units einheit einheiten unite unites unidad unidades unita
""")
_OF_FRAMES = _words("""
    joint jnt frame offset link point center centre transform plate position interface row gelenk rahmen repere from to
""")
_SLIDES = _words("""
    prismatic prismatical prism prismatisch prismatique prismatico linear linearly lineal lineaire lineare sliding slide
    slider translation translational translatory translatorisch traslacional traslacion traslazione schub schubgelenk
    schubachse linearachse glissiere deslizante corredera prismatica deslizamento 移动 平移 直线 滑动 直动
    поступательная поступательный линейная линейный liniowy liniowa dogrusal
    призматическая призматический przesuwny przesuwna pryzmatyczny pryzmatyczna postepowy prizmatik kayar 直動 並進
    スライド スライダ 직동 병진 직선
""")
_SLIDING = _words("""
    torsolift liftcolumn columnlift baselift verticallift hub rail railway track schiene schlitten carriage verfahrachse
    fahrachse hubachse elevator telescope teleskop gantry portalachse
""")
"""What a joint that slides is called after: a name only, since a column may have such a word for a part of the arm.

A `lift` alone is none: it is the second joint of a UR, between `pan` and `elbow`.
"""
_OF_SLIDES = _words("""
    joint jnt axis rail guide motion drive unit stage actuator module gelenk achse liaison articulation axe articulacion
    eje giunto asse junta articulacao eixo guida 关节 轴 副 运动 関節 軸 관절 축 пара ось звено para os mafsal eklem
    base torso column saeule saule boden floor external extern ext e x y z
""")
_MOTIONS = _words(
    "trans transl translate translates slides tz schieben schiebt verschieben gleiten glisse coulisse desliza scorre"
)
"""What a joint that slides does, in a column that no field knows."""
_SLIDE_SYMBOL = r"[pd][0-9]{0,3}"
"""``P2`` between ``R1`` and ``R3``, and the variable ``d2`` between ``θ1`` and ``θ3``."""
_SLIDE_IN_PROSE = (
    r"(?i)(?<![^\W_])(?:pri[sz]m[aá]ti|schubgelenk|призматич|поступательн\w* (?:пара|кинематич|сочлен|шарнир)"
    r"|pryzmatyczn|przesuwn)|移动副|移动关节|直动关节|直動関節|직동 ?관절|병진 ?관절"
)
_TYPE_BEHIND = r"(?i)[^\W_].*[(\[\uff08]([^()\[\]\uff08\uff09]*)[)\]\uff09]\s*|[a-z].*[0-9]\s*[\s_:/,-]\s*(p)\s*"
"""``Joint 2 (P)``, ``Joint 2 (elbow, prismatic)``, ``J2-P``."""
_BREAKS = r"[\s_:/,()\[\]\u2013-]+"
_UNMOVED = _words("""
    f fix notused unused passive passiv dummy virtual locked notactuated unactuated inactive gesperrt mimic mimics
    coupled disabled frozen blocked clamped welded notdriven undriven notmotorized nomotor notmoving bloque
    bloquee bloqueado bloqueada bloccato bloccata fixee passif pasivo passivo blockiert nichtangetrieben nichtaktiv
    固定 被动 从动 锁定 고정
""")
"""What is behind the name of a joint that does not move, or not by itself."""
_STILL = (_UNMOVED - {"f", "fix"}) | _words("fixed fest fixe fijo fija fisso fissa fixo fixa")
"""The same where it may be one word of a name."""
_TO_FRAME = r"(?i)[0-9]{1,3}\s*(?:-+>|[→➔⟶])\s*[a-z]"
"""The last row of a table whose rows are ``0->1``, ``1->2``: ``6->G`` leads to the gripper."""
_HINTS = tuple(filter(str.isascii, _TOTALS | _FRAMES | _SLIDES | _SLIDING | (_UNMOVED - {"f"})))
_REMARK = (
    r"(?i)(?<![^\W_])(?:(?P<sign>reversed|inverted|invertiert|invertid|inversé|negated|negative|flipped|mirrored|gespiegelt"
    r"|umgekehrt|(?:counter|anti)?[ -]?clockwise|(?<=[(\[\uff08])(?:c?cw|inv\.?|[-−–])(?=[)\]\uff09])"
    r"|(?<=[0-9][\s_])c?cw$|upside down)|(?P<motion>coupled|gekoppelt|couplé|acoplad|accoppiat|mimic|continuous"
    r"|(?<=[(\[])(?:mm|cm|m)(?=[)\]])))"
    r"|(?P<sign2>反向|反转)|(?P<motion2>耦合)|(?<=[(\[\uff08])(?P<value>[^()\[\]]*(?:[±°]|(?<![0-9])[-+−]\s?(?:[0-9][0-9.]|pi|π))[^()\[\]]*)[)\]\uff09]"
)
"""What a name says about its joint: ``elbow [inverted]``, ``J3 coupled to J2``, ``J1 (±170°)``."""
_IN_REMARKS = tuple(
    "( [ \uff08 revers verted vertid invers negat flipped mirrored gespiegelt umgekehrt clockwise cw upside coupl "  # noqa: SIM905
    "gekoppelt acoplad accoppiat mimic continuous 反 耦".split()
)
"""What such a name has one of."""
_DIGITS = r"[0-9]+"
_LONGEST = 60


@lru_cache(maxsize=4096)
def kind_of(name: str) -> RowKind | None:
    """What a row seems to be by its name, if it is hardly a joint that turns: a total, a frame or a note, a slide."""
    if len(name) > _LONGEST:
        return None
    key = _key(name)
    if is_total(name):
        return "total"
    if name and (not key or _consists_of(key, _FRAMES, _OF_FRAMES) or re.fullmatch(_TO_FRAME, name)):
        return "frame"
    slides = re.fullmatch(_SLIDE_SYMBOL, key) or _consists_of(key, _SLIDES | _SLIDING, _OF_SLIDES)
    return "slide" if slides or speaks_of_slide(name) else _kind_behind(name)


def _kind_behind(name: str) -> RowKind | None:
    """What a row is by what is behind its name: ``Joint 2 (P)``, ``J7 [fixed]``."""
    match = re.fullmatch(_TYPE_BEHIND, name)
    for word in re.split("[,;/]", match[1] or match[2]) if match else ():
        key = _key(word)
        kind = joint_type(word) if len(key) > 1 and key.isalpha() else None
        if kind is JointType.FIXED or key in _UNMOVED:
            return "frame"
        if kind is JointType.PRISMATIC or key == "p":
            return "slide"
    return None


@lru_cache(maxsize=4096)
def kind_of_name(name: str) -> RowKind | None:
    """The same of a name, which may have a word for what does not move: ``fixed elbow``, ``J3 - not used``."""
    if len(name) > _LONGEST or not any(hint in _key(name) for hint in _STILL):
        return kind_of(name)
    first, *others = filter(None, map(_key, re.split(_BREAKS, name)))
    beside = {first, *others[-1:], "".join(others[-2:]), _key(name)}
    return kind_of(name) if beside.isdisjoint(_STILL) else "frame"


def remark_in(name: str) -> str | None:
    """What a name says about its joint besides: its sign, motion or value, as in ``wrist (reversed)``; or None."""
    if not any(hint in name.lower() for hint in _IN_REMARKS) or not (match := re.search(_REMARK, name)):
        return None
    return next(kind.rstrip("2") for kind, text in match.groupdict().items() if text)


def is_total(name: str) -> bool:
    """Whether a row seems by its name to sum up those above it: ``Total``."""
    return len(name) <= _LONGEST and _consists_of(_key(name), _TOTALS, _OF_TOTALS)


def speaks_of_slide(text: str) -> bool:
    """Whether prose speaks of a prismatic joint: ``joint 3 is prismatic``."""
    return re.search(_SLIDE_IN_PROSE, text) is not None


def holds_type(text: str, number: int) -> bool:
    """Whether a cell in a column that no field knows says that its joint does not turn.

    Args:
        text: the cell: ``prismatic``, ``fixed``, ``prismatic joint``, ``d2*``, ``slides (prismatic)``.
        number: the number of the row, which a symbol such as ``d2`` has to have.
    """
    if text.isalpha() and joint_type(text) not in (None, JointType.REVOLUTE):
        return True
    symbol = re.fullmatch(_SLIDE_SYMBOL, _key(text[:_LONGEST]))
    if symbol:
        return symbol[0][1:] in ("", str(number))
    if kind_of(text) != "slide":
        return speaks_of_slide(text) or text.casefold() in _MOTIONS
    return not _consists_of(_key(text), _SLIDING, _OF_SLIDES)


def is_plain_label(text: str) -> bool:
    """Whether a cell in a column that no field knows says for sure nothing about the type of its joint."""
    return text.isdecimal() or not (kind_of(text) or holds_type(text, 0))


def is_base(name: str) -> bool:
    """Whether a name is that of a base, or of row 0: ``0 (from base)``."""
    key = _key(name[: _LONGEST + 1])
    return len(name) <= _LONGEST and (key == "0" or _consists_of(key, _BASES, _OF_FRAMES))


def is_first_joint(names: Sequence[str]) -> bool:
    """Whether labels have the numbers of their rows and no others, and the first one names the base: ``1 (base)``.

    A base that does not move has the number 0, or none; and in ``1 (base)``, ``2 (joint 1)`` the joints have others.
    """
    counts = [re.findall(_DIGITS, name) for name in names]
    is_counted = len(names) > 1 and counts == [[str(number)] for number in range(1, len(names) + 1)]
    return is_counted and _consists_of(_key(names[0]), _TURNING_BASES, _words("joint jnt axis j gelenk achse axe"))


def are_joints(names: Collection[str], *, typed: bool) -> bool:
    """Whether none of some ASCII names is that of a row that is hardly a joint that turns, or has a remark in it.

    Args:
        names: in lower case.
        typed: whether each row has a type, which decides for all but totals.
    """
    text = without_separators("".join(names))  # a name that has a word has it here, too
    keys = list(map(_key, names))
    doubtful = (
        any(hint in text for hint in _HINTS) or not all(keys) or any(re.fullmatch(_SLIDE_SYMBOL, key) for key in keys)
    )
    doubtful = (
        doubtful
        or any(re.fullmatch(_TYPE_BEHIND, name) for name in names)
        or any(re.fullmatch(_TO_FRAME, name) for name in names)
    )
    kinds = set(map(kind_of_name, names)) if doubtful else set()
    return "total" not in kinds and (typed or kinds <= {None}) and not any(map(remark_in, names))


def total_problem(row: DHRow, above: Sequence[DHRow | None]) -> Problem | None:
    """Why a row with a type is a total all the same: it is called so, and its lengths are made of those above it."""
    rows = [other for other in above if other is not None]
    if not is_total(row.joint) or len(rows) < len((row.a, row.d)):
        return None
    columns = (([abs(other.a) for other in rows], row.a), ([abs(other.d) for other in rows], row.d))
    for make in (sum, max, min, _mean):
        if any(number for _, number in columns) and all(
            math.isclose(make(numbers), abs(number), rel_tol=1e-3, abs_tol=1e-9) for numbers, number in columns
        ):
            return Problem(
                message=f"the row {shown(row.joint)} seems to be no joint: its lengths sum up those of the rows above",
                mark=row.mark,
                joint=row.joint,
                accepted="one row for each joint",
                suggestion="remove the row, or name it otherwise if it is a joint",
            )
    return None


def _mean(numbers: Sequence[float]) -> float:
    return math.fsum(numbers) / len(numbers)


def _consists_of(key: str, words: frozenset[str], others: frozenset[str]) -> bool:
    """Whether a name consists of words, others and digits, and has one of the words."""
    reached: list[bool | None] = [False, *[None] * len(key)]  # whether the name up to there has a word
    longest = max(map(len, words | others))
    for start in range(len(key)):
        if reached[start] is None:
            continue
        for end in range(start + 1, min(start + longest, len(key)) + 1):
            part = key[start:end]
            if part in words or part in others or part.isdigit():
                reached[end] = bool(reached[end] or reached[start] or part in words)
    return bool(reached[-1])
