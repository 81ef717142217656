"""What is left of a track after one pass and after ten, when the ball really slides?

A stationary disc keeps the same cells under the ball; here the ball moves on by some cells a step and comes
round again. The disc then wears over the whole track, and the ball is worn by all of it.
"""

import numpy as np

import warpwear

study = warpwear.Study.load("track").replace(
    {
        "grid.cell": "20 um",
        "grid.extent": "1.2 mm",
        "disc.synthetic.period": "2 mm",
        "disc.synthetic.cut_off": "80 um",
        "sliding.track": "2 mm",
        "sliding.shift": 4,
        "sliding.distance": "300 mm",  # ten passes of 30 mm
        "output.snapshots": ["30 mm", "300 mm"],
    }
)
result = warpwear.run(study)
for distance in ("30 mm", "300 mm"):
    snapshot = result.at(distance)
    track, ball = snapshot.wear_disc, snapshot.wear_counter  # mm; of the disc over the whole track
    middle = track[:, track.shape[1] // 2]
    print(
        f"after {distance}: the track has lost {1e3 * middle.mean():.2f} µm in its middle, "
        f"where {np.mean(middle > 0.0):.0%} of it is worn; the ball {1e3 * ball.max():.2f} µm at most"
    )
result.plot.groove().savefig("groove.png")
