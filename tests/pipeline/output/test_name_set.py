from __future__ import annotations

from dh2urdf.output import NameSet


def test_names_are_told_apart_to_the_last_letter() -> None:
    """Case, accents and white space make other names."""
    names = ["arm", "Arm", "arm ", "árm", "a\u0301rm", "arm\0", "\ud800"]
    seen = NameSet()
    for name in names:
        assert seen.known(names) == set(names[: names.index(name)])
        seen.add([name])
