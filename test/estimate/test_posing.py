"""Posing a problem: what is free, in which sizes and bounds."""

from __future__ import annotations

import pytest
from fitrigs import DEMO, demo_record

from msd_ident.errors import UsageError
from msd_ident.estimate.posing import build
from msd_ident.estimate.problem import Nuisance


def test_what_is_not_fixed_is_free_and_stands_before_what_the_records_add() -> None:
    nuisances = (Nuisance(0, "initial velocity"), Nuisance(0, "zero"))
    problem = build(DEMO, (demo_record(),), frozenset({"mass"}), nuisances)
    free = [name for name in DEMO.names if name != "mass"]
    assert problem.names[: len(free)] == tuple(free)
    assert [name.split(" of ")[0] for name in problem.names[len(free) :]] == ["initial velocity", "zero"]
    typical = problem.typical
    assert problem.scale[-2:].tolist() == [typical.length / typical.time, typical.length]
    assert (problem.lower < problem.upper).all() and problem.lower.size == problem.size


def test_an_unknown_name_is_refused() -> None:
    with pytest.raises(UsageError, match="no parameter 'spring' to fix; this model has mass, damping, stiffness"):
        build(DEMO, (demo_record(),), frozenset({"spring"}), ())
