"""How words are compared: without case, separators and accents."""

from __future__ import annotations

import unicodedata

_SPACES = "\t\n\v\f\r\x1c\x1d\x1e\x1f \x85\xa0\u1680\u2028\u2029\u202f\u205f\u3000"
_SEPARATORS = f"{_SPACES}_.*{{}}'’-"
_DOT_WORDS = {"\u0307": "dot", "\u0308": "ddot"}
_DOTS = {f"{letter}{dots}": f"{letter}{word}" for letter in "qθτ" for dots, word in _DOT_WORDS.items()}
_GREEK = str.maketrans({"α": "alpha", "θ": "theta", "σ": "sigma", "β": "beta", "γ": "gamma", "φ": "phi", "τ": "tau"})
_GREEK |= str.maketrans({"ω": "omega", "μ": "mu", "ı": "i", "ё": "е", "№": "no"})  # with letters of other alphabets
_WITHOUT_DOTS = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue"})
_KEY = _GREEK | dict.fromkeys((*map(ord, _SEPARATORS), *range(0x2000, 0x200B), *range(0x300, 0x370)))
"""Without separators, among them all white space, and without accents."""


def without_separators(word: str) -> str:
    """The letters and digits of a word."""
    return "".join(filter(str.isalnum, word))


def key_of(plain: str) -> str:
    """A word without case, separators and accents, by which headers are compared."""
    if plain.isascii():
        if plain.isalpha():
            return plain
    else:
        plain = unicodedata.normalize("NFD", plain)
        if not _DOT_WORDS.keys().isdisjoint(plain):
            for dotted, word in _DOTS.items():
                plain = plain.replace(dotted, word)
    return plain.translate(_KEY)


def keys_of(word: str) -> set[str]:
    """The keys by which a word of the lists above is known: with ``ä`` written as ``a`` or as ``ae``."""
    twin = word if word.isascii() else word.translate(_WITHOUT_DOTS)
    return {key_of(word)} if twin == word else {key_of(word), key_of(twin)}
