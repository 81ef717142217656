"""Declare the command `warpwear sweep`."""

from typing import Any

import click

from warpwear.cli.options import BAND_OVER, DEVICE, EXPERIMENTS, PATH, repeated
from warpwear.cli.places import sweep_command
from warpwear.cli.study import CHANGES, STUDY, parsed_changes


@click.command(epilog=STUDY)
@click.argument("study")
@CHANGES
@repeated("--vary", "KEY=VALUES", "Vary a key: values between commas, a range 1:20, or a distribution.")
@click.option("--design", help="grid, zip, sobol, latin-hypercube or saltelli.  [default: grid]")
@click.option("--samples", type=int, help="Of all designs but grid and zip.")
@click.option("--seed", type=int, help="Of the samples.")
@BAND_OVER
@click.option("--out", type=PATH, help="Folder of the sweep. [default: the study's name and -sweep, here]")
@click.option("--runs", type=PATH, help="Folder of runs that sweeps share.  [default: runs/ in the sweep's]")
@click.option("--workers", type=int, help="Processes here.  [default: one a core, or one a GPU]")
@click.option("--cluster", metavar="ADDRESS", help="A Dask scheduler, tls://HOST:PORT, instead.")
@click.option("--insecure", is_flag=True, help="Allow a cluster that is neither encrypted nor here.")
@click.option("--gpus", type=click.Choice(["all"]), help="Share the workers among all GPUs here.")
@DEVICE
@click.option("--resume", is_flag=True, help="Go on with the sweep that the folder holds.")
@click.option("--dry-run", is_flag=True, help="Say what it would cost, and stop.")
@EXPERIMENTS
def sweep(study: str, changes: tuple[str, ...], vary: tuple[str, ...], **options: Any) -> int:
    """Run STUDY for many values of its keys, and lay the results together.

    \b
    warpwear sweep v3-fine --vary "contact.load=2 N,4 N,8 N" --vary disc.synthetic.seed=1:20 \\
        --band-over disc.synthetic.seed
    warpwear sweep mine.toml --vary "wear.counter=normal 9.4e-4 +- 0.7e-4 mm^3/N/m" \\
        --design sobol --samples 64

    \b
    runs/          one folder a run; a run that is there is not made again
    table.csv      one row a run: what was varied, how it ended (also table.parquet)
    sweep.nc       courses of all runs on one grid of distances
    figures/       courses with bands, scatter, heat map, what decides the friction
    sweep.html     all of it on one page

    The values may stand in the study's own section [sweep] too. A run that fails is a row that says why; the
    others are made, and the command ends with exit status 1.
    """
    design = {name: options.pop(name) for name in ("design", "samples", "seed")}
    design |= {"band_over": list(options.pop("band_over")) or None, "vary": sweep_command.varied(vary)}
    return sweep_command.command(study, parsed_changes(changes), design, **options)
