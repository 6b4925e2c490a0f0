"""Words for types and conventions in other languages than English, which messages do not list."""

from __future__ import annotations

from dh2urdf.manipulator import Convention, JointType
from dh2urdf_plugins.readers.words.word_keys import keys_of

_TYPES = {
    JointType.REVOLUTE: "drehgelenk, rotationsgelenk, drehachse, rotatorisch, rotoïde, rotatif, rotacional, rotatoria, "
    "rotatorio, rotativa, rotativo, giratoria, giratorio, revoluta, rotoidale, 转动, 旋转, 回转, 转动副, 旋转副, "
    "вращательная, вращательный, вращательное, obrotowy, obrotowa, obrotowe, döner, dönel, "
    "回転, 回転関節, 회전, 회전관절",
    JointType.PRISMATIC: "schubgelenk, linearachse, lineargelenk, prismatisch, translatorisch, prismatique, glissière, "
    "linéaire, prismático, prismática, lineal, prismatico, prismatica, lineare, 移动, 平移, 直线, 移动副, 棱柱, 直动, "
    "поступательная, поступательный, поступательное, призматическая, призматический, призматическое, przesuwny, "
    "przesuwna, przesuwne, pryzmatyczny, pryzmatyczna, postępowy, prizmatik, kayar, "
    "линейная, линейный, liniowy, liniowa, doğrusal, 直動, 直動関節, 並進, 직동, 직동관절, 병진, 직선",
    JointType.FIXED: "fest, fixe, fijo, fija, fisso, fissa, fixo, fixa, 固定, неподвижная, неподвижный, "
    "фиксированная, фиксированный, nieruchomy, stały, sabit, 고정",
}
_CONVENTIONS = {
    Convention.STANDARD: "estándar",
    Convention.MODIFIED: "modifiziert, modifiée, modificada, modificata",
}
OTHER_TYPES = {key: kind for kind, words in _TYPES.items() for word in words.split(", ") for key in keys_of(word)}
"""Types of joints by the keys of words for them."""
OTHER_CONVENTIONS = {
    key: kind for kind, words in _CONVENTIONS.items() for word in words.split(", ") for key in keys_of(word)
}
"""Conventions by the keys of words for them."""
