"""MAT files of MATLAB and Octave: variables as named columns.

Versions 4 to 7 are read by scipy; version 7.3 is an HDF5 file and needs h5py, an extra of this package. Members of a
structure are called ``name.member``, those in an array of structures ``name(3).member``, the parts of a cell array
``name{3}`` and columns of a matrix ``name(:,1)``, as MATLAB calls them. Arrays of structures and cells of version 7.3
are not followed.
"""

from __future__ import annotations

import warnings
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from msd_ident.data.record import FloatArray
from msd_ident.errors import DataError, SetupError

_MAGIC = b"MATLAB "
#: Columns of a matrix that are offered; an image has more.
_MOST_COLUMNS = 50
#: Structures, and arrays of them, are followed so deep in each other.
_DEEPEST = 8
#: Classes of arrays of numbers.
_ARRAYS = ("logical", "double", "single", *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)))
#: What scipy raises on files that were cut off or are no MAT files.
_BROKEN = (OSError, ValueError, TypeError, IndexError, KeyError, MemoryError, OverflowError)


def is_mat(path: Path) -> bool:
    """Whether a file is a MAT file by its name or its first bytes."""
    if path.suffix.lower() == ".mat":
        return True
    try:
        with path.open("rb") as file:
            return file.read(len(_MAGIC)) == _MAGIC
    except OSError:
        return False


class MatFile:
    """The vectors of a MAT file as columns; single numbers and texts are left out.

    Raises:
        DataError: it cannot be read, or holds no vector.
        SetupError: it is of version 7.3 and h5py is not installed.
    """

    kind = "MAT file"
    notes: tuple[str, ...] = ()

    def __init__(self, path: Path) -> None:
        self._path = path
        variables = dict(_variables(path))
        self._vectors = {name: vector for of, value in variables.items() for name, vector in _vectors(of, value)}
        if not self._vectors:
            objects = "".join(
                f", {of} is an object ({o.kind})" for of, o in variables.items() if isinstance(o, _Object)
            )
            raise DataError(
                f"{path} holds no vector of numbers{objects}; expected variables with a number for each sample, such "
                "as time, force and position: save them with MATLAB's save, and of objects (timeseries, table) the "
                "vectors, as in t = ts.Time; x = ts.Data; save('run.mat', 't', 'x')"
            )

    @property
    def header(self) -> tuple[str, ...]:
        """Names of the variables that are vectors."""
        return tuple(self._vectors)

    @property
    def lines(self) -> int:
        """Length of the longest vector."""
        return max(vector.size for vector in self._vectors.values())

    def columns(self, indices: Sequence[int]) -> tuple[FloatArray, ...]:
        """The vectors of these places, each (n,).

        Raises:
            DataError: their lengths differ.
        """
        names = [self.header[index] for index in indices]
        sizes = {name: self._vectors[name].size for name in names}
        if len(set(sizes.values())) > 1:
            listed = ", ".join(f"{name} {size}" for name, size in sizes.items())
            raise DataError(
                f"{self._path}: the variables have different lengths ({listed}); expected one number for each sample "
                "in each of them: choose others with --time, --force and --position"
            )
        return tuple(self._vectors[name] for name in names)


@dataclass(frozen=True)
class _Object:
    """An object of MATLAB's, of which a file of version 7.3 has a handle and a class."""

    kind: str


def _variables(path: Path) -> Iterator[tuple[str, Any]]:
    import scipy.io
    from scipy.io.matlab import MatReadError, MatReadWarning

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", MatReadWarning)  # of objects, which no reader of vectors asks for
            found = scipy.io.loadmat(path, squeeze_me=True, struct_as_record=False)
    except NotImplementedError:  # scipy's word for version 7.3
        found = _hdf5(path)
    except (PermissionError, IsADirectoryError) as error:
        raise DataError(f"cannot read {path}: {error.strerror}; expected a file that may be read") from None
    except (*_BROKEN, MatReadError, zlib.error) as error:
        raise DataError(
            f"{path} cannot be read as a MAT file ({error}); expected one that MATLAB saved: save it again, or as CSV"
        ) from None
    yield from ((name, value) for name, value in found.items() if not name.startswith(("__", "#")))


def _hdf5(path: Path) -> dict[str, Any]:
    """Variables of a MAT file of version 7.3: datasets, with MATLAB's axes in reverse, and groups for structures."""
    try:
        import h5py
    except ImportError:
        raise SetupError(
            f"{path} is a MAT file of version 7.3, which needs h5py; expected it to be installed: pip install "
            "'msd_ident[mat]', or save the file with MATLAB's save -v7"
        ) from None

    def value(item: Any) -> Any:
        """What a variable holds, with the names of its members where it is a structure."""
        if isinstance(item, h5py.Group):
            return {name: value(member) for name, member in item.items()}
        kind = item.attrs.get("MATLAB_class", b"")
        kind = kind.decode(errors="replace") if isinstance(kind, bytes) else str(kind)
        if "MATLAB_object_decode" in item.attrs and kind not in _ARRAYS:
            return _Object(kind)
        return str(kind) if kind == "char" else np.asarray(item).T  # what a text says is not asked for

    try:
        with h5py.File(path, "r") as file:
            return {name: value(item) for name, item in file.items()}
    except (OSError, RuntimeError, TypeError, ValueError) as error:
        raise DataError(
            f"{path} cannot be read as a MAT file of version 7.3 ({error}); expected one that MATLAB saved: save it "
            "again, or as CSV"
        ) from None


def _vectors(name: str, value: Any, depth: int = 0) -> Iterator[tuple[str, FloatArray]]:
    """The vectors in a variable, with their names."""
    members = value if isinstance(value, dict) else {n: getattr(value, n) for n in getattr(value, "_fieldnames", ())}
    if members and depth < _DEEPEST:
        for member, item in members.items():
            yield from _vectors(f"{name}.{member}", item, depth + 1)
        return
    array = np.asarray(value)
    if array.dtype == object and array.ndim and depth < _DEEPEST:
        for i, item in enumerate(array.ravel(order="F")):
            place = f"({i + 1})" if hasattr(item, "_fieldnames") else f"{{{i + 1}}}"
            yield from _vectors(f"{name}{place}", item, depth + 1)
        return
    if array.dtype.kind not in "buif" or not array.size:
        return
    array = np.squeeze(array).astype(np.float64)
    if array.ndim == 1:
        yield name, array
    elif array.ndim == 2:
        columns = array if array.shape[0] >= array.shape[1] else array.T
        if columns.shape[1] <= _MOST_COLUMNS:
            by_row = columns is not array
            for i in range(columns.shape[1]):
                place = f"({i + 1},:)" if by_row else f"(:,{i + 1})"
                yield f"{name}{place}", np.ascontiguousarray(columns[:, i])
