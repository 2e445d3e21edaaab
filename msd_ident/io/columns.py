"""What every file of columns offers, whatever its format: a table of text, a MAT file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Protocol

from msd_ident.data.record import FloatArray


class Columns(Protocol):
    """Named columns of numbers."""

    @property
    def kind(self) -> str:
        """Kind of file, in words."""

    @property
    def header(self) -> tuple[str, ...]:
        """Names of the columns."""

    @property
    def lines(self) -> int:
        """Number of lines."""

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
