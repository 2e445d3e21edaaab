"""Hashes and versions."""

from __future__ import annotations

import hashlib
import platform
from pathlib import Path

import pytest

from msd_ident.errors import DataError
from msd_ident.provenance import fingerprint, versions


def test_hash_of_a_file_is_what_sha256sum_says(tmp_path: Path) -> None:
    path = tmp_path / "data.csv"
    path.write_bytes(b"time_s,force_n\n" * 100_000)
    assert fingerprint(path) == (1_500_000, hashlib.sha256(path.read_bytes()).hexdigest())


def test_hash_of_a_folder_hears_of_every_file_and_name(tmp_path: Path) -> None:
    (tmp_path / "metadata.yaml").write_text("a")
    (tmp_path / "bag_0.mcap").write_text("bc")
    size, first = fingerprint(tmp_path)
    assert size == 3
    (tmp_path / "bag_0.mcap").rename(tmp_path / "bag_1.mcap")
    assert fingerprint(tmp_path)[1] != first


def test_what_is_not_there_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="cannot read .*nothing.csv: .*; expected a file that may be read"):
        fingerprint(tmp_path / "nothing.csv")


def test_versions_name_python_and_what_computes() -> None:
    found = versions()
    assert found["python"] == platform.python_version() and set(found) == {
        "python",
        "msd_ident",
        "numpy",
        "scipy",
        "numba",
    }
