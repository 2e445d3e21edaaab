"""What differs between rigs is named, what does not is not, and a rival cause is no robot."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("pyarrow", reason="the extra batch is not installed")

from batchrigs import PLANT, row, steps  # noqa: E402

from msd_ident.batching import table  # noqa: E402
from msd_ident.comparison import rows  # noqa: E402
from msd_ident.comparison.comparing import Comparison, Difference, compare  # noqa: E402
from msd_ident.comparison.estimates import Measured, structure  # noqa: E402
from msd_ident.comparison.joint import joint_fit  # noqa: E402
from msd_ident.errors import DataError, UsageError  # noqa: E402

CUBIC = {"cubic_spring": {"cubic_stiffness": 3e5}}


def measured(
    seed: int, group: str, causes: tuple[str, ...] = (), temperature: float | None = None, **rig: float
) -> Measured:
    """A record as a diagnosis would tell it, with the truth a little off for its values."""
    record = steps(seed, **rig)
    values = {name: 1.02 * float(rig.get(name, value)) for name, value in PLANT.items()}
    values |= {"cubic_stiffness": 2e5} if causes else {}
    beside = {"amplitude": float(np.max(np.abs(record.force)))}
    beside |= {} if temperature is None else {"temperature": temperature}
    return Measured(record.name, group, record, causes, values, (), beside)


def kinds(found: Comparison) -> dict[str, str]:
    return {one.parameter: one.kind for one in found.differences}


@pytest.mark.parametrize(("name", "factor"), [("stiffness", 0.969), ("damping", 1.05), ("mass", 1.02)])
def test_the_parameter_that_differs_is_named_with_its_size(name: str, factor: float) -> None:
    found = compare([measured(1, "A"), measured(2, "B", **{name: factor * PLANT[name]})], "robot")
    assert kinds(found) == {other: "differs" if other == name else "shared" for other in PLANT}
    (one,) = [one for one in found.differences if one.parameter == name]
    size, half = one.percent["B"]
    assert size == pytest.approx(100.0 * (factor - 1.0), abs=max(3.0 * half, 0.05)) and one.probability > 0.99
    assert f"{name} is " in found.sentence and "on robot B (p > 99.9 %); the rest agrees" in found.sentence


def test_nothing_differs_is_said_with_what_would_have_been_seen() -> None:
    found = compare([measured(seed, "AB"[seed % 2]) for seed in range(4)], "robot")
    assert set(kinds(found).values()) == {"shared"}
    assert found.sentence.startswith("Nothing differs beyond ±")


def test_a_joint_fit_that_shares_what_differs_leaves_more() -> None:
    found = compare([measured(1, "A"), measured(2, "B", stiffness=0.98 * PLANT["stiffness"])], "robot")
    apart, shared = found.joint
    assert (apart.differing, shared.differing) == (("stiffness",), ())
    assert apart.converged and shared.chi2 > 2.0 * apart.chi2
    place = found.estimates[0].fit.free.index("stiffness")
    assert apart.values[1, place] / apart.values[0, place] == pytest.approx(0.98, abs=1e-3)
    assert apart.values[0, 0] == apart.values[1, 0]  # the mass is one for both
    own = joint_fit(found.estimates, ["A", "B"], found.estimates[0].fit.free)
    assert own.chi2 <= apart.chi2 * (1.0 + 1e-6)


def test_a_temperature_that_explains_the_difference_is_named_instead() -> None:
    lots, made = np.random.default_rng(3), []
    for seed in range(8):
        group = "AB"[seed % 2]
        temperature = 20.0 + 6.0 * (group == "B") + 4.0 * lots.normal()
        warm = PLANT["stiffness"] * (1.0 - 0.002 * (temperature - 20.0))
        made.append(measured(seed, group, temperature=temperature, stiffness=warm))
    found = compare(made, "robot")
    assert kinds(found)["stiffness"] == "explained"
    assert "stiffness varies with temperature, not with the robot" in found.sentence


def test_a_temperature_that_goes_with_the_robot_is_a_tie() -> None:
    made = [
        measured(seed, "AB"[seed % 2], temperature=20.0 + 20.0 * (seed % 2), stiffness=694.0 - 20.0 * (seed % 2))
        for seed in range(4)
    ]
    found = compare(made, "robot")
    assert kinds(found)["stiffness"] == "tied"
    assert "or it is temperature: these records cannot tell" in found.sentence


def test_another_amplitude_on_a_hardening_spring_is_no_other_robot() -> None:
    made = [
        measured(seed, "AB"[seed % 2], ("cubic_spring",), force=(10.0, 5.0)[seed % 2], effects=CUBIC)  # type: ignore[arg-type]
        for seed in range(2)
    ]
    assert structure(made).effect_names == ("cubic_spring",)
    assert set(kinds(compare(made, "robot")).values()) == {"shared"}


def test_one_record_each_is_said() -> None:
    found = compare([measured(1, "A"), measured(2, "B")], "robot")
    assert any("One record of each robot: the repeatability is not known" in line for line in found.warnings)


def test_one_group_is_refused() -> None:
    with pytest.raises(UsageError, match="all records have the robot A; expected at least two to compare"):
        compare([measured(1, "A"), measured(2, "A")], "robot")


@pytest.mark.parametrize(
    ("made", "by", "error", "says"),
    [
        ([row(1)], "colour", UsageError, "no column colour to compare by; expected one of robot, joint, day"),
        ([row(1), row(2)], "joint", UsageError, "the column joint is empty in all rows"),
        ([row(1, verdict=None, error="broken")], "robot", DataError, "no record of the table has a result"),
        ([row(1, verdict=None, error="a.csv: empty")], "robot", DataError, "(a.csv: empty); expected diagnoses"),
        (
            [row(n, verdict=None, error=f"bad {n}") for n in range(3)],
            "robot",
            DataError,
            "(bad 0); expected diagnoses; 2 others have errors too",
        ),
        ([row(1), row(2, position_unit="rad", force_unit="N·m")], "robot", UsageError, "expected one pair of units"),
        ([row(1), row(2)], "robot", DataError, "no record of the table can be read any more"),
    ],
)
def test_tables_that_cannot_be_compared_are_refused(
    made: list[dict[str, object]], by: str, error: type[Exception], says: str
) -> None:
    with pytest.raises(error) as refused:
        rows.measured(table.made(made), by)
    assert says in str(refused.value)


@pytest.mark.parametrize(
    ("size", "half", "words"),
    [
        (3.20314, 0.00052, "3.2031 % ± 0.0005"),
        (3.07, 0.63, "3.1 % ± 0.6"),
        (12.4, 3.2, "12 % ± 3"),
        (12.4, 0.96, "12 % ± 1"),
        (141.0, 37.0, "141 % ± 37"),
        (3.2, float("inf"), "3.2 % ± inf"),
        (3.2, 0.0, "3.2 % ± 0"),
    ],
)
def test_a_difference_has_the_digits_of_its_interval(size: float, half: float, words: str) -> None:
    found = Difference(
        parameter="stiffness", unit="N/m", values={}, probability=1.0, rivals={}, percent={"B": (-size, half)},
        resolution=1.0, kind="differs",
    )  # fmt: skip
    made = Comparison("robot", {"A": 2, "B": 2}, (), (found,), (), {}, (), ())
    assert made.sentence.startswith(f"stiffness is {words} lower on robot B (p ")
