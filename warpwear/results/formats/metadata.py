"""Say what a run's folder holds in the words of RO-Crate 1.1, so that it can be passed on.

ro-crate-metadata.json is JSON-LD: the files, what stands in them in which unit, the bodies, the settings and
the program (Soiland-Reyes and others, Data Science 5 (2022) 97). Where the TriboDataFAIR ontology (Garabedian
and others, Scientific Data 9 (2022) 315) has a word for a quantity, it is named beside the program's own.
"""

import json
import mimetypes
import os
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import quote

from warpwear.history.quantities import Quantity, columns_of, evolution_columns
from warpwear.results.file import FILE_NAME, ResultFile
from warpwear.results.formats.forms import filled
from warpwear.version import __version__

NAME = "ro-crate-metadata.json"
CRATE = "https://w3id.org/ro/crate/1.1"
TRIBODATA = (
    "https://raw.githubusercontent.com/nick-garabedian/TriboDataFAIR-Ontology/v0.1.1/"
    "TriboDataFAIR_Ontology.owl#"
)
#: Key of a study, or column of a history -> its class in the ontology.
WORDS = {
    "contact.load": "NormalLoadSetpoint",
    "sliding.speed": "SlidingSpeedSetpoint",
    "counter.radius": "ObjectRadius",
    "distance": "ExperimentTraveledDistance",
    "time": "ExperimentElapsedTime",
}
#: What a run leaves: name -> what it is, and its type.
FILES = {
    "study.toml": ("Study: every key with its unit, defaults included", "application/toml"),
    FILE_NAME: ("Result: study, history and snapshots of fields, units as attributes", "application/x-hdf5"),
    "history.csv": ("History: a row a step", "text/csv"),
    "surface.csv": ("Roughness of both bodies: a row a snapshot", "text/csv"),
    "summary.json": ("Values at the end, assumptions and warnings", "application/json"),
}
#: Type of a file whose name has no known ending.
UNKNOWN = "application/octet-stream"
#: Sections of a study that describe a body, or how it was tested.
SECTIONS = ("counter", "disc", "contact", "wear", "friction", "sliding")
#: Who answers for a run, and who passes it on: keys of [study] -> their types.
PEOPLE = {"author": "Person", "publisher": "Organization"}
Entity = dict[str, Any]


def write_metadata(folder: Path, result: ResultFile) -> None:
    """Write the metadata of what every run leaves into a folder."""
    text = metadata(result, tomllib.loads(result.study.to_toml()), dict.fromkeys(FILES, ""))
    (folder / NAME).write_text(text, encoding="utf-8", errors="backslashreplace")


def metadata(result: ResultFile, sections: Mapping[str, Any], files: Mapping[str, str]) -> str:
    """Return the metadata as text. sections: of the study; files: path in the crate -> what it is, or ''."""
    columns = {"history.csv": columns_of(result.study), FILE_NAME: columns_of(result.study)}
    columns["surface.csv"] = evolution_columns(result.study)
    quantities: dict[str, Quantity] = {}
    described: list[Entity] = []
    for name, note in files.items():
        about, encoding = FILES.get(name) or (note, mimetypes.guess_type(name)[0] or UNKNOWN)
        entity: Entity = {
            "@id": quote(os.fsencode(name)),
            "@type": "File",
            "name": name,
            "description": about,
        }
        entity["encodingFormat"] = encoding
        if name in columns:
            quantities |= {column.name: column for column in columns[name]}
            entity["variableMeasured"] = [{"@id": f"#{column.name}"} for column in columns[name]]
        described.append(entity)
    study = result.study.study
    people = {role: name for role in PEOPLE if (name := getattr(study, role))}
    described += [_person(role, name, people) for role, name in people.items()]
    license = study.license and (study.license if ":" in study.license else "#license")
    described += [{"@id": license, "@type": "CreativeWork", "name": study.license}] if license else []
    return filled(
        NAME,
        {
            "json": partial(json.dumps, ensure_ascii=False),
            "ids": _ids,
            "quote": partial(quote, errors="backslashreplace"),
        },
        escape=False,
        crate=CRATE,
        words=TRIBODATA,
        study=study,
        people=people,
        license=license,
        today=datetime.now(UTC).date().isoformat(),
        version=str(result.attributes.get("version", __version__)),
        files=files,
        results=[name for name in files if name in FILES and name != "study.toml"],
        settings=[*_settings(sections)],
        others=[*described, *map(_quantity, quantities.values())],
    )


def _person(role: str, name: str, people: Mapping[str, str]) -> Entity:
    """Describe an author, who belongs to the publisher, or a publisher, 'A Laboratory <https://address>'."""
    name, _, address = name.partition(" <")
    entity: Entity = {"@id": f"#{role}", "@type": PEOPLE[role], "name": name}
    if address:
        entity["url"] = address.rstrip(">")
    if role == "author" and "publisher" in people:
        entity["affiliation"] = {"@id": "#publisher"}
    return entity


def _ids(names: Iterable[str]) -> str:
    return json.dumps([{"@id": name} for name in names])


def _named(name: str, entity: Entity) -> Entity:
    """Add the ontology's word for a key or a column, where it has one."""
    return entity | ({"propertyID": f"{TRIBODATA}{WORDS[name]}"} if name in WORDS else {})


def _quantity(quantity: Quantity) -> Entity:
    name, about = quantity.name, {"description": quantity.meaning, "unitText": quantity.units}
    return _named(name, {"@id": f"#{name}", "@type": "PropertyValue", "name": name} | about)


def _settings(sections: Mapping[str, Any]) -> Iterator[Entity]:
    """Describe each number and word of the bodies and of the test, by its dotted key."""
    open_sections = [(name, sections[name]) for name in SECTIONS if isinstance(sections.get(name), dict)]
    for prefix, keys in open_sections:
        for key, value in keys.items():
            name = f"{prefix}.{key}"
            if isinstance(value, dict):
                open_sections.append((name, value))
                continue
            number, _, unit = str(value).partition(" ")
            entity: Entity = {"@id": f"#{name}", "@type": "PropertyValue", "name": name, "value": str(value)}
            with suppress(ValueError):  # a word
                entity |= {"value": float(number)} | ({"unitText": unit} if unit else {})
            yield _named(name, entity)
