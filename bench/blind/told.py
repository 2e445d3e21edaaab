"""Tables of the blind studies in Markdown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from bench.blind import score
from bench.blind.cases import Outcome

#: Of the tables of shares.
_HEAD = "| quantity | result | cases | required | goal |"
_STATEMENTS: Mapping[score.Statement, str] = {
    "cause": "The named cause acts",
    "cause or tied": "The named cause or one tied with it acts",
}


def report(outcomes: Sequence[Outcome]) -> list[str]:
    """All tables of the study."""
    return [
        *_figures(outcomes), "",
        *_experiments(outcomes), "",
        *_false(outcomes), "",
        *_reliability(outcomes), "",
        *_confusion(outcomes), "",
        *_smallest(outcomes), "",
        *_oddities(outcomes),
    ]  # fmt: skip


def variants(outcomes: Sequence[Outcome]) -> list[str]:
    """The table of laws that the library does not have; the last line is the sum. Then every case with an error."""
    lines = [
        f"| hidden law | cases | visible | visible and family named | false cause with p > {score.SURE:g} | "
        f"`explained` with a false cause | m and k within {100.0 * score.NEAR:g} % | m and k covered |",
        "|---|---|---|---|---|---|---|---|",
    ]
    found = score.variants(outcomes)
    cases = {name: sum(o.case.hidden == name for o in outcomes) for name in found}
    for name, row in found.items():
        lines.append(f"| {name} | {cases[name]} | " + " | ".join(map(str, row)) + " |")
    total = (sum(cases.values()), *(sum(column) for column in zip(*found.values(), strict=True)))
    return [*lines, "| all | " + " | ".join(map(str, total)) + " |", "", *failures(outcomes)] if found else []


def variant_pairs(outcomes: Sequence[Outcome]) -> list[str]:
    """The table of rigs with two laws that the library does not have, then every case with an error."""
    return [*_shares(score.variant_pairs(outcomes)), "", *failures(outcomes)]


def _shares(figures: Sequence[score.Figure]) -> list[str]:
    """A table of shares."""
    cells = [(f.what, f"{f.percent:.1f} %", f"{f.good} of {f.total}", f.must, f.aim) for f in figures]
    return [_HEAD, "|---|---|---|---|---|", *(f"| {' | '.join(row)} |" for row in cells)]


def second_author(outcomes: Sequence[Outcome]) -> list[str]:
    """The tables of MuJoCo's rigs: figures, kinds, failures."""
    lines = _shares(score.second_author(outcomes))
    lines += [
        "",
        f"| hidden faults | rigs | visible, or none hidden | of these exact | false cause with p > {score.SURE:g} | "
        f"m and k within {100.0 * score.NEAR:g} % |",
        "|---|---|---|---|---|---|",
    ]
    for hidden, kind in sorted({(str(o.case.hidden), o.case.kind) for o in outcomes}):
        chosen = [o for o in outcomes if (str(o.case.hidden), o.case.kind) == (hidden, kind)]
        seen = [o for o in chosen if o.case.hidden is None or o.without_floors >= score.VISIBLE]
        near = sum(o.plant_error <= score.NEAR for o in chosen)
        name = {"clean": "none", "beside": f"{hidden} and frictionloss"}.get(kind, hidden)
        cells = (name, len(chosen), len(seen), sum(o.exact for o in seen), sum(map(score.surely_false, chosen)), near)
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return [*lines, "", *failures(outcomes)]


def several_faults(outcomes: Sequence[Outcome]) -> list[str]:
    """The tables of rigs with several faults at once: figures, each fault, each rig."""
    lines = _shares(score.several_faults(outcomes))
    lines += [
        "",
        f"| fault | rigs | plain ({score.PLAIN:g} noise floors) | of these named | named |",
        "|---|---|---|---|---|",
    ]
    for fault in sorted({name for o in outcomes for name in o.truth}):
        having = [o for o in outcomes if fault in o.truth]
        plain = [o for o in having if o.strength[fault] >= score.PLAIN]
        cells = (fault, len(having), len(plain), sum(o.counts_as(fault) for o in plain))
        lines.append(f"| {' | '.join(map(str, cells))} | {sum(o.counts_as(fault) for o in having)} |")
    return [*lines, "", *failures(outcomes)]


def failures(outcomes: Sequence[Outcome]) -> list[str]:
    """Every case with an error, with its seed."""
    wrong = [(o, score.failed(o)) for o in outcomes if score.failed(o)]
    if not wrong:
        return ["No case has an error."]
    lines = [
        "| seed | experiment | true causes | named causes with p (~ tied with) | verdict [noise floors left by the "
        "extended, base model] | error |",
        "|---|---|---|---|---|---|",
    ]
    for o, why in wrong:
        said = ", ".join(f"{name} {p:.3f}" + (f" ~ {'/'.join(t)}" if t else "") for name, p, t, _ in o.named) or "none"
        rig = " + ".join(o.truth) or "none"
        floors = f"{o.verdict} [{o.extended_floors:.2f}, {o.base_floors:.1f}]"
        lines.append(f"| {o.case.seed} | {o.case.experiment} | {rig} | {said} | {floors} | {'; '.join(why)} |")
    return lines


def _figures(outcomes: Sequence[Outcome]) -> list[str]:
    lines = _shares(score.figures(outcomes))
    main = score.visible(score.main_experiment(outcomes))
    seconds = [o.seconds for o in score.main_experiment(outcomes)] or [float("nan")]
    processor = [o.processor_seconds for o in score.main_experiment(outcomes)] or [float("nan")]
    lines += [
        "| SEE on left-out data divided by the noise, visible cases with an exact set, median | "
        f"{score.heldout(outcomes):.3f} | | <= 1.2 | 1.05 |",
        "| calibration: largest difference of stated probability and share that acts, bins with at least "
        f"{score.POPULATED} causes, all cases | {score.miscalibration(outcomes):.3f} | | <= 0.05 | 0.03 |",
        _by_chance(outcomes),
        f"| the same, only visible effects in steps at 1 kHz | {score.miscalibration(main):.3f} | | | |",
        _by_chance(main),
        "| error above the noise on left-out data: part that the extended model removes, median | "
        f"{100.0 * score.removed(outcomes):.1f} % | | | |",
        f"| duration of a diagnosis [s], median | {np.median(seconds):.2f} | {len(seconds)} | <= 2 | 0.5 |",
        f"| duration of a diagnosis [s], longest | {max(seconds):.2f} | {len(seconds)} | | |",
        f"| processor time of a diagnosis [s], median | {np.median(processor):.2f} | {len(processor)} | | |",
        f"| processor time of a diagnosis [s], longest | {max(processor):.2f} | {len(processor)} | | |",
    ]
    return lines


def _by_chance(outcomes: Sequence[Outcome]) -> str:
    """How far a bin is off although every stated probability is right: the causes in it are few."""
    median, most = score.by_chance(outcomes)
    what = "of it by chance, if every stated probability were right: median (95 % below)"
    return f"| {what} | {median:.3f} ({most:.3f}) | | | |"


def _experiments(outcomes: Sequence[Outcome]) -> list[str]:
    """What each experiment shows of visible effects, and what is named falsely, seen or not."""
    lines = [
        f"| experiment | visible | visible and exact | not visible | all cases | false cause with p > {score.SURE:g} | "
        "no hidden effect: a false cause named |",
        "|---|---|---|---|---|---|---|",
    ]
    for experiment, rate in sorted({(o.case.experiment, o.case.rate) for o in outcomes}):
        chosen = [o for o in score.kinds(outcomes, experiment) if o.case.rate == rate]
        seen, clean = score.visible(chosen), [o for o in chosen if o.case.hidden is None]
        lines.append(
            f"| {experiment}, {rate:g} Hz | {len(seen)} | {sum(o.exact for o in seen)} | "
            f"{len(chosen) - len(seen) - len(clean)} | {len(chosen)} | {sum(map(score.surely_false, chosen))} | "
            f"{sum(bool(o.false) for o in clean)} of {len(clean)} |"
        )
    return lines


def _false(outcomes: Sequence[Outcome]) -> list[str]:
    """Every case in which a cause that is not in the rig is stated as certain."""
    wrong = [o for o in outcomes if not o.odd and score.surely_false(o)]
    if not wrong:
        return [f"No false cause is named with p > {score.SURE:g}."]
    lines = ["| seed | experiment | noise | true causes | false causes with p | verdict |", "|---|---|---|---|---|---|"]
    for o in wrong:
        names = ", ".join(f"{name} {p:.3f}" for name, p in o.false)
        rig = " + ".join(o.truth) or "none"
        lines.append(f"| {o.case.seed} | {o.case.experiment} | {o.case.noise} | {rig} | {names} | {o.verdict} |")
    return lines


def _reliability(outcomes: Sequence[Outcome]) -> list[str]:
    """Of the figures' own cases, and of all experiments and sizes together, where more is open."""
    main = score.visible(score.main_experiment(outcomes))
    return [
        "Calibration over all cases without an unknown law:", "", *_bins(score.reliability(outcomes)), "",
        "Calibration over visible effects, steps at 1 kHz:", "", *_bins(score.reliability(main)),
    ]  # fmt: skip


def calibration(outcomes: Sequence[Outcome]) -> list[str]:
    """Named causes of all studies together, then of each rig's author: stated probability and share that is right.

    First of each named cause, then of it or what is tied with it.
    """
    authors = {
        "All rigs": outcomes,
        "Simulated rigs with laws of the library": [o for o in outcomes if o.case.author == "own" and not o.odd],
        "Simulated rigs with other laws": [o for o in outcomes if o.case.author == "foreign" or o.odd],
        "MuJoCo's rigs": [o for o in outcomes if o.case.author == "mujoco"],
        "Rigs with several faults": [o for o in outcomes if o.case.author == "several"],
    }
    lines: list[str] = []
    for of, statement in _STATEMENTS.items():
        lines += [f"## {statement}", ""]
        for name, chosen in authors.items():
            if chosen:
                lines += _calibrated(name, chosen, of)
    return lines[:-1]


def _calibrated(name: str, outcomes: Sequence[Outcome], of: score.Statement) -> list[str]:
    median, most = score.named_by_chance(outcomes, of)
    bins = score.named_reliability(outcomes, of)
    gap = f"largest difference {score.largest_gap(bins):.3f} in bins with at least {score.POPULATED} causes"
    chance = f"by chance {median:.3f} (95 % below {most:.3f}) if every stated probability were right"
    return [f"{name}, {len(outcomes)} cases: {gap}; {chance}.", "", *_bins(bins, "share that is right"), ""]


def _bins(bins: Sequence[score.Bin], share: str = "share that acts") -> list[str]:
    lines = [f"| stated probability | causes | mean stated | {share} | 95 % interval |", "|---|---|---|---|---|"]
    for b in bins:
        low, high = b.range
        shares = f"{b.stated:.3f} | {b.observed:.3f} | {low:.2f} to {high:.2f}"
        lines.append(f"| {b.low:.2f} to {b.high:.2f} | {b.count} | {shares} |")
    return lines


def _confusion(outcomes: Sequence[Outcome]) -> list[str]:
    lines = ["| visible hidden effect | named in its place (cases) |", "|---|---|"]
    for name, answers in sorted(score.confusion(outcomes).items()):
        lines.append(f"| {name} | {', '.join(f'{answer} ({n})' for answer, n in answers.most_common())} |")
    return lines


def _smallest(outcomes: Sequence[Outcome]) -> list[str]:
    lines = [
        "| effect | named in every case from this visibility on [noise floors]; inf: not in the most visible case |",
        "|---|---|",
    ]
    return lines + [f"| {name} | {size:.1f} |" for name, size in score.smallest(outcomes).items()]


def _oddities(outcomes: Sequence[Outcome]) -> list[str]:
    lines = ["| unknown law, visible | verdict: named causes (cases) |", "|---|---|"]
    for name, answers in sorted(score.oddities(outcomes).items()):
        lines.append(f"| {name} | {'; '.join(f'{answer} ({n})' for answer, n in answers.most_common())} |")
    return lines
