"""Words for types and conventions in other languages than English, which messages do not list."""

from __future__ import annotations

from dh2urdf.manipulator import Convention, JointType
from dh2urdf_plugins.readers.words.word_keys import keys_of

_TYPES = {
    JointType.REVOLUTE: "drehgelenk, rotatorisch, rotoïde, rotacional, rotoidale",
    JointType.PRISMATIC: "schubgelenk, prismatisch, prismatique, prismático, prismatico",
    JointType.FIXED: "fest, fixe, fijo, fisso",
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
