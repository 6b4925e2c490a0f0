"""Expressions mean what they mean to the real xacro, or are refused; none reaches anything but its data."""

from __future__ import annotations

import re
from typing import Any

import pytest
import xacro
from hypothesis import given, strategies as st

from dh2urdf_plugins.xacro_fence.interpreter import MAX_WORK, ExpressionError, Function, Work, evaluate

REFUSALS = (ExpressionError, NameError, SyntaxError, TypeError, ValueError, KeyError, AttributeError, RecursionError)


def names() -> Any:
    """What a file of xacro has: the global names, properties, a YAML file, and a namespace."""
    table = xacro.Table(xacro._global_symbols)
    config = {"limits": {"j1": {"lower": -1.5, "upper": 2}}, "links": [{"mass": 1.5}, {"mass": 2}], "items": 3}
    for name, value in {"size": 0.5, "side": "left", "n": 3, "true": True, "x": 3}.items():
        table._setitem(name, value, unevaluated=False)
    table._setitem("config", xacro.YamlDictWrapper(config), unevaluated=False)
    table["foo"] = xacro.NameSpace(parent=table)
    table["foo"]["z"] = "${2 * size}"
    return table


def value_of(text: str) -> Any:
    return evaluate(text, names(), Work())


def real_value_of(text: str) -> Any:
    return xacro.safe_eval(text, names())


WRITTEN = """
1 + 2*3**2 | sin(pi/2) | 'left' + '_' + str(3) | [2*x for x in [1, 2] if x > 1] | dict(a=1).get('b', 5)
{k: v for k, v in dict(a=1).items()} | 'a,b'.split(',')[1].upper() | list(map(lambda x: x + 1, python.range(3)))
python.sorted([3, 1], key=lambda x: -x) | f'{1 + 1}_{"a"}' | '%05.1f' % 2.25 | 1 if true else 0 | not (1 < 2 <= 3)
'ab' * 2 | 2**-1 | 1 << 4 | 'x'.rjust(3, '0') | factorial(5) | [1, 2, 3][-2:] | max(*[1, 2]) | -size | +n | ~n | 7 // 2
7 % 4 | 7 / 2 | n & 1 | n|4 | n ^ 1 | n >> 1 | n - 1.5 | size == 0.5 | side != 'left' | side is None | n is not None
'e' in side | 'q' not in side | 1 < n < 5 and n or 0 | 0 or '' | () and 1 | (1, 2) | {1, 2} | {1: 'a', 'b': [2]} | [] | {}
radians(90) | degrees(pi) | math.sqrt(2) | atan2(1, 2) | round(2.567, 1) | round(2.5) | abs(-2) | python.abs(-2) | hypot(3, 4)
min(3, 1) | max([1, 5]) | python.sum([1, 2.5]) | len(side) | int('3') | float('2.5') | str(1.0) | bool(0) | str(config.links)
config.limits.j1.lower | config['limits']['j1'].upper | config.links[1].mass | [link.mass for link in config.links]
config['items'] | config.get('none', 1) | list(config.keys()) | [key for key in config.limits] | 'limits' in config
python.isinstance(side, str) | python.isinstance(n, (int, float)) and n > 2 | python.ord('a') | python.list(python.zip([1], [2]))
python.list(python.enumerate('ab')) | python.any([0, 1]) | python.all(x for x in [1, 0]) | python.tuple([1]) | python.set([1, 1])
python.list(python.filter(lambda x: x > 1, [1, 2])) | python.list(python.reversed([1, 2])) | python.divmod(7, 2) | python.repr('a')
'{} {}'.format(1, side) | '{0:.2f}'.format(1.234) | '{name:>5}'.format(name='a') | '{!r}'.format('a') | f'{size:.3f}' | f'{side!r:>8}'
'%s_%d' % (side, n) | '%(a)s' % {'a': 1} | '_'.join([side, 'arm']) | side.replace('l', 'L') | side.center(8, '*') | '7'.zfill(3)
side.startswith('le') | side[0] | side[::-1] | [[1, 2], [3]][0][1] | [y for x in [[1, 2], [3]] for y in x] | [(a, b) for a, (b, c) in [(1, (2, 3))]]
{x % 2 for x in [1, 2, 3]} | {x: [y for y in python.range(x)] for x in (1, 2)} | [f() for f in [lambda: x for x in (1, 2)]]
(lambda a, b: a - b)(3, 1) | (lambda: n)() | [(lambda k: k * n)(k) for k in (1, 2)] | [*[1, 2], 3] | (1, *'ab') | foo.z | foo['z'] + 1
xacro.tokenize('a b;c') | xacro.tokenize('a:b', ':') | xacro.dotify(dict(a=1)).a | xacro.message('told') | math.inf | pi | e | True
[1, 2].index(2) | [3, 4].pop(0) | (1, 1).count(1) | {1}.union({2}) | n.real | size.is_integer() | complex(1, 2) | python.complex(1, 2).imag
1_000 | 0x10 | 'a' 'b' | [1][-1] | min([3, 2], key=lambda v: -v) | python.sum([[1], [2]], []) | math.prod([2, 3]) | comb(5, 2) | lcm(4, 6)
list(python.range(2, 9, 3)) | str(python.range(3)) | python.slice(1, 2) | 'abc'[python.slice(1, 3)] | python.hash(1) | python.bool('')
"""
CORPUS = [text for line in WRITTEN.strip().splitlines() for text in line.split(" | ")]
MEANT = {
    "sorted([3, 1], key=lambda x: -x)": [3, 1],
    "range(3)": range(3),
    "{k: v for k, v in dict(a=1).items()}": {"a": 1},
    "(lambda a, b: a - b)(3, 1)": 2,
    "'{0:.2f} {1}'.format(1.234, side)": "1.23 left",
    "config.limits.j1.lower": -1.5,
    "foo.z": 1.0,
}


@pytest.mark.parametrize("text", MEANT)
def test_an_expression_has_a_value(text: str) -> None:
    assert value_of(text) == MEANT[text]


@pytest.mark.parametrize("text", CORPUS)
def test_what_people_write_is_evaluated_as_the_real_xacro_does(text: str) -> None:
    """The same value of the same type; where the real one fails, as with the name `abs`, ours fails too."""
    try:
        real = real_value_of(text)
    except Exception as error:  # noqa: BLE001 - whatever the real one says
        with pytest.raises(type(error)):
            value_of(text)
        return
    ours = value_of(text)
    assert (ours, type(ours)) == (real, type(real))


ATTACKS = {
    # what is behind a value
    "().__class__": "the name '__class__'",
    "(lambda: ().__class__.__base__.__subclasses__())()": "the name '__",
    "[c for c in ().__class__.__mro__]": "the name '__",
    "(lambda: 0).__globals__": "the name '__globals__'",
    "{''.__class__: 1}": "the name '__class__'",
    "len.__self__": "the name '__self__'",
    "'a'._formatter_parser()": "attribute '_formatter_parser'",
    "(x for x in [1]).gi_frame": "attribute 'gi_frame' of a generator",
    "sin.real": "attribute 'real' of a Function",
    "sin._call": "attribute '_call' of a Function",
    "(lambda: 0)._work": "attribute '_work' of a Function",
    "config.update": "attribute 'update' of a YamlDictWrapper",
    "[1].append(2)": "attribute 'append' of a list",
    "config.get._call": "attribute '_call' of a Function",
    # namespaces, behind which tables of xacro are
    "foo['__builtins__']": "the name '__builtins__' is refused",
    "foo.__builtins__": "the name '__builtins__' is refused",
    "foo['__builtins__'].update(python.dict(a=1))": "the name '__builtins__' is refused",
    "foo.update(python.dict(a=1))": "attribute 'update' of a Namespace",
    "foo.keys()": "attribute 'keys' of a Namespace",
    "foo.parent": "attribute 'parent' of a Namespace",
    "foo.root": "attribute 'root' of a Namespace",
    "foo.unevaluated": "attribute 'unevaluated' of a Namespace",
    "foo.table": "name 'table' is not defined",
    "[k for k in foo]": "the name 0 is refused",
    "python.list(python)": "the name 0 is refused",
    "python.dict(foo)": "the name 0 is refused|not iterable|sequence",
    "str(foo)": "is no text",
    "'%s' % (sin,)": "is no text",
    "f'{foo}'": "is no text",
    "'{}'.format(math)": "is no text",
    "foo": "",
    "math['__loader__']": "the name '__loader__' is refused",
    "python['__import__']": "the name '__import__' is refused",
    # formats, which reach attributes in a text
    "'{0.__class__}'.format(1)": "the field '0.__class__'",
    "'{a.__class__}'.format(a=1)": "the field 'a.__class__'",
    "'{0[limits]}'.format(config)": r"the field '0\[limits\]'",
    "'{:{0.__class__}}'.format(1)": "the field '0.__class__'|cannot switch",
    "'{a.__class__}'.format_map(dict(a=1))": "attribute 'format_map' of a str",
    "str.format('{0.__class__}', 1)": "attribute 'format' of a Function",
    "list(map(str.format, ['{0.__class__}'], [1]))": "attribute 'format' of a Function",
    "list(map('{0.__class__}'.format, [1]))": "the field '0.__class__'",
    "python.sorted([1], key='{0.__class__}'.format)": "the field '0.__class__'",
    "max([1, 2], key='{0.__class__}'.format)": "the field '0.__class__'",
    "f'{1:>{10**9}}'": "a width of more than",
    "f'{1!r:>999999999}'": "a width of more than",
    "'{:>999999999}'.format(1)": "a width of more than",
    "('{0}' * 3000).format('a' * 90000)": "steps",
    "('%(a)s' * 3000) % {'a': 'a' * 90000}": "a size of more than",
    "'%999999999d' % 1": "a width of more than",
    "'%*d' % (10**8, 1)": "a width of more than",
    "'%.999999999f' % 1": "a width of more than",
    "'%(a(b))999999999d' % {'a(b)': 1}": "a key with parentheses",
    "b'%99999d' % 1": "bytes are refused",
    # names
    "__import__('os').system('id')": "the name '__import__'",
    "__builtins__": "the name '__builtins__'",
    "(lambda __call: 1)(2)": "the name '__call'",
    "dict(__class__=1)": "the name '__class__'",
    "open('/etc/passwd')": "name 'open' is not defined",
    "eval('1')": "name 'eval' is not defined",
    "getattr(1, 'real')": "name 'getattr' is not defined",
    "python.vars(sin)": "is refused",
    # calls
    "python.type('T', (), {})": "is refused",
    "python.type(python.type(1))": "is refused",
    "list(map(python.type, ['T'], [()], [{}]))": "is refused",
    "1()": "calling 'int' is refused",
    "config()": "calling 'YamlDictWrapper' is refused",
    "dict[0]": "not subscriptable",
    "list[dict[str]](1)": "not subscriptable",
    "int | str": "unsupported operand",
    "dict(**{'a': 1})": "must be strings",
    "{**config}": "NoneType is refused",
    "(lambda *a: a)(1)": "a lambda with other than plain parameters",
    "(lambda a=1: a)()": "a lambda with other than plain parameters",
    # statements in disguise
    "(x := 1)": "NamedExpr is refused",
    "[0 for x.y in [1]]": "Attribute is refused",
    "[0 for config['a'] in [1]]": "Subscript is refused",
    "[await x for x in [1]]": "refused|outside",
    "(yield 1)": "refused|invalid|outside",
    # work and memory without end
    "9**9**9": "bits",
    "2**100000": "bits",
    "1 << 10**9": "bits",
    "(10**2000) * (10**2000) * (10**2000)": "bits",
    "'a' * 10**9": "a size of more than",
    "10**9 * [0]": "a size of more than",
    "(1,) * 10**9": "a size of more than",
    "b'a' * 10**9": "bytes are refused",
    "range(10**12)": "a range of more than",
    "list(python.range(0, 10**12))": "a range of more than",
    "factorial(10**7)": "an argument of more than",
    "comb(10**7, 5000)": "an argument of more than",
    "lcm(*python.range(1, 10**5))": "an argument of more than|a size",
    "round(1, -10**9)": "an argument of more than",
    "'a'.center(10**10)": "a size of more than",
    "('a' * 1000).replace('a', 'b' * 100000)": "a size of more than",
    "'a'.replace('', 'b' * 600000)": "a size of more than",
    "('a' * 1000).join(['b'] * 2000)": "a size of more than",
    "'a'.zfill(10**10)": "a size of more than",
    "'\\t'.expandtabs(10**10)": "attribute 'expandtabs' of a str",
    "python.sum(('a' * 10**5 for k in python.range(10**5)), [])": "a size|steps|must be",
    "python.sum(([0] * 10**5 for k in python.range(10**4)), [])": "a size of more than|steps",
    "(lambda a: [a, a])([[0] * 300000, [0] * 300000])": "a size of more than",
    "xacro.tokenize('a' * 40 + 'b', ']|(a+)+$|[')": "the separator",
    "(lambda f: f(f))(lambda f: f(f))": "recursion",
    "1" * 30_000: "has 30000 characters",
    "9" * 5000: "Exceeds the limit",
    "(" * 500 + ")" * 500: "too many nested parentheses",
    "-" * 15_000 + "1": "",
}


@pytest.mark.parametrize("text", ATTACKS, ids=[text[:40] for text in ATTACKS])
def test_what_no_robot_needs_is_refused(text: str) -> None:
    """Whether it reaches behind a value, runs something, or never ends."""
    with pytest.raises((*REFUSALS, MemoryError)) as caught:
        str(value_of(text))
    assert re.search(ATTACKS[text], str(caught.value))


def test_a_namespace_is_not_changed_by_what_reads_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """The real xacro puts `__builtins__` into the table of every expression; ours puts nothing there."""
    monkeypatch.setattr(xacro, "safe_eval", lambda text, table: evaluate(text, table, Work()))
    table = names()
    assert evaluate("foo.z + foo['z']", table, Work()) == 2.0
    assert set(dict.keys(table["foo"])) == {"z"}


@pytest.mark.parametrize(
    "text",
    [
        "[1 for x in python.range(10**6) for y in python.range(10**6)]",
        "(lambda f: f(f, 40))(lambda f, k: f(f, k - 1) + f(f, k - 1) if k else 1)",
        "[k for k in (x for x in (y for y in python.range(10**6)) for z in python.range(10**6))]",
    ],
)
def test_a_loop_ends_by_its_steps(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The bound is a number of steps, which no clock measures; here it is a tenth."""
    monkeypatch.setattr("dh2urdf_plugins.xacro_fence.interpreter.MAX_WORK", MAX_WORK // 10)
    with pytest.raises(ExpressionError, match=f"more than {MAX_WORK // 10} steps"):
        value_of(text)


ATOMS = st.sampled_from(
    [
        "1",
        "'a'",
        "[1]",
        "x",
        "len",
        "str",
        "(lambda: 0)",
        "dict(a=1)",
        "python.range",
        "foo",
        "config",
        "1.5",
        "'{0.real}'",
    ]
)
NAMES = st.sampled_from(
    [
        "__class__",
        "format",
        "append",
        "a",
        "gi_frame",
        "__globals__",
        "mro",
        "upper",
        "items",
        "real",
        "z",
        "table",
        "kind",
    ]
)


def forms(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    pairs = st.tuples(inner, inner)
    return st.one_of(
        st.tuples(inner, NAMES).map(lambda p: f"({p[0]}).{p[1]}"),
        *(
            pairs.map(lambda p, op=op: f"({p[0]}){op}({p[1]})")
            for op in ("", " + ", " % ", " * ", " == ", " in ", " or ", " < ")
        ),
        pairs.map(lambda p: f"({p[0]})[{p[1]}]"),
        pairs.map(lambda p: f"[{p[0]}, {p[1]}]"),
        pairs.map(lambda p: f"({p[0]} if {p[1]} else 2)"),
        inner.map(lambda e: f"[y for y in [{e}]]"),
        inner.map(lambda e: f"(lambda z: {e})(1)"),
        inner.map(lambda e: f"list(map({e}, [1]))"),
        inner.map(lambda e: f"f'{{{e}}}'" if "'" not in e else e),
    )


@given(st.recursive(ATOMS, forms, max_leaves=12))
def test_no_expression_reaches_behind_a_value(text: str) -> None:
    """Whatever is put together: plain data comes out, or what can only be called; data is what the real xacro has."""
    try:
        found = value_of(text)
    except REFUSALS:
        return
    waiting, is_data = [found], True
    while waiting:
        value = waiting.pop()
        if isinstance(value, (list, tuple, set)):
            waiting.extend(value)
        elif isinstance(value, dict):
            waiting.extend([*value, *value.values()])
        elif not isinstance(value, (int, float, str, range, type(None))):
            assert isinstance(value, Function) or type(value).__name__ in (
                "Namespace",
                "map",
                "dict_items",
                "generator",
            )
            is_data = False
    if is_data:
        assert found == real_value_of(text)
