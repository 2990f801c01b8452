"""What keeps a number from proving anything, and changes that no gear makes: in words for the rows of the trend."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from gearwear.fleet.quantities import DOUBTFUL, UNSEEN

DOUBTED = "is it the same gear, and the same design?"
"""Asked of a gear that gained metal."""


@dataclass(frozen=True, slots=True)
class Doubts:
    """Of a scan, or of all scans of an inspection.

    Parameters
    ----------
    grave : tuple of str
        What puts the whole result in question: it proves neither that a limit is kept nor that it is not.
    unseen : tuple of str
        Which part of the gear says nothing: no limit is proven to be kept there.
    """

    grave: tuple[str, ...] = ()
    unseen: tuple[str, ...] = ()

    @property
    def words(self) -> tuple[str, ...]:
        """A clause each, for a note."""
        return (
            *(f"{DOUBTFUL}{text}" for text in self.grave),
            *(f"{text}: what wore there is in no number, and no limit is proven to be kept" for text in self.unseen),
        )


NO_DOUBTS = Doubts()


def together(doubts: Iterable[Doubts]) -> Doubts:
    """Those of several scans, each once."""
    every = list(doubts)
    grave = dict.fromkeys(text for one in every for text in one.grave)
    return Doubts(tuple(grave), tuple(dict.fromkeys(text for one in every for text in one.unseen)))


def doubts_by_scan(rows: Iterable[Mapping[str, object]]) -> dict[str, Doubts]:
    """From the rows of their scope, by key.

    >>> doubts_by_scan([{"key": "a", "quantity": "doubtful: little was seen"}])["a"].words
    ('doubtful: little was seen',)
    """
    found: dict[str, list[str]] = {}
    for row in rows:
        found.setdefault(str(row["key"]), []).append(str(row["quantity"]))
    return {
        key: Doubts(*(tuple(name.removeprefix(kind) for name in names if name.startswith(kind)) for kind in (DOUBTFUL, UNSEEN)))
        for key, names in found.items()
    }
