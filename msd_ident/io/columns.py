"""What every file of columns offers, whatever its format: a table of text, a MAT file.

A further format is a class like ``mat_file.MatFile`` in a file of its own, chosen in ``open_columns``. Which column is
which signal, units in headings, runs, missing lines and uneven stamps are the same for all, see ``csv_file``.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

from msd_ident.data.record import FloatArray

#: Names of a time column, in lower case and without their unit.
TIME_NAMES = ("time", "t", "stamp", "timestamp")

#: Endings of files of columns, by which ``msd batch`` finds them in folders.
SUFFIXES = (".csv", ".mat")


class Columns(Protocol):
    """Named columns of numbers.

    A heading may end with its unit, such as ``position_mm`` (``units`` has the list). Times are a column too; a format
    that states a sampling interval in its place makes one.
    """

    @property
    def kind(self) -> str:
        """Kind of file, in words, e.g. ``MAT file``."""

    @property
    def header(self) -> tuple[str, ...]:
        """Names of the columns."""

    @property
    def lines(self) -> int:
        """Number of lines, at least roughly: what ``msd info`` shows without a time column."""

    @property
    def notes(self) -> tuple[str, ...]:
        """What was left out or repaired in what has been read so far, in sentences."""

    def columns(self, indices: Sequence[int]) -> tuple[FloatArray, ...]:
        """The columns of these places, each (n,); NaN where there is no number.

        Raises:
            DataError: one of them cannot be read.
        """


def open_columns(path: Path) -> Columns:
    """The columns of a file, a MAT file by its name or its first bytes, else a table of text.

    Raises:
        DataError: it cannot be read.
    """
    from msd_ident.io.csv_table import Table
    from msd_ident.io.mat_file import MatFile, is_mat

    return MatFile(path) if is_mat(path) else Table(path)
