"""What a hand costs: one conversion, and a run of variations, with it and without.

    python benchmarks/attached.py
    python benchmarks/attached.py --variants 10000 --rounds 3

The hand has 21 links, 20 joints and a joint that follows another one. A run is compared for each byte that it writes.
"""

from __future__ import annotations

import argparse
import tempfile
from functools import partial
from pathlib import Path
from typing import Any

from measuring import in_turn, machine, seconds, table

import dh2urdf

LINKS = 21
UR5 = """# convention: standard
a, alpha, d
0, pi/2, 0.089159
-0.425, 0, 0
-0.39225, 0, 0
0, pi/2, 0.10915
0, -pi/2, 0.09465
0, 0, 0.0823
"""
"""The table of the UR5 from its data sheet [m, rad]."""


def hand() -> str:
    """A palm with five fingers of four links, of which the first one leads the second one."""
    body = '<inertial><mass value="0.1"/><inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial>'
    parts = [f'<link name="palm">{body}</link>']
    for number in range(LINKS - 1):
        finger, knuckle = divmod(number, 4)
        holder = f"link_{number - 1}" if knuckle else "palm"
        follows = f'<mimic joint="joint_{number - 1}"/>' if number == 1 else ""
        parts.append(
            f'<link name="link_{number}">{body}</link><joint name="joint_{number}" type="revolute">'
            f'<parent link="{holder}"/><child link="link_{number}"/><origin xyz="0.0{finger} 0 0.05"/>'
            f'<axis xyz="0 1 0"/><limit lower="0" upper="1.5" effort="1" velocity="2"/>{follows}</joint>'
        )
    return f'<robot name="hand">{"".join(parts)}</robot>'


def converted(arm: Path, edits: list[Any], place: Path) -> int:
    """The size of one URDF [B]."""
    return len(dh2urdf.convert(arm, place / "arm.urdf", edits=edits).text.encode())


def varied(arm: Path, edits: list[Any], place: Path, count: int) -> int:
    """The size of many URDF, in one process [B]."""
    vary = {"joints": [2, 3], "field": "a", "scale": [0.8, 1.2]}
    run = {
        "inputs": str(arm),
        "variations": {"of": "arm", "name": "v", "count": count, "vary": vary},
        "edits": [{"stage": name, "options": options} for edit in edits for name, options in edit.items()],
        "emitters": "urdf",
        "execution": {"stage": "local", "options": {"workers": 1}},
        "output": {"directory": str(place / "out"), "layout": "shards"},
    }
    dh2urdf.run(run)
    return sum(path.stat().st_size for path in (place / "out").rglob("*.tar"))


def main() -> None:
    """Print a table of seconds, bytes and ratios."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--variants", type=int, default=2000, help="variants of a run")
    options.add_argument("--rounds", type=int, default=3, help="rounds, of which the median counts")
    given = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        arm, part = place / "arm.csv", place / "hand.urdf"
        arm.write_text(UR5, "utf-8")
        part.write_text(hand(), "utf-8")
        edits = [{"attach": {"file": str(part), "name": "hand"}}]
        rows = []
        for what, side in (
            ("one URDF", converted),
            (f"{given.variants} variants", partial(varied, count=given.variants)),
        ):
            sides = {"without": partial(side, arm, []), "with": partial(side, arm, edits)}
            turns = in_turn(sides, given.rounds, place)
            bare, laden = (seconds(turns[name]) for name in sides)
            small, large = (turns[name][0].value for name in sides)
            ratio = laden / bare
            rows.append((what, f"{bare:.3f}", f"{laden:.3f}", f"{ratio:.2f}", f"{ratio * small / large:.2f}"))
        print(machine(place, ("dh2urdf", "lxml")), end="\n\n")
        table(("", "without, s", "with, s", "ratio", "ratio for each byte"), rows)


if __name__ == "__main__":
    main()
