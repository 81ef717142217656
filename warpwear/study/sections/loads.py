"""A load of a study is a force, or that of a line contact's length."""

from dataclasses import dataclass
from typing import Any, Self

from warpwear.study.units import Quantity, text


class LineLoad(float):
    """A load [N] that was given as one of a length [N/mm] is that times the length it acts on [mm]."""

    per_length: float
    length: float

    def __new__(cls, per_length: float, length: float = 1.0) -> Self:
        load = super().__new__(cls, per_length * length)
        load.per_length, load.length = per_length, length
        return load

    def __reduce__(self) -> tuple[type[Self], tuple[float, float]]:
        return type(self), (self.per_length, self.length)


@dataclass(frozen=True)
class Load(Quantity):
    """This annotates a load: a force, or a force of a length, which is times a length known later."""

    def read(self, value: Any) -> Any:
        """Return the load [N], or a `LineLoad`. Raises ValueError, saying what is allowed."""
        if isinstance(value, LineLoad):
            return value
        try:
            return super().read(value)
        except ValueError as refused:
            if "dimension" not in str(refused):
                raise
            try:
                return LineLoad(float(Quantity("N/mm").read(value)))
            except ValueError as error:
                either = ValueError(f"{refused}, or of a line contact one of its length, '18.5 N/mm'")
                raise (either if "dimension" in str(error) else error) from None

    def write(self, value: Any) -> str:
        """Return text that `read` reads back without loss."""
        return text(value.per_length, "N/mm") if isinstance(value, LineLoad) else text(value, self.unit)
