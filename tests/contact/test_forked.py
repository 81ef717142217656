"""A child that was forked in the middle of a computation is refused; one forked before or after computes."""

import os
import threading
from collections.abc import Callable

import numpy as np
import pytest

from warpwear import solve_contact
from warpwear.engine.executor import Executor
from warpwear.errors import InputError
from warpwear.grid import Grid

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="nothing is forked there")
REFUSED, SECONDS = 7, 60


def solve() -> None:
    solve_contact(np.random.default_rng(0).normal(size=(32, 32)), cell=1.0, mean_pressure=0.1, modulus=1.0)


def status_of_child(work: Callable[[], None]) -> int:
    child = os.fork()
    if child == 0:
        threading.Timer(SECONDS, os._exit, (1,)).start()
        try:
            work()
        except InputError as error:
            os._exit(REFUSED if "was forked while another thread computed" in str(error) else 2)
        except BaseException:
            os._exit(3)
        os._exit(0)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_child_forked_in_the_middle_is_refused() -> None:
    solve()
    assert status_of_child(solve) == 0
    begun, ended = threading.Event(), threading.Event()

    def compute() -> None:
        with Executor(Grid(8, 8, 1.0), threads=1):
            begun.set()
            ended.wait(SECONDS)

    thread = threading.Thread(target=compute)
    thread.start()
    begun.wait(SECONDS)
    try:
        assert status_of_child(solve) == REFUSED
    finally:
        ended.set()
        thread.join()
    assert status_of_child(solve) == 0
