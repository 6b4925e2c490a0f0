"""Evaluates expressions of a foreign xacro by walking their syntax tree; Python's own `eval` never sees them.

An expression has data, namespaces that answer to a name and to nothing else, and `functions.Function`, the one kind of
value that can be called. No class, module or table is among them. `functions.Work` bounds every value, and the sum.
"""

from __future__ import annotations

import ast
import functools
from collections import ChainMap
from typing import TYPE_CHECKING

from dh2urdf_plugins.xacro_fence.functions import OPERATORS, ExpressionError, Formatter, Function, Namespace, attribute

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from dh2urdf_plugins.xacro_fence.functions import Value, Work

MAX_EXPRESSION = 20_000
"""Characters of an expression."""
_KINDS: dict[type, type] = {ast.List: list, ast.Tuple: tuple, ast.Set: set, ast.ListComp: list, ast.SetComp: set}


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
                return attribute(value(of), name, self._work)
            case ast.Subscript(of, ast.Slice(lower, upper, step)):
                return made(value(of)[slice(*(part and value(part) for part in (lower, upper, step)))])
            case ast.Subscript(of, index):
                return value(of)[value(index)]
            case ast.Call(called, args, keywords):
                function, given = value(called), self._items(args)
                named: Value = {word.arg: value(word.value) for word in keywords}
                if not isinstance(function, Function):
                    raise ExpressionError(f"calling {type(function).__name__!r} is refused")
                return function(*given, **named)
            case ast.Lambda(parameters, body):
                return self._function(parameters, body)
            case ast.UnaryOp(op, operand):
                return OPERATORS[type(op)](value(operand))
            case ast.BinOp(left, op, right):
                return made(OPERATORS[type(op)](value(left), value(right)))
            case ast.BoolOp(op, parts):
                for part in parts:
                    if bool(found := value(part)) is isinstance(op, ast.Or):
                        break
                return found
            case ast.Compare(left, ops, parts):
                before = value(left)
                for relation, part in zip(ops, parts, strict=True):
                    if not (found := OPERATORS[type(relation)](before, before := value(part))):
                        break
                return found
            case ast.IfExp(test, body, otherwise):
                return value(body if value(test) else otherwise)
            case ast.JoinedStr(parts):
                return made("".join(map(value, parts)))
            case ast.FormattedValue(of, conversion, form):
                formatter = Formatter(self._work)
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
