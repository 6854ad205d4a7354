"""What a section of the benchmark hands back: tables and targets, printed and saved alike."""

from __future__ import annotations

from dataclasses import dataclass, field

__all__ = ["Cell", "Section", "Settings", "Table", "Target"]

Cell = str | float | int | None


@dataclass(frozen=True)
class Settings:
    """How much to measure: `quick` is for seeing that it runs, its figures mean little."""

    quick: bool = False
    rounds: int = 7

    def choose(self, full: int, quick: int) -> int:
        """The size of a piece of work."""
        return quick if self.quick else full


@dataclass(frozen=True)
class Target:
    """A ratio that must not exceed `limit` (or, if `at_least`, must not fall short of it).

    `measured` is None if it could not be measured.
    """

    name: str
    limit: float
    measured: float | None
    at_least: bool = False

    @property
    def met(self) -> bool | None:
        """Whether the target is met; None if not measured."""
        if self.measured is None:
            return None
        return self.measured >= self.limit if self.at_least else self.measured <= self.limit


@dataclass(frozen=True)
class Table:
    """Rows of cells under named columns; floats carry the unit that the column's name gives."""

    title: str
    columns: tuple[str, ...]
    rows: list[tuple[Cell, ...]]

    def records(self) -> list[dict[str, Cell]]:
        """The rows as dictionaries."""
        return [dict(zip(self.columns, row, strict=True)) for row in self.rows]


@dataclass
class Section:
    """One section's outcome; `notes` are lines on what was left out and why."""

    name: str
    title: str
    tables: list[Table] = field(default_factory=list)
    targets: list[Target] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
