"""A worker process of `pool.Workers`: it reads a call from standard input, makes it, writes what it gave.

python -m warpwear.sweeps.worker
"""

import os
import pickle
import signal
import sys


def main() -> None:
    """Serve calls until the input ends. What a call prints goes to standard error."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # a run then leaves a checkpoint
    calls, answers = sys.stdin.buffer, os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    while True:
        try:
            function, arguments = pickle.load(calls)
        except EOFError:
            return
        try:
            answer = (True, function(*arguments))
        except Exception as error:
            answer = (False, error)
        pickle.dump(answer, answers, protocol=pickle.HIGHEST_PROTOCOL)
        answers.flush()


if __name__ == "__main__":
    try:
        main()
    except (KeyboardInterrupt, BrokenPipeError):
        sys.exit(130)
