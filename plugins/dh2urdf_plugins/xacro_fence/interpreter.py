"""Evaluates expressions of a foreign xacro by walking their syntax tree; Python's own `eval` never sees them.

An expression has data, namespaces that answer to a name and to nothing else, and `Function`, the one kind of value that
can be called. No class, module or table is among them. `Work` bounds every value, and the sum.
"""

from __future__ import annotations

import ast
import builtins
import functools
import math
import operator
import re
import string
import tomllib
from collections import ChainMap
from collections.abc import Iterator, Sized
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import xacro  # noqa: TID253 - only the child that expands imports this module

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

Value: TypeAlias = Any  # what an expression comes to
MAX_EXPRESSION, MAX_BITS, MAX_ARGUMENT = 20_000, 8192, 1000
"""Characters of an expression; bits of a whole number; width, digits to round to, and argument of a factorial."""
MAX_SIZE, MAX_WORK = 1_000_000, 5_000_000
"""Elements, characters and bits of a value at all depths; and of all values of a file, with the steps to make them."""

_ALLOWED: dict[str, dict[str, str]] = tomllib.loads(Path(__file__).with_name("allowed.toml").read_text("utf-8"))
_ATTRIBUTES: dict[Value, set[str]] = {
    tuple(getattr(builtins, kind) for kind in kinds.split()): set(names.split())
    for kinds, names in _ALLOWED["attributes"].items()
}


class ExpressionError(Exception):
    """An expression does what no expression of a robot needs."""


def bounded(size: Value, most: int, what: str) -> Value:
    """Return a size, unless it is above a bound: that is an `ExpressionError`."""
    if abs(size) > most:
        raise ExpressionError(f"{what} of more than {most} is refused")
    return size


class Work:
    """Bounds what the expressions of a file make and do."""

    def __init__(self) -> None:
        self._left = MAX_WORK

    def spend(self, steps: int) -> None:
        """Count steps."""
        self._left -= steps
        if self._left < 0:
            raise ExpressionError(f"macros and expressions take more than {MAX_WORK} steps")

    def made(self, value: Value) -> Value:
        """Count a value with all that it contains, and return it."""
        size, waiting = 0, [value]
        while waiting:
            item = waiting.pop()
            if isinstance(item, bytes):
                raise ExpressionError("bytes are refused")
            if isinstance(item, int):
                size += bounded(item.bit_length(), MAX_BITS, "a number of bits")
            within = isinstance(item, (list, tuple, set, frozenset, dict))
            size += 1 + (len(item) if within or isinstance(item, str) else 0)
            bounded(size, MAX_SIZE, "a size")
            if within:
                waiting.extend((*item, *item.values()) if isinstance(item, dict) else item)
        self.spend(size)
        return value


class _NoText:
    def __repr__(self) -> str:
        raise ExpressionError("a function or a namespace is no text: call it, or write a name in it after a dot")


class Function(_NoText):
    """A function, method, type or lambda: all that an expression may call. `kind` is the type that it stands for."""

    def __init__(self, work: Work, name: str, call: Callable[..., Value]) -> None:
        self._work, self._call, self.kind = work, _OWN.get(name, call), call if isinstance(call, type) else None

    def __call__(self, *args: Value, **named: Value) -> Value:
        """Return what it makes of values; what an iterator among them gives is counted first."""
        self._work.spend(sum(len(arg) for arg in args if isinstance(arg, Sized)))
        drawn = [iter(self._work.made(list(arg))) if isinstance(arg, Iterator) else arg for arg in args]
        return self._work.made(self._call(*drawn, **named))


class Namespace(_NoText):
    """Names with their values: the table of xacro that has them is neither seen nor changed."""

    def __init__(self, work: Work, table: Mapping[str, Value]) -> None:
        self._work, self.table = work, table

    def __getitem__(self, name: object) -> Value:
        if not isinstance(name, str) or name.startswith("__"):
            raise ExpressionError(f"the name {name!r} is refused")
        try:
            value = self.table[name]
        except KeyError:
            raise NameError(f"name {name!r} is not defined") from None
        if isinstance(value, xacro.Table):
            return Namespace(self._work, value)
        return Function(self._work, name, value) if callable(value) and not isinstance(value, Function) else value


def _attribute(value: Value, name: str, work: Work) -> Value:
    """A method of data, or an entry whose name follows a dot; any other attribute is an `ExpressionError`."""
    for kind, names in _ATTRIBUTES.items():
        if isinstance(value, kind) and name in names:
            found = getattr(value, name)
            if isinstance(value, str) and name == "format":
                found = partial(_Formatter(work).format, value)
            elif isinstance(value, str) and name in _ALLOWED["growing"]["methods"].split():
                found = partial(_grown, name, value)
            return Function(work, "", found) if callable(found) else found
    is_entry = isinstance(value, Namespace) and name not in dir(value.table)
    if is_entry or (isinstance(value, xacro.YamlDictWrapper) and name not in dir(dict)):
        return value[name]
    raise ExpressionError(f"the attribute {name!r} of a {type(value).__name__} is refused")


def _grown(name: str, text: str, *args: Value) -> Value:
    args = tuple(list(arg) if isinstance(arg, Iterator) else arg for arg in args)
    sizes = [abs(each) if isinstance(each, int) else len(each) for each in (text, *args)]
    bounded(math.prod(1 + size for size in sizes), MAX_SIZE, "a size")
    return getattr(text, name)(*args)


class _Formatter(string.Formatter):
    """Fills a text in as `str.format` does, by names and numbers alone: no field reaches an attribute of a value."""

    def __init__(self, work: Work) -> None:
        self._work = work

    def get_field(self, field_name: str, args: Value, kwargs: Value) -> Value:
        if not field_name.isidentifier() and not field_name.isdecimal():
            raise ExpressionError(f"the field {field_name!r} of a format is refused")
        return super().get_field(field_name, args, kwargs)

    def format_field(self, value: Value, format_spec: str) -> str:
        for width in re.findall("[0-9]+", format_spec):
            bounded(int(width), MAX_ARGUMENT, "a width")
        return str(self._work.made(format(value, format_spec)))


# --- Functions and operators that need a bound before they work -------------------------------------------------------


def _product(left: Value, right: Value) -> Value:
    for sequence, times in ((left, right), (right, left)):
        if isinstance(sequence, Sized) and isinstance(times, int):
            bounded(len(sequence) * times, MAX_SIZE, "a size")
    return left * right


def _power(base: Value, exponent: Value) -> Value:
    if isinstance(base, int) and isinstance(exponent, int):
        bounded(base.bit_length() * exponent, MAX_BITS, "a number of bits")
    return base**exponent


def _remainder(left: Value, right: Value) -> Value:
    if isinstance(left, str):
        fields = re.findall(r"%(\([^)]*\))?([-+ #0-9.*]*)", left)
        for key, flags in fields:
            if "(" in key[1:]:
                raise ExpressionError("a key with parentheses is refused in a format")
            for width in re.findall(r"[0-9]+|\*", flags):
                bounded(math.inf if width == "*" else int(width), MAX_ARGUMENT, "a width")
        bounded(len(fields) * len(str(right)), MAX_SIZE, "a size")  # a mapping may fill in a value many times
    return left % right


def _of_small(function: Callable[..., Value], *numbers: Value) -> Value:
    return function(*(bounded(number, MAX_ARGUMENT, "an argument") for number in numbers))


def _refused(*_args: Value) -> Value:
    raise ExpressionError("what shows a type or what is behind a value is refused; `isinstance` is not")


def _tokenize(text: str, sep: str = ",; ", *skip_empty: bool) -> Value:
    if "]" in sep:  # xacro makes a pattern of it
        raise ExpressionError("the separator ']' is refused")
    return xacro.tokenize(text, sep, *skip_empty)


_OWN: dict[str, Callable[..., Value]] = {
    "range": lambda *ends: range(*ends)[: bounded(len(range(*ends)), MAX_SIZE, "a range")],
    "round": lambda number, digits=None: round(number, digits and _of_small(int, digits)),
    "prod": lambda numbers: _of_small(lambda *each: math.prod(each), *numbers),
    **{each.__name__: partial(_of_small, each) for each in (math.factorial, math.comb, math.perm, math.lcm)},
    **dict.fromkeys(("type", "vars"), _refused),
    "isinstance": lambda value, kinds: any(
        isinstance(value, each.kind) for each in (kinds if isinstance(kinds, tuple) else (kinds,))
    ),
    "tokenize": _tokenize,
}
"""What takes the place of functions of xacro, by name."""
_OPERATORS: dict[type[ast.AST], Callable[..., Value]] = {
    **{getattr(ast, kind): getattr(operator, name) for kind, name in _ALLOWED["operators"].items()},
    ast.Mult: _product,
    ast.Pow: _power,
    ast.LShift: lambda number, by: number << bounded(by, MAX_BITS, "a number of bits"),
    ast.Mod: _remainder,
    ast.In: lambda one, many: one in many,
    ast.NotIn: lambda one, many: one not in many,
}
"""What an operator does, by its node."""
_KINDS: dict[type, type] = {ast.List: list, ast.Tuple: tuple, ast.Set: set, ast.ListComp: list, ast.SetComp: set}


# --- The syntax tree --------------------------------------------------------------------------------------------------


def evaluate(text: str, names: Mapping[str, Value], work: Work) -> Value:
    """Return the value of an expression; what is refused is an `ExpressionError`, other errors are Python's."""
    names = ChainMap({}, Namespace(work, names))  # type: ignore[arg-type]  # the first alone is written
    return work.made(_Scope(work, names).value(_parsed(text)))


@functools.lru_cache(4096)
def _parsed(text: str) -> ast.expr:
    if len(text) > MAX_EXPRESSION:
        raise ExpressionError(f"the expression has {len(text)} characters, more than {MAX_EXPRESSION}")
    tree = ast.parse(text.strip(), "<expression>", "eval").body
    for node in ast.walk(tree):
        for name in (getattr(node, of, None) for of in ("id", "attr", "arg")):
            if isinstance(name, str) and name.startswith("__"):
                raise ExpressionError(f"the name {name!r} is refused")
    return tree


class _Scope:
    """The names that an expression, a lambda or a comprehension sees; evaluates nodes with them."""

    def __init__(self, work: Work, names: ChainMap[str, Value]) -> None:
        self._work, self._names = work, names

    def value(self, node: ast.AST | None) -> Value:  # noqa: C901, PLR0911, PLR0912 - one case for each kind of node
        """Return the value of a node."""
        self._work.spend(1)
        value, made = self.value, self._work.made
        match node:
            case ast.Constant(constant):
                return made(constant)
            case ast.Name(name):
                return self._names[name]
            case ast.Attribute(of, name):
                return _attribute(value(of), name, self._work)
            case ast.Subscript(of, ast.Slice(lower, upper, step)):
                return made(value(of)[slice(*(part and value(part) for part in (lower, upper, step)))])
            case ast.Subscript(of, index):
                return value(of)[value(index)]
            case ast.Call(called, args, keywords):
                function, given = value(called), self._items(args)
                if not isinstance(function, Function):
                    raise ExpressionError(f"calling {type(function).__name__!r} is refused")
                named: Value = {word.arg: value(word.value) for word in keywords}
                return function(*given, **named)
            case ast.Lambda(parameters, body):
                return self._function(parameters, body)
            case ast.UnaryOp(op, operand):
                return _OPERATORS[type(op)](value(operand))
            case ast.BinOp(left, op, right):
                return made(_OPERATORS[type(op)](value(left), value(right)))
            case ast.BoolOp(op, parts):
                for part in parts:
                    if bool(found := value(part)) is isinstance(op, ast.Or):
                        break
                return found
            case ast.Compare(left, ops, parts):
                before = value(left)
                for relation, part in zip(ops, parts, strict=True):
                    if not (found := _OPERATORS[type(relation)](before, before := value(part))):
                        break
                return found
            case ast.IfExp(test, body, otherwise):
                return value(body if value(test) else otherwise)
            case ast.JoinedStr(parts):
                return made("".join(map(value, parts)))
            case ast.FormattedValue(of, conversion, form):
                formatter = _Formatter(self._work)
                shown = formatter.convert_field(value(of), chr(conversion) if conversion > 0 else None)
                return formatter.format_field(shown, value(form) if form else "")
            case ast.List(parts) | ast.Tuple(parts) | ast.Set(parts):
                return made(_KINDS[type(node)](self._items(parts)))
            case ast.ListComp(part, loops) | ast.SetComp(part, loops):
                return made(_KINDS[type(node)](inner.value(part) for inner in self._rounds(loops)))
            case ast.Dict(keys, parts):
                return made({value(key): value(part) for key, part in zip(keys, parts, strict=True)})
            case ast.DictComp(key, part, loops):
                return made({inner.value(key): inner.value(part) for inner in self._rounds(loops)})
            case ast.GeneratorExp(part, loops):
                return (inner.value(part) for inner in self._rounds(loops))
        raise ExpressionError(f"{type(node).__name__} is refused in an expression")

    def _items(self, nodes: Iterable[ast.expr]) -> list[Value]:
        items: list[Value] = []
        for node in nodes:
            items.extend(list(self.value(node.value)) if isinstance(node, ast.Starred) else [self.value(node)])
        return items

    def _function(self, parameters: ast.arguments, body: ast.expr) -> Function:
        """What a lambda makes: it sees the names of its scope as they are when it is called."""
        names = [each.arg for each in parameters.args]
        if ast.unparse(parameters) != ", ".join(names):
            raise ExpressionError("a lambda with other than plain parameters is refused")

        def called(*values: Value) -> Value:
            return _Scope(self._work, self._names.new_child(dict(zip(names, values, strict=True)))).value(body)

        return Function(self._work, "", called)

    def _rounds(self, loops: list[ast.comprehension]) -> Iterator[_Scope]:
        """The scope of a comprehension, once for each round; its first items are found outside it, as in Python."""
        inner = _Scope(self._work, self._names.new_child())
        return inner._inner_rounds(loops, iter(self.value(loops[0].iter)))

    def _inner_rounds(self, loops: list[ast.comprehension], items: Iterator[Value]) -> Iterator[_Scope]:
        loop, *rest = loops
        if loop.is_async:
            raise ExpressionError("async is refused in an expression")
        for item in items:
            self._bind(loop.target, item)
            if all(map(self.value, loop.ifs)):
                yield from self._inner_rounds(rest, iter(self.value(rest[0].iter))) if rest else (self,)

    def _bind(self, target: ast.expr, value: Value) -> None:
        match target:
            case ast.Name(name):
                self._names[name] = value
            case ast.Tuple(parts) | ast.List(parts):
                for part, item in zip(parts, list(value), strict=True):
                    self._bind(part, item)
            case _:
                raise ExpressionError(f"{type(target).__name__} is refused as the name of a loop")
