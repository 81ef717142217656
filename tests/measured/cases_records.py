"""Records as machines write them, made here: the lines around the rows are those of real exports."""

from collections.abc import Callable
from typing import Any

import numpy as np

from warpwear.grid import FloatArray

#: Rows of each step of a record.
ROWS = 40


def course(count: int) -> list[float]:
    """Return a coefficient of friction that rises, with a pattern of its own, rounded as a file has it."""
    place = np.arange(count)
    return [round(0.2 + 0.1 * place[k] / count + 0.01 * ((7 * k) % 5), 5) for k in range(count)]


def rtec() -> str:
    """Return a rotary record of a Rtec: a title cut by a lone carriage return, two steps, a footer."""
    lines = [
        "Recipe, UpperSample, LowerSample, OtherInfo, Averaging, LogFrequency, Type, Radius\r"
        "two_steps.Rx,,,,100,1000,Rotary,1,\r",
        "Step, Timestamp, RecipeStep, DAQ.Fz (N),DAQ.Fx (N),DAQ.COF (),Rotary.Velocity (rpm),"
        "Rotary.Position (rev),XYZ.X Position (mm),XYZ.Z Position (mm),\r",
    ]
    for step in (4, 7):
        for k, cof in enumerate(course(ROWS)):
            laps = (k + ROWS * (step == 7)) * 0.2
            lines.append(
                f"{step},{0.1 * (k + 1):.3f},{step},3.0,{3 * cof:.6f},{cof},120,{laps:.2f},0,-114.6,"
            )
    return "\n".join([*lines, "\r", "TotalTime\r", "00:12:56.5661021\r", ""])


def cetr(number: int = 1) -> str:
    """Return one file of a CETR with a linear drive: two strokes, forces in grams, Fx with an offset."""
    lines = [
        "Created by CETR Data Viewer ver.2.19.106 05/12/22 14:43:46",
        f"Created by CETR UMT ver.1.136.257 12 May 2022 12:{20 + number}:50",
        "Total number of runs - 1",
        "Total number of steps = 2",
        "Indenter tip ID = 0",
        rf"C:\data\wear_{number:03d}.tst",
        "",
        "Run # 1",
        "Run date 12 May 2022 12:21:50",
    ]
    for step, sign in ((1, -1.0), (2, 1.0)):
        lines += [f"Step No. {step}", "", "Step Type Code: 0", "Radius       = 3.9493", "Velocity     = 240"]
        lines += [f"Data Count   = {ROWS}", "", "Fx,Fz,Z,Y,X,V1,V2,V3,T,Ff,COF"]
        lines += ["g,g,mm,mm,mm,mm/sec,mm/sec,mm/sec,sec,g,", ""]
        for k in range(ROWS):
            force = sign * 200.0 * (0.3 + 0.001 * number) + 20.0
            lines.append(
                f"{force:.6f},-200.000000,-0.69,0.0,3.949250,0.05,0.0,0.0,{0.02 * k:.4f},{abs(force):.6f},"
                f"{abs(force) / 200.0:.6f}"
            )
        lines += ["", ""]
    return "\r\n".join(lines)


def phoenix() -> str:
    """Return a record of a Phoenix TE67: 15 lines above the names, tabs around the fields, decimal commas."""
    lines = ["Data file\t\tPIN_60N.TSV", "Configuration file\t\tA.CFG", "Calibration file\t\tB.CAL"]
    lines += ["Test control file\t\tC.TSF", "", "test 2\t\tPIN_60N", *["\t\t"] * 7, ""]
    lines.append("Test started at 19:54:05 on 2019-04-12")
    names = (
        "Time,This Step,Step Time,Test Time,Sliding Velocity,Speed,Mass,Load,TOTAL REVOLUTIONS,Specimen Temp,"
    )
    names += (
        "Contact Potential,Radius,Distance,Friction Force,Friction Coefficient,Displacement,Friction Force"
    )
    lines.append("\t" + names.replace(",", "\t") + "\t")
    for k, cof in enumerate(course(ROWS)):
        moving = int(k > 1)
        force = f"{50 * cof:.5f}"
        fields = [f"19:54:{k:02d}", "2" if k < 30 else "3", "1800,", f"{k},", f"{0.15 * moving:.3f}"]
        fields += [f"{102 * moving}", "5099", "50.000", f"{max(k - 1, 0) * 2}", "26.4", "90.6", "14"]
        fields += [f"{max(k - 1, 0) * 2 * 0.0879646:.3f}", force, f"{cof:.6f}", "3969", force]
        lines.append("\t" + "\t".join(fields).replace(".", ",") + "\t")
    return "\r\n".join([*lines, "Test completed at 20:24:18 on 2019-04-12", ""])


def anton_paar() -> str:
    """Return a record of a TRB3 with a linear drive: signed coefficients, the position, no Fz."""
    lines = ["TRB3", "Linear mode", "Full amplitude [mm]: 4.00", ""]
    lines.append(
        "Time [s]\tDistance [m]\tLaps\tSequence ID\tCycle ID\tMax Linear Speed [m/s]\tNominal Load [N]\tµ\t"
        "Linear Position [mm]\tFriction Force [N]\tTemperature [°C]\tHumidity [%]\tPenetration Depth [µm]"
    )
    for k in range(6 * ROWS):
        phase = 2.0 * np.pi * k / ROWS
        position, way = -2.0 * np.cos(phase), 1.0 if np.sin(phase + 1e-9) >= 0 else -1.0
        cof = way * (0.3 + 0.01 * (k // ROWS))
        row = (
            f"{0.025 * k:.3f} {0.2 * k:.3f} {k / ROWS:.3f} 1 {k // ROWS + 1} 0.01 5 {cof:.4f} {position:.5f}"
        )
        lines.append("\t".join(f"{row} {5 * cof:.4f} 24.1 40.2 1.5".split()))
    return "\n".join([*lines, ""])


def kyowa() -> bytes:
    """Return what a logger of load cells wrote, in Shift JIS: names and units of the channels, grams."""
    lines = ['"ID番号","PCD-400A"', '"タイトル",""', '"試験日時","2021/02/26","16:41:09"', '"測定CH数",2']
    lines += ['"ローパス(デジタル)","***","***"', '"校正係数",2.71,0.2983', '"単位","g","g"']
    lines += ['"Time(sec)","CH1","CH2"']
    lines += [f"{0.02 * k:.2f},3000.5,{3000.5 * cof:.6f}" for k, cof in enumerate(course(ROWS))]
    return "\r\n".join([*lines, ""]).encode("shift_jis")


def t11() -> str:
    """Return a record of an ITeR T-11: semicolons at the end of all rows, revolutions, no load."""
    lines = [
        "Time [s];Friction force [N];Displacement [um];Temperature2 [C];Temperature1 [C];"
        "Rotational speed [rpm];Number of revolutions;"
    ]
    lines += [f"{k};{4.0 * cof:.5f};1.5;20.1;20.2;120;{2 * k};" for k, cof in enumerate(course(ROWS))]
    return "\n".join([*lines, ""])


#: Make -> its record, and the options that it is read with.
RECORDS: dict[str, tuple[Callable[[], str | bytes], dict[str, Any]]] = {
    "rtec.csv": (rtec, {"radius": [6.0, 9.0]}),
    "phoenix.tsv": (phoenix, {}),
    "trb3.txt": (anton_paar, {}),
    "kyowa.csv": (kyowa, {"columns": "Time(sec), CH2 [g], CH1 [g]", "speed": 10.0}),
    "t11.csv": (t11, {"radius": 5.0, "load": 4.0}),
}


def written(content: str | bytes) -> bytes:
    """Return what a file of the record holds."""
    return content if isinstance(content, bytes) else content.encode()


def raw(
    *, cycles: float = 12, samples: int = 600, noise: float = 0.0, offset: float = 0.5, start: float = 0.0
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Passes slid, friction force, normal force, position: 30 mm, 8 N, μ = 0.3 + 0.01 passes."""
    rng = np.random.default_rng(3)
    passes = start + np.arange(round(2 * cycles * samples)) / samples
    part = np.where(passes % 2 < 1, passes % 1, 1 - passes % 1)
    direction = np.where(passes % 2 < 1, 1.0, -1.0)
    sliding = np.clip(np.minimum(part, 1 - part) / 0.05, 0, 1)  # friction builds up again after a turn
    normal = 8 + 0.2 * np.sin(7 * passes)
    friction = direction * (0.3 + 0.01 * passes) * normal * sliding + offset
    position = 30 * part + rng.normal(0.0, noise, passes.size)
    return passes, friction + rng.normal(0.0, 0.05, passes.size), normal, position
