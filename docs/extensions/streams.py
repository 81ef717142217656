"""Show what a cell prints as one text: a command's output comes in pieces that end anywhere in a line."""

from typing import Any

import myst_nb.core.render


def joined(outputs: list[Any]) -> list[Any]:
    """Return the outputs of a cell with the pieces of each stream put together."""
    streams: dict[str, Any] = {}
    whole = []
    for output in outputs:
        if output["output_type"] == "stream" and output["name"] in streams:
            streams[output["name"]]["text"] += output["text"]
            continue
        if output["output_type"] == "stream":
            streams[output["name"]] = output
        whole.append(output)
    return whole


def setup(app: Any) -> dict[str, bool]:
    """Put it in place of what adds a line's end to each piece."""
    myst_nb.core.render.coalesce_streams = joined
    return {"parallel_read_safe": True, "parallel_write_safe": True}
