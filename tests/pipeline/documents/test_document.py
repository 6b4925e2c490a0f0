from __future__ import annotations

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
        ("-1", -1),
        ("+1", 1),
        ("007", 7),
        ("0o17", 15),
        ("0x1F", 31),
        ("1e3", 1000.0),
        ("1e-3", 0.001),
        ("1E+3", 1000.0),
        (".5", 0.5),
        ("+.5", 0.5),
        ("1.", 1.0),
        ("-1.5e-2", -0.015),
        (".inf", math.inf),
        ("-.INF", -math.inf),
        ("true", True),
        ("FALSE", False),
        ("~", None),
        ("null", None),
        ("NULL", None),
    ],
)
def test_numbers_and_constants_follow_the_core_schema_of_yaml_12(text: str, value: object) -> None:
    """A bare scalar is what section 10.3.2 of YAML 1.2.2 says, whole numbers and floats kept apart."""
    found = plain(f"x: {text}")["x"]
    assert found == value
    assert type(found) is type(value)


@pytest.mark.parametrize(
    "text",
    [
        "no",
        "yes",
        "on",
        "off",
        "y",
        "N",
        "1:30",
        "2020-01-01",
        "1_000",
        "0b11",
        "nULL",
        "tRue",
        ".",
        "-",
        "+",
        "e3",
        "0o8",
    ],
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


def test_quoted_scalars_and_blocks_are_texts() -> None:
    """Quotes and block scalars make a text of what would be a number."""
    assert plain("a: '1'\nb: \"true\"\nc: |\n  2\nd: ''") == {"a": "1", "b": "true", "c": "2\n", "d": ""}


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


# --- Keys -------------------------------------------------------------------------------------------------------------


def test_all_duplicate_keys_are_named_with_both_places() -> None:
    """Two equal keys are an error at the second that tells where the first stands; every pair is reported."""
    text = refusal("a: 1\nb: {c: 1, c: 2}\na: 3\n")
    assert "f.yaml:2:11: error: the key 'c' stands here and in line 2, column 5" in text
    assert "f.yaml:3:1: error: the key 'a' stands here and in line 1, column 1" in text


def test_a_key_is_the_same_key_in_quotes() -> None:
    """`1` and `"1"` are one key: keys are texts."""
    assert "stands here and in" in refusal("1: a\n'1': b\n")
    assert plain("{1: a, true: b, 007: c}") == {"1": "a", "true": "b", "007": "c"}


def test_a_mapping_as_a_key_is_refused() -> None:
    """Keys are names."""
    assert "stands as a key" in refusal("? [a, b]\n: 1\n")


# --- Aliases ----------------------------------------------------------------------------------------------------------


def test_merge_keys_take_in_defaults() -> None:
    """`<<` adds what the mapping does not say itself; of a list of mappings, earlier ones win."""
    text = "d: &d {p: 1, q: 2}\na: {<<: *d, q: 3}\nb: {q: 3, <<: [{q: 9, r: 8}, *d]}\nc: {'<<': 1}\n"
    assert plain(text) == {
        "d": {"p": 1, "q": 2},
        "a": {"q": 3, "p": 1},
        "b": {"q": 3, "r": 8, "p": 1},
        "c": {"<<": 1},
    }


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


@pytest.mark.parametrize("text", ["x: &a [*a]", "x: &a {b: *a}", "x: &a {<<: *a}", "&a [[[*a]]]"])
def test_an_alias_inside_its_own_value_is_refused(text: str) -> None:
    """A value cannot hold itself."""
    assert "inside the value that it stands for" in refusal(text)


def test_an_unknown_alias_names_the_nearest_anchor() -> None:
    """A misspelt alias gets a suggestion."""
    text = refusal("d: &defaults {}\na: *default\n")
    assert "f.yaml:2:4" in text
    assert "did you mean 'defaults'?" in text


def test_an_anchor_that_stands_twice_is_refused() -> None:
    """Which of two anchors of one name an alias means is not left to chance."""
    assert "'&a' stands twice" in refusal("x: &a 1\ny: &a 2\n")


# --- Bounds -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", ["[" * 100_000, "- " * 100_000 + "1", "{a: " * 100_000, "? " * 100_000])
def test_deep_nesting_is_refused_without_recursion(text: str) -> None:
    """A hundred thousand open brackets are an error at the first one too many."""
    assert f"more than {MAX_DEPTH} mappings and lists" in refusal(text)


def test_aliases_do_not_deepen_a_document_beyond_the_bound() -> None:
    """Depth counts what aliases stand for, so `plain` never recurses deeper."""
    chain = "\n".join(f"k{i}: &a{i} [[[[[*a{i - 1}]]]]]" for i in range(1, 40))
    assert "stand inside each other" in refusal("k0: &a0 [1]\n" + chain)


def test_the_bound_of_depth_itself_is_read() -> None:
    """Exactly as deep as allowed is read."""
    assert plain("[" * MAX_DEPTH + "]" * MAX_DEPTH)


# --- Documents --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", ["", "   \n", "# only a comment\n", "---\n", "\ufeff"])
def test_an_empty_file_says_so(text: str) -> None:
    """A file without a value is empty, whatever comments it holds."""
    assert refusal(text) == "f.yaml: error: the file is empty"


def test_a_second_document_is_refused() -> None:
    """One file, one document; an end marker and a directive are no second one."""
    assert "f.yaml:2:1: error: a second document begins here" in refusal("a: 1\n--- \nb: 2\n")
    assert plain("%YAML 1.2\n---\na: 1\n...\n") == {"a": 1}


@pytest.mark.parametrize(
    ("text", "tag"),
    [
        ("a: !include x", "!include"),
        ("a: !!python/object/apply:os.system [ls]", "!!python/object/apply:os.system"),
        ("a: !!str 1", "!!str"),
        ("!x {a: 1}", "!x"),
        ("a: ! 12", "!"),
        ("!!str a: 1", "!!str"),
    ],
)
def test_tags_are_refused_by_name(text: str, tag: str) -> None:
    """No tag is obeyed, and none is ignored."""
    assert f"the YAML tag '{tag}' is not accepted" in refusal(text)


def test_half_a_character_is_refused() -> None:
    """A lone half of a surrogate pair is no text; a whole pair, as JSON writes it, is."""
    assert plain(r'a: "\ud83e\udd16"') == {"a": "🤖"}
    assert plain(r'a: "\\ud83e\udd16"'.replace(r"\udd16", "x")) == {"a": r"\ud83ex"}
    for half in (r"\ud83e", r"\udd16\ud83e"):
        assert "not valid YAML" in refusal(f'a: "{half}"')


def test_an_escape_beyond_unicode_is_refused() -> None:
    """Neither of PyYAML's parsers lets an impossible character through, or anything but a ConfigError out."""
    assert "not valid YAML" in refusal(r'a: "\UFFFFFFFF"')
    assert refusal(r'a: "\ud83e\udd16 \UFFFFFFFF"').startswith("f.yaml:1:")


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


def test_expect_mapping_says_what_there_is_instead() -> None:
    """A CSV table in a YAML file is told to be a text where a mapping is wanted."""
    with pytest.raises(TableError, match="must be a mapping of names and values, not the text 'joint,type"):
        expect_mapping(read_yaml(INPUTS / "csv_content.yaml"), "a table", TableError)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("3", "the number 3"),
        ("true", "the truth value true"),
        ("a", "the text 'a'"),
        ("[1, 2]", "a list of 2"),
        ("[]", "an empty list"),
        ("{}", "a mapping"),
        ("~", "an empty value"),
    ],
)
def test_values_are_described_in_words(text: str, words: str) -> None:
    """Messages say what kind of value was found."""
    assert load_yaml(text, "f").describe() == words


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
