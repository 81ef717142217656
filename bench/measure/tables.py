"""Tables of what the benchmarks of the half-space recorded, as text: python bench/measure/tables.py [FOLDER].

FOLDER holds the records (default: bench/recorded): aspher_*.json and half_space*.json of `half_space.py`,
alone_*.json of the same without contenders, capped_*.json of contacts with a hardness, challenge.json of the
challenge's surface, largest.json of the largest contacts on a GPU. A table without a record is left out.
"""

import json
import statistics
import sys
from pathlib import Path
from typing import Any

RECORDED = Path(__file__).parents[1] / "recorded"


def _records(folder: Path, pattern: str) -> list[dict[str, Any]]:
    return [json.loads(path.read_text()) for path in sorted(folder.glob(pattern))]


def _machine(record: dict[str, Any]) -> str:
    """A line on what a record was made on."""
    there = record["machine"]
    versions = ", ".join(f"{name} {there[name]}" for name in ("numpy", "scipy", "warp-lang") if name in there)
    return f"{there['processor']}, {there['cores']} cores, Python {there['python']}, {versions}"


def areas(folder: Path = RECORDED) -> str:
    """Residual and share in contact of all solvers."""
    lines = [
        f"{'cells':>6s} {'case':11s}{'asked':>8s} {'solver':18s}{'residual':>9s}{'share in contact':>18s}"
    ]
    for record in _records(folder, "half_space.json") + _records(folder, "aspher_*.json"):
        for row in record["rows"]:
            for side, solver in (("ours", "warpwear"), ("theirs", row["contender"])):
                if f"{side}_area" in row:
                    lines.append(
                        f"{row['cells']:6d} {row['case']:11s}{row['target']:8.0e} {solver:18s}"
                        f"{row[f'{side}_residual']:9.1e}{row[f'{side}_area']:18.5f}"
                    )
    return "\n".join(lines)


def times(folder: Path = RECORDED, pattern: str = "aspher_*.json") -> str:
    """Processor time and memory beside a peer; the median of its ratios by size, residual and threads."""
    lines, last = [], ""
    ratios: dict[tuple[str, int, float, int], list[float]] = {}
    for record in _records(folder, pattern):
        rows = [row for row in record["rows"] if "processor_seconds_ratio" in row]
        if rows and (said := _machine(record)) != last:
            last = said
            lines += [
                said,
                f"{'cells':>6s} {'threads':7s} {'case':11s}{'residual':>9s} {'beside':24s}"
                f"{'its tolerance':>13s}{'ours':>9s}{'theirs':>9s}{'times':>8s}{'clock':>8s}"
                f"{'MiB ours':>10s}{'theirs':>8s}",
            ]
        for row in sorted(rows, key=lambda row: (row["cells"], -row["target"])):
            ours, theirs = (
                statistics.median(row[f"{side}_processor_seconds"]) for side in ("ours", "theirs")
            )
            lines.append(
                f"{row['cells']:6d} {row['threads']:7d} {row['case']:11s}{row['target']:9.0e}"
                f" {row['contender'] + ' ' + row['version']:24s}{row['their_tolerance']:13.0e}"
                f"{ours:8.2f}s{theirs:8.2f}s"
                f"{row['processor_seconds_ratio']:8.2f}{row['seconds_ratio']:8.2f}"
                f"{row['ours_memory_mib']:10.0f}{row['theirs_memory_mib']:8.0f}"
            )
            key = row["contender"], row["cells"], row["target"], row["threads"]
            ratios.setdefault(key, []).append(row["processor_seconds_ratio"])
    for (peer, cells, target, threads), found in sorted(ratios.items()):
        if len(found) == 1:
            continue
        lines.append(
            f"{peer}, {cells}², {target:.0e}, {threads} thread(s): median {statistics.median(found):.2f}, "
            f"least {min(found):.2f}, of {len(found)} cases"
        )
    return "\n".join(lines)


def alone(folder: Path = RECORDED) -> str:
    """Solves of large grids on a CPU."""
    lines = []
    for record in _records(folder, "alone_*.json"):
        lines.append(_machine(record))
        lines += [
            f"{row['cells']}² {row['case']:9s} to {row['target']:.0e}, {row['threads']} threads: "
            f"{row['seconds']:.1f} s, {row['processor_seconds']:.1f} s of processor time, "
            f"{row['iterations']} iterations, residual {row['residual']:.1e}, {row['memory_mib']:.0f} MiB"
            for row in record["rows"]
        ]
    return "\n".join(lines)


def capped(folder: Path = RECORDED) -> str:
    """Iterations of contacts with a hardness, by load and hardness."""
    lines = []
    for record in _records(folder, "capped_*.json"):
        rows = {(row["hardness"], row["load"]): row for row in record["rows"]}
        hardnesses, loads = (sorted({key[n] for key in rows}) for n in (0, 1))
        one = record["rows"][0]
        lines += [
            f"{one['cells']}² cells, residual {one['tolerance']:.0e}; H/E* down, mean pressure / H across"
        ]
        lines.append(" " * 8 + "".join(f"{load:>7g}" for load in loads))
        for hardness in hardnesses:
            found = [rows.get((hardness, load), {}).get("iterations", "–") for load in loads]
            lines.append(f"{hardness:<8g}" + "".join(f"{value:>7}" for value in found))
    return "\n".join(lines)


def largest(folder: Path = RECORDED) -> str:
    """The largest contacts on one GPU."""
    lines = []
    for record in _records(folder, "largest*.json"):
        lines += [
            f"{row['cells']}² {row['case']:8s} to {row['tolerance']:.0e}, {row['device']}: "
            f"{row['seconds']:.1f} s from array to array, {row['pairs']} pairs of transforms, "
            f"share in contact {row['area']:.5f}, "
            f"violation {row['violation']:.1e}, relative energy gap {row['relative_gap']:.1e}, "
            f"host at most {row['host_gib']:.0f} GiB"
            for row in record["rows"]
        ]
    return "\n".join(lines)


def challenge(folder: Path = RECORDED) -> str:
    """Areas and gaps on the challenge's surface."""
    lines = []
    for record in _records(folder, "challenge.json"):
        lines.append(f"{_machine(record)}; rms height {record['rms_um']:.3f} µm")
        lines.append(
            f"{'cells':>6s} {'solver':10s}{'residual':>9s}{'share':>9s}{'mean gap':>12s}{'largest p/E*':>14s}"
            f"{'cpu':>9s}"
        )
        for row in record["rows"]:
            lines.append(
                f"{row['cells']:6d} {row['solver']:10s}{row['residual']:9.1e}{row['area']:9.5f}"
                f"{row['mean_gap_um']:9.4f} µm{row['largest_pressure']:14.3f}{row['processor_seconds']:8.1f}s"
            )
    return "\n".join(lines)


TABLES = {
    "areas": areas,
    "times": times,
    "alone": alone,
    "capped": capped,
    "largest": largest,
    "challenge": challenge,
}


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else RECORDED
    for name, make in TABLES.items():
        if made := make(folder):
            print(f"{name}\n{made}\n")


if __name__ == "__main__":
    main()
