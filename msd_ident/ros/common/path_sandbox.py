"""Paths of service requests: only files in one folder, also through dots and links. Without ROS."""

from __future__ import annotations

from pathlib import Path

from msd_ident.errors import UsageError
from msd_ident.io.new_folder import dated_folder
from msd_ident.paths import kind_of

#: Longest path that a request may hold, and longest name in it, as Linux has them [bytes].
LONGEST_PATH, LONGEST_NAME = 4096, 255
#: Characters of a long text that a refusal quotes.
_QUOTED = 60


class Place:
    """A folder, and what requests may name below it.

    Args:
        folder: its path; ``~`` stands for the user's home.
        parameter: that it comes from, for the words of a refusal.
    """

    def __init__(self, folder: str, parameter: str = "bag_folder") -> None:
        self.root = Path(folder).expanduser().resolve()
        self._parameter = parameter

    def existing(self, text: str) -> Path:
        """A bag or file to read; one that is not there is the reader's to refuse.

        Raises:
            UsageError: it lies elsewhere, or leads there, or is neither file nor folder.
        """
        path = self._below(text)
        for part in (path, *_entries(path)):
            if not self._holds(part.resolve()):
                raise UsageError(f"{part} leads out of {self.root}; expected files there: copy it")
            if kind_of(part):  # reading it need not end: a pipe's other side may never write
                raise UsageError(f"{part} is neither file nor folder; expected a bag or a CSV file")
        return path

    def new(self, text: str, suffix: str = "") -> Path:
        """A file or bag to make.

        Raises:
            UsageError: it lies elsewhere, exists, has another suffix or no folder to be in.
        """
        path = self._below(text, f"a name that ends in {suffix}" if suffix else "a bag")
        if suffix and path.suffix != suffix:
            raise UsageError(f"{text} does not end in {suffix}; expected a name that does")
        if path.exists() or path.is_symlink():
            raise UsageError(f"{path} exists; expected a new name: nothing is overwritten")
        if suffix and not path.parent.is_dir():
            raise UsageError(f"folder {path.parent} does not exist; expected one to write {path.name} into: make it")
        return path

    def automatic(self, prefix: str) -> Path:
        """A new folder named by date and time, which nobody else has.

        Raises:
            SetupError: the disk does not take it.
        """
        return dated_folder(self.root, prefix)

    def _below(self, text: str, expected: str = "a bag") -> Path:
        """The path with all links followed, relative ones counted from the root."""
        _check_words(text)
        try:
            path = (self.root / Path(text).expanduser()).resolve()
            path.exists()
        except (OSError, RuntimeError, ValueError) as error:  # links in a circle, a home that nobody has
            raise UsageError(f"{quoted(text)} cannot be followed: {error}; expected a path below {self.root}") from None
        if not self._holds(path) or path == self.root:
            raise UsageError(
                f"{quoted(text)} is not below {self.root}; expected {expected} there: give another name, or set "
                f"{self._parameter} when the node starts"
            )
        return path

    def _holds(self, path: Path) -> bool:
        return path == self.root or self.root in path.parents


def quoted(text: str) -> str:
    """A text in one line of a refusal: what cannot be printed as its code, the middle of a long one left out."""
    line = "".join(sign if sign.isprintable() else sign.encode("unicode_escape").decode() for sign in text)
    return line if len(line) <= _QUOTED else f"{line[: _QUOTED - 10]}…{line[-9:]}"


def _check_words(text: str) -> None:
    """Refuse what no file system takes.

    Raises:
        UsageError: the text is too long, or has characters that no name has.
    """
    size = len(text.encode("utf-8", "surrogatepass"))
    if size > LONGEST_PATH or "\0" in text:
        raise UsageError(f"a path of {len(text)} characters; expected at most {LONGEST_PATH}, and no zero among them")
    if not text.isprintable():
        raise UsageError(f"{quoted(text)} has characters that cannot be printed; expected a name without them")
    longest = max(text.split("/"), key=lambda part: len(part.encode()))
    if (size := len(longest.encode())) > LONGEST_NAME:
        raise UsageError(f"{quoted(longest)} is a name of {size} bytes; expected at most {LONGEST_NAME}: shorten it")


def _entries(path: Path) -> list[Path]:
    """What lies in a folder; nothing where that cannot be seen, which the reader says better."""
    try:
        return list(path.iterdir()) if path.is_dir() else []
    except OSError:
        return []
