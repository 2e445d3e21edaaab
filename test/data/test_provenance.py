"""Hashes and versions."""

from __future__ import annotations

import ast
import hashlib
import platform
from pathlib import Path

import pytest
from sources import parsed

from msd_ident import seeds
from msd_ident.data.provenance import Provenance, fingerprint, versions
from msd_ident.errors import DataError


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


def test_versions_are_read_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """It took 13 ms for each export, page and row."""
    before = versions()
    monkeypatch.setattr("importlib.metadata.version", lambda name: pytest.fail(f"{name} is read again"))
    assert versions() == before


def test_all_seeds_are_told() -> None:
    found = Provenance("msd diagnose a.csv", "2026-01-31T12:00:00Z", (), versions())
    assert found.to_json_dict()["seeds"] == seeds.ALL
    assert all(str(seed) in found.drawn for seed in (seeds.PREDICTION, seeds.RANDOM_STEPS))
    assert {value for name, value in vars(seeds).items() if isinstance(value, int)} == set(seeds.ALL.values())


@pytest.mark.xdist_group("house")
def test_whatever_draws_takes_its_seed_from_there_or_from_the_profile(repository: Path) -> None:
    taken = set()
    for path in (repository / "msd_ident").rglob("*.py"):
        for node in ast.walk(parsed(path)):
            if isinstance(node, ast.Call) and ast.unparse(node.func).endswith(("default_rng", "random.seed")):
                taken.add(", ".join(map(ast.unparse, node.args)))
    names = ("PREDICTION", "RANDOM_STEPS", "REMAINDER", "DRAWS", "ENCODER")
    assert taken == {*(f"seeds.{name}" for name in names), "[seeds.CALIBRATION, *number]", "self.seed", "seed"}
