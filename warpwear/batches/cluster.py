"""Sweeps on a Dask cluster: who may be asked, and the executor that its client gives."""

import ipaddress
import logging
import threading
import time
from asyncio import CancelledError
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any
from urllib.parse import urlsplit

from warpwear import lazy
from warpwear.errors import InputError
from warpwear.runs.console import warn

distributed = lazy.module("distributed")

#: How often a run is begun again whose worker was lost.
RETRIES = 5


@dataclass(frozen=True)
class Patience:
    """How long the first worker is waited for, how often it is looked whether any is left, and for how long.

    All in s.
    """

    first: float = 60.0
    look: float = 5.0
    lost: float = 300.0


@contextmanager
def connected(
    address: str, *, insecure: bool = False, device: str = "cpu", patience: Patience = Patience()
) -> Iterator[tuple[Executor, int, int]]:
    """Return the executor of a Dask scheduler, the threads of a run, and how many workers it has.

    Raises InputError for an address that is refused or not reached, and for workers that will not do. A plain
    TCP address that is not of this machine is refused unless insecure: whoever reaches such a scheduler runs
    any code on its workers; tls:// is the way. On a GPU each run takes one of a worker's resource "GPU".
    """
    _check(address, insecure=insecure)
    try:
        client = distributed.Client(address, timeout="20s", set_as_default=False)
    except ImportError:
        raise InputError("--cluster needs the package distributed: pip install 'warpwear[cluster]'") from None
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(f"--cluster {address} cannot be reached: {error}.") from error
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)  # rows tell of a cluster that dies
    with client:
        number = _check_workers(client, address, patience.first)
        more = {"resources": {"GPU": 1}} if device.startswith("cuda") else {}
        # Not pure: the same run in two sweeps is two calls. Stealing would begin runs twice.
        executor, ended = client.get_executor(pure=False, retries=RETRIES, **more), threading.Event()
        watched = (client, executor, address, ended, patience)
        threading.Thread(target=_watch, args=watched, daemon=True).start()
        try:
            yield executor, 1, number
        finally:
            ended.set()


def _watch(client: Any, executor: Executor, address: str, ended: threading.Event, patience: Patience) -> None:
    """Tell of a cluster that has lost all its workers, and give up its runs where none comes back."""
    since: float | None = None
    while not ended.wait(patience.look):
        try:
            alive = bool(client.nthreads())
        except (Exception, CancelledError):  # the sweep has ended, or the scheduler
            return
        if alive:
            since = None
        elif since is None:
            since = time.monotonic()
            lost = f"{patience.lost:g} s"
            warn(f"--cluster {address} has lost all its workers: waiting {lost} for one to come back.")
        elif time.monotonic() - since > patience.lost:
            executor.shutdown(wait=False)  # cancels what is left
            return


def _check(address: str, *, insecure: bool) -> None:
    """Raise InputError for an address that is none, or that others could listen in on."""
    try:
        parts = urlsplit(address if "//" in address else f"tcp://{address}")
        host, port = parts.hostname, parts.port
    except ValueError:
        host = port = None
    if not host or port is None:
        raise InputError(
            f"--cluster {address!r} is no address; tls://HOST:PORT or tcp://127.0.0.1:8786 is expected."
        )
    if parts.scheme == "tcp" and not insecure and not _is_here(host):
        raise InputError(
            f"--cluster {address} is neither encrypted nor on this machine: whoever reaches it could run any "
            "code on its workers. Use tls://, an SSH tunnel to 127.0.0.1, or --insecure in your own network."
        )


def _is_here(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _check_workers(client: Any, address: str, patience: float) -> int:
    """Return the number of workers. Raises InputError where one would make two runs at a time."""
    if not client.nthreads():
        warn(f"--cluster {address} has no workers yet: waiting {patience:g} s for the first.")
        try:
            client.wait_for_workers(1, timeout=patience)
        except TimeoutError as error:
            raise InputError(
                f"--cluster {address} has no workers: start some with dask worker {address} --nthreads 1."
            ) from error
    workers = client.nthreads()
    many = {name: threads for name, threads in workers.items() if threads > 1}
    if many:
        raise InputError(
            f"--cluster {address}: {len(many)} of its workers have several threads, in which runs would wait "
            "for each other; start them with --nthreads 1 (and --nworkers as many as cores)."
        )
    return len(workers)
