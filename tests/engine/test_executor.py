"""Launches that are kept for the next time run the kernel that was asked for, with the arguments of now."""

import numpy as np

from warpwear.engine.executor import Executor, arguments, set_numbers
from warpwear.engine.tiles import Tiles
from warpwear.grid import Grid
from warpwear.kernels import contact


def test_recorded_launches_see_what_changes_in_a_struct(device: str) -> None:
    gaps = np.random.default_rng(2).normal(size=(5, 40))
    with Executor(Grid(*gaps.shape, 0.1), device=device) as executor:
        gap, stiffness, sums = executor.field(gaps), executor.field(np.ones((1, 40))), executor.partials(3)
        listed = Tiles(executor, gap, executor.zeros(), least=1e9)
        law = arguments(contact.Law, cap=1.0e300)
        for base in (0.1, 0.2, -0.4):
            law.base = base
            executor.launch(
                contact.carried, inputs=[law, stiffness, gap], outputs=[sums], over=listed, often=True
            )
            expected = np.maximum(base - gaps, 0.0).sum()
            assert abs(sums.numpy()[0].sum() - expected) < 1e-12 * expected


def test_recorded_launches_see_numbers_that_are_set(device: str) -> None:
    """`set_numbers` does what setting the members one by one does, for kernels and for who reads them."""
    gaps = np.random.default_rng(3).normal(size=(5, 40))
    with Executor(Grid(*gaps.shape, 0.1), device=device) as executor:
        gap, stiffness, sums = executor.field(gaps), executor.field(np.ones((1, 40))), executor.partials(3)
        listed = Tiles(executor, gap, executor.zeros(), least=1e9)
        law = arguments(contact.Law)
        for base, cap in ((0.1, 1.0e300), (np.float64(0.2), 0.3), (0.5, 0.1)):
            set_numbers(law, base=base, cap=cap)
            assert (law.base, law.cap, law.offset) == (base, cap, 0.0)
            executor.launch(
                contact.carried, inputs=[law, stiffness, gap], outputs=[sums], over=listed, often=True
            )
            expected = np.clip(base - gaps, 0.0, cap).sum()
            assert abs(sums.numpy()[0].sum() - expected) < 1e-12 * expected
