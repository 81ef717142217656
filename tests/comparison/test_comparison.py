"""What a comparison says of runs beside each other and beside measurements: notes, names, numbers."""

import csv
import re
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
from cases_comparison import gather, refusal

import warpwear
from warpwear import Study
from warpwear.comparison import figures
from warpwear.comparison.figures import FIGURES
from warpwear.comparison.table import to_text, write_table
from warpwear.errors import InputError
from warpwear.figures.describe import Chart, Line


def test_ends_that_are_inputs_are_told_and_notes_are_said_once(tmp_path: Path) -> None:
    """Three loads calibrated at their ends: 0.55 three times, which compares nothing."""
    study = Study.load("v3-fine").replace(
        {"grid.cell": "10 um", "sliding.distance": "30 mm", "friction.coefficient": 0.55}
    )
    names = ["l2", "l4", "l8"]
    for name in names:
        loaded = study.replace({"contact.load": f"{name[1]} N"})
        warpwear.run(loaded, out=tmp_path / name, plots=False).close()
    told = gather([tmp_path / name for name in names])
    text = to_text(told)
    assert re.search(r"^coefficient of friction at the end +0\.55 +0\.55 +0\.55$", text, re.MULTILINE)
    assert re.search(r"^coefficient of friction that is given +end +end +end$", text, re.MULTILINE)
    strengths = [run.summary.shear_strength for run in told.rows]
    assert len(set(strengths)) == 3
    for run, found in zip(told.rows, strengths, strict=True):
        assert found == pytest.approx(0.55 * run.study.contact.load / run.courses["area_contact"][1][-1])
    line = " +".join(f"{found:.4g}" for found in strengths)
    assert re.search(rf"^shear strength τ0, MPa +{line}$", text, re.MULTILINE)
    assert len(told.notes) == 4  # unlike loads, late snapshots, coarse cells, inputs
    assert sum(note.startswith("l2, l4, l8: cells of 10 µm") for note in told.notes) == 1
    assert told.notes[-1].startswith(
        "The coefficient of friction at the end of l2, l4, l8 is an input (friction.calibrate = 'end')"
    )
    assert figures.cof(told).panels[0].note == "the end is an input of 3 of 3 runs"  # type: ignore[union-attr]
    write_table(told, tmp_path / "table.csv")
    with (tmp_path / "table.csv").open(encoding="utf-8") as file:
        assert [row["cof_input [1]"] for row in csv.DictReader(file)] == ["end", "end", "end"]


def test_representative_patches_are_told_beside_whole_ones(runs: Path, tmp_path: Path) -> None:
    """And a two-scale run beside one of one scale."""
    changes = {"grid.cell": "10 um", "disc.synthetic.cut_off": "20 um", "grid.extent": "1.2 mm"}
    changes |= {"sliding.distance": "0.1 mm", "patches.macro_cell": "300 um", "output.snapshots": []}
    for name, patch in {"whole": "300 um", "part": "150 um"}.items():
        study = Study.load("two-scale").replace(changes | {"patches.width": patch, "study.name": name})
        warpwear.run(study, out=tmp_path / name, plots=False).close()
    read = gather([tmp_path / "whole", tmp_path / "part"])
    told = [note for note in read.notes if note.startswith("Unlike tests")]
    assert told == ["Unlike tests: the runs differ in patches.width (whole 0.3 mm, part 0.15 mm)."]
    lines = {line.split("  ")[0]: line.split()[-2:] for line in to_text(read).splitlines()}
    assert lines["patches.macro_cell, µm"] == ["300", "300"]
    assert lines["patches.width, µm"] == ["300", "150"]
    beside = gather([runs / "a", tmp_path / "part"])
    (told,) = (note for note in beside.notes if note.startswith("Unlike tests"))
    assert "study.model (v3-fine micro, part two-scale)" in told
    assert "patches." not in told
    assert "patches.width" not in to_text(gather([runs / "a", runs / "light"]))


def test_one_stands_for_a_list_of_one_and_a_result_for_its_folder(runs: Path, measured: Path) -> None:
    """A text is not read letter by letter."""
    with warpwear.Result.open(runs / "a") as result:
        compared = warpwear.compare(result, experiments=str(measured), columns="DISTANCE,COF")
    assert [experiment.name for experiment in compared.experiments] == ["sample 3"]
    assert [run.folder for run in compared.rows] == [runs / "a"]
    banded = warpwear.compare(runs / "a", runs / "soft", band_over="wear.disc")
    assert len(banded.groups) == 2  # they differ in ploughing, too
    with pytest.raises(InputError, match=r"sample 3.csv is no run; give records by experiments=\[…\]"):
        warpwear.compare(runs / "a", measured)
    with pytest.raises(TypeError, match="'foo' is no option; allowed: pixel"):
        warpwear.compare(runs / "a", runs / "soft", foo=1)  # type: ignore[call-arg]


def test_two_folders_of_one_name_go_by_their_paths(runs: Path, tmp_path: Path) -> None:
    shutil.copytree(runs / "a", tmp_path / "a")
    names = [run.name for run in gather([runs / "a", tmp_path / "a", runs / "soft"]).rows]
    assert names == [str(runs / "a"), str(tmp_path / "a"), "soft"]
    copy = shutil.copy(runs / "a" / "history.csv", tmp_path / "soft.csv")
    read = gather([runs / "soft"], [copy], columns="distance [mm],cof [1]")
    assert [e.name for e in read.experiments] == ["soft (experiment)"]
    assert read.rows[0].ends["rms_cof soft (experiment)"] is not None


def test_a_runs_own_history_differs_by_nothing(runs: Path) -> None:
    read = gather([runs / "a"], [runs / "a" / "history.csv"], columns="distance,cof")
    assert read.rows[0].ends["rms_cof history"] == pytest.approx(0.0, abs=1e-11)


def test_time_takes_the_runs_speed_unless_they_differ(runs: Path, tmp_path: Path) -> None:
    record = tmp_path / "record.txt"
    record.write_text("Zeit [min]\tReibwert\n0\t0,1\n1\t0,2\n2\t0,2\n", encoding="utf-8")
    alike = gather([runs / "a", runs / "soft"], [record])
    assert alike.experiments[0].distance.tolist() == pytest.approx([0.0, 20.0, 40.0])
    with pytest.raises(InputError, match="a speed is needed"):
        gather([runs / "a", runs / "light"], [record])
    told = gather([runs / "a", runs / "light"], [record], speed="1 mm/s")
    assert told.experiments[0].distance.tolist() == [0.0, 60.0, 120.0]
    assert not any("mm long" in note for note in told.notes)  # twice the longer run's
    slow = gather([runs / "a", runs / "light"], [record], speed="1 um/s")
    assert "record: It is 0.12 mm long, the runs 30, 60 mm." in slow.notes
    twice = gather([runs / "a", runs / "soft"], [record], speed="1 um/s")
    assert "record: It is 0.12 mm long, the runs 30 mm." in twice.notes
    single = gather([runs / "a"], [record], speed="1 um/s")
    assert "record: It is 0.12 mm long, the run 30 mm." in single.notes


def test_turns_need_the_radius_of_their_track_and_not_the_runs_speed(runs: Path, tmp_path: Path) -> None:
    record = tmp_path / "turns.csv"
    record.write_text("Time (s),Laps,COF\n0,0,0.1\n60,30,0.2\n120,60,0.2\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"gives turns, 'Laps', and no distance: .* such as radius '6 mm'"):
        gather([runs / "a"], [record])
    told = gather([runs / "a"], [record], radius="0.1 mm").experiments[0]
    assert told.distance.tolist() == pytest.approx([0.0, 6.0 * np.pi, 12.0 * np.pi])
    by_time = gather([runs / "a"], [record], speed="1 mm/s")  # as asked
    assert by_time.experiments[0].distance.tolist() == [0.0, 60.0, 120.0]
    assert "Warning: speed 1 mm/s is given, the run has 0.333333 mm/s." in by_time.notes
    assert "--radius" in refusal(runs / "a", "--experiment", record)
    read = warpwear.read_record(record, radius="0.1 mm")
    taken = warpwear.compare(runs / "a", experiments=[read])  # with what it was read with
    assert taken.experiments[0].name == "turns"
    assert taken.experiments[0].distance.tolist() == told.distance.tolist()
    assert warpwear.compare(runs / "a", experiments=read).experiments[0].cof.tolist() == told.cof.tolist()


def test_a_raw_record_is_told_by_its_last_cycle_and_its_load(runs: Path, tmp_path: Path) -> None:
    part = np.arange(1600) / 200  # of a pass of 30 mm, eight of them
    position = 30.0 * np.where(part % 2 < 1, part % 1, 1 - part % 1)
    table = np.column_stack([np.where(part % 2 < 1, 1.5, -1.5), np.full(1600, 5.0), position])
    record = tmp_path / "raw.csv"
    np.savetxt(record, table, delimiter=";", header="Fx (N);Fz (N);X position (mm)", comments="", fmt="%.6f")
    with pytest.raises(InputError, match=r"30 mm by the position, not 10 mm: pass stroke='30 mm'"):
        gather([runs / "a"], [record], stroke="10 mm")
    notes = gather([runs / "a"], [record], stroke="30 mm").notes
    assert notes[0] == "raw: Warning: the median of the normal force is 5 N where the run has 8 N."
    (told,) = (note for note in notes if "last cycle" in note)
    assert told == "raw: The middle of its last cycle is at 210 mm, the run 30 mm long."


def test_gaps_of_a_measured_course_are_told_or_refused(runs: Path, tmp_path: Path) -> None:
    record = tmp_path / "holes.csv"

    def notes(places: np.ndarray) -> str:
        np.savetxt(
            record, np.c_[places, 0.3 + 0 * places], delimiter=";", header="Distance [mm];COF", comments=""
        )
        return "\n".join(gather([runs / "a"], [record]).notes)

    assert "no measured point" not in notes(np.linspace(0.0, 30.0, 6))  # few, but even
    assert "no measured point" not in notes(30.0 * np.linspace(0.0, 1.0, 60) ** 2)  # dense at first
    some = notes(np.concatenate([np.arange(0.0, 10.0, 0.1), np.arange(22.0, 30.1, 0.1)]))
    # From 9.9 to 22 mm of the 0.3 to 30 mm that both have, or a little more.
    assert re.search(r"holes: It has no measured point over 4[01] % of .* from 9\.9 to 22 mm:", some)
    with pytest.raises(
        InputError, match=r"no measured point over 6\d % .* from 9\.9 to 28 mm; half of it is"
    ):
        notes(np.concatenate([np.arange(0.0, 10.0, 0.1), np.arange(28.0, 30.1, 0.1)]))


def test_what_happens_early_is_drawn_apart(runs: Path, measured: Path) -> None:
    left, right = FIGURES["cof"](gather([runs / "a"], [measured])).panels
    assert isinstance(left, Chart)
    assert isinstance(right, Chart)
    assert right.lines == left.lines
    last = max(float(line.x.max()) for line in left.lines if isinstance(line, Line))
    assert right.x.high == pytest.approx(0.1 * last)
    assert right.note == "the first tenth of the distance"


def test_files_of_the_runs_are_closed(runs: Path) -> None:
    gather([runs / "a", runs / "soft"])
    with h5py.File(runs / "a" / "result.h5", "r+"):  # refused while it is open elsewhere for reading
        pass
