"""Reads the settings of a run file that say how much and how: layout, samples, limits."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from dh2urdf.conversion.one_manipulator import Sample
from dh2urdf.errors import ConfigError
from dh2urdf.meshes.conversion import conversion_of
from dh2urdf.meshes.files import RELATIVE, prefix_of
from dh2urdf.meshes.forms import MeshConversion
from dh2urdf.output.layouts import DEFAULT_SIZE, LARGEST, Form, Layout
from dh2urdf.run_file.sections import SectionReader
from dh2urdf.source import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.documents.document import Node

T = TypeVar("T")

DEFAULT_SAMPLE = Sample(first=1000, every=50)
"""What goes through xacro expansion and simulators: all of a run of up to 1,000, of a longer one a sample."""
DEFAULT_TIME_LIMIT = 300.0
"""How long one manipulator may take, simulators aside [s]."""
MOST = 10**9
"""Largest whole number of a setting that counts manipulators."""


class SettingsReader(SectionReader):
    """Reads settings, and gathers what is wrong with them."""

    def layout(self, output: dict[str, Node]) -> Layout:
        """How the output lies in its place."""
        form, node = Form.FILES, output.get("layout")
        if node is not None and node.value is not None:
            if node.value in list(Form):
                form = Form(node.value)
            else:
                self.say(
                    f"the layout cannot be {node.describe()}",
                    node,
                    "output.layout",
                    accepted=", ".join(Form),
                    suggestion=did_you_mean(node.text or "", [form.value for form in Form]),
                )
        if (size := output.get("size")) is not None and size.value is not None and form is Form.FILES:
            self.say(
                "all files go into one folder, which has no size",
                size,
                "output.size",
                accepted=f"a size with layout: {Form.FOLDERS} or layout: {Form.SHARDS}",
            )
        return Layout(form=form, size=self.whole(size, "output.size", 1, LARGEST, DEFAULT_SIZE))

    def mesh_copies(self, node: Node | None, layout: Layout) -> tuple[str | None, MeshConversion]:
        """What descriptions write before a copied mesh's name, None where none is copied; what becomes of meshes."""
        given = {} if node is None or node.value is None else self.entries(node, ("names", "convert"), "output.meshes")
        in_folders = layout.form is Form.FOLDERS
        prefix = self._understood(
            given.get("names"), "output.meshes.names", RELATIVE, lambda word: prefix_of(word, in_folders=in_folders)
        )
        conversion = self._understood(
            given.get("convert"),
            "output.meshes.convert",
            MeshConversion.NEVER,
            lambda word: conversion_of(word, prefix),
        )
        return prefix, conversion

    def _understood(self, node: Node | None, field: str, default: str, understand: Callable[[str], T]) -> T:
        """What a word means; what the default means, where there is none or it means nothing."""
        if node is not None and node.value is not None and (word := self.name(node, field)):
            try:
                return understand(word)
            except ConfigError as error:
                why = error.problems[0]
                self.say(why.message, node, field, accepted=why.accepted, suggestion=why.suggestion)
        return understand(default)

    def sample(self, given: dict[str, Node], field: str, default: Sample) -> Sample:
        """Which manipulators are looked at: the first of the run, and every how many-th of the rest."""
        first = self.whole(given.get("first"), f"{field}.first", 0, MOST, default.first)
        every = self.whole(given.get("every"), f"{field}.every", 1, MOST, default.every)
        return Sample(first=first, every=every)

    def seconds(self, execution: Node) -> float:
        """How long one manipulator may take [s]."""
        node = execution.value.get("time_limit") if isinstance(execution.value, dict) else None
        if node is None or node.value is None:
            return DEFAULT_TIME_LIMIT
        if isinstance(node.value, (int, float)) and not isinstance(node.value, bool) and 0 < node.value < MOST:
            return float(node.value)
        self.say(
            f"the time limit cannot be {node.describe()}",
            node,
            "execution.time_limit",
            accepted="seconds that one manipulator may take, a number greater than 0",
        )
        return DEFAULT_TIME_LIMIT

    def switch(self, node: Node | None, field: str, *, default: bool) -> bool:
        """Whether something is done."""
        if node is None or node.value is None:
            return default
        if not isinstance(node.value, bool):
            message = f"{field.rpartition('.')[2]} cannot be {node.describe()}"
            self.say(message, node, field, accepted="true, false")
            return default
        return node.value

    def whole(self, node: Node | None, field: str, least: int, most: int, default: int) -> int:
        """A whole number within bounds."""
        if node is None or node.value is None:
            return default
        if isinstance(node.value, int) and not isinstance(node.value, bool) and least <= node.value <= most:
            return node.value
        self.say(
            f"{field.rpartition('.')[2]} cannot be {node.describe()}",
            node,
            field,
            accepted=f"a whole number from {least} to {most}",
        )
        return default
