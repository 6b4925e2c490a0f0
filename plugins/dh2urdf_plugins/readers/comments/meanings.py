"""What prose says that no comment can declare, and only columns or keys can: the words for it, by what they mean.

Each meaning has words, one of which prose with it has at least, and a pattern that tells it from other uses of them.
Most comments have none of the words, and compile no pattern.
"""

from __future__ import annotations

import re
from typing import NamedTuple

NTH = (
    r"(?:(?:joint|axis|link|gelenk|achse|axe|articulation|articulaci[oó]n|articulação|eje|giunto|asse|junta|eixo|关节|轴|関節|軸"
    r"|관절|축|przegub|eklem|сочленение|ось|j|q)[\s_.#-]*[0-9]{1,2}|第?\s?[0-9一二三四五六七](?:关节|轴|関節|軸)"
    r"|(?:[0-9]{1,2}(?:st|nd|rd|th|\.|[eªº])|first|second|third|fourth|fifth|sixth|last)\s+"
    r"(?:joint|axis|gelenk|achse|axe|articulation|eje|giunto|asse))(?![a-zA-Z0-9\u00c0-\u04ff])"
)
"""A joint by its number, as prose names it."""
_VARIABLE = rf"(?:{NTH}|(?<![^\W_])(?:θ|theta|th|q|d)[\s_{{]*(?:[0-9]{{1,2}}|[₁-₉])\}}?)"
_WORD, _END = r"(?<![^\W_])", r"(?![^\W_])"
"""Where a word begins, and where it ends."""
_NEAR = "[^.;]{0,24}"
_ADDED = r"(?:[0-9]{2,}|[0-9]+(?:[.,][0-9]+|\s*(?:°|deg|rad|mm|cm))|[0-9]*\s?\*?\s?(?:pi|π))"
"""What is added to a joint variable, and no number of a joint: ``q1-6`` are six joints."""
_SIGN = "[-+−]"
_SOME = r"(?:[0-9]|pi|π)"


class Meaning(NamedTuple):
    """What prose may mean.

    Attributes:
        words: in lower case; prose that means it has one of them.
        pattern: what it matches.
    """

    words: tuple[str, ...]
    pattern: str

    def is_in(self, text: str, plain: str) -> bool:
        """Whether a text means it; `plain` is the text without case."""
        return any(word in plain for word in self.words) and re.search(self.pattern, text) is not None


def _meaning(words: str, *patterns: str, also: tuple[str, ...] = ()) -> Meaning:
    return Meaning((*words.split(), *also), "(?i)" + "|".join(patterns))


_STATES = (
    "fixed locked coupled mimic reversed inverted opposite negativ negated welded frozen blocked clamped passiv unused "
    "disabled swapped exchanged mirrored flipped dependent follows linked constant "
    "fest gesperrt blockiert gekoppelt gegenläufig umgekehrt invertiert gespiegelt konstant bloqué couplé inversé fixe "
    "bloquead acoplad invertid fijo fija pasiv contrari constante bloccat accoppiat invertit fisso fissa"
)
_EASTERN_STATES = "固定 不动 被动 从动 耦合 锁定 反向 相反 联动 連動 반대 고정"
"""The same in scripts whose words have no blanks between them."""
_TURNED = "reversed inverted opposite negative positive"
_TIP = "(?:tool|tip|tcp|flange|end[ -]?effector|gripper|hand)"
_NEGATED = "negated reversed inverted flipped mirrored"
_FROM = "horizontal vertical absolute"
_POSED = (
    "straight stretched extended outstretched gestreckt horizontal vertical upright upwards downwards folded candle"
)
_SHIFTED = "offset shifted versatz décalage decalage desfase"
_OFFSETS = "offset shift versatz décalage decalage desfase"


def _any(words: str) -> str:
    return f"(?:{'|'.join(words.split())})"


MOTION = "how a joint moves"
MEANINGS = {
    MOTION: _meaning(
        f"{_STATES} {_EASTERN_STATES} {_TURNED} never n't n’t",
        rf"{NTH}{_NEAR}?{_WORD}(?:{_any(_STATES)}|(?:not|never|n['’]t)\s+(?:mov|used|actuated|driven|turn|rotat)"
        rf"|the (?:other|wrong) (?:way|direction){_END})",
        rf"{NTH}{_NEAR}?(?:{_any(_EASTERN_STATES)}|{_WORD}(?:nicht|non|no|não)\s+(?:an)?(?:ge(?:trieb|nutz)|verwend|bewegt|a[ck]t))",
        rf"{_WORD}(?:angles|joints|signs|directions|axes){_END}{_NEAR}{_any(_NEGATED)}",
        rf"{_WORD}{_any(_TURNED)}\s+(?:direction|sense|sign)\b{_NEAR}{NTH}",
        rf"{_WORD}(?:encoder|motor|servo|drive)s?\s*[0-9]{{0,2}}{_END}{_NEAR}{_any(_NEGATED)}",
        rf"{_WORD}(?:alphas?|α|thetas?|θ|signs?)[^.;,]{{0,16}}{_any(_NEGATED)}",
        rf"{_WORD}(?:ignore|skip|omit|disregard)\s+(?:the\s+)?(?:(?:last|first)\s+)?(?:row|line|{NTH}|joint{_END})",
        rf"{_WORD}(?:(?:row|line)\s*[0-9]{{1,2}}\s+(?:is\s+)?(?:not |un)used|{NTH}\s+does nothing)",
        also=(
            "the other ",
            "the wrong ",
            "not ",
            "nicht ",
            "non ",
            "no ",
            "não ",
            "ignore",
            "skip",
            "omit",
            "disregard",
            "flipped",
            "nothing",
        ),
    ),
    "its sign": _meaning("sign: sign= signs", rf"{_WORD}signs?\s*[:=]\s*[\[(]?\s*{_SIGN}(?!\s?[0-9])"),
    "another joint in it": _meaning(
        "=", r"(?:θ|theta|th|q|j)[\s_{]*[0-9]{1,2}[a-z_}]{0,8}\W{0,3}=[^=]*(?:θ|theta|th|q|j)[\s_{]*[0-9]"
    ),
    "what is added to it": _meaning(
        f"{_FROM} {_OFFSETS} added subtract plus minus 偏置 偏移 オフセット",
        rf"{_WORD}(?:add|subtract|plus|minus)(?:ed)?\s{_NEAR}?{_SOME}{_NEAR}{_VARIABLE}",
        r"(?:偏置|偏移|オフセット)\W{0,3}[0-9π]",
        rf"{_WORD}offsets?\s+(?:(?:is|are|to be)\s+)?subtracted",
        rf"{_SOME}\s*(?:°|deg\w*|rad\w*|mm|cm|m)?\s*(?:offset|shift|versatz){_END}",
        rf"{_VARIABLE}[^.;]{{0,32}}?{_WORD}{_any(_FROM)}(?!\s+(?:ax[ei]s|encoders?|distance|length|reach|offset)\b)",
        # ``joint 4: wrist offset`` is a name of its d, and no offset of the joint
        rf"{_VARIABLE}(?:(?!\s*:)[^.;]{{0,32}}?{_WORD}{_any(_SHIFTED)}"
        rf"|[^.;]{{0,32}}?{_WORD}{_any(_SHIFTED)}\s+(?:(?:by|of|de|um|von)\s+)?{_SIGN}?\s?{_SOME})",
        rf"{_WORD}{_any(_OFFSETS)}{_END}[^.;]{{0,16}}{_VARIABLE}",
        rf"{_WORD}offsets?(?:\s+(?:of|is))?\s*[:=]?\s*[-+−±]?\s*(?:(?![0-9]+\s+(?:rows?|lines?|columns?|cells?|pages?"
        r"|figures?|tables?|characters?|digits?)\b)[0-9.]|pi|π)",
        also=("add ",),
    ),
    "a sum of it": _meaning(
        "q theta θ phi φ",
        rf"{_WORD}(?:θ|theta|th|q|phi|φ)[\s_{{]*[0-9₁-₉]?[}}'\s]{{0,3}}{_SIGN}\s?{_ADDED}",
        rf"{_WORD}(?:θ|theta|th)\w{{0,3}}\W{{0,3}}=\s*(?:[-−]?\s*q\w{{0,3}}\s*{_SIGN}\s*{_SOME}|[-−]\s*q"
        rf"|q\w{{0,3}}\s*[-−]\s*offset)",
    ),
    "a sum of d": _meaning("d1 d2 d3 d4 d5 d6 d7 d_", rf"{_WORD}d_?[0-9]\s?{_SIGN}\s?{_ADDED}"),
    "where its zero is": _meaning(
        "zero home initial reference starts zéro cero null 零",
        rf"{_WORD}(?:zero|home|rest|initial|reference)\b{_NEAR}"
        rf"(?:{_VARIABLE}|(?:position|pose|configuration|angle)s?)[^;]{{0,40}}?(?<![\w.,])[-+−]?{_ADDED}",
        rf"{_VARIABLE}{_NEAR}{_WORD}(?:zero|home|starts? at|zéro|cero)\b{_NEAR}{_ADDED}",
        rf"{_WORD}(?:(?:zero|home|rest|initial|reference)\b{_NEAR}(?:position|pose|configuration|angle)s?"
        rf"|null(?:stellung|lage|position))[^.;]{{0,32}}{_WORD}{_any(_POSED)}{_END}",
        rf"(?:null(?:stellung|lage|punkt|position)|零位|零点){_NEAR}(?<![\w.,])[-+−]?{_ADDED}|(?:零位|零点)\D?[0-9]",
        also=("rest ", "start at"),
    ),
    "how far it moves": _meaning(
        "∈ + limit < ≤ > ≥ ± range .. … to bis ~ ～ between zwischen endless infinite continuous",
        rf"{_WORD}(?:limits?|ranges?|rom|(?:all|each|every) (?:joints?|ax[ei]s)){_END}{_NEAR}"
        r"(?:±|\+\s?/?\s?[-−])\s?[0-9]",
        rf"{_WORD}(?:ranges?|rom){_END}\W{{0,3}}{_SIGN}?[0-9.]+\s?(?:°|deg)?\s?(?:\.\.+|…|to|bis|~)\s?[-+−]?[0-9]",
        rf"{_VARIABLE}[^.;]{{0,32}}?(?:[∈±]|\+\s?/?\s?[-−]\s?[0-9]|[<≤>≥]=?\s?{_SIGN}?\s?{_SOME}|{_WORD}ranges?{_END}"
        r"|[0-9]\s?(?:°|deg)?\s?(?:\.\.+|…|to|bis|~|～)\s?[-+−]?[0-9])",
        rf"{_WORD}(?:between|from|zwischen|von)\s+{_SIGN}?[0-9.]+\s*(?:°|deg|rad|mm|cm|m)?\s+(?:and|to|und|bis)\s+"
        rf"(?:{_SIGN}[0-9]|[0-9.]+\s*(?:°|deg|rad|mm|cm|m){_END})",
        rf"{_WORD}(?:endless|unlimited|no limits?|infinite|continuous (?:rotation|joint|turn|motion)){_END}",
    ),
    "that it turns the other way, or that the base is turned": _meaning(
        "clockwise cw mirror uhrzeiger 顺时针 時計 시계 horaire horario horário orario часовой upside ceiling "
        "wall handed kopf häng hang 装 z0 z_0 z₀ unten decke envers plafond boca techo capovolt 倒 "
        "hand tilted rotated mounted elevated raised symmetric",
        rf"(?<!counter)(?<!counter-)(?<!anti)(?<!anti-){_WORD}(?:clockwise|cw{_END})",
        rf"{_WORD}mirror(?:ed|s)?{_END}|(?<!gegen den )uhrzeigersinn",
        r"顺时针|(?<!反)時計回り|(?<!반)시계 ?방향|(?<!против )часовой",
        rf"(?<!anti)(?<!anti-){_WORD}h?or[aá](?:ire|rio){_END}",
        rf"upside[ -]down|{_WORD}(?:ceiling(?! height)|wall[ -]mount(?:ed)?|left[ -]hand(?:ed)?|kopfüber){_END}",
        rf"{_WORD}(?:(?:tilted|rotated|mounted|elevated|raised) (?:at |by )?[0-9]|symmetric to|(?:y|x)[ -]up{_END})",
        rf"{_WORD}(?:mounted (?:on|to) (?:an? |the )?wall|(?:base|robot|arm)(?: is)? tilted){_END}",
        rf"{_WORD}z(?:[ -]ax[ei]s)?(?: points?| pointing)?[ -]down(?:wards?)?{_END}",
        rf"{_WORD}(?:hängend|hang(?:s|ing)){_END}",
        r"nach unten|(?:an|von) der decke|à l['’]envers|au plafond|boca abajo|(?:d|en )el techo|capovolt",
        rf"倒[装置挂]|吊装|{_WORD}z_?[0₀][^.;]{{0,16}}(?:down|unten|abajo){_END}",
        also=("y up", "x up", "y-up", "x-up", "down"),
    ),
    "that all numbers are scaled": _meaning(
        "10 multipl divided scal maßstab massstab chelle times normali dimensionless doubled halved "
        "tripled = ≙ / equals",
        rf"{_WORD}(?:half|double)[ -](?:scale|size)(?!\s+models?\b)|(?<![\w.])1\s?:\s?[0-9]+\s+scale(?!\s+models?\b)",
        rf"{_WORD}(?:lengths?|values?|numbers?|dimensions?|angles?){_END}{_NEAR}{_WORD}(?:doubled|halved|tripled){_END}",
        rf"{_WORD}(?:lengths?|values?|numbers?|dimensions?|angles?)\s?/\s?[0-9]{{1,4}}(?![\w./])",
        rf"{_WORD}times\s+[0-9]{{2,}}|multiply by|normali[sz]ed|dimensionless",
        r"10\s*(?:\^|\*\*|(?=[⁻⁺⁰¹²³⁴-⁹]))|[x×*]\s*10{1,6}\b",
        r"(?:multiplied|divided|scaled|divide) by|(?:multiples|units) of (?:pi|π|[0-9])|/\s?10{2,6}(?![\w.])",
        rf"{_WORD}(?:1|one)\s*(?:=|means|is)\s*[0-9.]+\s*(?:°|deg|mm|cm){_END}|{_WORD}in thousandths",
        rf"{_WORD}(?:1|one)\s+[^\W\d]{{1,12}}\s*(?:=|≙|equals)\s*[0-9.]",
        rf"{_WORD}in (?:(?:units|steps) of )?[01][0-9.]*(?:e[-+]?[0-9]+)?\s*(?:µm|mm|cm|m|deg|rad|°){_END}",
        rf"{_WORD}(?:scale(?!\s+models?\b)|scaling|scaled|ma(?:ß|ss)stab|[ée]chelle|escala|scala){_END}{_NEAR}[0-9]",
        also=("in 0", "in 1", "units of", "divide by", "multiples of", "1 means", "1 is", "one is", "thousandths"),
    ),
    "a unit that no table has": _meaning(
        "gon grads gradian mrad milliradian arcmin arcsec decimet dezimet yard semi quarter half",
        rf"{_WORD}(?:gons?|grads|gradians?|mrad|milliradians?|arc ?min\w*|arc ?sec\w*|de[cz]imet\w+|yards?"
        rf"|(?:in )?(?:semi-?circles|(?:quarter|half)[ -](?:turns|circles))){_END}",
    ),
    "what masses and limits refer to": _meaning(
        "inertia motor rotor gear weight",
        rf"{_WORD}inertias?{_END}{_NEAR}(?:about|around|at|relative to)\s+(?:the\s+)?"
        r"(?:joint|origin|link|frame|axis|base)",
        rf"{_WORD}(?:com|cog|cent(?:re|er)s? of mass){_END}{_NEAR}"
        r"(?:(?:frame|link)\s*\(?i\s*[-−]\s*1|(?:world|base|previous)\s+(?:frame|link|coord))",
        rf"{_WORD}(?:limits?|speeds?|velocit(?:y|ies)|torques?|ranges?){_END}{_NEAR}{_WORD}(?:motors?|rotor|gear)",
        rf"{_WORD}(?:mass(?:es)?|weights?){_END}\W{{0,3}}(?:(?:in|is|are|given)\s+)*(?:N|newtons?){_END}",
        also=("com ", "cog ", "of mass", "mass in", "masses in", "mass [n", "mass (n"),
    ),
    "that joints move each other": _meaning(
        "parallel closed moves",
        r"parallelogram|parallel (?:link|mechanism|kinematic|structure)|closed[ -](?:loop|chain)",
        rf"{_WORD}moves (?:together )?with\s+(?:the\s+)?{NTH}",
    ),
    "the order of the rows": _meaning(
        "revers starts first numbered counted",
        rf"revers\w+ order|{_WORD}order(?: is|:)? revers|last (?:joint|row|axis) first",
        rf"{_WORD}(?:numbered|counted) from (?:the )?{_TIP}",
        rf"{_WORD}starts? (?:at|with|from) the {_TIP}",
        rf"{_WORD}(?:from|order[:,]?) (?:the )?{_TIP}(?: frame)? (?:back )?(?:down )?to (?:the )?base",
        also=("to base", "to the base"),
    ),
}
