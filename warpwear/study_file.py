"""Where studies come from: TOML files, run folders and presets."""

import tomllib
from difflib import get_close_matches
from importlib import resources
from pathlib import Path
from typing import Any

from warpwear.errors import InputError


def presets() -> list[str]:
    """Names of the presets."""
    folder = resources.files("warpwear") / "presets"
    return sorted(p.name.removesuffix(".toml") for p in folder.iterdir() if p.name.endswith(".toml"))


def read_sections(path_or_preset: str | Path) -> dict[str, Any]:
    """What a TOML file, a run folder or the preset of that name says. Raises InputError."""
    if str(path_or_preset) in presets():
        source = resources.files("warpwear") / "presets" / f"{path_or_preset}.toml"
        return tomllib.loads(source.read_text(encoding="utf-8"))
    path = Path(path_or_preset)
    try:
        if path.is_dir():
            if not (path / "study.toml").is_file():
                raise InputError(f"STUDY = '{path}' is a folder without a study.toml.")
            path = path / "study.toml"
        sections = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(_no_such_study(str(path_or_preset))) from None
    except OSError as error:
        raise InputError(f"{str(path)[:200]} cannot be read: {error.strerror}.") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is not text, which a study is.") from error
    except (ValueError, RecursionError) as error:  # also numbers of thousands of digits, endless nesting
        raise InputError(f"{path} is not TOML: {error}.") from error
    surface = sections.get("disc", {}).get("surface") if isinstance(sections.get("disc"), dict) else None
    if isinstance(surface, str):
        sections["disc"]["surface"] = str(path.parent.resolve() / surface)
    return sections


def _no_such_study(name: str) -> str:
    near = get_close_matches(name, presets(), n=1)
    hint = f" Did you mean '{near[0]}'?" if near else ""
    return f"STUDY = '{name}' is neither a file nor a preset ({', '.join(presets())}).{hint}"
