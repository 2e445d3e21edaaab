"""A ring buffer of rows with contiguous columns: the latest rows, oldest first, as views."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from msd_ident.data.record import FloatArray


class Track:
    """Rows in order of arrival; when full, the oldest go out. Not safe for threads by itself.

    Rows are kept one after the other in twice the room that they need, and moved to its beginning once it is full: a
    view on all of them costs nothing, and a row is moved once in its life.

    Args:
        capacity: rows that are kept.
        columns: numbers in a row.
    """

    def __init__(self, capacity: int, columns: int) -> None:
        self._capacity = capacity
        self._room: FloatArray = np.full((columns, 2 * capacity), np.nan)
        self._begin = self._end = 0
        #: Rows that have gone out: the number of the first row here.
        self.first = 0

    def __len__(self) -> int:
        return self._end - self._begin

    @property
    def bytes(self) -> int:
        """Memory that it takes, from its first moment on."""
        return int(self._room.nbytes)

    def column(self, index: int) -> FloatArray:
        """(n,) view of one column, oldest first; good until the next ``append``."""
        return self._room[index, self._begin : self._end]

    def append(self, *columns: npt.ArrayLike) -> None:
        """Take rows; columns that are not given are NaN. Of more than fit, the last ones."""
        rows = np.atleast_2d(np.array(columns, dtype=np.float64))
        skipped = max(rows.shape[1] - self._capacity, 0)
        rows = rows[:, skipped:]
        if self._end + rows.shape[1] > self._room.shape[1]:
            self._make_room(rows.shape[1])
        new = slice(self._end, self._end + rows.shape[1])
        self._room[:, new] = np.nan
        self._room[: rows.shape[0], new] = rows
        self._end = new.stop
        self._drop(skipped)

    def clear(self) -> None:
        """Forget all rows; their numbers are not given again."""
        self.first += len(self)
        self._begin = self._end = 0

    def _make_room(self, rows: int) -> None:
        kept = self._room[:, max(self._end - (self._capacity - rows), self._begin) : self._end].copy()
        self.first += len(self) - kept.shape[1]
        self._begin, self._end = 0, kept.shape[1]
        self._room[:, : self._end] = kept

    def _drop(self, skipped: int) -> None:
        surplus = max(len(self) - self._capacity, 0)
        self._begin += surplus
        self.first += surplus + skipped
