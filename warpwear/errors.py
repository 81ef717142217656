"""The two ways a run can end badly, each with one sentence for the user."""


class InputError(ValueError):
    """Bad input: one sentence that names the field, the value and what is allowed. Exit status 2."""

    def __init__(self, sentence: str) -> None:
        super().__init__(sentence if sentence.endswith((".", "?")) else f"{sentence}.")


class ConvergenceError(RuntimeError):
    """A solve that did not meet its tolerance: the message names the residual. Never reported as success."""
