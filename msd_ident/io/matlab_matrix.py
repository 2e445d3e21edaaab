"""Tables in MATLAB's notation: an ECP export, and the script that such an export was saved as.

An export has brackets around its numbers, and a semicolon at the end of each line. In a script the matrix has a name;
above it the headings may stand in a comment, and there may be code around it::

    % Sample   Time     Encoder 1 Pos   Control Effort
    data =[    0    0.000               0          0.0000;
         1    0.009              21          4.8840];
    plot(data(:,2), data(:,3))
"""

from __future__ import annotations

import re

from msd_ident.errors import DataError
from msd_ident.io.cells import cells_of, is_missing, is_number

#: Brackets around numbers.
_BRACKETS = re.compile(r"^[ \t]*\[([^\[\]]*)\]\s*;?\s*$", re.MULTILINE)
#: A matrix with a name, to its end or to another bracket; and what is on the line behind it.
_NAMED = re.compile(r"^[ \t]*([A-Za-z][\w.]*)[ \t]*=[ \t]*\[([^\[\]]*)(.*)$", re.MULTILINE)
#: What may be there: the end of the statement and a comment, no factor and no sign of a transposition.
_END = re.compile(r"\][ \t]*;?[ \t]*(?:%.*)?")


def without_brackets(text: str, name: str) -> tuple[str, list[str]]:
    """Text of a table without MATLAB's notation, on the same lines, and notes on what was left out.

    Args:
        text: of the file.
        name: of the file, for the error message.

    Raises:
        DataError: it is a script from which no one table can be taken.
    """
    if "[" not in text:
        return text, []
    tables = [found for found in _NAMED.finditer(text) if _is_table(found.group(2))]
    if len(tables) > 1:
        raise refused(name, f" with the matrices {', '.join(found.group(1) for found in tables)}")
    if tables:
        return _of_script(text, tables[0], name)
    plain = _BRACKETS.sub(lambda found: found.group(1).replace(";", " "), text)
    closed = text.rstrip(" \t\n;").endswith("]")  # which ends the last line too
    return f"{plain}\n" if closed else plain, []


def is_script(text: str) -> bool:
    """Whether a text sets a matrix as MATLAB does."""
    return _NAMED.search(text) is not None


def refused(name: str, found: str = "") -> DataError:
    """The error for a script that cannot be read.

    Args:
        name: of the file.
        found: what the script has, with a space in front.
    """
    return DataError(
        f"{name} is a MATLAB script{found}; expected one matrix with a line for each sample: save the numbers as CSV, "
        "with a header like time_s,force_n,position_m"
    )


def _of_script(text: str, matrix: re.Match[str], name: str) -> tuple[str, list[str]]:
    """The matrix as a table with tabs between its cells, below its headings."""
    called, body, behind = matrix.groups()
    if behind and not _END.fullmatch(behind):
        raise refused(name, f" that goes on with {behind[:20].strip()!r} in or behind the matrix {called}")
    rows = [_row(line) for line in re.sub(r";(?!\s*(?:%.*)?(?:\n|$))", "\n", body).split("\n")]
    above = text[: matrix.start()].split("\n")[:-1]
    width = len(next(filter(None, rows)))
    headings = [_headings(line, width) for line in above]
    last = max((at for at, names in enumerate(headings) if names), default=-1)
    lines = ["\t".join(names) if at == last else "" for at, names in enumerate(headings)]
    table = "\n".join([*lines, *("\t".join(row) for row in rows)])
    if not behind:
        return table, [f"the matrix {called} of the MATLAB script has no closing bracket: the file may have been cut."]
    first = text.count("\n", 0, matrix.end()) + 1
    code = [(at, line.strip()) for at, line in enumerate(text.split("\n")[first:], first + 1)]
    code = [(at, line) for at, line in code if line and not line.startswith("%")]
    notes = [f"line {at} and what follows are code of a MATLAB script, and left out: {line[:40]!r}."
             for at, line in code[:1]]  # fmt: skip
    return f"{table}\n", notes


def _is_table(body: str) -> bool:
    """Whether what stands in brackets is several lines, the first of them of numbers."""
    first, _, rest = body.strip().partition("\n")
    return bool(rest) and bool(_row(first)) and all(is_number(cell) or is_missing(cell) for cell in _row(first))


def _row(line: str) -> list[str]:
    """Cells of a line of a matrix."""
    return [cell for cell in re.split(r"[\s,;]+", line.partition("%")[0]) if cell]


def _headings(line: str, width: int) -> tuple[str, ...]:
    """So many headings in a line, which may be a comment; none in code, or where it has another number of cells."""
    text = line.strip().lstrip("%").strip()
    if not line.lstrip().startswith("%") and any(sign in line for sign in "=;"):
        return ()
    several = (cells_of(text), tuple(re.split(r"\s{2,}", text)))
    return next((names for names in several if text and len(names) == width), ())
