"""The README's first picture: a pressure map, a worn section beside a measured one, and a course of friction.

    python bench/overview.py [--out FOLDER]

draws overview.png. About a minute on two cores.
"""

from pathlib import Path

import click
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import warpwear
from warpwear import Study

PUBLISHED = Path(__file__).parents[1] / "docs" / "files" / "published"
SEEDS = range(1, 6)


def pressure(figure: Figure, axes: Axes) -> None:
    """Draw the pressures of the preset `first`, unworn, on cells of 1 µm."""
    still = {"sliding.kinematics": "stationary", "sliding.distance": "0 mm", "sliding.track": "full"}
    study = Study.load("first").replace({"grid.cell": "1 um", "grid.extent": "0.16 mm", **still})
    with warpwear.run(study) as result:
        pressures = np.asarray(result.snapshot(-1).pressure).T
        area = result.summary["area_mm2"]["contact"]
    half = pressures.shape[0] * study.grid.cell / 2 * 1e3
    shown = np.where(pressures > 0.0, pressures * 1e-3, np.nan)
    image = axes.imshow(shown, extent=(-half, half, -half, half), origin="lower", cmap="viridis", vmin=0.0)
    figure.colorbar(image, ax=axes, label="pressure, GPa", shrink=0.85)
    axes.set(xlabel="along sliding x, µm", ylabel="across y, µm", xlim=(-70, 70), ylim=(-70, 70))
    axes.set_title(f"ball on a rough disc, 5 N\n{1e6 * area:.0f} µm² in contact", fontsize=10)


def groove(axes: Axes) -> None:
    """Draw the section of a block that a ring has worn beside the measured one."""
    study = Study.load(PUBLISHED / "cruzado2010.toml")
    lines = (PUBLISHED / "measured_cruzado2010_test1.csv").read_text(encoding="utf-8").splitlines()
    place, height = np.loadtxt([row for row in lines if row[0] in "-0123456789"], delimiter=",").T
    with warpwear.run(study) as result:
        worn = np.asarray(result.snapshot(-1).wear_disc).mean(axis=1)
    x = (np.arange(worn.size) - (worn.size - 1) / 2) * study.grid.cell
    axes.plot(place, height, ".", ms=3, color="0.55", label="measured")
    axes.plot(x, -1e3 * worn, color="C0", label="warpwear")
    axes.set(xlabel="along sliding x, mm", ylabel="height of the block, µm", xlim=(-2, 2))
    axes.set_title("block on ring after 3600 m\n(Cruzado 2010)", fontsize=10)
    axes.legend(frameon=False, loc="upper center", markerscale=2)


def course(axes: Axes) -> None:
    """Draw the friction of the preset `running-in` on surfaces of five seeds: each, and their mean."""
    study = Study.load("running-in")
    curves = []
    for seed in SEEDS:
        with warpwear.run(study.replace({"disc.synthetic.seed": seed})) as result:
            distance = np.asarray(result.history["distance"])
            curves.append(np.asarray(result.history["cof"]))
    band = {"color": "C0", "alpha": 0.25, "lw": 0, "label": "least to most"}
    axes.fill_between(distance, np.min(curves, 0), np.max(curves, 0), **band)
    axes.plot(distance, np.mean(curves, 0), color="C0", label=f"mean of {len(SEEDS)} surfaces")
    axes.set(xlabel="sliding distance, mm", ylabel="coefficient of friction", ylim=(0, None), xlim=(0, None))
    axes.set_title("friction as a film wears through\n(preset running-in)", fontsize=10)
    axes.legend(frameon=False, loc="lower right")


@click.command()
@click.option("--out", type=click.Path(path_type=Path), default=Path(__file__).parent / "pictures")
def main(out: Path) -> None:
    figure = Figure(figsize=(11.5, 3.6), layout="constrained", dpi=110)
    left, middle, right = figure.subplots(1, 3)
    pressure(figure, left)
    groove(middle)
    course(right)
    figure.savefig(out / "overview.png")


if __name__ == "__main__":
    main()
