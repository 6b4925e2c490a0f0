"""One cold conversion of the UR5 against the `xacro` command that expands the UR5 macro.

All commands are started afresh and in turn, so that what else the machine does falls on all of them. Medians of their
processor time (user and system) and of the time on the clock are printed, with ratios. Run it with the interpreter of
the environment that has dh2urdf installed:

    python benchmarks/convert.py
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

TABLE = Path(__file__).parents[1] / "configs" / "tables" / "ur5.csv"


def seconds(command: list[str]) -> tuple[float, float]:
    """Processor time of a command, and time on the clock [s]."""
    started = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"{command} failed")
    return used.ru_utime + used.ru_stime, time.perf_counter() - started


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
            "dh2urdf --help": [str(scripts / "dh2urdf"), "--help"],
        }
        for command in commands.values():
            seconds(command)
        times: dict[str, list[tuple[float, float]]] = {name: [] for name in commands}
        for _ in range(rounds):
            for name, command in commands.items():
                times[name].append(seconds(command))
    medians = {name: [median(each) for each in zip(*found, strict=True)] for name, found in times.items()}
    unit = medians["xacro ur5.urdf.xacro"]
    print(f"{rounds} cold starts each, in turn; Python {sys.version.split()[0]}")
    print(f"{'':26} {'processor time':>24}   {'on the clock':>24}")
    for name, (used, taken) in medians.items():
        print(
            f"{name:26} {1000 * used:7.1f} ms {used / unit[0]:5.2f} x xacro   "
            f"{1000 * taken:7.1f} ms {taken / unit[1]:5.2f} x xacro"
        )


if __name__ == "__main__":
    main()
