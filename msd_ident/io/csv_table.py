"""A CSV file as named columns of numbers, with any separator, decimal mark and encoding.

Numbers are parsed by numpy's C reader. If that fails, the file is read line by line, which handles empty cells and
names the line that cannot be read.
"""

from __future__ import annotations

import codecs
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from io import StringIO
from pathlib import Path

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.errors import DataError
from msd_ident.io import channel_header, date_times, matlab_matrix, units
from msd_ident.io.cells import cells_of, is_missing, joined, separator_of, split
from msd_ident.io.number_marks import with_points, without_quotes
from msd_ident.io.table_header import COMMENTS, contents, heading_cells, holds_numbers, is_one_column, with_units

#: Larger tables are no experiment, and would fill the memory: ten million lines of three columns fit.
MOST_MEGABYTES = 500
#: A word of spreadsheets for a missing number, which begins like a comment.
_HASHED = re.compile("#N/A", re.IGNORECASE)
#: A comment behind numbers, with a space in front; not an error of a spreadsheet (#VALUE!), nor a C library's 1.#QNAN.
_COMMENT = re.compile(r"(?:^|(?<=\s))#(?![A-Z]+(?:/0)?[!?]).*$")
#: What is left of a number that was cut behind its sign or in its exponent.
_STUMP = re.compile(r"[-+]\.?|\.|[-+]?[\d.,]+[eE][-+]?")
#: Digits with colons between them.
_LIKE_TIME = re.compile(r"[\d.,]+(?::[\d.,]+)+")
#: What a line is drawn of under the names, and what stands between its parts.
_DRAWN, _BETWEEN = re.compile(r"[-=_~*]{3}"), frozenset("-=_~*|+:;, \t")
#: What stands for a byte that is none of the encoding.
_UNREADABLE = "\ufffd"
#: Lines in which a header of keys and values is looked for.
_HEADER_LINES = 50
#: Characters behind the first line of numbers that are looked at for a decimal comma.
_AHEAD = 2000


@dataclass(frozen=True)
class Layout:
    """Where the numbers of a file are.

    Attributes:
        header: names of the columns.
        first: index of the first line of numbers, 0 for the first line of the file.
        separator: between cells, ``None`` for white space.
        decimal_comma: numbers are written like ``0,15``.
    """

    header: tuple[str, ...]
    first: int
    separator: str | None
    decimal_comma: bool


class Table:
    """The columns of a file; an empty cell is NaN, and so is a word for a missing number (``nan``, ``NA``, ``null``).

    Raises:
        DataError: the file cannot be read, is empty, or has no header or no numbers.
    """

    kind = "CSV file"

    def __init__(self, path: Path) -> None:
        self._path = path
        self._text, notes = matlab_matrix.without_brackets(_read_text(path), str(path))
        self._since: dict[int, date_times.SinceFirst] = {}  # by column: its dates or times of day
        self.layout = self._find_layout()
        self._notes = [*notes, *self._leave_out_cut_line()]

    @property
    def header(self) -> tuple[str, ...]:
        """Names of the columns."""
        return self.layout.header

    @property
    def lines(self) -> int:
        """Number of lines below the header, empty ones and comments included."""
        return len(self._body().splitlines())

    @property
    def notes(self) -> tuple[str, ...]:
        """On lines that were left out, and on columns with times of day."""
        of_columns = [since.note(self.header[index]) for index, since in self._since.items()]
        return (*self._notes, *filter(None, of_columns))

    def columns(self, indices: Sequence[int]) -> tuple[FloatArray, ...]:
        """The columns as numbers, each (n,); NaN where there is none.

        Raises:
            DataError: a line that has too few or too many cells, or a cell that is no number, with its number.
        """
        wanted = sorted(set(indices))
        numbers = self._at_once(wanted)
        if numbers is None:
            return self._line_by_line(indices)
        return tuple(np.ascontiguousarray(numbers[:, wanted.index(index)]) for index in indices)

    def _at_once(self, wanted: Sequence[int]) -> FloatArray | None:
        """Columns (n, wanted) of a file with nothing odd in it; ``None`` when line by line must have the last word."""
        text = self._body().rstrip()
        separator = self.layout.separator
        # loadtxt skips the cells that it is not asked for, and so does not see that a line has too few or too many.
        lines = text.count("\n") + 1
        if not text or separator is None or text.count(separator) != lines * (len(self.header) - 1):
            return None
        try:
            numbers = np.loadtxt(StringIO(text), delimiter=separator, usecols=wanted, comments=None, ndmin=2)
        except ValueError:
            return None
        return None if bool(np.any(np.isinf(numbers))) else numbers

    def _body(self) -> str:
        """Text behind the header, decimal commas turned into points and thousands separators left out."""
        position = 0
        for _ in range(self.layout.first):
            position = self._text.index("\n", position) + 1
        body = self._text[position:]
        if self.layout.separator == "," and '"' in body:
            return without_quotes(body, str(self._path))
        return with_points(body) if self.layout.decimal_comma else body

    def _line_by_line(self, indices: Sequence[int]) -> tuple[FloatArray, ...]:
        width = len(self.layout.header)
        rows: list[list[float]] = []
        self._since = {}
        for number, line in enumerate(self._body().splitlines(), start=self.layout.first + 1):
            cells = self._cells(line)
            if not cells:
                continue
            if len(cells) == width + 1 and not cells[-1].strip():
                cells.pop()  # a separator at the end of each line
            if len(cells) != width:
                raise self._ragged(number, len(cells))
            rows.append([self._number(cells[index], number, index) for index in indices])
        if not rows:
            raise DataError(f"{self._path} has a header and no numbers; expected at least one line of them")
        columns = tuple(np.array(column, dtype=np.float64) for column in zip(*rows, strict=True))
        for index, column in zip(indices, columns, strict=True):
            self._refuse_mixed(index, int(np.count_nonzero(np.isfinite(column))))
        return columns

    def _cells(self, line: str) -> list[str]:
        """Cells of a line below the header; none in an empty one or a comment."""
        text = _COMMENT.sub("", _HASHED.sub("NA", line)).strip(" \r")
        if not text.strip() or text.lstrip().startswith(COMMENTS):
            return []
        return split(text, self.layout.separator)

    def _leave_out_cut_line(self) -> list[str]:
        """Take a last line from the text that the file ends in the middle of, as of a logger that was killed; a note.

        It has no line break, and fewer cells than the others, or a last one that is not whole.
        """
        begin = self._text.rfind("\n") + 1
        last, above = self._text[begin:], self._text[self._text.rfind("\n", 0, max(begin - 1, 0)) + 1 : begin]
        cells, at = self._cells(last), self._text.count("\n")
        most = max(len(self.header), len(self._cells(above)) if at > self.layout.first else 0)
        if not cells or at < self.layout.first:
            return []
        if len(cells) >= most and last.count('"') % 2 == 0 and not _STUMP.fullmatch(cells[-1].strip()):
            return []
        self._text = self._text[:begin]
        return [f"line {at + 1} was left out: the file ends in the middle of it, behind {last[-20:]!r}."]

    def _ragged(self, line: int, cells: int) -> DataError:
        width, names = len(self.header), ", ".join(self.header)
        doubled = self.layout.separator == "," and cells == 2 * width
        advice = "write decimal points, or semicolons between the cells" if doubled else "repair or remove that line"
        return DataError(
            f"{self._path} line {line} has {cells} cells; expected {width} as in the header ({names}): {advice}"
        )

    def _number(self, cell: str, line: int, index: int) -> float:
        text = cell.strip().strip('"').strip()
        if not text or is_missing(text):
            return math.nan
        try:
            value = float(text)
        except ValueError:
            value = self._since_first(text, line, index)
        if not math.isfinite(value):
            raise self._no_number(line, text, index)
        return value

    def _since_first(self, text: str, line: int, index: int) -> float:
        """Seconds from a column's first date, or time of day, to this one; NaN where a cell is neither."""
        since = self._since.get(index, date_times.SinceFirst())
        try:
            seconds = since.seconds(text, line)
        except date_times.OtherForm as error:
            raise self._no_number(line, text, index, str(error)) from None
        if math.isnan(seconds):
            form = ", or a time like HH:MM:SS or MM:SS.s" if _LIKE_TIME.fullmatch(text) else ""
            raise self._no_number(line, text, index, f"a finite number{form}")
        heading, unit = self.header[index], units.unit(self.header[index])[0]
        angle = units.POSITION.known.get(unit, ("",))[0] == "rad"  # in degrees, minutes and seconds
        if angle or units.time_factor(heading) not in (None, 1.0):
            raise self._no_number(line, text, index, f"a number in {unit}, as the heading says")
        self._since[index] = since
        return seconds

    def _refuse_mixed(self, index: int, numbers: int) -> None:
        """Refuse a column in which some of its numbers are dates or times, and others are not."""
        if index in self._since and (dated := self._since[index].count) != numbers:
            raise DataError(
                f"{self._path}: column {self.header[index]} has {dated} dates or times and {numbers - dated} numbers; "
                "expected one of them on all lines: repair or remove the others"
            )

    def _no_number(self, line: int, text: str, index: int, expected: str = "a finite number") -> DataError:
        return DataError(
            f"{self._path} line {line}, column {self.layout.header[index]} holds {text[:40]!r}; expected {expected}: "
            "repair or remove that line"
        )

    def _find_layout(self) -> Layout:
        """Read the header, which is the last text before the numbers, and the first line of numbers."""
        if (found := self._of_channels()) is not None:
            return found
        comment, texts = "", list[str]()
        position = number = 0
        while position < len(self._text):
            end = self._text.find("\n", position)
            end = len(self._text) if end < 0 else end
            line = self._text[position:end].strip()
            position = end + 1
            if line.startswith(COMMENTS):
                comment = "" if texts else line.lstrip("".join(COMMENTS)).strip()
            elif line and holds_numbers(line, texts[-1] if texts else "", self._text[position : position + _AHEAD]):
                header = with_units(texts) if texts else comment  # numpy.savetxt comments its header
                return self._layout(header, line, number, self._text[position : position + _AHEAD])
            elif line and not (_BETWEEN.issuperset(line) and _DRAWN.search(line)):
                texts.append(line)
            number += 1
        if matlab_matrix.is_script(self._text):
            raise matlab_matrix.refused(str(self._path))
        expected = "expected a header like time_s,force_n,position_m and numbers"
        if not texts:
            raise DataError(f"{self._path} is empty; {expected}")
        self._names(texts[0], texts[0])  # refuses text that is no header
        said = "one line" if len(texts) == 1 else "no line of numbers"
        raise DataError(f"{self._path} has {said}; {expected}")

    def _of_channels(self) -> Layout | None:
        """Layout of a file whose header is a line for each property of the channels."""
        lines = [line.strip() for line in self._text.split("\n", _HEADER_LINES)[:_HEADER_LINES]]
        found = channel_header.names_of(cells_of(line) for line in lines)
        if found is None:
            return None
        names, first_at = found
        header = joined(names, separator_of(lines[first_at]) or "\t")
        return self._layout(header, lines[first_at], first_at, "\n".join(lines[first_at + 1 :]))

    def _names(self, header: str, first: str) -> tuple[str, ...]:
        """Names of the columns: their numbers, from 1 on, in a file without a header."""
        if not header:
            return tuple(str(place) for place in range(1, len(cells_of(first)) + 1))
        names = cells_of(header)
        if separator_of(header) is None and len(names) != len(first.split()):
            names = tuple(re.split(r"\s{2,}", header.strip()))  # names with spaces in them
        if len(names) < 2:
            raise DataError(
                f"{self._path} begins with one cell, {names[0][:40]!r}; expected the names of several columns, such as "
                "time_s,force_n,position_m: is it a CSV file?"
            )
        return names

    def _layout(self, header: str, first: str, first_at: int, rest: str) -> Layout:
        numbers = [first, *contents(rest)]
        if is_one_column(header, first):
            names = heading_cells(header)
            names = names if header and len(names) == 1 else ("1",)  # several cells are a title
            return Layout(names, first_at, None, decimal_comma=any("," in line for line in numbers))
        separator = separator_of(header or first)
        comma = separator != "," and any("," in line for line in numbers)
        return Layout(self._names(header, first), first_at, separator, decimal_comma=comma)


def _read_text(path: Path) -> str:
    try:
        if (size := path.stat().st_size) > MOST_MEGABYTES * 10**6:
            raise DataError(
                f"{path} has {size / 1e6:.0f} MB; expected at most {MOST_MEGABYTES}: cut it, or make it a bag"
            )
        data = path.read_bytes()
    except OSError as error:
        raise DataError(f"cannot read {path}: {error.strerror or error}; expected a file that may be read") from None
    wide = data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    controls = sum(data[:1000].count(code) for code in range(32)) - sum(data[:1000].count(c) for c in b"\t\n\r\f")
    if (b"\0" in data[:1000] or controls > 0.02 * len(data[:1000])) and not wide:
        raise DataError(f"{path} is not text; expected a CSV file, a MAT file or a bag: export it as one of these")
    text = data.decode("utf-16" if wide else "utf-8-sig", errors="replace")
    if _UNREADABLE in text and all(sign.isascii() or sign == _UNREADABLE for sign in text):
        text = data.decode("cp1252", errors="replace")  # of European spreadsheets: ° and µ are one byte
    return text.replace("\r\n", "\n").replace("\r", "\n") if "\r" in text else text
