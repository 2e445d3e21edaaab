"""YAML that a person writes: what stands there counts, and nothing is passed over."""

from __future__ import annotations

import pytest

from msd_ident.strict_yaml import YAMLError, dump, load


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("force: 1\ntravel: 2\nforce: 100\n", "it has the key 'force' twice, in lines 1 and 3"),
        ('rig:\n  force: 1\n  "force": 1\n', "it has the key 'force' twice, in lines 2 and 3"),
        ("{force: 1, force: 100}", "it has the key 'force' twice, in lines 1 and 1"),
    ],
)
def test_a_key_that_stands_twice_is_refused(text: str, says: str) -> None:
    with pytest.raises(YAMLError, match=f"^{says}$"):
        load(text)


def test_a_key_may_stand_in_several_mappings() -> None:
    text = "a: &a {x: 1, y: 2}\nb: {<<: *a, y: 3}\nc: {<<: *a, x: 4}\n"
    assert load(text) == {"a": {"x": 1, "y": 2}, "b": {"x": 1, "y": 3}, "c": {"x": 4, "y": 2}}


@pytest.mark.parametrize("text", ["3e-2", "3E-2", "3.e-2", "3.0e-2", "+.3e-1", "-3e-2", "3.0e2", "30e0"])
def test_a_number_with_an_exponent_is_one(text: str) -> None:
    assert load(f"x: {text}") == {"x": float(text)}


@pytest.mark.parametrize("text", ["1:30", "1:30.5", "-1:00", "010", "1_000", "1_0.5", "0b11", "0o17"])
def test_what_only_yaml_1_1_takes_for_a_number_is_a_text(text: str) -> None:
    assert load(f"x: {text}") == {"x": text}


@pytest.mark.parametrize(
    ("text", "value"),
    [("16", 16), ("0x10", 16), ("-3", -3), ("+4", 4), ("0", 0), ("0.5", 0.5), (".5", 0.5), ("007.5", 7.5), ("2.", 2.0)],
)
def test_numbers_are_numbers(text: str, value: float) -> None:
    found = load(f"x: {text}")["x"]
    assert found == value and type(found) is type(value)
    assert load("[.inf, -.inf]") == [float("inf"), -float("inf")]


@pytest.mark.parametrize(
    "value", ["1:30", "010", "0o17", "1_0", "3e-2", "1e5", "e5", "1e", "0x1", 3, 3e-20, "3e-2 m", "1.0"]
)
def test_what_is_written_is_read(value: object) -> None:
    again = load(dump({"x": value}))["x"]
    assert again == value and type(again) is type(value)
