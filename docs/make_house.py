"""Draw docs/developer/house.svg: the wings of `[tool.importlinter]` and which of them import which."""

import ast
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
PICTURE = ROOT / "docs" / "developer" / "house.svg"
WIDTH, STOREY, BOX, HEIGHT = 760, 62, 104, 30  # pixels


def storeys() -> list[list[str]]:
    """Return the wings from the roof to the ground, those beside each other in one list."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    (layers,) = (c["layers"] for c in project["tool"]["importlinter"]["contracts"] if "layers" in c)
    return [layer.split(" | ") for layer in layers]


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

    def below(wing: str) -> set[str]:
        return found[wing].union(*(below(other) for other in found[wing]))

    return sorted(
        (wing, other)
        for wing, others in found.items()
        for other in others
        if not any(other in below(between) for between in others - {other})
    )


def picture() -> str:
    """Return the picture as SVG."""
    rows = storeys()
    # Wings that have a storey to themselves stand left and right in turns, so that arrows find a way past.
    places = {
        wing: (
            (column + 1) * WIDTH / (len(row) + 1) + (len(row) == 1) * BOX * (0.85 if number % 2 else -0.85),
            30 + STOREY * number,
        )
        for number, row in enumerate(rows)
        for column, wing in enumerate(row)
    }
    height = 60 + STOREY * (len(rows) - 1)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" font-family="sans-serif" '
        'font-size="14">',
        '<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" '
        'orient="auto"><path d="M0 0L8 4L0 8z" fill="#5b6b7b"/></marker></defs>',
        f'<rect width="{WIDTH}" height="{height}" fill="#ffffff"/>',
    ]
    level = {wing: number for number, row in enumerate(rows) for wing in row}
    for number, (wing, other) in enumerate(shortest(imports())):
        (x, y), (u, v) = places[wing], places[other]
        y, v = y + HEIGHT / 2, v - HEIGHT / 2 - 1
        steps = level[other] - level[wing]
        if other in rows[-1]:  # everybody may use the ground
            continue
        outwards = -1 if x + u < WIDTH or (x + u == WIDTH and number % 2) else 1
        side = 0 if steps == 1 else outwards * (20 + 26 * steps)
        middle = (y + v) / 2
        lines.append(
            f'<path d="M{x:.0f} {y:.0f}C{x + side:.0f} {middle:.0f} {u + side:.0f} {middle:.0f} '
            f'{u:.0f} {v:.0f}" fill="none" stroke="#5b6b7b" stroke-width="1.3" marker-end="url(#tip)"/>'
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
