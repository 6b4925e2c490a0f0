import json
import math
import tracemalloc
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, strategies as st

from dh2urdf.documents import Node, load_yaml, stream_yaml
from dh2urdf.documents.composer import MAX_ALIASED, MAX_DEPTH
from dh2urdf.documents.document import expect_mapping, read_yaml
from dh2urdf.errors import ConfigError, TableError

INPUTS = Path(__file__).parents[2] / "reference" / "inputs"


def plain(text: str | bytes) -> Any:
    return load_yaml(text, "f.yaml").plain()


def refusal(text: str | bytes) -> str:
    with pytest.raises(ConfigError) as caught:
        load_yaml(text, "f.yaml")
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1", 1),
        ("+1", 1),
        ("007", 7),
        ("0o17", 15),
        ("0x1F", 31),
        ("1E+3", 1000.0),
        (".5", 0.5),
        ("1.", 1.0),
        ("-1.5e-2", -0.015),
        ("-.INF", -math.inf),
        ("FALSE", False),
        ("NULL", None),
    ],
)
def test_numbers_and_constants_follow_the_core_schema_of_yaml_12(text: str, value: object) -> None:
    """A bare scalar is what section 10.3.2 of YAML 1.2.2 says, whole numbers and floats kept apart."""
    found = plain(f"x: {text}")["x"]
    assert found == value
    assert type(found) is type(value)


@pytest.mark.parametrize(
    "text", ["no", "on", "y", "1:30", "2020-01-01", "1_000", "0b11", "nULL", ".", "-", "e3", "0o8"]
)
def test_what_yaml_11_would_have_changed_is_a_text(text: str) -> None:
    """Norway, sexagesimals, dates and binary numbers of YAML 1.1 are texts."""
    assert plain(f"x: [{text}]" if text == "-" else f"x: {text}") == ({"x": [text]} if text == "-" else {"x": text})


def test_nan_is_a_number() -> None:
    """`.nan` is the float that is not a number."""
    assert math.isnan(plain("x: .NaN")["x"])


def test_a_scalar_keeps_its_source_text() -> None:
    """Names that look like numbers can be had as they were written."""
    node = load_yaml("[007, 1e3, no, '1', \"a\\tb\"]", "f")
    assert isinstance(node.value, list)
    assert [entry.text for entry in node.value] == ["007", "1e3", "no", "1", "a\tb"]
    assert [entry.quoted for entry in node.value] == [False, False, False, True, True]


def test_a_number_of_a_thousand_digits_is_infinite() -> None:
    """A whole number beyond every double does not cost time, and is no finite number."""
    assert plain("x: " + "9" * 10_000)["x"] == math.inf


def test_marks_count_lines_and_columns_from_one() -> None:
    """Every value and every key knows its place, in characters."""
    node = load_yaml("ä: 1\nb:\n  - {c: ü, d: [2]}\n", "t.yaml")
    entries = expect_mapping(node, "it")
    assert str(node.mark) == "t.yaml:1:1"
    assert str(entries["ä"].mark) == "t.yaml:1:4"
    assert str(node.key_mark("b")) == "t.yaml:2:1"
    assert isinstance(entries["b"].value, list)
    inner = entries["b"].value[0]
    assert [str(inner.key_mark(key)) for key in "cd"] == ["t.yaml:3:6", "t.yaml:3:12"]
    assert isinstance(inner.value, dict)
    assert str(inner.value["d"].mark) == "t.yaml:3:15"


@given(
    st.recursive(
        st.none()
        | st.booleans()
        | st.integers(-(10**18), 10**18)
        | st.floats(allow_nan=False, allow_infinity=False)
        | st.text(st.characters(exclude_categories=["Cs", "Cc"], exclude_characters="\u2028\u2029\x85")),
        lambda inner: (
            st.lists(inner, max_size=4) | st.dictionaries(st.text("abcdefgh<é🤖", min_size=1), inner, max_size=4)
        ),
        max_leaves=20,
    )
)
def test_json_is_yaml(value: Any) -> None:
    """What Python writes as JSON reads back as the same value, escapes of both kinds included."""
    for ascii_only in (True, False):
        found = plain(json.dumps({"x": value}, ensure_ascii=ascii_only))["x"]
        assert found == value


@given(st.text(st.characters(codec="utf-8")) | st.binary())
def test_any_text_is_read_or_refused(content: str | bytes) -> None:
    """No text or bytes give anything but a document or a ConfigError."""
    try:
        node = load_yaml(content, "f")
    except ConfigError:
        return
    assert node.value is not None or node.text


# --- Aliases ----------------------------------------------------------------------------------------------------------


def test_merge_keys_take_in_defaults() -> None:
    """`<<` adds what the mapping does not say itself; of a list of mappings, earlier ones win."""
    text = "d: &d {p: 1, q: 2}\na: {<<: *d, q: 3}\nb: {q: 3, <<: [{q: 9, r: 8}, *d]}\nc: {'<<': 1}\n"
    assert plain(text) == {"d": {"p": 1, "q": 2}, "a": {"q": 3, "p": 1}, "b": {"q": 3, "r": 8, "p": 1}, "c": {"<<": 1}}


def test_a_merged_value_keeps_its_place() -> None:
    """An error in a merged value points to the anchor's mapping, where it can be fixed."""
    entries = expect_mapping(load_yaml("d: &d {p: 1}\na: {<<: *d}\n", "f"), "it")
    assert str(entries["a"].key_mark("p")) == "f:1:8"


@pytest.mark.parametrize(
    ("text", "about"), [("a: {<<: 3}", "`<<`"), ("a: {<<: [x]}", "`<<`"), ("d: &d {}\na: {<<: *d, <<: *d}", "'<<'")]
)
def test_a_merge_key_of_anything_else_is_refused(text: str, about: str) -> None:
    """`<<` takes mappings, once."""
    assert about in refusal(text)


def test_the_alias_bomb_of_the_reference_is_refused_with_little_memory() -> None:
    """Nine to the twelfth values are never made."""
    tracemalloc.start()
    try:
        with pytest.raises(ConfigError, match="the aliases of this file stand for more values"):
            read_yaml(INPUTS / "alias_bomb.yaml")
        assert tracemalloc.get_traced_memory()[1] < 10_000_000
    finally:
        tracemalloc.stop()


def test_long_files_may_use_more_aliases() -> None:
    """What bounds aliases grows with the file, so that a million rows may share their defaults."""
    block = "- &d {" + ", ".join(f"k{i}: {i}" for i in range(50)) + "}\n"
    entries = MAX_ALIASED // 50 + 1000
    node = load_yaml(block + "- {<<: *d, a: 1}\n" * entries, "f")
    assert isinstance(node.value, list)
    assert len(node.value) == entries + 1


# --- Bounds -----------------------------------------------------------------------------------------------------------


def test_the_bound_of_depth_itself_is_read() -> None:
    """Exactly as deep as allowed is read."""
    assert plain("[" * MAX_DEPTH + "]" * MAX_DEPTH)


# --- Documents --------------------------------------------------------------------------------------------------------


def test_documents_are_read_without_libyaml(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where PyYAML was built without libyaml, its own parser gives the same nodes."""
    text = "a: &x [1, 'b', {c: ü}]\nd: *x\n"
    fast = load_yaml(text, "f")
    monkeypatch.delattr("yaml.CSafeLoader")
    assert load_yaml(text, "f") == fast
    assert refusal("a: [").startswith("f.yaml:1:")


def test_the_error_type_is_the_callers() -> None:
    """A table reader gets its own kind of error."""
    with pytest.raises(TableError):
        load_yaml("a: [", "f", TableError)


# --- Streams ----------------------------------------------------------------------------------------------------------


def test_entries_of_a_list_come_one_by_one() -> None:
    """The entries come before the end of the file is read, and last the document without them."""
    items = stream_yaml("units: {length: mm}\nrobots:\n- {name: a}\n- {name: b}\n- [\n", "f", items_of="robots")
    assert [next(items).node.plain() for _ in range(2)] == [{"name": "a"}, {"name": "b"}]
    with pytest.raises(ConfigError, match="not valid YAML"):
        next(items)
    *_, last = stream_yaml("a: 1\nrobots: [x, y]\nb: 2\n", "f", items_of="robots")
    assert last.node.plain() == {"a": 1, "robots": [], "b": 2}


def test_a_bad_entry_of_a_stream_spoils_no_other() -> None:
    """Duplicate keys and tags belong to the entry they are in; those outside, to the document."""
    text = "a: 1\na: 2\nrobots:\n- {n: 1, n: 2}\n- {n: 3}\n- {n: !x 4}\nc: 1\nc: 2\n"
    items = list(stream_yaml(text, "f", items_of="robots"))
    assert [len(item.problems) for item in items] == [1, 0, 1, 2]
    assert str(items[0].problems[0]).startswith("f:4:10")


def test_only_the_outermost_list_of_that_name_is_streamed() -> None:
    """A key of the same name deeper down, or one that holds no list, is an ordinary value."""
    (item,) = stream_yaml("a: {robots: [1]}\nrobots: {x: [2]}\n", "f", items_of="robots")
    assert item.node.plain() == {"a": {"robots": [1]}, "robots": {"x": [2]}}


def test_a_long_stream_holds_one_entry_at_a_time() -> None:
    """Memory does not grow with the number of entries."""
    text = "robots:\n" + "- {name: r, joints: [{a: 1, alpha: 2, d: 3}]}\n" * 5000
    tracemalloc.start()
    try:
        before = tracemalloc.get_traced_memory()[0]
        held = 0
        for item in stream_yaml(text, "f", items_of="robots"):
            assert isinstance(item.node, Node)
            held = max(held, tracemalloc.get_traced_memory()[0] - before)
        assert held < 2 * len(text)
    finally:
        tracemalloc.stop()


REFUSED = {
    # Syntax: with the place where a person fixes it, and how.
    "a:\n\t- b": ("2:1", "indent with spaces"),
    "a: b: c": ("1:5", "quote a text that holds ': '"),
    "name:arm\nx: 1": ("2:2", "indent the keys of a mapping alike"),
    "a: 1\nb": ("2:1", "each line of a mapping is `name: value`"),
    "a: @x": ("1:4", "quote a text that starts with this character"),
    "a: [1, 2": ("1:4", "close the bracket that opens here"),
    "a: {x: 1\nb: 2\n": ("2:2", "comma"),
    "a: ]": ("1:4", "a bracket or comma is too many"),
    "x: 1\na: 'abc": ("2:4", "close the quote that opens here"),
    "a: *": ("1:4", "quote a text that starts with * or &"),
    r'a: "C:\new\q"': ("1:11", "use single quotes"),
    "%YAML 2.0\n---\na: 1": ("1:1", "remove the line %YAML"),
    r'a: "\UFFFFFFFF"': ("1:", "not valid YAML"),
    r'a: "\udd16\ud83e"': ("1:", "not valid YAML"),
    # What YAML allows, and nobody means.
    "a: 1\nb: {c: 1, c: 2}\na: 3\n": ("2:11", "the key 'c' stands here and in line 2, column 5"),
    "1: a\n'1': b\n": ("2:1", "stands here and in line 1"),
    "? [a, b]\n: 1\n": ("1:3", "stands as a key"),
    "": ("", "the file is empty"),
    "a: 1\n--- \nb: 2\n": ("2:1", "a second document begins here"),
    "a: !include x": ("1:4", "the YAML tag '!include' is not accepted"),
    "a: !!python/object/apply:os.system [ls]": ("1:4", "the YAML tag '!!python/object/apply:os.system'"),
    "x: &a [*a]": ("1:8", "inside the value that it stands for"),
    "x: &a {<<: *a}": ("1:12", "inside the value that it stands for"),
    "d: &defaults {}\na: *default\n": ("2:4", "did you mean 'defaults'?"),
    "x: &a 1\ny: &a 2\n": ("2:4", "'&a' stands twice"),
    # What would cost too much: without recursion, and counting what aliases stand for.
    "[" * 100_000: ("1:", f"more than {MAX_DEPTH} mappings and lists"),
    "{a: " * 100_000: ("1:", f"more than {MAX_DEPTH} mappings and lists"),
    "k0: &a0 [1]\n" + "\n".join(f"k{i}: &a{i} [[[[[*a{i - 1}]]]]]" for i in range(1, 40)): (
        "",
        "stand inside each other",
    ),
}


@pytest.mark.parametrize(
    ("text", "place", "says"), [(text, *told) for text, told in REFUSED.items()], ids=range(len(REFUSED))
)
def test_what_is_refused(text: str, place: str, says: str) -> None:
    """The message names the place and what is wrong there."""
    message = refusal(text)
    assert message.startswith(f"f.yaml:{place}")
    assert says in message


def test_what_looks_like_it_is_read() -> None:
    """Keys are texts; an end marker is no second document; JSON writes a character as two escapes."""
    assert plain("{1: a, true: b, 007: c}") == {"1": "a", "true": "b", "007": "c"}
    assert plain("%YAML 1.2\n---\na: 1\n...\n") == {"a": 1}
    assert plain(r'a: "\ud83e\udd16"') == {"a": "🤖"}
    assert plain(r'a: "\\ud83e\\udd16"') == {"a": r"\ud83e\udd16"}


def test_problems_before_a_syntax_error_are_told_too() -> None:
    """What is known to be wrong is said together with what stopped the reading."""
    with pytest.raises(ConfigError) as caught:
        load_yaml("a: !x 1\nb: 2\nb: 3\nc: [1", "f")
    assert [problem.mark.line for problem in caught.value.problems if problem.mark] == [1, 3, 4]
