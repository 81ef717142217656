"""Peak memory of a run, in a process of its own: `-m measure.memory CELLS THREADS` prints it in fields."""

import sys
import threading

import psutil
from contenders.roster import study_on

import warpwear


def peak_fields(cells: int, threads: int) -> float:
    """Peak above what is held after the imports, in float64 fields of cells² cells."""
    # A small run first, so that imports and compiled kernels do not count.
    warpwear.run(study_on(64, sliding__distance="0.003 mm"), threads=threads).close()
    process = psutil.Process()
    before = peak = process.memory_info().rss
    finished = threading.Event()

    def watch() -> None:
        nonlocal peak
        while not finished.wait(0.001):
            peak = max(peak, process.memory_info().rss)

    watcher = threading.Thread(target=watch)
    watcher.start()
    warpwear.run(study_on(cells, sliding__distance="0.03 mm"), threads=threads).close()
    finished.set()
    watcher.join()
    return float(peak - before) / (8 * cells**2)


if __name__ == "__main__":
    print(peak_fields(int(sys.argv[1]), int(sys.argv[2])))
