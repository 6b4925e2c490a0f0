"""One cold conversion of the UR5 against the `xacro` command that expands the UR5 macro.

Both commands are started afresh and in turn, so that what else the machine does falls on both; medians and their
ratio are printed. Run it with the interpreter of the environment that has dh2urdf installed:

    python benchmarks/convert.py
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

TABLE = Path(__file__).parents[1] / "configs" / "tables" / "ur5.csv"


def seconds(command: list[str]) -> float:
    started = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - started


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=30)
    rounds = parser.parse_args().rounds
    scripts = Path(sys.executable).parent
    with tempfile.TemporaryDirectory() as folder:
        top = f"{folder}/ur5.urdf.xacro"
        subprocess.run([scripts / "dh2urdf", "convert", TABLE, "-o", top], check=True)
        commands = {
            "python -c pass": [sys.executable, "-c", "pass"],
            "xacro ur5.urdf.xacro": [str(scripts / "xacro"), top],
            "dh2urdf convert ur5.csv": [str(scripts / "dh2urdf"), "convert", str(TABLE), "-o", f"{folder}/ur5.urdf"],
            "dh2urdf plugins": [str(scripts / "dh2urdf"), "plugins"],
        }
        for command in commands.values():
            seconds(command)
        times: dict[str, list[float]] = {name: [] for name in commands}
        for _ in range(rounds):
            for name, command in commands.items():
                times[name].append(seconds(command))
    unit = median(times["xacro ur5.urdf.xacro"])
    print(f"{rounds} cold starts each, in turn; Python {sys.version.split()[0]}")
    for name, found in times.items():
        print(f"{name:26} {1000 * median(found):7.1f} ms   {median(found) / unit:5.2f} x xacro")


if __name__ == "__main__":
    main()
