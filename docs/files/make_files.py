"""Make the files that the tutorials read: no instrument has seen them, and their own headers say so.

`python docs/files/make_files.py` writes them beside itself. They have what real files have and made-up arrays
mostly lack: a tilt and a bow, noise, points that were lost on steep flanks, spikes, and ends of strokes.
"""

import zipfile
from pathlib import Path

import numpy as np
from SurfaceTopography import Topography

HERE = Path(__file__).parent
RNG = np.random.default_rng(20)
NUMBER, PIXEL = 400, 2.5e-3  # points a side; [mm]
LAY = np.radians(86.0)  # angle between the grinding marks and the file's x, along which the ball slides
MARK, LENGTH = 0.011, 0.35  # width and length over which grinding marks stay alike [mm]
SQ, NOISE, BOW = 1.0e-3, 20e-6, 1.5e-3  # roughness, noise of a point, height of the lapped-in bow [mm]
RESOLUTION = 5e-6  # of the heights [mm]


def ground() -> np.ma.MaskedArray:
    """Return heights [mm], shape (x, y), of a ground disc of 1 mm × 1 mm, as a profiler exports them."""
    frequency = np.fft.fftfreq(2 * NUMBER, PIXEL)
    fx, fy = frequency[:, np.newaxis], frequency[np.newaxis, :]
    along, across = fx * np.cos(LAY) + fy * np.sin(LAY), fy * np.cos(LAY) - fx * np.sin(LAY)
    noise = np.fft.fft2(RNG.normal(size=(2 * NUMBER, 2 * NUMBER)))
    marks = (1.0 + (2.0 * np.pi * MARK * across) ** 2) ** -1.1 / (1.0 + (2.0 * np.pi * LENGTH * along) ** 2)
    heights = np.fft.ifft2(noise * marks).real[:NUMBER, :NUMBER]
    heights = (heights - heights.mean()) / heights.std()
    heights = -np.expm1(-0.35 * heights)  # marks are deeper than ridges are high
    heights = SQ * (heights - heights.mean()) / heights.std()
    slope = np.hypot(*np.gradient(heights, PIXEL))
    steep = slope * RNG.uniform(0.5, 1.5, size=slope.shape)
    lost = steep > np.quantile(steep, 0.994)
    heights += RNG.normal(scale=NOISE, size=heights.shape)
    x, y = np.meshgrid(*2 * [PIXEL * (np.arange(NUMBER) - NUMBER / 2)], indexing="ij")
    heights += 2.1e-3 * x - 1.4e-3 * y + BOW * (1.0 - (x**2 + y**2) / 0.5)
    spikes = [(206, 193), *RNG.integers(10, NUMBER - 10, size=(3, 2))]  # one of them under the ball
    for place in spikes:
        heights[tuple(place)] += RNG.uniform(8e-3, 12e-3)
    return np.ma.MaskedArray(RESOLUTION * np.round(heights / RESOLUTION), lost)


def record() -> str:
    """Return the raw record of a test: 40 cycles of 8 mm stroke, 4 N, 1 Hz, 100 points a second."""
    time = np.arange(0.0, 40.0, 0.01)  # s
    position = 4.0 * np.sin(2.0 * np.pi * time)  # mm
    direction = np.tanh(np.cos(2.0 * np.pi * time) / 0.08)
    friction = 0.18 + 0.34 * (1.0 - np.exp(-time / 9.0))
    normal = 4.0 + 0.05 * np.sin(2.0 * np.pi * time + 0.4) + RNG.normal(scale=0.02, size=time.size)
    tangential = friction * normal * direction + 0.06 + RNG.normal(scale=0.05, size=time.size)
    lines = ["Time [s],Position [mm],Fx [N],Fz [N]"]
    rows = np.column_stack([time, position, tangential, normal])
    lines += [",".join(f"{value:.3f}" for value in row) for row in rows]
    return "\n".join(lines) + "\n"


def rotary() -> str:
    """Return a record as a Rtec writes it: a ball on a disc, 250 laps of 5 mm radius at 3 N.

    It is low for 40 laps, jumps in 3, overshoots by a tenth, comes to 0.6; noise of laps goes together.
    """
    dice, laps, points = np.random.default_rng(7), 250, 4
    lap = np.arange(laps * points) / points
    noise = np.zeros(laps)
    for number in range(1, laps):
        noise[number] = 0.7 * noise[number - 1] + dice.normal(scale=0.008)
    rise = np.clip(0.1 + 0.8 * (lap - 40.0) / 3.0, 0.0, 1.0)
    level = 0.6 + 0.06 * np.exp(-np.clip(lap - 43.0, 0.0, None) / 20.0)
    cof = 0.18 + rise * (level - 0.18) + np.repeat(noise, points) * (0.3 + 0.7 * rise)
    cof += 0.02 * np.sin(2.0 * np.pi * lap) * (0.3 + 0.7 * rise) + dice.normal(scale=0.004, size=lap.size)
    normal = 3.0 + dice.normal(scale=0.01, size=lap.size)
    lines = ["Recipe, UpperSample, LowerSample, OtherInfo, Type", "made_by_warpwear.Rx,ball,disc,,Rotary"]
    lines.append("Step, Timestamp, RecipeStep, DAQ.Fz (N),DAQ.COF (),Rotary.Position (rev),")
    rows = zip(lap, normal, cof, strict=True)
    lines += [f"2,{a:g},2,{n:.2f},{c:.3f},{a:g}," for a, n, c in rows]
    return "\n".join([*lines, "", "TotalTime", "00:04:10.00", ""])


def packed(path: Path) -> None:
    """Compress the parts of an .x3p, which is a zip."""
    with zipfile.ZipFile(path) as file:
        parts = [(info, file.read(info)) for info in file.infolist()]
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as file:
        for info, content in parts:
            file.writestr(zipfile.ZipInfo(info.filename), content, zipfile.ZIP_DEFLATED)


if __name__ == "__main__":
    surface = Topography(1e3 * ground(), (NUMBER * PIXEL * 1e3, NUMBER * PIXEL * 1e3), unit="um")
    surface.to_x3p(
        str(HERE / "ground-disc.x3p"),
        dtype="I",
        manufacturer="warpwear, documentation",
        model="none: this surface was made by docs/files/make_files.py, not measured",
    )
    packed(HERE / "ground-disc.x3p")
    (HERE / "reciprocating-test.csv").write_text(record(), encoding="utf-8")
    (HERE / "ball-on-disc.csv").write_text(rotary(), encoding="utf-8")
