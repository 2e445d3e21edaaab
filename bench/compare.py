"""``python -m bench.compare``: pairs of random rigs that differ in one parameter, in none, or in something else.

Each record is 6 s at 1 kHz of steps, diagnosed on its own and then compared. A change counts as named where that
parameter alone is said to differ; it must be where it exceeds three of its 95 % intervals. A false change is one that
is said where none is.

    python -m bench.compare --pairs 300     # on a quiet machine
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np

from msd_ident.comparison.comparing import Comparison, compare
from msd_ident.comparison.estimates import Measured
from msd_ident.data.record import Record, from_samples
from msd_ident.errors import MsdError
from msd_ident.workflow import pipeline
from msd_sim import api, lottery

#: What may change, and the hidden causes beside which it does.
CHANGED = ("mass", "damping", "stiffness", "coulomb_force")
BESIDE = (None, None, "quadratic_drag", "cubic_spring", "backlash")
#: Records of each group where something else than the rig differs.
REPEATS = 4


@dataclass(frozen=True)
class Pair:
    """What is drawn: a seed, the parameter that differs and by which part, or what else differs."""

    seed: int
    changed: str = ""
    by: float = 0.0
    rival: str = ""


def draw(pairs: int, rivals: int, seed: int) -> list[Pair]:
    """Pairs that differ, as many that do not, and those that differ in something else."""
    lots, found = np.random.default_rng(seed), []
    for number in range(pairs):
        size = float(lots.uniform(0.01, 0.10) * lots.choice((-1.0, 1.0)))
        found.append(Pair(seed + number, CHANGED[number % len(CHANGED)], size))
    found += [Pair(seed + 10_000 + number) for number in range(pairs)]
    what = ("amplitude", "temperature", "load")
    return found + [Pair(seed + 20_000 + number, rival=what[number % 3]) for number in range(rivals)]


def run(pair: Pair) -> dict[str, Any]:
    """Simulate, diagnose and compare one pair."""
    try:
        found = _rivals(pair) if pair.rival else _two(pair)
    except MsdError as error:
        return {**vars(pair), "error": str(error)}
    told = {one.parameter: one.kind for one in found.differences}
    half = {one.parameter: max(wide for _, wide in one.percent.values()) for one in found.differences}
    tied = {one.parameter: one.tied_with for one in found.differences if one.tied_with}
    return {**vars(pair), "kinds": told, "half": half, "tied": tied, "sentence": found.sentence}


def _two(pair: Pair) -> Comparison:
    spec = _spec(pair.seed, BESIDE[pair.seed % len(BESIDE)])
    other = _changed(spec, pair.changed, pair.by)
    records = [_record({**spec, "seed": 2 * pair.seed}, "A"), _record({**other, "seed": 2 * pair.seed + 1}, "B")]
    return compare([_measured(one, one.name, {}) for one in records], "robot")


def _rivals(pair: Pair) -> Comparison:
    lots, measured = np.random.default_rng(pair.seed), []
    spec = _spec(pair.seed, "cubic_spring" if pair.rival == "amplitude" else None)
    for number in range(2 * REPEATS):
        group, beside, own = "AB"[number % 2], {}, dict(spec)
        if pair.rival == "amplitude":
            own = _pushed(spec, 0.5 if group == "B" else 1.0)
        elif pair.rival == "temperature":
            beside["temperature"] = 20.0 + 6.0 * (group == "B") + 4.0 * float(lots.normal())
            own["stiffness"] *= 1.0 - 0.002 * (beside["temperature"] - 20.0)
        else:
            beside["load"] = (1.0 + 0.5 * (group == "B")) * float(np.exp(0.2 * lots.normal()))
            own["damping"] *= 1.0 + 0.05 * np.log(beside["load"])
        record = _record({**own, "seed": 100 * pair.seed + number}, group)
        measured.append(_measured(record, group, beside))
    return compare(measured, "robot")


def _spec(seed: int, hidden: str | None) -> dict[str, Any]:
    found = lottery.draw(seed, hidden, True, "steps", 1000.0)
    return dict(found.spec)


def _changed(spec: Mapping[str, Any], name: str, by: float) -> dict[str, Any]:
    found = {**spec, "effects": {key: dict(values) for key, values in spec["effects"].items()}}
    if name == "coulomb_force":
        for effect in found["effects"].values():
            if name in effect:
                effect[name] *= 1.0 + by
    elif name:
        found[name] *= 1.0 + by
    return found


def _pushed(spec: Mapping[str, Any], part: float) -> dict[str, Any]:
    experiment = dict(spec["experiment"])
    return {**spec, "experiment": {**experiment, "force": part * experiment["force"]}}


def _record(spec: Mapping[str, Any], name: str) -> Record:
    made = api.simulate(spec)
    place = np.searchsorted(made.force_time, made.time + 1e-9, side="right") - 1
    force = np.where(place < 0, 0.0, made.force[np.maximum(place, 0)])
    return from_samples(made.time, force, made.position, name=name)


def _measured(record: Record, group: str, beside: Mapping[str, float]) -> Measured:
    found = pipeline.diagnose([record])
    values = {name: quantity.value for name, quantity in found.extended.quantities.items()}
    causes = tuple(cause.name for cause in found.causes if cause.probability > 0.5)
    fixed = tuple(name for name in values if name not in found.extended.free)
    force = float(np.max(np.abs(record.force_at(record.time))))
    return Measured(record.name, group, record, causes, values, fixed, {**beside, "amplitude": force})


def score(found: list[dict[str, Any]]) -> dict[str, Any]:
    """The figures."""
    good = [one for one in found if "error" not in one]
    differ = [one for one in good if one["changed"] and one["changed"] in one["kinds"]]
    seen = [one for one in differ if 100.0 * abs(one["by"]) > 3.0 * one["half"][one["changed"]]]
    named = [one for one in seen if _named(one) == {one["changed"]}]
    same = [one for one in good if not one["changed"] and not one["rival"]]
    rivals = [one for one in good if one["rival"]]
    as_such = [one for one in rivals if _as_such(one)]
    tied = [one for one in rivals if not _named(one) and not _as_such(one)]
    return {
        "pairs that differ": len(differ),
        "… by more than three of their intervals": len(seen),
        "named [%]": 100.0 * len(named) / max(len(seen), 1),
        "with a further parameter": sum(len(_named(one)) > 1 for one in seen),
        "pairs that do not": len(same),
        "false change [%]": 100.0 * sum(bool(_named(one)) for one in same) / max(len(same), 1),
        "another amplitude, temperature or load": len(rivals),
        "named as such [%]": 100.0 * len(as_such) / max(len(rivals), 1),
        "called a tie": len(tied),
        "could not be compared": len(found) - len(good),
    }


def _named(one: Mapping[str, Any]) -> set[str]:
    return {name for name, kind in one["kinds"].items() if kind == "differs"}


def _as_such(one: Mapping[str, Any]) -> bool:
    """The covariate is named; another amplitude is taken in by the law that depends on it, so that nothing differs."""
    if _named(one):
        return False
    if one["rival"] == "amplitude":
        return set(one["kinds"].values()) <= {"shared", "explained"}
    return any(kind == "explained" and one["rival"] in one["tied"].get(name, ()) for name, kind in one["kinds"].items())


def main() -> None:
    """Run the pairs on all cores and print the figures; pairs that went wrong, each on a line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", type=int, default=20, help="that differ, and as many that do not")
    parser.add_argument("--rivals", type=int, default=12)
    parser.add_argument("--seed", type=int, default=500)
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()
    with ProcessPoolExecutor(given.jobs) as pool:
        found = list(pool.map(run, draw(given.pairs, given.rivals, given.seed)))
    for one in found:
        if "error" in one or (one["rival"] and not _as_such(one)) or (not one["rival"] and _wrong(one)):
            print(json.dumps(one, ensure_ascii=False))
    print(json.dumps(score(found), ensure_ascii=False, indent=1))


def _wrong(one: Mapping[str, Any]) -> bool:
    wanted = {one["changed"]} if one["changed"] else set()
    return _named(one) != wanted


if __name__ == "__main__":
    main()
