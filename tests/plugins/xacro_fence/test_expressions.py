from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given, strategies as st

from dh2urdf_plugins.xacro_fence.expressions import BOUNDED, ExpressionError, compiled, evaluate

FUNCTIONS: dict[str, Any] = {
    **{
        function.__name__: function
        for function in (len, str, list, dict, map, sorted, sum, min, max, float, int, filter)
    },
    **BOUNDED,
    "pi": math.pi,
    "sin": math.sin,
    "true": True,
}
CALLS = {id(value): value for value in FUNCTIONS.values() if callable(value)}


def value_of(text: str) -> Any:
    return evaluate(text, dict(FUNCTIONS), None, CALLS)


WRITTEN = {
    "1 + 2*3**2": 19,
    "sin(pi/2)": 1.0,
    "'left' + '_' + str(3)": "left_3",
    "[2*x for x in [1, 2] if x > 1]": [4],
    "{k: v for k, v in dict(a=1).items()}": {"a": 1},
    "dict(a=1).get('b', 5)": 5,
    "'a,b'.split(',')[1].upper()": "B",
    "list(map(lambda x: x + 1, range(3)))": [1, 2, 3],
    "sorted([3, 1], key=lambda x: -x)": [3, 1],
    "f'{1 + 1}_{\"a\"}'": "2_a",
    "'%05.1f' % 2.25": "002.2",
    "1 if true else 0": 1,
    "not (1 < 2 <= 3)": False,
    "'ab' * 2": "abab",
    "2**-1": 0.5,
    "1 << 4": 16,
    "'x'.rjust(3, '0')": "00x",
    "factorial(5)": 120,
    "(lambda *a: len(a))(1, 2)": 2,
    "[1, 2, 3][-2:]": [2, 3],
    "max(*[1, 2])": 2,
}


@pytest.mark.parametrize("text", WRITTEN)
def test_what_people_write_is_evaluated_as_python_does(text: str) -> None:
    assert value_of(text) == WRITTEN[text]


ATTACKS = {
    # what is behind a value
    "().__class__": "attribute '__class__'",
    "(lambda: ().__class__.__base__.__subclasses__())()": "attribute '__",
    "[c for c in ().__class__.__mro__]": "attribute '__",
    "(lambda f=(lambda: 0): f.__globals__)()": "attribute '__globals__'",
    "{''.__class__: 1}": "attribute '__class__'",
    "len.__self__": "attribute '__self__'",
    "'a'._formatter_parser()": "attribute '_formatter_parser'",
    "(x for x in [1]).gi_frame": "attribute 'gi_frame' of a generator",
    "sin.real": "attribute 'real' of a builtin",
    "(lambda: 0).func_code": "attribute 'func_code' of a function",
    # formats, which reach attributes in a text
    "'{0.__class__}'.format(1)": "attribute 'format' of a str",
    "'{a.__class__}'.format_map(dict(a=1))": "attribute 'format_map' of a str",
    "str.format('{0.__class__}', 1)": "attribute 'format' of a type",
    "list(map(str.format, ['{0.__class__}'], [1]))": "attribute 'format' of a type",
    "f'{1:>{10**9}}'": "a format in an f-string",
    "f'{1!r:>999999999}'": "a format in an f-string",
    "'%999999999d' % 1": "the width '999999999'",
    "'%*d' % (10**8, 1)": "the width '*'",
    "'%.999999999f' % 1": "the width '999999999'",
    "b'%99999d' % 1": "a format of bytes",
    # names
    "__import__('os').system('id')": "the name '__import__'",
    "__builtins__": "the name '__builtins__'",
    "(lambda __call: 1)(2)": "the name '__call'",
    "dict(__class__=1)": "the name '__class__'",
    "open('/etc/passwd')": "name 'open' is not defined",
    "eval('1')": "name 'eval' is not defined",
    "getattr(1, 'real')": "name 'getattr' is not defined",
    "vars(1)": "name 'vars' is not defined",
    # calls
    "type('T', (), {})": "takes 1 positional argument",
    "type(lambda: 0)(1, {})": "the type of a function is refused",
    "type(sorted)(1)": "the type of a builtin_function_or_method is refused",
    "type(type(1))('T', (), {})": "the type of a type is refused",
    "list(map(type(type(1)), ['T'], [()], [{}]))": "the type of a type is refused",
    "sorted([1], key=type(type(1)))": "the type of a type is refused",
    "1()": "calling 'int' is refused",
    "dict[0]": "an index of the type 'dict' is refused",
    "list[dict[str]](1)": "an index of the type 'list' is refused",
    "[type(1)][0] | str": "a union of types is refused",
    "1 | type(1)": "a union of types is refused",
    # statements in disguise
    "(x := 1)": "NamedExpr is refused",
    "[await x for x in y]": "refused|outside",
    "(yield 1)": "refused|invalid|outside",
    # work and memory without end
    "9**9**9": "bits",
    "2**100000": "bits",
    "1 << 10**9": "bits",
    "(10**2000) * (10**2000) * (10**2000)": "bits",
    "'a' * 10**9": "a length of more than",
    "10**9 * [0]": "a length of more than",
    "(1,) * 10**9": "a length of more than",
    "b'a' * 10**9": "a length of more than",
    "range(10**12)": "a range of more than",
    "list(range(0, 10**12))": "a range of more than",
    "factorial(10**7)": "a factorial of more than",
    "comb(10**7, 5000)": "a factorial of more than",
    "'a'.center(10**10)": "a width of more than",
    "('a' * 1000).replace('a', 'b' * 100000)": "a length of more than",
    "'a'.replace('', 'b' * 600000)": "a length of more than",
    "('a' * 1000).join(['b'] * 2000)": "a length of more than",
    "'a'.zfill(10**10)": "a width of more than",
    "'\\t'.expandtabs(10**10)": "a width of more than",
    "1" * 30_000: "has 30000 characters",
    "9" * 5000: "Exceeds the limit",
    "(" * 500 + ")" * 500: "too many nested parentheses",
}


@pytest.mark.parametrize("text", ATTACKS, ids=[text[:40] for text in ATTACKS])
def test_what_no_robot_needs_is_refused(text: str) -> None:
    """Whether it reaches behind a value, runs something, or never ends."""
    import re

    with pytest.raises((ExpressionError, NameError, SyntaxError, TypeError, ValueError)) as caught:
        value_of(text)
    assert re.search(ATTACKS[text], str(caught.value))


@pytest.mark.parametrize("name", ["sum", "product", "power", "attribute", "call"])
def test_a_guard_has_a_name_that_nobody_can_take(name: str) -> None:
    """A name with a space and a number that is drawn anew in every process is no parameter of a macro."""
    names = " ".join(compiled("a.b(c + d * e ** f)").co_names)
    assert name in names
    assert value_of(f"(lambda {name}: 2 + 3)(1)") == 5


ATOMS = st.sampled_from(["1", "'a'", "[1]", "x", "len", "str", "(lambda: 0)", "dict(a=1)", "range", "type"])
NAMES = st.sampled_from(
    ["__class__", "format", "append", "a", "gi_frame", "__globals__", "mro", "upper", "items", "real"]
)


def forms(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    pairs = st.tuples(inner, inner)
    return st.one_of(
        st.tuples(inner, NAMES).map(lambda p: f"({p[0]}).{p[1]}"),
        pairs.map(lambda p: f"({p[0]})({p[1]})"),
        pairs.map(lambda p: f"({p[0]}) + ({p[1]})"),
        pairs.map(lambda p: f"({p[0]}) % ({p[1]})"),
        inner.map(lambda e: f"[y for y in [{e}]]"),
        inner.map(lambda e: f"(lambda z: {e})(1)"),
        inner.map(lambda e: f"list(map({e}, [1]))"),
    )


@given(st.recursive(ATOMS, forms, max_leaves=12))
def test_no_expression_reaches_behind_a_value(text: str) -> None:
    """Whatever is put together: what comes out is a plain value, or a function that was given."""
    names = {**FUNCTIONS, "x": 3}
    try:
        found = evaluate(text, names, None, CALLS)
    except (ExpressionError, NameError, SyntaxError, TypeError, ValueError, KeyError, AttributeError, RecursionError):
        return
    waiting = [found]
    while waiting:
        value = waiting.pop()
        if isinstance(value, (list, tuple, set)):
            waiting.extend(value)
        elif isinstance(value, dict):
            waiting.extend([*value, *value.values()])
        else:
            plain = isinstance(value, (int, float, str, range, map, type, type(None)))
            own = callable(value) and (
                id(value) in CALLS or getattr(value, "__name__", "") in ("<lambda>", "narrow", "joined", "replaced")
            )
            method = type(value).__name__ in ("builtin_function_or_method", "generator")
            assert plain or own or method, (text, value)
