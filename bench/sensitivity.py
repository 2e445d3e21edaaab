"""``python -m bench.sensitivity``: halve and double each tuned constant, and diagnose the same blind cases again.

python -m bench.sensitivity [--cases 24] [--seed 870000] [--jobs 2] [--only NAME,…] [--out out/sensitivity.jsonl]
                            [--docs DIR]

Each run is a process of its own, in which one constant has another value from the start: what follows from it follows
too. A run is one line of the file; runs that the file has already are not done again. For a part between a half and 1,
its distance from 1 is halved and doubled (0.9 becomes 0.95 and 0.8); a ``factor`` becomes its root and its square.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from pathlib import Path
from types import CodeType
from typing import Any

from msd_ident import parallel, tuning

parallel.one_blas_thread()  # as the `msd` command does, before numpy is imported

#: Subpackages in the order of their runs: those first that decide about causes.
FIRST = ("selection", "residuals", "estimate", "diagnosis", "design")
#: Where the table stands in ``docs/tuning.md``.
BEGIN, END = "<!-- sensitivity: begin -->", "<!-- sensitivity: end -->"
#: What a run does with a constant.
SIDES = ("half", "double")
Value = float | int | tuple[Any, ...]


def moved(value: Value, unit: str, side: str) -> Value:
    """A constant's value halved or doubled."""
    if isinstance(value, tuple):
        return tuple(moved(one, "", side) for one in value)
    double = side == "double"
    if isinstance(value, int):
        return max(2 * value if double else round(value / 2), 1)
    if unit == "factor":
        return value**2.0 if double else value**0.5
    if unit == "1" and 0.5 < value < 1.0:
        return 1.0 - (1.0 - value) * (2.0 if double else 0.5)
    return value * (2.0 if double else 0.5)


class _Changing(SourceFileLoader):
    """Loads one module with another value in one of its declarations."""

    name_of_constant, value = "", "0"

    def source_to_code(self, data: Any, path: Any = "", *, _optimize: int = -1) -> CodeType:  # type: ignore[override]
        tree = ast.parse(data, path)
        for name, call in tuning.declarations(tree):
            if name == self.name_of_constant:
                call.args[0] = ast.copy_location(ast.parse(self.value, mode="eval").body, call.args[0])
        return compile(ast.fix_missing_locations(tree), path, "exec", optimize=_optimize)

    def get_code(self, fullname: str) -> CodeType:
        return self.source_to_code(self.get_data(self.path), self.path)  # never from a cache


class _Changed(MetaPathFinder):
    """Finds one module, for ``_Changing``."""

    def __init__(self, module: str, name: str, value: str) -> None:
        self.module, self.name, self.value = module, name, value

    def find_spec(self, fullname: str, path: Any = None, target: Any = None) -> ModuleSpec | None:
        if fullname != self.module:
            return None
        spec = PathFinder.find_spec(fullname, path)
        assert spec is not None and spec.origin is not None
        loader = _Changing(fullname, spec.origin)
        loader.name_of_constant, loader.value = self.name, self.value
        spec.loader = loader
        return spec


def run(place: str, side: str, count: int, seed: int) -> dict[str, Any]:
    """Diagnose the cases with one constant moved; with none for the place ``""``."""
    text = ""
    if place:
        one = next(one for one in tuning.declared() if one.place == place and one.is_tuned)
        text = repr(moved(ast.literal_eval(one.text), one.about["unit"], side))
        sys.meta_path.insert(0, _Changed(one.module, one.name, text))
    from bench.blind import cases, score

    began, found, failed = time.process_time(), [], []
    for case in chosen(count, seed):
        try:
            found.append(cases.run(case))
        except Exception as error:  # noqa: BLE001  a value at which nothing works is a finding too
            failed.append(f"{case.seed}: {error!r}"[:200])
    foreign = [one for one in found if one.case.kind == "variant"]
    seen = [one for one in found if not one.odd and one.without_floors >= score.VISIBLE and one.case.hidden]
    clean = [one for one in found if one.case.hidden is None]
    return {
        "place": place, "side": side, "value": text, "cases": count, "seed": seed,
        "exact": sum(one.exact for one in seen), "visible": len(seen),
        "family": sum(map(score.family_named, foreign)), "foreign": len(foreign),
        "adequate": sum(one.verdict == "adequate" for one in clean), "clean": len(clean),
        "false": sum(score.surely_false(one) for one in found), "failed": failed,
        "seconds": sum(one.processor_seconds for one in found), "whole": time.process_time() - began,
        "said": [[one.case.seed, one.verdict, sorted(one.names)] for one in found],
    }  # fmt: skip


def chosen(count: int, seed: int) -> list[Any]:
    """Two thirds of the cases from one round of the blind study: steps of two amplitudes, 1 kHz, white noise. One third
    are rigs of laws that the library does not have. Both evenly spaced over their study.
    """
    from bench.blind import plan

    own = [
        case
        for case in plan.study(1, seed)
        if case.experiment == "steps" and case.rate == 1000.0 and case.noise == "white" and case.kind != "odd"
    ]
    return [*_spaced(own, count - count // 3), *_spaced(plan.variants(1, seed + len(own)), count // 3)]


def _spaced(cases: Sequence[Any], count: int) -> list[Any]:
    return [cases[i * len(cases) // count] for i in range(min(count, len(cases)))]


def wanted(only: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Place and side of each run, the untouched one first."""
    yield "", "as it is"
    for one in sorted(tuning.declared(), key=lambda one: FIRST.index(one.module.split(".")[1])):
        if one.is_tuned and (not only or one.name in only or one.place in only):
            yield from ((one.place, side) for side in SIDES)


def table(runs: Sequence[dict[str, Any]]) -> str:
    """The runs as a table: what each constant moves, compared with the untouched run."""
    base = next((one for one in runs if not one["place"]), None)
    if base is None:
        return ""
    by = {(one["place"], one["side"]): one for one in runs if same(one, base)}
    exact, false = f"{base['exact']} of {base['visible']}", base["false"]
    lines = [
        f"{base['cases']} cases, seed {base['seed']}. As they are, the constants give {exact} exact sets, the family "
        f"of {base['family']} of {base['foreign']} foreign laws is named, {base['adequate']} of {base['clean']} rigs "
        f"without a hidden effect are called adequate, {false} false causes have p > 0.9.",
        "",
        "| constant | value | halved: exact, family, adequate, false, changed, time | doubled: the same |",
        "|---|---|---|---|",
    ]
    for one in tuning.declared():
        cells = [_cell(by.get((one.place, side)), base) for side in SIDES]
        if one.is_tuned and any(cells):
            lines.append(f"| `{one.place}` | {one.text} | {cells[0] or 'not run'} | {cells[1] or 'not run'} |")
    return "\n".join(lines) + "\n"


def _cell(found: dict[str, Any] | None, base: dict[str, Any]) -> str:
    if found is None:
        return ""
    changed = sum(one not in base["said"] for one in found["said"])
    time_change = 100.0 * (found["seconds"] / base["seconds"] - 1.0)
    said = (
        f"{found['exact']}, {found['family']}, {found['adequate']}, {found['false']}, {changed}, {time_change:+.0f} %"
    )
    said = f"{said}; {len(found['failed'])} failed" if found["failed"] else said
    fewer = any(found[what] < base[what] for what in ("exact", "family", "adequate"))
    return f"**{said}**" if fewer or found["false"] > base["false"] or found["failed"] else said


def same(one: dict[str, Any], other: dict[str, Any]) -> bool:
    """Whether two runs are of the same cases."""
    return (one["cases"], one["seed"]) == (other["cases"], other["seed"])


def read(path: Path, count: int, seed: int) -> list[dict[str, Any]]:
    """The runs that a file has of these cases."""
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    return [one for one in map(json.loads, lines) if same(one, {"cases": count, "seed": seed})]


def _apart(count: int, seed: int, which: tuple[str, str]) -> subprocess.CompletedProcess[str]:
    """A run in a process of its own."""
    command = [sys.executable, "-m", "bench.sensitivity", "--one", *which]
    command += ["--cases", str(count), "--seed", str(seed)]
    return subprocess.run(command, capture_output=True, text=True, env=dict(os.environ))


def main() -> int:
    """Run what the file does not have, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=24)
    parser.add_argument("--seed", type=int, default=870_000)
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time")
    parser.add_argument("--only", default="", help="names of constants, with commas")
    parser.add_argument("--out", type=Path, default=Path("out/sensitivity.jsonl"))
    parser.add_argument("--docs", type=Path, help="write the table into tuning.md there")
    parser.add_argument("--one", nargs=2, metavar=("PLACE", "SIDE"), help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.one:
        print(json.dumps(run(*given.one, given.cases, given.seed)))
        return 0
    given.out.parent.mkdir(parents=True, exist_ok=True)
    made = {(one["place"], one["side"]) for one in read(given.out, given.cases, given.seed)}
    left = [one for one in wanted([name for name in given.only.split(",") if name]) if one not in made]
    with ThreadPoolExecutor(given.jobs) as pool:
        for (place, side), done in zip(left, pool.map(partial(_apart, given.cases, given.seed), left), strict=True):
            if done.returncode:
                print(f"{place} {side}: {done.stderr.strip().splitlines()[-1]}", file=sys.stderr)
                continue
            with given.out.open("a", encoding="utf-8") as file:
                file.write(done.stdout.strip().splitlines()[-1] + "\n")
    text = table(read(given.out, given.cases, given.seed))
    print(text)
    if given.docs:
        page = given.docs / "tuning.md"
        head, _, rest = page.read_text(encoding="utf-8").partition(BEGIN)
        page.write_text(f"{head}{BEGIN}\n{text}{END}{rest.partition(END)[2]}", encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
