"""The HTML page: all sections of all results in one file that needs no network."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any

from msd_ident.data.provenance import versions
from msd_ident.diagnosis import Diagnosis
from msd_ident.export import Export
from msd_ident.external import Comparison
from msd_ident.model.effects import structural
from msd_ident.model.effects.base import DELAY
from msd_ident.report.plots import Detail, ModelCurve, diagnosis_curves, identification_curves
from msd_ident.report.sections.calibration import Calibration
from msd_ident.report.sections.causes import Causes
from msd_ident.report.sections.comparison import Differences, LackingForce, Outcome, comparison_columns
from msd_ident.report.sections.data import Data
from msd_ident.report.sections.export import Effects, Exported
from msd_ident.report.sections.fit import Fit
from msd_ident.report.sections.missing_force import MissingForce
from msd_ident.report.sections.next_experiment import NextExperiment
from msd_ident.report.sections.parameters import (
    Column,
    Parameters,
    StandardForm,
    diagnosis_columns,
    identification_columns,
)
from msd_ident.report.sections.section import Section
from msd_ident.report.sections.trial import Trial
from msd_ident.report.sections.verdict import DiagnosisVerdict, IdentificationVerdict
from msd_ident.workflow.validation import Validation
from msd_ident.writing import write_text

if TYPE_CHECKING:
    from jinja2 import Environment

    from msd_ident.data.provenance import Provenance
    from msd_ident.quantity import Quantity
    from msd_ident.report.plot import Plot
    from msd_ident.workflow.identification import Identification

    #: What a page has an article about.
    Result = Diagnosis | Identification | Validation | Export | Comparison

#: A page is not larger than this, however many records it is about [bytes].
LARGEST = 6_000_000


@dataclass(frozen=True)
class Article:
    """One result: what made it, the records' names, its sections in order."""

    command: str
    name: str
    sections: tuple[Section, ...]

    @property
    def verdict(self) -> str:
        """For the colour of its pill."""
        return str(self.sections[0].context()["verdict"])

    @property
    def pill(self) -> str:
        """The verdict in a few words."""
        return str(self.sections[0].context()["pill"])

    @property
    def plots(self) -> tuple[Plot, ...]:
        """All plots of all sections."""
        return tuple(plot for section in self.sections for plot in section.plots)


def of_diagnosis(found: Diagnosis, provenance: Provenance | None = None, detail: Detail | None = None) -> Article:
    """The sections of a diagnosis."""
    detail = detail or Detail.shared_by(len(found.records))
    sections: list[Section] = [
        DiagnosisVerdict(found),
        Fit(found.records, diagnosis_curves(found), found.noise_floor, detail),
        MissingForce(found, found.records, detail),
        Causes(found),
        Parameters(found.records, diagnosis_columns(found), found.extended.open_directions, found.spread),
        Data(found.records, found.findings, provenance, _delay(found)),
    ]
    if found.calibration is not None:
        sections.insert(4, Calibration(found.calibration))
    if found.next_experiment is not None:
        sections.append(NextExperiment(found.next_experiment, found.records[0].position_unit))
    return Article("msd diagnose", " + ".join(record.name for record in found.records), tuple(sections))


def of_identification(
    found: Identification, provenance: Provenance | None = None, detail: Detail | None = None
) -> Article:
    """The sections of an identification."""
    detail = detail or Detail.shared_by(len(found.records))
    sections: tuple[Section, ...] = (
        IdentificationVerdict(found),
        Fit(found.records, identification_curves(found), found.noise_floor, detail),
        StandardForm(found),
        Parameters(found.records, identification_columns(found), found.open),
        Data(found.records, found.findings, provenance, None),
    )
    return Article("msd identify", " + ".join(record.name for record in found.records), sections)


def of_validation(found: Validation, provenance: Provenance | None = None, detail: Detail | None = None) -> Article:
    """The sections of a saved model tried on another record."""
    detail = detail or Detail.shared_by(len(found.records))
    curve = ModelCurve("saved model", "extended", found.predicted, found.residuals)
    sections: tuple[Section, ...] = (
        Trial(found),
        Fit(found.records, (curve,), found.noise_floor, detail),
        Parameters(found.records, (_saved_column(found),), ()),
        Data(found.records, found.findings, provenance, None),
    )
    return Article("msd validate", " + ".join(record.name for record in found.records), sections)


def of_export(found: Export, provenance: Provenance | None = None, detail: Detail | None = None) -> Article:
    """The sections of an exported model: in its target with and without the correction."""
    sections: list[Section] = [Exported(found)]
    if found.proof is not None:
        detail = detail or Detail.shared_by(len(found.records))
        target, parts = found.target.name, found.proof.parts
        base, exported = tuple(part.base for part in parts), tuple(part.target for part in parts)
        curves = [
            ModelCurve.of_readings(f"m, b, k alone, in {target}", "base", found.records, base),
            ModelCurve.of_readings(f"exported, in {target}", "extended", found.records, exported),
        ]
        sections.append(Fit(found.records, curves, found.plan.saved.noise_floor, detail))
    sections.append(Effects(found))
    if found.records:
        sections.append(Data(found.records, (), provenance, None))
    return Article("msd export", f"{found.out.name} ({found.target.name})", tuple(sections))


def of_comparison(found: Comparison, provenance: Provenance | None = None, detail: Detail | None = None) -> Article:
    """The sections of a user's own simulation against a record."""
    detail = detail or Detail.shared_by(len(found.records))
    curves = (
        ModelCurve.of_readings("your simulation", "base", found.records, found.simulated),
        ModelCurve.of_fit("model of the rig", "extended", found.records, found.rig),
    )
    sections: tuple[Section, ...] = (
        Outcome(found),
        Differences(found),
        Fit(found.records, curves, found.diagnosis.noise_floor, detail),
        LackingForce(found, found.records, detail),
        Parameters(found.records, comparison_columns(found), found.rig.open_directions),
        Data(found.records, found.diagnosis.findings, provenance, _delay(found.diagnosis)),
    )
    name = " + ".join(record.name for record in found.records)
    return Article("msd validate", f"{found.simulation} on {name}", sections)


def _saved_column(found: Validation) -> Column:
    saved = found.saved
    return Column("saved model", "extended", "model", saved.parameters, saved.see, saved.model)


def articles(results: Sequence[Result], provenance: Sequence[Provenance | None] = ()) -> tuple[Article, ...]:
    """An article for each result, all together as detailed as one page can carry."""
    detail = Detail.shared_by(sum(len(found.records) for found in results))
    return tuple(article(found, origin, detail) for found, origin in zip_longest(results, provenance))


#: What makes the article of a result, by its class; the others are identifications.
_ARTICLES: dict[type, Callable[..., Article]] = {
    Diagnosis: of_diagnosis,
    Validation: of_validation,
    Export: of_export,
    Comparison: of_comparison,
}


def article(found: Result, provenance: Provenance | None = None, detail: Detail | None = None) -> Article:
    """The article about one result.

    Args:
        found: the result.
        provenance: files, versions and command.
        detail: points per curve; as many as a page of this result alone can carry if ``None``.
    """
    return _ARTICLES.get(type(found), of_identification)(found, provenance, detail)


def render(results: Sequence[Result], provenance: Sequence[Provenance | None] = ()) -> str:
    """The page as text; ``provenance`` of each result, where it is known."""
    made = articles(results, provenance)
    title = made[0].name if len(made) == 1 else f"{len(made)} results"
    return document(
        [_rendered(article, f"r{number}") for number, article in enumerate(made, start=1)],
        f"{title} – {made[0].command}",
        next((origin.made for origin in provenance if origin is not None), ""),
    )


def document(articles: Sequence[Mapping[str, Any]], title: str, made: str = "") -> str:
    """A self-contained page as text.

    Args:
        articles: as the template takes them.
        title: of the page.
        made: when the results were made; may be empty.
    """
    from markupsafe import Markup

    return environment().get_template("page.html.j2").render(
        articles=articles,
        title=title,
        version=versions()["msd_ident"],
        made=made,
        css=Markup(shipped("templates", "page.css")),
        script=Markup(shipped("templates", "page.js")),
        plotly=Markup(shipped("vendor", "plotly-basic.min.js")),
    )  # fmt: skip


def _delay(found: Diagnosis) -> Quantity | None:
    """The delay of the force against its stamps [s], where the model has one."""
    delay = structural(DELAY)
    return found.extended.quantities.get(delay.parameters[0].name) if delay is not None else None


def save(
    results: Sequence[Result],
    path: Path,
    provenance: Sequence[Provenance | None] = (),
) -> None:
    """Write one self-contained page about all results.

    Args:
        results: one article each.
        path: file to write.
        provenance: of each result: files, versions and command.

    Raises:
        SetupError: the disk does not take it.
    """
    write_text(render(results, provenance), path)


def _rendered(article: Article, anchor: str) -> dict[str, Any]:
    """An article with the text of its sections."""
    from markupsafe import Markup

    sections = []
    for section in article.sections:
        here = f"{anchor}-{section.slug}"
        template = environment().get_template(section.template)
        body = template.render(here=here, plots=section.plots, **section.context())
        sections.append({"anchor": here, "slug": section.slug, "title": section.title, "body": Markup(body)})
    return {
        "anchor": anchor,
        "command": article.command,
        "name": article.name,
        "verdict": article.verdict,
        "pill": article.pill,
        "sections": sections,
    }


@cache
def environment() -> Environment:
    """Templates; every text is escaped, since names and notes come out of other people's files."""
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup

    from msd_ident.report import plotly_figure

    found = Environment(
        loader=PackageLoader("msd_ident.report", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    found.filters["figure"] = lambda plot: Markup(plotly_figure.to_json(plot))
    return found


@cache
def shipped(folder: str, name: str) -> str:
    """Text of a file in a folder of this package, e.g. of ``templates``."""
    return resources.files("msd_ident.report").joinpath(folder).joinpath(name).read_text(encoding="utf-8")
