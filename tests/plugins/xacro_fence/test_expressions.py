"""Expressions mean what they mean to the real xacro, or are refused; none reaches anything but its data."""

import re
from pathlib import Path
from typing import Any

import pytest
import xacro
import yaml
from hypothesis import given, strategies as st

from dh2urdf_plugins.xacro_fence.interpreter import MAX_WORK, ExpressionError, Function, Work, evaluate

REFUSALS = (ExpressionError, NameError, SyntaxError, TypeError, ValueError, LookupError, AttributeError, RecursionError)


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


EXPRESSIONS = yaml.safe_load(Path(__file__).with_name("expressions.yaml").read_text("utf-8"))
CORPUS: list[str] = EXPRESSIONS["written"]
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


ATTACKS: dict[str, str] = EXPRESSIONS["refused"] | {
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
