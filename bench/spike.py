"""What one wrong pixel does to a contact, and what the outlier step does about it.

    python bench/spike.py [--out FOLDER]

A measured disc (synthetic heights in a .npy file) is run clean, with a spike of 50 µm on one pixel, and with
the spike and `disc.outliers = 6`. Prints a table and draws spike.png.
"""

import tempfile
from pathlib import Path

import click
import numpy as np
from matplotlib.figure import Figure

import warpwear
from warpwear.surfaces.made.self_affine import SelfAffine

PIXEL, SIDE = 0.002, 0.8  # [mm]
PLACE = 0.25  # of the spike, from the middle along sliding [mm]
SPIKE = 0.05  # [mm]
CASES = {"clean": (False, {}), "spike": (True, {}), "spike, outliers = 6": (True, {"disc.outliers": 6})}


def study_of(file: Path) -> warpwear.Study:
    """The reference test on the measured disc, over 3 mm."""
    return warpwear.Study.load("v3-fine").replace(
        {
            "disc.surface": str(file),
            "disc.pixel": f"{PIXEL} mm",
            "disc.height_unit": "mm",
            "grid.cell": f"{PIXEL} mm",
            "grid.extent": f"{SIDE} mm",
            "sliding.distance": "3 mm",
            "output.snapshots": [],
        }
    )


def results(folder: Path) -> dict[str, warpwear.Result]:
    """Each case run."""
    places = (np.arange(round(SIDE / PIXEL)) + 0.5) * PIXEL - SIDE / 2
    clean = SelfAffine(sq=0.3e-3, roll_off=0.1, cut_off=0.016, seed=1).heights(places, places)
    spiked = clean.copy()
    spiked[np.argmin(np.abs(places - PLACE)), places.size // 2] += SPIKE
    found = {}
    for name, (is_spiked, changes) in CASES.items():
        np.save(folder / "disc.npy", spiked if is_spiked else clean)
        found[name] = warpwear.run(study_of(folder / "disc.npy").replace(changes))
    return found


def draw(found: dict[str, warpwear.Result]) -> Figure:
    """The contact of each case after 3 mm."""
    figure = Figure(figsize=(7.0, 2.9), layout="constrained")
    for axes, (name, result) in zip(figure.subplots(1, 3, sharey=True), found.items(), strict=True):
        contact = result.snapshot(-1).pressure > 0.0
        half = SIDE / 2
        axes.imshow(contact.T, origin="lower", extent=(-half, half, -half, half), cmap="Greys", vmax=1)
        if "spike" in name:
            axes.annotate(
                "spike", (PLACE, 0.0), (PLACE, 0.25), ha="center", arrowprops={"arrowstyle": "->"}, fontsize=7
            )
        along = result.history["patch_along"][-1]
        axes.set_title(f"{name}\nscar {1e3 * along:.0f} µm long", fontsize=8)
        axes.set_xlabel("along sliding, x, mm", fontsize=8)
        axes.tick_params(labelsize=7)
    figure.axes[0].set_ylabel("across, y, mm", fontsize=8)
    return figure


@click.command()
@click.option("--out", type=click.Path(path_type=Path), default=Path("spike"), show_default=True)
def main(out: Path) -> None:
    """What one wrong pixel does to a contact, and what the outlier step does about it."""
    with tempfile.TemporaryDirectory() as folder:
        found = results(Path(folder))
    click.echo(f"{'':<22}{'first contact, µm':>18}{'area, mm²':>12}{'scar, mm':>18}{'removed':>9}")
    for name, result in found.items():
        history, removed = result.history, result.record["surface"]["outliers_removed"]
        scar = f"{history['patch_along'][-1]:.3f} × {history['patch_across'][-1]:.3f}"
        click.echo(
            f"{name:<22}{1e3 * history['approach'][0]:>18.3f}{history['area_contact'][-1]:>12.4f}{scar:>18}"
            f"{removed:>9}"
        )
    out.mkdir(parents=True, exist_ok=True)
    draw(found).savefig(out / "spike.png", dpi=200)
    click.echo(f"written to {out}/spike.png")


if __name__ == "__main__":
    main()
