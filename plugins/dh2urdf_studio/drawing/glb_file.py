"""A binary glTF file: nodes, meshes and materials as JSON, followed by the numbers of the triangles.

Source: glTF 2.0, https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html
"""

from __future__ import annotations

import json
import math
import struct
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Sequence

    from dh2urdf_studio.drawing.solids import Picture, Surface

_VERSION = 2
_TYPES = {"<f4": 5126, "<u4": 5125}  # as OpenGL counts them
_VERTICES, _INDICES = 34962, 34963
_PICTURES = ("image/png", "image/jpeg")
_IDENTITY = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]
_Y_UP = [-math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]
"""Quaternion that turns z, which points up here, into y, which does in glTF."""


class GlbFile:
    """A file that is being written.

    Args:
        name: name of the root node, which turns z up into y up.
    """

    ROOT = 0

    def __init__(self, name: str) -> None:
        self._nodes: list[dict[str, Any]] = [{"name": name, "rotation": _Y_UP}]
        self._meshes: list[dict[str, Any]] = []
        self._materials: list[dict[str, Any]] = []
        self._textures: list[dict[str, Any]] = []
        self._images: list[dict[str, Any]] = []
        self._accessors: list[dict[str, Any]] = []
        self._views: list[dict[str, Any]] = []
        self._binary = bytearray()
        self._kept: dict[Hashable, int] = {}

    def add_node(self, parent: int, name: str, matrix: Any, mesh: int | None = None) -> int:  # noqa: ANN401 - an array
        """Adds a node.

        Args:
            parent: number of the node that holds it.
            name: its name.
            matrix: where it is in its parent, homogeneous, of shape (4, 4).
            mesh: number of what is drawn there.
        """
        numbers = matrix.T.ravel().tolist()
        place = {} if numbers == _IDENTITY else {"matrix": numbers}
        self._nodes.append({"name": name, **place, **({} if mesh is None else {"mesh": mesh})})
        self._nodes[parent].setdefault("children", []).append(len(self._nodes) - 1)
        return len(self._nodes) - 1

    def mesh(self, pieces: Sequence[tuple[Hashable, Surface, Sequence[float]]]) -> int:
        """The number of a mesh, which is written once.

        Args:
            pieces: its surfaces, each with a key of its own, and with red, green, blue and alpha in 0..1, as in a URDF.
        """
        key = ("mesh", *((key, *rgba) for key, _, rgba in pieces))
        return self._once(key, self._meshes, lambda: {"primitives": [self._primitive(*piece) for piece in pieces]})

    def content(self) -> bytes:
        """The bytes of the file."""
        self._binary += bytes(-len(self._binary) % 4)
        lists = {
            "nodes": self._nodes,
            "meshes": self._meshes,
            "materials": self._materials,
            "textures": self._textures,
            "images": self._images,
            "accessors": self._accessors,
            "bufferViews": self._views,
            "buffers": [{"byteLength": len(self._binary)}] if self._binary else [],
        }
        told = {"asset": {"version": f"{_VERSION}.0", "generator": "dh2urdf"}, "scene": 0, "scenes": [{"nodes": [0]}]}
        text = json.dumps({**told, **{name: each for name, each in lists.items() if each}}).encode()
        text += b" " * (-len(text) % 4)
        chunks = [struct.pack("<I4s", len(text), b"JSON"), text]
        if self._binary:
            chunks += [struct.pack("<I4s", len(self._binary), b"BIN\0"), bytes(self._binary)]
        length = 12 + sum(map(len, chunks))
        return b"".join([struct.pack("<4sII", b"glTF", _VERSION, length), *chunks])

    def _primitive(self, key: Hashable, surface: Surface, rgba: Sequence[float]) -> dict[str, Any]:
        def accessor(name: str, numbers: Any, kind: str, target: int) -> int:  # noqa: ANN401 - an array
            return self._once((name, key), self._accessors, lambda: self._accessor(numbers, kind, target))

        attributes = {
            "POSITION": accessor("positions", surface.positions, "<f4", _VERTICES),
            "NORMAL": accessor("normals", surface.normals, "<f4", _VERTICES),
        }
        texture = None if surface.texture is None else self._texture(surface.texture)
        if texture is not None:
            down = surface.uv * (1.0, -1.0) + (0.0, 1.0)  # glTF counts from the upper left corner
            attributes["TEXCOORD_0"] = accessor("uv", down, "<f4", _VERTICES)
        return {
            "attributes": attributes,
            "indices": accessor("corners", surface.corners, "<u4", _INDICES),
            "material": self._once(("material", texture, *rgba), self._materials, lambda: _material(rgba, texture)),
        }

    def _texture(self, picture: Picture) -> int | None:
        """The number of a texture; None for a picture of a type that glTF does not have."""
        if picture.media_type not in _PICTURES:
            return None

        def image() -> dict[str, Any]:
            return {"bufferView": self._view(picture.content), "mimeType": picture.media_type}

        number = self._once(("image", picture), self._images, image)
        return self._once(("texture", number), self._textures, lambda: {"source": number})

    def _view(self, content: bytes, **told: int) -> int:
        """The number of some bytes in the binary part."""
        self._binary += bytes(-len(self._binary) % 4)
        self._views.append({"buffer": 0, "byteOffset": len(self._binary), "byteLength": len(content), **told})
        self._binary += content
        return len(self._views) - 1

    def _accessor(self, numbers: Any, kind: str, target: int) -> dict[str, Any]:  # noqa: ANN401 - an array
        numbers = numbers.astype(kind)
        view = self._view(numbers.tobytes(), target=target)
        told = {"bufferView": view, "componentType": _TYPES[kind], "count": len(numbers)}
        if numbers.ndim == 1:
            return {**told, "type": "SCALAR"}
        if numbers.shape[1] == 2:  # noqa: PLR2004 - a place in a texture
            return {**told, "type": "VEC2"}
        return {**told, "type": "VEC3", "min": numbers.min(axis=0).tolist(), "max": numbers.max(axis=0).tolist()}

    def _once(self, key: Hashable, items: list[dict[str, Any]], make: Callable[[], dict[str, Any]]) -> int:
        if key not in self._kept:
            item = make()
            self._kept[key] = len(items)
            items.append(item)
        return self._kept[key]


def _material(rgba: Sequence[float], texture: int | None) -> dict[str, Any]:
    colour = [*(_linear(part) for part in rgba[:3]), rgba[3]]
    plain: dict[str, Any] = {"baseColorFactor": colour, "metallicFactor": 0.0, "roughnessFactor": 0.7}
    if texture is not None:
        plain["baseColorTexture"] = {"index": texture}
    return {"pbrMetallicRoughness": plain, **({"alphaMode": "BLEND"} if rgba[3] < 1.0 else {})}


def _linear(part: float) -> float:
    """A part of a colour of sRGB, in which URDFs have them, in the linear space of glTF (IEC 61966-2-1)."""
    part = min(max(part, 0.0), 1.0)
    return part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4  # noqa: PLR2004 - the standard's
