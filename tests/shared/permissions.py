"""Commands that permissions hold, as those of an ordinary user, also where root runs the tests."""

import ctypes
import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest_linux = pytest.mark.skipif(sys.platform != "linux", reason="permissions are those of Linux")


def ordinary(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Runs the command as somebody whom permissions hold: root without the capabilities that pass over them."""

    def give_up() -> None:
        if os.geteuid() == 0:
            libc = ctypes.CDLL(None, use_errno=True)
            for capability in (1, 2):  # CAP_DAC_OVERRIDE and CAP_DAC_READ_SEARCH
                if libc.prctl(24, capability, 0, 0, 0):  # PR_CAPBSET_DROP
                    raise OSError(ctypes.get_errno(), "prctl")

    command = [sys.executable, "-c", "from dh2urdf.cli import main; main()", *words]
    return subprocess.run(
        command, cwd=folder, capture_output=True, text=True, check=False, preexec_fn=give_up, timeout=300
    )
