"""``msd design``: the next experiment, from what was measured and what the rig may be put through."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from msd_ident.cli import groups, options, progress, results
from msd_ident.errors import UsageError

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.design import Limits, Proposal
    from msd_ident.design.parameter_design import Sharpened
    from msd_ident.diagnosis import Diagnosis

#: Endings of ``--figure``.
PICTURES = (".png", ".svg", ".pdf")

TargetsOption = Annotated[
    str,
    options.model_option(
        "--for", metavar="NAME,…", help="design for narrower intervals of these parameters, e.g. mass,damping"
    ),
]
CheckOption = Annotated[
    bool, options.model_option("--check", help="look for causes that this data could not show, even if none are tied")
]
OutOption = Annotated[
    Path | None, options.output_option("--out", metavar="FILE", help="profile to write: .yaml or .csv")
]
FigureOption = Annotated[
    Path | None,
    options.output_option(
        "--figure", metavar="FILE", help=f"picture of the rivals' predictions ({', '.join(PICTURES)})"
    ),
]


@groups.grouped("json", "quiet", "overwrite")
def design(
    paths: options.PathsArgument,
    source: groups.Source,
    limits: options.LimitsOption = None,
    targets: TargetsOption = "",
    check: CheckOption = False,
    out: OutOption = None,
    figure: FigureOption = None,
    model: options.ModelOption = "auto",
    *,
    output: results.Output,
) -> int:
    """Design the shortest experiment that decides between tied causes. All paths are records of one rig."""
    from msd_ident.design import profile_file
    from msd_ident.diagnosis import same_plant
    from msd_ident.io import read_all
    from msd_ident.workflow import pipeline

    if targets and check:
        raise UsageError("--check and --for were given; expected one of the two: to look for causes, or for intervals")
    if targets and figure is not None:
        raise UsageError("--figure with --for; expected it without: it shows what rivals predict, and --for has none")
    output.check(*paths, *filter(None, (limits,)), written=[path for path in (out, figure) if path is not None])
    results.check_targets(output.overwrite, out, figure)
    if out is not None:
        profile_file.check_name(out)
    if figure is not None and figure.suffix.lower() not in PICTURES:
        raise UsageError(f"{figure} is no picture's name; expected one that ends in {', '.join(PICTURES)}")
    allowed = options.limits_of(limits)
    with progress.stages(output.quiet) as report:
        records: Sequence[Record] = [record for path in paths for record in read_all(path, source)]
        diagnosis = pipeline.diagnose(
            records, pipeline.Options(model=model), lambda stage, part, cause: report(f"{stage} {cause}", 0.9 * part)
        )
        same_plant.check(diagnosis)
        report("designing", 0.95)
        found = _designed(diagnosis, allowed, targets, check)
    made = Found(found, diagnosis, allowed, " + ".join(str(path) for path in paths))
    _write(made, output, out, figure)
    return 0


def _designed(diagnosis: Diagnosis, limits: Limits, targets: str, check: bool) -> Proposal | Sharpened | None:
    from msd_ident import design as designs
    from msd_ident.design.parameter_design import sharpen

    designs.check_predictable(diagnosis)
    if targets:
        return sharpen(diagnosis, [name.strip() for name in targets.split(",") if name.strip()], limits)
    return designs.check(diagnosis, limits) if check else designs.design(diagnosis, limits)


@dataclass(frozen=True)
class Found:
    """A designed experiment, ``None`` where none is needed, for a diagnosis within limits; ``name`` of the records."""

    experiment: Proposal | Sharpened | None
    diagnosis: Diagnosis
    limits: Limits
    name: str


def _write(made: Found, output: results.Output, out: Path | None, figure: Path | None) -> None:
    from msd_ident.design import Proposal, write_profile
    from msd_ident.report import design_figures, design_tables

    found, diagnosis = made.experiment, made.diagnosis
    line = {
        "schema": "msd.design/1", "path": made.name, "verdict": diagnosis.verdict,
        "limits": made.limits.to_dict(), "next_experiment": None if found is None else found.to_json_dict(),
    }  # fmt: skip
    results.write([line], output)
    console = results.console()
    if output.tables:
        design_tables.print_design(found, diagnosis, console)
    if found is None:
        return
    if out is not None:
        write_profile(found.profile, out, (found.sentence,))
        if output.tables:
            console.print(f"profile: {out}", soft_wrap=True)
    if figure is not None and isinstance(found, Proposal):
        design_figures.save(found, figure)
        if output.tables:
            console.print(f"picture: {figure}", soft_wrap=True)
