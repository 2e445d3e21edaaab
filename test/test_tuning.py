"""Tuned constants: few, each declared with unit, reason and origin, and none beside the declared ones."""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import get_args

import pytest
from sources import parsed

from bench import sensitivity
from msd_ident import tuning

REPOSITORY = Path(__file__).resolve().parent.parent
MOST = 60
#: Numbers that may stand in an expression of others: halves, counts, a variance (1/12) and a quartile (0.75).
PLAIN = {0.0, 0.5, 0.75, 1.0, 2.0, 3.0, 12.0}
FILES = [path for room in tuning.ROOMS for path in sorted((REPOSITORY / "msd_ident" / room).glob("*.py"))]


def numbers(node: ast.AST) -> Iterator[float]:
    for part in ast.walk(node):
        if isinstance(part, ast.Constant) and isinstance(part.value, int | float) and not isinstance(part.value, bool):
            yield float(part.value)


def test_tuned_constants_are_few_and_say_unit_reason_and_origin() -> None:
    found = tuning.declared()
    tuned = [one for one in found if one.is_tuned]
    assert len(tuned) <= MOST
    assert len({one.place for one in found}) == len(found)
    for one in tuned:
        assert set(one.about) == {"unit", "why", "chosen"}, one.place
        assert all(said.strip() for said in one.about.values()), one.place
    for one in found:
        assert one.is_tuned or one.about["kind"] in get_args(tuning.Kind), one.place


@pytest.mark.xdist_group("house")
def test_no_number_stands_beside_the_declared_ones() -> None:
    bare = []
    for path in FILES:
        tree = parsed(path)
        declared = {name for name, _ in tuning.declarations(tree)}
        for node in tree.body:
            if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
                continue
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            if {part.id for target in targets for part in ast.walk(target) if isinstance(part, ast.Name)} <= declared:
                continue
            literal = set(numbers(node.value))
            derived = any(isinstance(part, ast.Name) for part in ast.walk(node.value))
            if literal and not (derived and literal <= PLAIN):
                bare.append(f"{path.relative_to(REPOSITORY)}:{node.lineno}: {ast.unparse(node)}")
    assert not bare, "declare with tuned or fixed of msd_ident/tuning.py:\n" + "\n".join(bare)


@pytest.mark.xdist_group("house")
def test_compiled_functions_hold_no_tuned_constant() -> None:
    """Numba compiles the value in, and its cache does not know when another module changes it."""
    tuned = {one.name for one in tuning.declared() if one.is_tuned}
    for path in FILES:
        tree = parsed(path)
        for node in tree.body:
            if isinstance(node, ast.FunctionDef) and any("njit" in ast.unparse(one) for one in node.decorator_list):
                used = {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}
                assert not used & tuned, f"{path.name}: {node.name}"


@pytest.mark.parametrize(
    ("value", "unit", "half", "double"),
    [
        (8.0, "1", 4.0, 16.0),
        (5, "steps", 2, 10),
        (1, "sets", 1, 2),
        (0.9, "1", 0.95, 0.8),
        (1.44, "factor", 1.2, 2.0736),
        ((0.3, 30.0), "1", (0.15, 15.0), (0.6, 60.0)),
    ],
)
def test_the_study_halves_and_doubles(value: float, unit: str, half: float, double: float) -> None:
    assert sensitivity.moved(value, unit, "half") == pytest.approx(half)
    assert sensitivity.moved(value, unit, "double") == pytest.approx(double)


def test_what_follows_from_a_constant_follows_in_the_study() -> None:
    code = """
import json, sys
from bench import sensitivity
sys.meta_path.insert(0, sensitivity._Changed("msd_ident.selection.ranking", "NEAR", "24.0"))
from msd_ident.design import nearest_rival
from msd_ident.selection import coarse_to_fine, ranking
print(json.dumps([ranking.NEAR, coarse_to_fine.NEAR, nearest_rival.SILENT, ranking.DECISIVE]))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=REPOSITORY)
    from msd_ident.selection import ranking

    assert json.loads(done.stdout) == [24.0, 24.0, 24.0, ranking.DECISIVE]


def test_the_table_compares_with_the_untouched_run() -> None:
    place = next(one.place for one in tuning.declared() if one.is_tuned)
    whole = {"cases": 2, "seed": 1, "visible": 1, "clean": 1, "family": 3, "foreign": 4, "failed": [], "false": 0}
    said = [[1, "explained", []], [2, "adequate", []]]
    base = {**whole, "place": "", "side": "", "exact": 1, "adequate": 1, "seconds": 2.0, "said": said}
    other = [[1, "unexplained", []], said[1]]
    worse = {**base, "place": place, "side": "half", "exact": 0, "seconds": 3.0, "said": other}
    text = sensitivity.table([base, worse])
    assert f"| `{place}` |" in text and "| **0, 3, 1, 0, 1, +50 %** | not run |" in text
    assert "the family of 3 of 4 foreign laws is named" in text
    foreign = {**base, "place": place, "side": "half", "family": 2}
    assert "| **1, 2, 1, 0, 0, +0 %** | not run |" in sensitivity.table([base, foreign])


def test_the_cases_are_of_both_studies_and_spaced_over_them() -> None:
    cases = sensitivity.chosen(24, 870_000)
    assert [case.kind for case in cases].count("variant") == 8 and len({case.seed for case in cases}) == 24
    assert len({case.hidden for case in cases}) > 15 and {case.experiment for case in cases[:16]} == {"steps"}
