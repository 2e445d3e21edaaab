"""``msd simulate``: files as asked for, the same for the same seed, one line for each mistake."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest

from msd_ident.cli.main import main
from msd_ident.io import read


@pytest.fixture
def msd(monkeypatch, capsys):
    """Run ``msd simulate`` with these words; gives exit code, standard output and standard error."""

    def call(*words):
        monkeypatch.setattr(sys, "argv", ["msd", "simulate", *map(str, words)])
        code = main()
        said = capsys.readouterr()
        return code, said.out, said.err

    return call


def test_the_papers_experiment_as_a_table(msd, tmp_path):
    code, said, wrong = msd("--out", tmp_path / "paper.csv")
    lines = (tmp_path / "paper.csv").read_text().splitlines()
    assert code == 0 and wrong == "" and "6000 samples in 5.999 s, experiment paper on rig ecp" in said
    assert lines[0] == "time_s,force_n,position_m" and lines[1] == "0.0,10.425,0.0" and len(lines) == 6001
    record = read(tmp_path / "paper.csv")
    assert 0.0264 < record.position.max() < 0.0266 and record.force_at(2.9995) == 10.425 and record.force_at(3.0) == 0


def test_bag_and_table_hold_the_same_record(msd, tmp_path):
    words = ("--experiment", "steps:force=8,hold=0.5", "--effect", "quadratic_drag", "--seed", 3)
    assert msd("--out", tmp_path / "one.csv", *words)[0] == msd("--out", tmp_path / "two", *words)[0] == 0
    table, bag = read(tmp_path / "one.csv"), read(tmp_path / "two")
    assert np.array_equal(table.position, bag.position) and np.abs(table.time - bag.time).max() < 1e-9
    assert np.array_equal(table.force_at(table.time), bag.force_at(bag.time)) and bag.force.size == 8


def test_effects_parameters_and_truth(msd, tmp_path):
    code, said, _ = msd(
        "--out", tmp_path / "a", "--rig", "backlash", "--effect", "coulomb_friction:coulomb_force=0.2", "--set",
        "mass=2,encoder.noise=2e-5", "--rate", 500, "--duration", 2, "--json", "-",
    )  # fmt: skip
    truth = json.loads(said)
    assert code == 0 and truth["schema"] == "msd.simulation/1" and truth["mass"] == 2.0 and truth["rate"] == 500.0
    assert truth["effects"]["backlash"] == {"backlash_half_width": 0.001}
    assert truth["effects"]["coulomb_friction"]["coulomb_force"] == 0.2 and truth["encoder"]["noise"] == 2e-5
    assert read(tmp_path / "a").samples == 1000


def test_the_seed_decides(msd, tmp_path):
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        msd("--out", tmp_path / f"{name}.csv", "--set", "encoder.noise=1e-4", "--seed", seed, "--duration", 1)
    a, b, c = ((tmp_path / f"{name}.csv").read_text() for name in "abc")
    assert a == b != c


def test_a_force_between_samples_keeps_its_own_stamps(msd, tmp_path):
    assert msd("--out", tmp_path / "r.csv", "--experiment", "random_steps:duration=2")[0] == 0
    record = read(tmp_path / "r.csv")
    assert not np.isin(record.force_time, record.time).all() and record.samples == 2000


MISTAKES = [
    (("--effect", "rubber"), "no effect 'rubber'; expected one of coulomb_friction,"),
    (("--effect", "backlash:gap=1"), "backlash has no parameter 'gap'; expected one of backlash_half_width"),
    (("--effect", ":gap=1"), "--effect ':gap=1' has no name; expected NAME or NAME:PARAMETER=NUMBER"),
    (
        ("--effect", "backlash:backlash_half_width=wide"),
        "'backlash_half_width=wide' is no setting; expected PARAMETER=",
    ),
    (("--rig", "ferrari"), "no rig 'ferrari'; expected one of backlash,"),
    (("--experiment", "kick"), "no experiment 'kick'; expected one of paper,"),
    (("--experiment", "step:fource=1"), "experiment step has no option 'fource'; expected one of force,"),
    (("--set", "mass=1", "--set", "mass=2"), "--set: mass is given twice; expected one value: remove one of them"),
    (
        ("--effect", "backlash:backlash_half_width=1,backlash_half_width=2"),
        "--effect: backlash_half_width is given twice; expected one value",
    ),
    (
        ("--effect", "backlash", "--effect", "backlash:backlash_half_width=0.1"),
        "--effect backlash is given twice; expected it once, with all its parameters: join them",
    ),
    (("--set", "mass"), "--set: 'mass' is no setting; expected PARAMETER=NUMBER"),
    (("--set", "mass=-1"), "rig mass is -1 kg; expected 1e-09 or more"),
    (("--rate", 10, "--duration", 1), "10 position samples; expected at least 20"),
    (("--seed", -4), "seed is -4; expected a whole number of 0 or more"),
]


@pytest.mark.parametrize(("words", "expected"), MISTAKES, ids=[" ".join(map(str, words)) for words, _ in MISTAKES])
def test_mistakes_get_one_line_and_code_2_and_leave_no_file(msd, tmp_path, words, expected):
    code, said, wrong = msd("--out", tmp_path / "x.csv", *words)
    assert code == 2 and said == "" and wrong.startswith("msd: ") and wrong.count("\n") == 1 and expected in wrong
    assert not (tmp_path / "x.csv").exists()


@pytest.mark.parametrize("name", ["x.csv", "x"])
def test_nothing_is_overwritten_without_force(msd, tmp_path, name):
    assert msd("--out", tmp_path / name, "--duration", 0.5)[0] == 0
    code, _, wrong = msd("--out", tmp_path / name, "--duration", 1)
    assert code == 2 and "exists; expected a new name: give another one, or --overwrite to replace it" in wrong
    assert read(tmp_path / name).samples == 500
    assert msd("--out", tmp_path / name, "--duration", 1, "--force")[0] == 0
    assert read(tmp_path / name).samples == 1000


def test_a_name_that_is_neither_table_nor_folder(msd, tmp_path):
    code, _, wrong = msd("--out", tmp_path / "x.mcap")
    assert code == 2 and "ends in .mcap; expected a name that ends in .csv, or a folder's for a bag" in wrong


def test_without_a_rig_it_says_what_is_missing(msd, tmp_path, monkeypatch):
    monkeypatch.setattr("importlib.metadata.entry_points", lambda group: ())
    code, _, wrong = msd("--out", tmp_path / "x.csv")
    assert code == 2 and "no simulated rig is installed; expected an entry point in msd.rigs" in wrong
