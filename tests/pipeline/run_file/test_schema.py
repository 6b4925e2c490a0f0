from __future__ import annotations

import json
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any, Literal

import pytest
from jsonschema import Draft202012Validator

from dh2urdf.documents import load_yaml
from dh2urdf.hookspecs import hookimpl
from dh2urdf.plugin_system import Catalog
from dh2urdf.plugin_system.catalog import Plugin
from dh2urdf.run_file.schema import run_schema, table_schema
from dh2urdf.stages import Emitter, Executor, HasSchema, Loader, NoOptions, Reader, Transform, Usual


@dataclass(frozen=True, slots=True, kw_only=True)
class Paper:
    size: Literal["a4", "a5"] = "a4"


@dataclass(frozen=True, slots=True, kw_only=True)
class DotOptions:
    rank: Literal["LR", "TB"] = field(default="LR", metadata={"help": "which way it grows"})
    paper: Paper = Paper()
    scale: float | None = None
    width: float | None = field(default=None, metadata={"measures": "length"})
    box: tuple[float, float, float] = field(default=(1.0, 1.0, 1.0), metadata={"measures": "length"})


@dataclass(frozen=True)
class Unresolvable:
    x: Missing = 0  # type: ignore[name-defined] # noqa: F821 - that is the point


def nothing(*_arguments: object) -> Any:
    return ()


STAGES: dict[str, tuple[Any, ...]] = {
    "dh2urdf_readers": (
        Reader(name="csv", summary="s", read=nothing, options=DotOptions, suffixes=(".csv", ".tsv")),
        Reader(name="odd", summary="s", read=nothing, options=NoOptions),
    ),
    "dh2urdf_transforms": (
        Transform(name="alpha-swap", summary="s", transform=nothing, options=DotOptions, capabilities=(Usual(),)),
    ),
    "dh2urdf_emitters": (
        Emitter(
            name="urdf", summary="s", emit=nothing, options=NoOptions, suffixes=(".urdf",), capabilities=(Usual(),)
        ),
        Emitter(name="dot", summary="graphs", emit=nothing, options=DotOptions, suffixes=(".dot",)),
        Emitter(name="broken", summary="s", emit=nothing, options=Unresolvable, suffixes=()),
    ),
    "dh2urdf_loaders": (Loader(name="sim", summary="s", open=nothing, options=NoOptions),),
    "dh2urdf_executors": (
        Executor(name="local", summary="s", map=nothing, options=NoOptions, capabilities=(Usual(),)),
    ),
}


def hook(name: str) -> Any:
    def give() -> tuple[Any, ...]:
        return STAGES[name]

    give.__name__ = name
    return hookimpl(give)


def catalog(**hooks: Any) -> Catalog:
    module = ModuleType("plugin")
    for name, give in hooks.items():
        setattr(module, name, give)
    return Catalog([Plugin(name="p", distribution="d 1", module=module)])


@pytest.fixture(scope="module")
def schema() -> dict[str, Any]:
    return run_schema(catalog(**{name: hook(name) for name in STAGES}))


def valid(schema: dict[str, Any], text: str) -> bool:
    return bool(Draft202012Validator(schema).is_valid(load_yaml(text, "f").plain()))


def test_the_schema_is_a_schema(schema: dict[str, Any]) -> None:
    """It keeps the rules of its dialect and can be written as JSON."""
    Draft202012Validator.check_schema(schema)
    assert json.loads(json.dumps(schema)) == schema


@pytest.mark.parametrize(
    "text",
    [
        "inputs: a.csv",
        "inputs: [a.csv, {path: b.csv, options: {rank: TB}}, {path: c.x, stage: odd, options: {}}]",
        "{inputs: a, transform: alpha-swap, emitters: urdf, loaders: sim, execution: local}",
        "{inputs: a, transform: {options: {rank: LR}}, emitters: [dot, {stage: urdf, options: {}}], loaders: []}",
        "{inputs: a, emitters: {stage: dot, options: {scale: null}}, output: {directory: x}, proof: {poses: 8}}",
        "{inputs: a, emitters: [{stage: dot, options: }], transform: , output: , execution: {stage: local}}",
        "{inputs: a, emitters: [{stage: broken, options: {x: 1}}]}",
        "{inputs: a, output: 's3://bucket/arms'}",
        "{inputs: a, proof: {first: 0, every: 1000}, sample: {first: 10, every: 100}}",
        "{inputs: a, meshes: {of: ur5*, base: {mesh: a.stl}, joints: {j: {visual: {file: a.stl, scale: [1, 1, 2]}}}}}",
        "{inputs: {path: b.csv, options: {width: 40 mm, box: [1, 2 cm, 3]}}}",
        "{inputs: a, variations: [{name: c, of: b, count: 5, seed: 7, sampling: sobol, vary: [{field: axes, choices: [4, 5]}]}]}",
        "{inputs: a, variations: {of: b, count: 5, vary: {joints: [1, elbow], field: d, normal: {deviation: 1 mm, bounds: [0, 1]}}}}",
        "{inputs: a, variations: {of: b, vary: {joints: all, field: d, grid: {from: 0, to: 1, points: 3}}}}",
        "{inputs: a, cells: [{name: p, arms: [{name: l, of: u, prefix: '', parent: r/tool0, xyz: [0, 5 mm, pi], rpy: [0, 0, 0]}]}]}",
        "{inputs: a, cells: {name: p, combine: all, arms: {name: l, of: v}, vary: {arm: l, field: yaw, offset: [-5 deg, 0]}}}",
        "{inputs: a, emitters: [{stage: urdf, only: cells}, {stage: dot, only: arms, options: {}}, {only: arms}]}",
    ],
)
def test_good_run_files_are_valid(schema: dict[str, Any], text: str) -> None:
    """Short and long forms, defaults and empty sections are what the program takes."""
    assert valid(schema, text)


@pytest.mark.parametrize(
    "text",
    [
        "transform: alpha-swap",
        "inputs: [{stage: csv}]",
        "{inputs: a, transform: {stage: nope}}",
        "{inputs: a, emitters: []}",
        "{inputs: a, emitters: {stage: dot, options: {paper: {sze: a4}}}}",
        "{inputs: a, emitters: {stage: dot, options: {box: [1 mm, 2]}}}",
        "{inputs: a, output: {layout: shards, size: 0}}",
        "{inputs: a, meshes: {of: b, joints: {j: {msh: a.stl}}}}",
        "{inputs: a, execution: {time_limit: long}}",
        "{inputs: a, variations: {of: b, count: 5, vary: {joints: 2, field: a}}}",
        "{inputs: a, variations: {of: b, count: 5, vary: {joints: 2, field: axes, choices: [4]}}}",
        "{inputs: a, cells: {name: pair, arms: [{name: left, of: ur5, parrent: world}]}}",
        "{inputs: a, cells: {name: p, arms: {name: l, of: v}, vary: {arm: l, field: a, offset: [0, 1]}}}",
        "{inputs: a, cells: {name: p, arms: {name: l, of: v}, vary: {arm: l, field: x}}}",
        "{inputs: a, emitters: {stage: urdf, only: tables}}",
        "{inputs: a, loaders: {stage: sim, only: cells}}",
    ],
)
def test_wrong_run_files_are_not_valid(schema: dict[str, Any], text: str) -> None:
    """Misspelt sections, stages and options, and values of another type, are found by an editor."""
    assert not valid(schema, text)


def test_options_carry_their_help_and_default(schema: dict[str, Any]) -> None:
    """An editor shows what an option is for."""
    rank = schema["$defs"]["emitter.dot"]["properties"]["rank"]
    assert rank == {"default": "LR", "enum": ["LR", "TB"], "type": "string", "description": "which way it grows"}
    assert schema["$defs"]["emitter.dot"]["description"] == "graphs"


# --- Tables -----------------------------------------------------------------------------------------------------------


def with_schemas(*schemas: dict[str, Any]) -> Catalog:
    records = [
        Reader(
            name=f"r{index}",
            summary="s",
            read=nothing,
            options=NoOptions,
            capabilities=(HasSchema(lambda own=own: own),),
        )  # type: ignore[misc]
        for index, own in enumerate(schemas)
    ]

    def dh2urdf_readers() -> Any:
        return records

    return catalog(dh2urdf_readers=hookimpl(dh2urdf_readers))


def test_the_schema_of_tables_is_the_readers() -> None:
    """A single reader's schema is passed on as it is."""
    own = {"type": "object", "properties": {"x": {"$ref": "#/$defs/y"}}, "$defs": {"y": {"type": "integer"}}}
    assert table_schema(with_schemas(own)) == own
