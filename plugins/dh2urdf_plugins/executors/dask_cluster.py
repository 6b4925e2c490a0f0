"""What runs in the process of a Dask cluster of its own: a scheduler, and workers in further processes.

It is started by its path, with the number of workers, and prints the scheduler's address. It lives in a session of its
own, where no Ctrl-C of a terminal arrives and all of it can be ended at once, and ends with the run that started it.
"""

from __future__ import annotations

import logging
import os
import signal
import sys

_HUSH = "import os\nfor number in (1, 2): os.dup2(os.open(os.devnull, os.O_WRONLY), number)\n"
"""Nobody sees what workers print, and it must not fill a disk."""


def main() -> None:
    """Starts the cluster, says where it is, and waits for the end of standard input."""
    from distributed import LocalCluster

    cluster = LocalCluster(
        n_workers=int(sys.argv[1]),
        threads_per_worker=1,
        dashboard_address=None,
        silence_logs=logging.CRITICAL,
        preload=[_HUSH],
    )
    os.write(1, f"{cluster.scheduler_address}\n".encode())
    exec(_HUSH)  # noqa: S102 - the text is above
    sys.stdin.read()
    if hasattr(os, "killpg"):
        os.killpg(0, signal.SIGKILL)
    os._exit(1)


if __name__ == "__main__":
    main()
