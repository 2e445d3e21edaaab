"""The diagnosis of records as a user asks for it: preparation, decision about the spring, search, warnings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from msd_ident.data.record import Record
from msd_ident.design import proposing
from msd_ident.diagnosis import Diagnosis, diagnose_records, same_plant
from msd_ident.errors import UsageError
from msd_ident.estimate import explained
from msd_ident.residuals import impulses
from msd_ident.residuals.ringdown import ring_down
from msd_ident.selection.structure_search import Progress
from msd_ident.workflow.options import Options
from msd_ident.workflow.preparation import Prepared, prepared, starting_plant
from msd_ident.workflow.spring_decision import has_spring, hidden_spring


def _silent(stage: str, fraction: float, cause: str) -> None:
    """Report to nobody."""


def diagnose(
    records: Sequence[Record],
    options: Options = Options(),  # noqa: B008 - frozen
    progress: Progress = _silent,
    earlier: Diagnosis | None = None,
) -> Diagnosis:
    """What mass, damping and stiffness get wrong about one experiment, and what repairs it.

    Args:
        records: of one plant.
        options: how.
        progress: called with the stage, the fraction done (0 to 1) and the cause being tried.
        earlier: of some of these records: its explanations are tried too, from where they stood.

    Raises:
        DataError, UsageError: as ``identify``.
    """
    if options.known:
        raise UsageError(
            "known parameters in a diagnosis; expected none, because it fits all parameters: use them in msd identify"
        )
    progress("looking at the data", 0.01, "")
    data = prepared(records)
    sprung, decided = has_spring(data.used, options, data.form)
    made = _diagnosed(data, options, (sprung, decided), progress, earlier)
    if decided and not sprung and (hidden := hidden_spring(made.extended, made.records)):
        made = _diagnosed(data, options, (True, (hidden,)), progress, earlier)
    whole = "mass, damping, stiffness and all causes of the library"
    explained.check(made.extended.residuals, made.records, whole, data.doubtful_units, diagnosed=True)
    progress("next experiment", 0.98, "")
    found = proposing(replace(made, turned=data.turned))
    if found.adequacy.material:
        said = [
            *impulses.sentences(found.records, found.extended, found.noise_floor),
            same_plant.warning(found.records),
        ]
        found = replace(found, warnings=(*found.warnings, *filter(None, said)))
    progress("done", 1.0, "")
    return found


def _diagnosed(
    data: Prepared,
    options: Options,
    spring: tuple[bool, tuple[str, ...]],
    progress: Progress,
    earlier: Diagnosis | None,
) -> Diagnosis:
    """The diagnosis with or without a spring, and why."""
    sprung, decided = spring
    return diagnose_records(
        data.used,
        sprung=sprung,
        plant=starting_plant(data.used, data.form),
        findings=data.findings,
        warnings=data.warnings + decided,
        ring_down=ring_down(data.features, data.used[0].position_unit),
        tolerance=options.tolerance,
        rests=data.rest_before,
        calibrate=options.calibrate,
        progress=progress,
        earlier=earlier,
    )
