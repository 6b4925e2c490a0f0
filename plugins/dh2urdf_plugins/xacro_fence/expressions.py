"""Expressions of a stranger's xacro, checked as a whole before any of it is evaluated.

xacro hands what is in ``${…}`` to Python, and looks for two underscores in the names of the outermost code alone: a
lambda hides anything from it. Here the whole syntax tree is checked, and what cannot be known before it is evaluated
goes through functions of our own, which are bounded: attributes, calls, products, powers and sums.
"""

from __future__ import annotations

import ast
import math
import re
import secrets
import types
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

MAX_EXPRESSION = 20_000
"""Characters of an expression."""
MAX_BITS = 8192
"""Bits of a whole number."""
MAX_ITEMS = 1_000_000
"""Characters of a text, elements of a list, numbers of a range."""
MAX_FACTORIAL = 1000
"""Largest argument of a factorial and of its relatives."""

_FILE = "<expression>"
_CLASSES = (
    *(ast.Expression, ast.Constant, ast.Name, ast.Load, ast.Store),
    *(ast.BinOp, ast.UnaryOp, ast.BoolOp, ast.Compare, ast.IfExp),
    *(ast.Tuple, ast.List, ast.Set, ast.Dict, ast.Subscript, ast.Slice, ast.Starred),
    *(ast.Call, ast.keyword, ast.Attribute, ast.Lambda, ast.arguments, ast.arg),
    *(ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp, ast.comprehension),
    *(ast.JoinedStr, ast.FormattedValue),
    *(ast.operator, ast.unaryop, ast.boolop, ast.cmpop),
)
_TEXT = (
    "capitalize casefold center count endswith expandtabs find index isalnum isalpha isascii isdecimal isdigit "
    "isidentifier islower isnumeric isprintable isspace istitle isupper join ljust lower lstrip partition removeprefix "
    "removesuffix replace rfind rindex rjust rpartition rsplit rstrip split splitlines startswith strip swapcase title "
    "upper zfill"
)
_METHODS: dict[type, frozenset[str]] = {
    kind: frozenset(names.split())
    for kind, names in (
        (str, _TEXT),
        (list, "append clear copy count extend index insert pop remove reverse sort"),
        (tuple, "count index"),
        (dict, "clear copy get items keys pop popitem setdefault update values"),
        (set, "add clear copy difference discard intersection isdisjoint issubset issuperset pop remove union update"),
        (frozenset, "copy difference intersection isdisjoint issubset issuperset union"),
        (float, "conjugate imag is_integer real"),
        (int, "bit_count bit_length conjugate denominator imag numerator real"),
        (complex, "conjugate imag real"),
        (range, "count index start step stop"),
    )
}
_FILLED = ("center", "ljust", "rjust", "zfill", "expandtabs")
_GROWING = ("join", "replace")
_FORMAT = re.compile(r"%(?:\([^)]*\))?[-+ #0]*(\*|[0-9]*)(?:\.(\*|[0-9]*))?[hlL]?[a-zA-Z%]")
_WIDEST = 1000


class ExpressionError(Exception):
    """An expression does what no expression of a robot needs."""


def evaluate(
    text: str, names: dict[str, Any], local: Mapping[str, object] | None, calls: Mapping[int, Callable[..., Any]]
) -> Any:  # noqa: ANN401 - whatever it comes to
    """What an expression comes to.

    Args:
        text: the expression.
        names: the values of its names.
        local: further ones, which come first.
        calls: what may be called, by `id`.

    Raises:
        ExpressionError: something in it is refused.
        Exception: whatever Python raises about it.
    """
    code = compiled(text)

    def call(function: Callable[..., Any], *args: object, **named: object) -> object:
        return _called(function, calls)(*args, **named)

    # Past the table's own way of setting names, as xacro itself does.
    dict.__setitem__(names, "__builtins__", {**_GUARDS, _CALL: call})
    return eval(code, names, local)  # noqa: S307 - the tree was checked, and what it calls is guarded


def compiled(text: str) -> types.CodeType:
    """The code of an expression in which nothing is refused.

    Raises:
        ExpressionError: something in it is refused.
        SyntaxError: it is none.
    """
    if len(text) > MAX_EXPRESSION:
        raise ExpressionError(f"the expression has {len(text)} characters, more than {MAX_EXPRESSION}")
    tree = ast.parse(text.strip(), _FILE, "eval")
    for node in ast.walk(tree):
        _check(node)
    return compile(ast.fix_missing_locations(_Guarded().visit(tree)), _FILE, "eval", dont_inherit=True)


def _check(node: ast.AST) -> None:
    if not isinstance(node, _CLASSES):
        raise ExpressionError(f"{type(node).__name__} is refused in an expression")
    name = node.id if isinstance(node, ast.Name) else node.arg if isinstance(node, (ast.arg, ast.keyword)) else None
    if name is not None and name.startswith("__"):
        raise ExpressionError(f"the name {name!r} is refused")
    if isinstance(node, ast.Attribute) and node.attr.startswith("_"):
        raise ExpressionError(f"the attribute {node.attr!r} is refused")
    if isinstance(node, ast.FormattedValue) and (node.format_spec is not None or node.conversion != -1):
        raise ExpressionError("a format in an f-string is refused")
    if isinstance(node, ast.comprehension) and node.is_async:
        raise ExpressionError("async is refused in an expression")


class _Guarded(ast.NodeTransformer):
    """Puts guards around what is only known when it is evaluated."""

    def visit_BinOp(self, node: ast.BinOp) -> ast.AST:
        self.generic_visit(node)
        guard = _OPERATORS.get(type(node.op))
        return node if guard is None else _guard(guard, node.left, node.right)

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        self.generic_visit(node)
        node.value = _guard(_ENTRIES, node.value)
        return node

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        self.generic_visit(node)
        return _guard(_ATTRIBUTE, node.value, ast.Constant(node.attr))

    def visit_Call(self, node: ast.Call) -> ast.AST:
        self.generic_visit(node)
        return ast.Call(func=_name(_CALL), args=[node.func, *node.args], keywords=node.keywords)


# No name of a xacro can be one of these: it has no spaces, and does not know the number.
_ATTRIBUTE, _CALL, _ENTRIES, _SUM, _PRODUCT, _POWER, _SHIFTED, _REMAINDER, _EITHER = (
    f"{word} {secrets.token_hex(8)}"
    for word in ("attribute", "call", "entries", "sum", "product", "power", "shifted", "rest", "either")
)
_OPERATORS: dict[type[ast.operator], str] = {
    ast.Add: _SUM,
    ast.Mult: _PRODUCT,
    ast.Pow: _POWER,
    ast.LShift: _SHIFTED,
    ast.Mod: _REMAINDER,
    ast.BitOr: _EITHER,
}


def _name(name: str) -> ast.Name:
    return ast.Name(id=name, ctx=ast.Load())


def _guard(name: str, *args: ast.expr) -> ast.Call:
    return ast.Call(func=_name(name), args=list(args), keywords=[])


# --- Guards -----------------------------------------------------------------------------------------------------------


def _bits(number: object) -> int:
    return abs(number).bit_length() if isinstance(number, int) else 0


def _bounded(size: int, most: int, what: str) -> None:
    if size > most:
        raise ExpressionError(f"{what} of more than {most} is refused")


def _sum(left: Any, right: Any) -> Any:  # noqa: ANN401
    if isinstance(left, (str, list, tuple)) and isinstance(right, (str, list, tuple)):
        _bounded(len(left) + len(right), MAX_ITEMS, "a length")
    return left + right


def _product(left: Any, right: Any) -> Any:  # noqa: ANN401
    for sequence, times in ((left, right), (right, left)):
        if isinstance(sequence, (str, list, tuple, bytes)) and isinstance(times, int):
            _bounded(len(sequence) * max(times, 0), MAX_ITEMS, "a length")
    _bounded(_bits(left) + _bits(right), 2 * MAX_BITS, "a number of bits")
    return left * right


def _power(base: Any, exponent: Any) -> Any:  # noqa: ANN401
    if isinstance(base, int) and isinstance(exponent, int):
        _bounded(_bits(base) * abs(exponent), MAX_BITS, "a number of bits")
    return base**exponent


def _shifted(number: Any, by: Any) -> Any:  # noqa: ANN401
    if isinstance(by, int):
        _bounded(_bits(number) + max(by, 0), MAX_BITS, "a number of bits")
    return number << by


def _remainder(left: Any, right: Any) -> Any:  # noqa: ANN401
    if isinstance(left, bytes):
        raise ExpressionError("a format of bytes is refused")
    if isinstance(left, str):
        for match in _FORMAT.finditer(left):
            for width in match.groups():
                if width == "*" or (width and int(width) > _WIDEST):
                    raise ExpressionError(f"the width {width!r} of a format is refused")
    return left % right


def _entries(value: Any) -> Any:  # noqa: ANN401
    """What is indexed: a type with an index is no value but another type."""
    if isinstance(value, type):
        raise ExpressionError(f"an index of the type {value.__name__!r} is refused")
    return value


def _either(left: Any, right: Any) -> Any:  # noqa: ANN401
    if isinstance(left, type) or isinstance(right, type):
        raise ExpressionError("a union of types is refused")
    return left | right


def _attribute(value: Any, name: str) -> Any:  # noqa: ANN401
    """An attribute that an expression may have: a method of a text, list or mapping, or an entry with a dot."""
    entries = getattr(type(value), "__getattr__", None)  # of xacro: namespaces, and mappings that YAML gave
    if isinstance(value, dict) and entries is not None and name not in _METHODS[dict]:
        return entries(value, name)
    for kind, names in _METHODS.items():
        if isinstance(value, kind) and name in names:
            method = getattr(value, name)
            if kind is str and name in _FILLED:
                return _narrow(method)
            return _short(value, name, method) if isinstance(value, str) and name in _GROWING else method
    raise ExpressionError(f"the attribute {name!r} of a {type(value).__name__} is refused")


def _narrow(method: Callable[..., str]) -> Callable[..., str]:
    """A method that fills a text up, to a bounded width."""

    def narrow(width: int, *fill: str) -> str:
        _bounded(width, MAX_ITEMS, "a width")
        return method(width, *fill)

    return _approved(narrow)


def _short(text: str, name: str, method: Callable[..., str]) -> Callable[..., str]:
    """A method that puts texts together, into one of a bounded length."""

    def joined(parts: Iterable[str]) -> str:
        parts = list(parts)
        _bounded(sum(map(len, parts)) + len(text) * len(parts), MAX_ITEMS, "a length")
        return method(parts)

    def replaced(old: str, new: str, count: int = -1) -> str:
        _bounded(len(text) + text.count(old) * len(new), MAX_ITEMS, "a length")
        return method(old, new, count)

    return _approved(joined if name == "join" else replaced)


def _called(function: object, calls: Mapping[int, Callable[..., Any]]) -> Callable[..., Any]:
    """A function that may be called: one that xacro documents, a method that was let through, or a lambda."""
    known = calls.get(id(function))
    if known is not None and known is function:
        return known
    if isinstance(function, types.FunctionType) and (function in _APPROVED or function.__code__.co_filename == _FILE):
        return function
    if isinstance(function, types.BuiltinMethodType):
        owner, name = function.__self__, function.__name__
        if any(isinstance(owner, kind) and name in names for kind, names in _METHODS.items()):
            return function
    raise ExpressionError(f"calling {getattr(function, '__name__', type(function).__name__)!r} is refused")


_APPROVED: set[Callable[..., Any]] = set()


def _approved(function: Callable[..., Any]) -> Callable[..., Any]:
    _APPROVED.add(function)
    return function


_GUARDS: dict[str, Callable[..., Any]] = {
    _SUM: _sum,
    _PRODUCT: _product,
    _POWER: _power,
    _SHIFTED: _shifted,
    _REMAINDER: _remainder,
    _EITHER: _either,
    _ENTRIES: _entries,
    _ATTRIBUTE: _attribute,
}


# --- Functions that take the place of those of Python -----------------------------------------------------------------


def bounded_range(*bounds: int) -> range:
    """A range of a bounded number of numbers."""
    numbers = range(*bounds)
    _bounded(len(numbers), MAX_ITEMS, "a range")
    return numbers


def type_of(value: object) -> type:
    """The type of a plain value: Python's own makes types of three arguments, and shows those behind functions."""
    if not isinstance(value, (*_METHODS, type(None))):
        raise ExpressionError(f"the type of a {type(value).__name__} is refused")
    return type(value)


def _small(function: Callable[..., int]) -> Callable[..., int]:
    def small(*numbers: int) -> int:
        _bounded(max((n for n in numbers if isinstance(n, int)), default=0), MAX_FACTORIAL, "a factorial")
        return function(*numbers)

    small.__name__ = function.__name__
    return small


BOUNDED: dict[str, Callable[..., Any]] = {
    "range": bounded_range,
    "type": type_of,
    "factorial": _small(math.factorial),
    "comb": _small(math.comb),
    "perm": _small(math.perm),
}
"""What takes the place of functions that have no bound of their own, by name."""
REFUSED = ("vars",)
"""Functions that show what is behind a value."""
