"""The loader `coppeliasim`: has a running CoppeliaSim import the written URDF, and measures the arm there.

CoppeliaSim is a program of its own. It is asked over its ZMQ remote API, by Coppelia Robotics' own Python client, and
what it prints stays on its console. It has one scene, which all workers of a run would use at once: each waits for its
turn.
"""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from dh2urdf.errors import MissingProgramError
from dh2urdf.stages import LOAD_TIME_LIMIT, Loader, Requires
from dh2urdf_plugins.loaders.coppeliasim.engines import Engine
from dh2urdf_plugins.loaders.options import SimulatorOptions
from dh2urdf_plugins.loaders.packages import Packages

if TYPE_CHECKING:
    from dh2urdf.stages import LoadReport, LoadRequest

_CLIENT = "coppeliasim_zmqremoteapi_client"
_PACKAGES = Packages("coppeliasim", {_CLIENT: "coppeliasim-zmqremoteapi-client", "zmq": "pyzmq"})

PORT = 23000
"""Where CoppeliaSim listens by default."""
ANSWERS_WITHIN = 5.0
"""How long a CoppeliaSim may take to answer at all [s]; its client would wait for ever."""
REMEDY = (
    "start one without a window, in its folder, by ./coppeliaSim.sh -H (with -GzmqRemoteApi.rpcPort=N for another "
    "port), or say in the loader's options `host` and `port` where it runs"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class CoppeliaSimOptions(SimulatorOptions):
    """Which CoppeliaSim is asked, and what is done there."""

    host: str = field(default="localhost", metadata={"help": "where CoppeliaSim runs"})
    port: int = field(default=PORT, metadata={"help": "port of its ZMQ remote API"})
    engine: Engine | None = field(
        default=None,
        metadata={
            "help": "engine of a hold test of two seconds, such as mujoco; none is done by default. "
            "bullet, which CoppeliaSim takes by itself, was seen to let joints come apart"
        },
    )

    def __post_init__(self) -> None:
        SimulatorOptions.__post_init__(self)
        if not 0 < self.port < 1 << 16:
            raise ValueError("port is a number from 1 to 65535")


def require(_options: CoppeliaSimOptions) -> None:
    """Ask whether the client is there, without importing it.

    Raises:
        MissingDependencyError: it is not installed.
    """
    _PACKAGES.require(_CLIENT, "zmq")


def load(request: LoadRequest, options: CoppeliaSimOptions) -> LoadReport:
    """Have CoppeliaSim import a URDF, and measure the arm; it is taken out of the scene again.

    Raises:
        LoaderError: CoppeliaSim cannot import the file, or holds another arm than the one that was written.
        MissingDependencyError: the client is not installed.
        MissingProgramError: no CoppeliaSim answers.
    """
    import socket
    from ipaddress import ip_address

    from dh2urdf_plugins.loaders.coppeliasim.arm import Arm, Connection
    from dh2urdf_plugins.loaders.coppeliasim.hold import hold
    from dh2urdf_plugins.loaders.coppeliasim.turns import turn

    zmq, library = _PACKAGES.load("zmq"), _PACKAGES.load(_CLIENT)
    try:
        with socket.create_connection((options.host, options.port), ANSWERS_WITHIN) as greeting:
            address, own = str(greeting.getpeername()[0]), str(greeting.getsockname()[0])
    except OSError as error:
        raise _silent(options) from error
    same_machine = address == own or ip_address(address.partition("%")[0]).is_loopback
    key = f"coppeliasim-{'localhost' if same_machine else address}-{options.port}"
    with turn(key, f"CoppeliaSim at {options.host}:{options.port}", LOAD_TIME_LIMIT / 2):
        client = library.RemoteAPIClient(options.host, options.port)
        client.socket.setsockopt(zmq.LINGER, 0)  # What was not delivered must not keep this process from ending.
        client.socket.setsockopt(zmq.RCVTIMEO, round(1000 * ANSWERS_WITHIN))
        try:
            client.require("sim")  # Somebody listens: CoppeliaSim, or another program?
        except zmq.ZMQError as error:
            raise _silent(options) from error
        client.socket.setsockopt(zmq.RCVTIMEO, round(1000 * LOAD_TIME_LIMIT / 4))
        with closing(Arm(request, Connection(client), same_machine=same_machine)) as arm:
            report = arm.report()
            if options.engine is None:
                return report
            held, findings = hold(arm, options.engine)
            return replace(report, hold=held, findings=(*report.findings, *findings))


def _silent(options: CoppeliaSimOptions) -> MissingProgramError:
    return MissingProgramError(
        "loader 'coppeliasim'", f"a CoppeliaSim that answers at {options.host}:{options.port}", REMEDY
    )


LOADER = Loader(
    name="coppeliasim",
    summary="has a running CoppeliaSim import a URDF, compares it with the table, lets it hold its weight if asked",
    open=load,
    options=CoppeliaSimOptions,
    formats=("urdf",),
    capabilities=(Requires(require),),
)
