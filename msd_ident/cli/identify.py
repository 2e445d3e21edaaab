"""``msd identify``: parameters with intervals from bags, MCAP files and CSV files."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Literal, cast

from msd_ident.cli import groups, options, results, solving
from msd_ident.cli.further import Further

if TYPE_CHECKING:
    from msd_ident.data.record import Record
    from msd_ident.workflow.identification import Identification
    from msd_ident.workflow.identify import Progress


LossOption = Annotated[str, options.model_option(help="linear, or soft_l1 for data with outliers")]
MassOption = Annotated[
    str,
    options.model_option(
        "--mass", metavar="KG[±STD]", help="known moving mass; a free decay then has results in newtons"
    ),
]
KnownOption = Annotated[
    list[str] | None,
    options.model_option(
        "--known", metavar="NAME=VALUE[±STD]", help="parameter that is known and not fitted; repeatable"
    ),
]


@groups.grouped("json", "report", "markdown", "figures", "quiet", "overwrite")
def identify(
    paths: options.PathsArgument,
    source: groups.Source,
    model: options.ModelOption = "auto",
    loss: LossOption = "linear",
    mass: MassOption = "",
    known: KnownOption = None,
    together: options.TogetherOption = False,
    on: options.OnOption = None,
    export: options.ExportOption = None,
    *,
    output: results.Output,
) -> int:
    """Estimate ωn, ζ and K, then mass, damping, stiffness and dry friction, each with its 95 % interval."""
    from msd_ident.report import tables
    from msd_ident.workflow import identify as identification
    from msd_ident.workflow.known_parameters import parse_all
    from msd_ident.workflow.options import Options

    settings = Options(model, cast(Literal["linear", "soft_l1"], loss), parse_all(known or (), mass))

    def solve(records: Sequence[Record], progress: Progress) -> Identification:
        return identification.identify(records, settings, progress)

    further = Further(on or (), export or (), source)
    data = solving.Data(paths, source, together)
    return solving.work(data, output, solve, tables.print_identification, further)[0]
