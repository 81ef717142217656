"""Draw docs/developer/house.svg: the wings of `[tool.importlinter]` and which of them import which."""

import ast
import tomllib
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
PICTURE = ROOT / "docs" / "developer" / "house.svg"
STOREY, BOX, HEIGHT, BETWEEN = 62, 104, 30, 26  # pixels
#: Distance of two lanes beside the house, in which arrows pass storeys, and radius of their corners [pixels].
LANE, CORNER = 16, 7
#: Most distance of two arrows that leave or reach a side of a box [pixels].
PORT = 9


def storeys() -> list[list[str]]:
    """Return the wings from the roof to the ground, those beside each other in one list."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    (layers,) = (c["layers"] for c in project["tool"]["importlinter"]["contracts"] if "layers" in c)
    return [layer.split(" | ") for layer in layers]


@cache
def imports() -> dict[str, set[str]]:
    """Return for each wing the wings that its files import."""
    wings = {wing for storey in storeys() for wing in storey}
    found: dict[str, set[str]] = {wing: set() for wing in wings}
    for wing in wings:
        places = [ROOT / "warpwear" / wing, ROOT / wing, ROOT / "warpwear" / f"{wing}.py"]
        files = [file for place in places for file in ([place] if place.is_file() else place.rglob("*.py"))]
        for file in files:
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
                if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("warpwear."):
                    found[wing].add((node.module or "").split(".")[1])
                elif isinstance(node, ast.ImportFrom) and node.module == "warpwear":
                    found[wing].update(alias.name for alias in node.names)
                elif isinstance(node, ast.Constant) and str(node.value).startswith("warpwear."):
                    found[wing].add(str(node.value).split(".")[1].partition(":")[0])
        found[wing] = (found[wing] & wings) - {wing}
    return found


def shortest(found: dict[str, set[str]]) -> list[tuple[str, str]]:
    """Return the imports that no longer way through other wings already tells of."""

    @cache
    def below(wing: str) -> set[str]:
        return found[wing].union(*(below(other) for other in found[wing]))

    return sorted(
        (wing, other)
        for wing, others in found.items()
        for other in others
        if not any(other in below(between) for between in others - {other})
    )


def lanes(passing: list[tuple[str, str]], rows: list[list[str]]) -> dict[tuple[str, str], tuple[int, int]]:
    """Give each arrow that passes a storey a side (-1 left, 1 right) and a lane (from 0, at the house).

    An arrow keeps to the side on which a box of its ends stands; no two in a lane pass the same storey.
    """
    level = {wing: number for number, row in enumerate(rows) for wing in row}
    side = {row[0]: -1 for row in rows if len(row) == 2} | {row[1]: 1 for row in rows if len(row) == 2}
    found: dict[tuple[str, str], tuple[int, int]] = {}
    for wing, other in sorted(passing, key=lambda ends: level[ends[1]] - level[ends[0]]):
        taken = {
            place: {
                lane
                for (a, b), (on, lane) in found.items()
                if on == place and level[a] <= level[other] and level[wing] <= level[b]
            }
            for place in (-1, 1)
        }
        asked = {side[end] for end in (wing, other) if end in side}
        assert len(asked) < 2, f"{wing} and {other} stand on two sides"
        free = {place: min(set(range(99)) - taken[place]) for place in asked or (-1, 1)}
        on = min(free, key=lambda place: free[place])
        found[wing, other] = on, free[on]
    return found


def rounded(points: list[tuple[float, float]]) -> str:
    """Return the path of an arrow along points at right angles, its corners rounded."""
    path = "M{:.0f} {:.0f}".format(*points[0])
    for (x0, y0), (x, y), (x1, y1) in zip(points, points[1:], points[2:], strict=False):
        before, behind = ((x - a, y - b) for a, b in ((x0, y0), (x1, y1)))
        (a, b), (c, d) = (
            (dx / abs(dx + dy) * CORNER, dy / abs(dx + dy) * CORNER) for dx, dy in (before, behind)
        )
        path += f"L{x - a:.0f} {y - b:.0f}Q{x:.0f} {y:.0f} {x - c:.0f} {y - d:.0f}"
    return path + "L{:.0f} {:.0f}".format(*points[-1])


def picture() -> str:
    """Return the picture as SVG: no arrow passes behind a box."""
    rows = storeys()
    level = {wing: number for number, row in enumerate(rows) for wing in row}
    arrows = [ends for ends in shortest(imports()) if ends[1] not in rows[-1]]  # everybody may use the ground
    passing = lanes([ends for ends in arrows if level[ends[1]] - level[ends[0]] > 1], rows)
    house, ground = (most * (BOX + BETWEEN) - BETWEEN for most in (max(map(len, rows[:-1])), len(rows[-1])))
    beyond = LANE * (2 + max(lane for _, lane in passing.values()))
    width, height = max(house + 2 * beyond, ground + 20), 60 + STOREY * (len(rows) - 1)
    places = {
        wing: (0.5 * width + (column - 0.5 * (len(row) - 1)) * (BOX + BETWEEN), 30 + STOREY * number)
        for number, row in enumerate(rows)
        for column, wing in enumerate(row)
    }
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" '
        'font-size="14">',
        '<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" '
        'orient="auto"><path d="M0 0L8 4L0 8z" fill="#5b6b7b"/></marker></defs>',
        f'<rect width="{width}" height="{height}" fill="#ffffff"/>',
    ]
    #: Wing and side -> arrows there, those with the nearest other end first, so that they cross little.
    ports: dict[tuple[str, int], list[tuple[str, str]]] = {}
    for ends, (side, _) in passing.items():
        for end in ends:
            ports.setdefault((end, side), []).append(ends)
    for (end, _), there in ports.items():
        there.sort(key=lambda ends: (ends[0] == end, -passing[ends][1] * (1 if ends[0] == end else -1)))
    for ends in arrows:
        (x, y), (u, v) = places[ends[0]], places[ends[1]]
        if ends in passing:
            side, lane = passing[ends]

            def port(end: str, at: float, side: int = side, ends: tuple[str, str] = ends) -> float:
                there = ports[end, side]
                gap = min(PORT, (HEIGHT - 8) / len(there))
                return at + gap * (there.index(ends) - 0.5 * (len(there) - 1))

            beside = 0.5 * width + side * (0.5 * house + LANE * (lane + 1))
            start, stop = (x + side * BOX / 2, port(ends[0], y)), (u + side * (BOX / 2 + 1), port(ends[1], v))
            path = rounded([start, (beside, start[1]), (beside, stop[1]), stop])
        else:
            aim = max(-0.3 * BOX, min(0.3 * BOX, 0.2 * (x - u)))
            path = f"M{x - aim:.0f} {y + HEIGHT / 2:.0f}L{u + aim:.0f} {v - HEIGHT / 2 - 1:.0f}"
        lines.append(
            f'<path d="{path}" fill="none" stroke="#5b6b7b" stroke-width="1.3" marker-end="url(#tip)"/>'
        )
    for wing, (x, y) in places.items():
        lines.append(
            f'<rect x="{x - BOX / 2:.0f}" y="{y - HEIGHT / 2:.0f}" width="{BOX}" height="{HEIGHT}" rx="5" '
            'fill="#e8f0f7" stroke="#33546f"/>'
            f'<text x="{x:.0f}" y="{y + 5:.0f}" text-anchor="middle" fill="#12283a">{wing}</text>'
        )
    return "\n".join([*lines, "</svg>"]) + "\n"


if __name__ == "__main__":
    PICTURE.write_text(picture(), encoding="utf-8")
