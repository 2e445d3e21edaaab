"""Which sets of a round are begun."""

from __future__ import annotations

import math
from itertools import combinations
from typing import Any

from setrigs import BASE, fitted, steps

from msd_ident.model.effects import by_name
from msd_ident.selection.evidence import scale_from
from msd_ident.selection.hypothesis_fit import StartingPoint
from msd_ident.selection.worthwhile import _BEGUN, promising

DATA = steps()
LAWS = ("quadratic_drag", "cubic_spring", "actuator_lag", "sensor_drift", "end_stop", "stiffness_drift", "second_mode")
PAIRS = list(combinations(LAWS, 2))
KNOWN = [fitted(DATA, BASE, 1e6)]
SCALE = scale_from(KNOWN, DATA.readings)


def starts(names: tuple[str, ...], *promises: tuple[float, float]) -> list[StartingPoint]:
    model: Any = BASE
    for name in names:
        model += by_name(name).guess(DATA.records[0], BASE)[0]
    here = fitted(DATA, model, 1e6)
    return [StartingPoint(promise, here, 1e6, least) for promise, least in promises]


def test_only_the_sets_that_promise_to_leave_least_are_begun() -> None:
    group = [starts(pair, (1e3 * 1.5**i, math.inf)) for i, pair in enumerate(PAIRS)]
    assert len(group) > _BEGUN
    kept = promising(group[::-1], SCALE, KNOWN)
    assert [one[0].promise for one in kept[:_BEGUN]] == [1e3 * 1.5**i for i in range(_BEGUN)]
    assert len(kept) < len(group)
    group[-1] = starts(PAIRS[-1], (9e8, math.inf), (9e8, 10.0))
    assert promising(group, SCALE, KNOWN)[0] is group[-1], "one of its starts goes far along a weak direction"


def test_a_plain_law_that_promises_more_evidence_is_begun_though_flexible_ones_leave_less() -> None:
    likely = ("quadratic_drag", "cubic_spring")
    group = [starts(names, (1e4 + i, math.inf)) for i, names in enumerate(combinations(LAWS, 3))][: 2 * _BEGUN]
    plain = starts(likely, (1.2e4, math.inf))
    assert any(one is plain for one in promising([*group, plain], SCALE, KNOWN))
    hopeless = starts(likely, (1e9, math.inf))
    assert all(one is not hopeless for one in promising([*group, hopeless], SCALE, KNOWN))


def test_all_single_causes_are_begun_alone_and_beside_coulomb_friction() -> None:
    """Larger sets are made of them, however little one explains."""
    for beside in ((), ("coulomb_friction",)):
        group = [starts((name, *beside), (1e3, math.inf)) for name in LAWS] * 3
        assert len(group) > _BEGUN and promising(group, SCALE, KNOWN) is group


def test_a_set_that_promises_more_than_the_best_one_leaves_is_not_begun() -> None:
    """Neither as one of few, nor as the likeliest of a round; but the first one of a round is begun anyway."""
    near = [starts(pair, (1e6 + 1e5 * i, math.inf)) for i, pair in enumerate(PAIRS[:4])]
    far = [starts(pair, (1e9, math.inf)) for pair in PAIRS[4:9]]
    assert promising([*near, *far], SCALE, KNOWN) == near
    assert len(promising(far, SCALE, KNOWN)) == 1
    ahead = [*KNOWN, fitted(DATA, BASE, 1e3)]
    assert promising([*near, *far], scale_from(ahead, DATA.readings), ahead) == near[:1]
