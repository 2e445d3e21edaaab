"""Profiles as files: YAML with segments, CSV with instants and forces."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from msd_ident import strict_yaml
from msd_ident.design.profile import MAY, NEEDS, RATE, Profile, Segment, is_finite, shown
from msd_ident.errors import DataError, UsageError
from msd_ident.paths import check_plain
from msd_ident.tuning import fixed
from msd_ident.writing import write_text

SCHEMA = "msd.profile/1"
#: Endings of a profile's file.
SUFFIXES = (".yaml", ".yml", ".csv")
_HEADER = "time_s,force_n"
_LARGEST_BYTES = fixed(64 * 2**20, "interface", "size of a profile file [bytes], at most")


def check_name(path: Path) -> None:
    """Refuse a name by which no profile would be read.

    Raises:
        UsageError: it has another ending.
    """
    if path.suffix not in SUFFIXES:
        raise UsageError(f"{path} is no profile's name; expected one that ends in .yaml or .csv")


def read_profile(path: Path) -> Profile:
    """A profile from a ``.yaml`` or ``.csv`` file.

    Raises:
        DataError: the file is not there, or holds no profile that can be played.
    """
    text = _text(path)
    try:
        return _from_table(text, path.stem) if path.suffix == ".csv" else from_yaml(text)
    except UsageError as error:
        raise DataError(f"{path}: {error}") from None


def _text(path: Path) -> str:
    if path.suffix not in SUFFIXES:
        raise DataError(f"{path} is no profile; expected a file that ends in .yaml or .csv")
    check_plain(path, "a profile in YAML or CSV")
    try:
        if path.stat().st_size > _LARGEST_BYTES:
            raise DataError(f"{path} is larger than 64 MiB; expected a profile")
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise DataError(f"{path} is no text; expected a profile in YAML or CSV") from None
    except OSError as error:
        raise DataError(f"cannot read {path}: {error.strerror}; expected a profile file") from None


def to_yaml(profile: Profile, remarks: tuple[str, ...] = ()) -> str:
    """The profile as YAML.

    Args:
        profile: the profile.
        remarks: sentences that become comments at the top.
    """
    head = "".join(f"# {line}\n" for remark in remarks for line in textwrap.wrap(remark, 108))
    return head + strict_yaml.dump(to_tree(profile))


def to_tree(profile: Profile) -> dict[str, Any]:
    """The profile as plain values."""
    return {
        "schema": SCHEMA,
        "name": profile.name,
        "force_unit": profile.unit,
        "rate": profile.rate,
        "segments": [segment.to_dict() for segment in profile.segments],
    }


def from_yaml(text: str) -> Profile:
    """The profile that a YAML text describes.

    Raises:
        UsageError: it describes none; the line says which segment and what was expected.
    """
    try:
        tree = strict_yaml.load(text)
    except strict_yaml.YAMLError as error:
        raise UsageError(f"no YAML ({' '.join(str(error).split())}); expected a profile") from None
    return from_tree(tree)


def from_tree(tree: Any) -> Profile:
    """The profile of a parsed file; otherwise as ``from_yaml``."""
    if not isinstance(tree, Mapping) or not isinstance(tree.get("segments"), list):
        raise UsageError("no list of segments; expected 'segments:' with one mapping each")
    if tree.get("schema", SCHEMA) != SCHEMA:
        raise UsageError(f"schema {tree['schema']!r}; expected {SCHEMA}")
    unknown = sorted(set(map(str, tree)) - {"schema", "name", "force_unit", "rate", "segments"})
    if unknown:
        raise UsageError(f"no entry is called {unknown[0]!r}; expected schema, name, force_unit, rate, segments")
    rate = tree.get("rate", RATE)
    if not is_finite(rate):
        raise UsageError(f"rate is {shown(rate)}; expected commands a second")
    segments = tuple(_segment(entry, number) for number, entry in enumerate(tree["segments"], start=1))
    return Profile(segments, str(tree.get("name", "profile")), str(tree.get("force_unit", "N")), float(rate))


def _segment(entry: Any, number: int) -> Segment:
    kind: Any = entry.get("kind") if isinstance(entry, Mapping) else entry
    if not isinstance(entry, Mapping) or kind not in tuple(NEEDS):  # not in NEEDS itself: a list has no hash
        raise UsageError(f"segment {number} is of kind {shown(kind)}; expected one of {', '.join(NEEDS)}")
    needed = ("duration", *NEEDS[kind])
    missing = [name for name in needed if name not in entry]
    if missing:
        raise UsageError(f"segment {number} ({kind}) has no {missing[0]}; expected {', '.join(needed)}")
    unknown = [name for name in entry if name not in ("kind", *needed, *MAY.get(kind, ()))]
    if unknown:
        raise UsageError(f"segment {number} ({kind}) has no use for {unknown[0]!r}; expected {', '.join(needed)}")
    given = {str(key): value for key, value in entry.items()}
    for name in ("time", "values"):
        if name in given:
            given[name] = _numbers(given[name], number, name)
    seed = given.get("seed", 0)
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise UsageError(f"segment {number} ({kind}): seed is {seed!r}; expected a whole number from 0")
    try:
        return Segment(**given)
    except UsageError as error:
        raise UsageError(f"segment {number}: {error}") from None


def _numbers(value: Any, number: int, name: str) -> tuple[float, ...]:
    if not isinstance(value, list) or not all(map(is_finite, value)):
        raise UsageError(f"segment {number}: {name} is no list of finite numbers; expected one")
    return tuple(float(v) for v in value)


def to_csv(profile: Profile) -> str:
    """Instants and forces, one command a line, the last one at the profile's end."""
    rows = "".join(f"{at:.9g},{force:.9g}\n" for at, force in zip(*profile.commands, strict=True))
    return f"{_HEADER}\n{rows}"


def _from_table(text: str, name: str) -> Profile:
    """A profile from instants and forces; the last row's instant is the end."""
    lines = [line.strip() for line in text.splitlines() if line.strip() and not line.startswith("#")]
    if not lines or lines[0].replace(" ", "") != _HEADER:
        raise UsageError(f"first line {lines[0] if lines else '(none)'!r}; expected {_HEADER}")
    try:
        rows = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
    except ValueError:
        raise UsageError("a line that is not two numbers; expected time in seconds and force") from None
    if rows.ndim != 2 or rows.shape[0] < 2 or rows.shape[1] != 2 or not np.isfinite(rows).all():
        raise UsageError(f"{max(len(lines) - 1, 0)} lines of numbers; expected at least two of two finite numbers each")
    time, force = rows.T
    if np.any(np.diff(time) <= 0.0):
        raise UsageError("instants that do not rise; expected each later than the one before")
    if force[-1] != 0.0:
        raise UsageError(f"a last force of {force[-1]:g}; expected 0, so that the rig is left without force")
    whole = Segment("table", float(time[-1] - time[0]), time=tuple(time[:-1] - time[0]), values=tuple(force[:-1]))
    return Profile((whole,), name)


def write_profile(profile: Profile, path: Path, remarks: tuple[str, ...] = ()) -> None:
    """Write a profile as CSV if the name ends in ``.csv``, else as YAML.

    Args:
        profile: the profile.
        path: of the file.
        remarks: comments of the YAML file; a CSV file has none.

    Raises:
        SetupError: the file cannot be written.
    """
    write_text(to_csv(profile) if path.suffix == ".csv" else to_yaml(profile, remarks), path)
