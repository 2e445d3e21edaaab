"""The study in words: tables in Markdown."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bench.blind import score
from bench.blind.cases import Outcome


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
    """The table of laws that the library does not have; the last line is the sum. Then what failed."""
    lines = [
        f"| law | cases | visible | family named | a cause of no related law with p > {score.SURE:g} | explained with "
        f"one | m and k within {100.0 * score.NEAR:g} % | of the interval or the range stated |",
        "|---|---|---|---|---|---|---|---|",
    ]
    found = score.variants(outcomes)
    cases = {name: sum(o.case.hidden == name for o in outcomes) for name in found}
    for name, row in found.items():
        lines.append(f"| {name} | {cases[name]} | " + " | ".join(map(str, row)) + " |")
    total = (sum(cases.values()), *(sum(column) for column in zip(*found.values(), strict=True)))
    return [*lines, "| all | " + " | ".join(map(str, total)) + " |", "", *failures(outcomes)] if found else []


def second_author(outcomes: Sequence[Outcome]) -> list[str]:
    """The tables of MuJoCo's rigs: figures, kinds, failures."""
    lines = ["| figure | got | of | must | aim |", "|---|---|---|---|---|"]
    for item in score.second_author(outcomes):
        lines.append(f"| {item.what} | {item.percent:.1f} % | {item.good} of {item.total} | {item.must} | {item.aim} |")
    lines += ["", "| in the rig | rigs | visible | exact, of these | surely false | m and k near |"]
    lines.append("|---|---|---|---|---|---|")
    for hidden, kind in sorted({(str(o.case.hidden), o.case.kind) for o in outcomes}):
        chosen = [o for o in outcomes if (str(o.case.hidden), o.case.kind) == (hidden, kind)]
        seen = [o for o in chosen if o.case.hidden is None or o.without_floors >= score.VISIBLE]
        near = sum(o.plant_error <= score.NEAR for o in chosen)
        name = {"clean": "nothing", "beside": f"{hidden} and frictionloss"}.get(kind, hidden)
        cells = (name, len(chosen), len(seen), sum(o.exact for o in seen), sum(map(score.surely_false, chosen)), near)
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return [*lines, "", *failures(outcomes)]


def failures(outcomes: Sequence[Outcome]) -> list[str]:
    """Every case that is not right, with its seed."""
    wrong = [(o, score.failed(o)) for o in outcomes if score.failed(o)]
    if not wrong:
        return ["Nothing failed."]
    lines = ["| seed | experiment | in the rig | said | verdict | wrong |", "|---|---|---|---|---|---|"]
    for o, why in wrong:
        said = ", ".join(f"{name} {p:.3f}" + (f" ~ {'/'.join(t)}" if t else "") for name, p, t in o.named) or "nothing"
        rig = " + ".join(o.truth) or "nothing"
        floors = f"{o.verdict} [{o.extended_floors:.2f} of {o.base_floors:.1f} floors]"
        lines.append(f"| {o.case.seed} | {o.case.experiment} | {rig} | {said} | {floors} | {'; '.join(why)} |")
    return lines


def _figures(outcomes: Sequence[Outcome]) -> list[str]:
    lines = ["| figure | got | of | must | aim |", "|---|---|---|---|---|"]
    for item in score.figures(outcomes):
        lines.append(f"| {item.what} | {item.percent:.1f} % | {item.good} of {item.total} | {item.must} | {item.aim} |")
    main = score.visible(score.main_experiment(outcomes))
    seconds = [o.seconds for o in score.main_experiment(outcomes)] or [float("nan")]
    processor = [o.processor_seconds for o in score.main_experiment(outcomes)] or [float("nan")]
    lines += [
        f"| held-out SEE over noise, median when right | {score.heldout(outcomes):.3f} | | <= 1.2 | 1.05 |",
        f"| largest difference of a stated probability from what was observed, bins of {score.POPULATED} causes and "
        f"more, all experiments | {score.miscalibration(outcomes):.3f} | | <= 0.05 | 0.03 |",
        f"| the same, visible effects in steps at 1 kHz | {score.miscalibration(main):.3f} | | | |",
        f"| removable error removed, median | {100.0 * score.removed(outcomes):.1f} % | | | |",
        f"| seconds a diagnosis, median | {np.median(seconds):.2f} | {len(seconds)} | <= 2 | 0.5 |",
        f"| seconds a diagnosis, longest | {max(seconds):.2f} | {len(seconds)} | | |",
        f"| seconds of processor time, median | {np.median(processor):.2f} | {len(processor)} | | |",
        f"| seconds of processor time, longest | {max(processor):.2f} | {len(processor)} | | |",
    ]
    return lines


def _experiments(outcomes: Sequence[Outcome]) -> list[str]:
    """What each experiment shows of visible effects, and what is named falsely, seen or not."""
    lines = [
        f"| experiment | visible | exact | invisible | all | a false cause with p > {score.SURE:g} | clean: named |",
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
        return [f"No cause that is not in the rig is named with p > {score.SURE:g}."]
    lines = ["| seed | experiment | noise | in the rig | named falsely | verdict |", "|---|---|---|---|---|---|"]
    for o in wrong:
        names = ", ".join(f"{name} {p:.3f}" for name, p in o.false)
        rig = " + ".join(o.truth) or "nothing"
        lines.append(f"| {o.case.seed} | {o.case.experiment} | {o.case.noise} | {rig} | {names} | {o.verdict} |")
    return lines


def _reliability(outcomes: Sequence[Outcome]) -> list[str]:
    """Of the figures' own cases, and of all experiments and sizes together, where more is open."""
    main = score.visible(score.main_experiment(outcomes))
    return [
        "All experiments and verdicts, visible or not, and nothing hidden:", "", *_bins(outcomes), "",
        "Visible effects, two amplitudes in both directions, 1 kHz:", "", *_bins(main),
    ]  # fmt: skip


def _bins(outcomes: Sequence[Outcome]) -> list[str]:
    lines = ["| stated probability | causes | mean stated | observed | 95 % range |", "|---|---|---|---|---|"]
    for b in score.reliability(outcomes):
        low, high = b.range
        shares = f"{b.stated:.3f} | {b.observed:.3f} | {low:.2f} to {high:.2f}"
        lines.append(f"| {b.low:.2f} to {b.high:.2f} | {b.count} | {shares} |")
    return lines


def _confusion(outcomes: Sequence[Outcome]) -> list[str]:
    lines = ["| hidden and visible | named as (number) |", "|---|---|"]
    for name, answers in sorted(score.confusion(outcomes).items()):
        lines.append(f"| {name} | {', '.join(f'{answer} ({n})' for answer, n in answers.most_common())} |")
    return lines


def _smallest(outcomes: Sequence[Outcome]) -> list[str]:
    lines = ["| effect | always found from (noise floors left without it) |", "|---|---|"]
    return lines + [f"| {name} | {size:.1f} |" for name, size in score.smallest(outcomes).items()]


def _oddities(outcomes: Sequence[Outcome]) -> list[str]:
    lines = ["| oddity, not in the library | verdict: causes (number) |", "|---|---|"]
    for name, answers in sorted(score.oddities(outcomes).items()):
        lines.append(f"| {name} | {'; '.join(f'{answer} ({n})' for answer, n in answers.most_common())} |")
    return lines
