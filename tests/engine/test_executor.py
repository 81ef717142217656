"""Launches that are kept for the next time run the kernel that was asked for, with the arguments of now."""

import numpy as np
from numpy.testing import assert_array_equal

from warpwear import Study
from warpwear.contact.search import LoadSearch
from warpwear.engine.executor import Executor, arguments, set_numbers
from warpwear.engine.tiles import Tiles
from warpwear.grid import Grid
from warpwear.kernels import balance, contact, patches
from warpwear.models.patches.cells import PatchContact
from warpwear.study.surface import surface_in


def test_kernels_of_one_name_in_two_modules(device: str) -> None:
    """What patches answer is the same before and after a single contact was solved on their executor."""
    assert balance.carried.key == patches.carried.key
    study = Study.load("two-scale").replace({"grid.cell": "10 um", "disc.synthetic.cut_off": "20 um"})
    layout, rough = study.patch_layout, surface_in(study).heights(study.cells.x, study.cells.y)
    with Executor(layout.grid, device=device) as executor:
        fine = PatchContact(layout, rough, executor, curvature=1.0 / 3.0, hardness=600.0)
        fine.stiffness = 1.0e6
        base, offset = fine.lowest + 1.0e-3, np.zeros(layout.count)
        before = fine.response(base, offset)
        gap, listed = fine.gap, Tiles(executor, fine.gap, fine.initial, least=1e9)
        stiffness = executor.field(np.full((1, layout.grid.ny), 1.0e6))
        LoadSearch(executor, gap, listed, stiffness=stiffness, load=1.0, hardness=600.0).solve()
        after = fine.response(base, offset)
    assert before.pressure.sum() > 0.0
    for one, other in zip(before, after, strict=True):
        assert_array_equal(one, other)


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
