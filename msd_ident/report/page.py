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
from msd_ident.model.effects.law import DELAY
from msd_ident.report import words
from msd_ident.report.plots import Detail, ModelCurve, diagnosis_curves, identification_curves
from msd_ident.report.sections.calibration import calibration
from msd_ident.report.sections.causes import causes
from msd_ident.report.sections.comparison import comparison_columns, differences, lacking_force, outcome
from msd_ident.report.sections.data import data
from msd_ident.report.sections.export import effects, exported
from msd_ident.report.sections.fit import fit
from msd_ident.report.sections.missing_force import missing_force
from msd_ident.report.sections.next_experiment import next_experiment
from msd_ident.report.sections.parameters import (
    Column,
    diagnosis_columns,
    identification_columns,
    parameters,
    standard_form,
)
from msd_ident.report.sections.section import Section
from msd_ident.report.sections.trial import trial
from msd_ident.report.sections.verdict import diagnosis_verdict, identification_verdict
from msd_ident.workflow.validation import Validation
from msd_ident.writing import write_text

if TYPE_CHECKING:
    from jinja2 import Environment

    from msd_ident.data.provenance import Provenance
    from msd_ident.data.record import Record
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
    def plots(self) -> tuple[Plot, ...]:
        """All plots of all sections."""
        return tuple(plot for section in self.sections for plot in section.plots)


def _names(records: Sequence[Record]) -> str:
    return words.records([record.name for record in records])


def _of_diagnosis(found: Diagnosis, provenance: Provenance | None, detail: Detail) -> Article:
    """The sections of a diagnosis."""
    sections = [
        diagnosis_verdict(found),
        fit(found.records, diagnosis_curves(found), found.noise_floor, detail),
        missing_force(found, detail),
        causes(found),
        parameters(found.records, diagnosis_columns(found), found.extended.open_directions, found.spread),
        data(found.records, found.findings, provenance, _delay(found)),
    ]
    if found.calibration is not None:
        sections.insert(4, calibration(found.calibration))
    if found.next_experiment is not None:
        sections.append(next_experiment(found.next_experiment, found.records[0].position_unit))
    return Article("msd diagnose", _names(found.records), tuple(sections))


def _of_identification(found: Identification, provenance: Provenance | None, detail: Detail) -> Article:
    """The sections of an identification."""
    sections = (
        identification_verdict(found),
        fit(found.records, identification_curves(found), found.noise_floor, detail),
        standard_form(found),
        parameters(found.records, identification_columns(found), found.open),
        data(found.records, found.findings, provenance),
    )
    return Article("msd identify", _names(found.records), sections)


def _of_validation(found: Validation, provenance: Provenance | None, detail: Detail) -> Article:
    """The sections of a saved model tried on another record."""
    saved = found.saved
    curve = ModelCurve("saved model", "extended", found.predicted, found.residuals)
    column = Column("saved model", "extended", "model", saved.parameters, saved.see, saved.model)
    sections = (
        trial(found),
        fit(found.records, (curve,), found.noise_floor, detail),
        parameters(found.records, (column,), ()),
        data(found.records, found.findings, provenance),
    )
    return Article("msd validate", _names(found.records), sections)


def _of_export(found: Export, provenance: Provenance | None, detail: Detail) -> Article:
    """The sections of an exported model: in its target with and without the correction."""
    sections = [exported(found)]
    if found.proof is not None:
        target, parts, floor = found.target.name, found.proof.parts, found.plan.saved.noise_floor
        before, after = tuple(part.base for part in parts), tuple(part.target for part in parts)
        curves = (
            ModelCurve.of_readings(f"m, b, k alone, in {target}", "base", found.records, before),
            ModelCurve.of_readings(f"exported, in {target}", "extended", found.records, after),
        )
        sections.append(fit(found.records, curves, floor, detail))
    sections.append(effects(found))
    if found.records:
        sections.append(data(found.records, (), provenance))
    return Article("msd export", f"{found.out.name} ({found.target.name})", tuple(sections))


def _of_comparison(found: Comparison, provenance: Provenance | None, detail: Detail) -> Article:
    """The sections of a user's own simulation against a record."""
    curves = (
        ModelCurve.of_readings("your simulation", "base", found.records, found.simulated),
        ModelCurve.of_fit("model of the rig", "extended", found.records, found.rig),
    )
    sections = (
        outcome(found),
        differences(found),
        fit(found.records, curves, found.diagnosis.noise_floor, detail),
        lacking_force(found, detail),
        parameters(found.records, comparison_columns(found), found.rig.open_directions),
        data(found.records, found.diagnosis.findings, provenance, _delay(found.diagnosis)),
    )
    return Article("msd validate", f"{found.simulation} on {_names(found.records)}", sections)


#: What makes the article of a result, by its class; the others are identifications.
_ARTICLES: dict[type, Callable[..., Article]] = {
    Diagnosis: _of_diagnosis,
    Validation: _of_validation,
    Export: _of_export,
    Comparison: _of_comparison,
}


def article(found: Result, provenance: Provenance | None = None, detail: Detail | None = None) -> Article:
    """The article about one result.

    Args:
        found: the result.
        provenance: files, versions and command.
        detail: points per curve; as many as a page of this result alone can carry if ``None``.
    """
    detail = detail or Detail.shared_by(len(found.records))
    return _ARTICLES.get(type(found), _of_identification)(found, provenance, detail)


def render(results: Sequence[Result], provenance: Sequence[Provenance | None] = ()) -> str:
    """The page as text; ``provenance`` of each result, where it is known."""
    detail = Detail.shared_by(sum(len(found.records) for found in results))  # as much as one page can carry of all
    made = [article(found, origin, detail) for found, origin in zip_longest(results, provenance)]
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
        template = environment().get_template(f"{section.slug}.html.j2")
        body = Markup(template.render(here=here, plots=section.plots, **section.context))
        sections.append({"anchor": here, "slug": section.slug, "title": section.title, "body": body})
    head = {name: article.sections[0].context[name] for name in ("verdict", "pill")}
    return {"anchor": anchor, "command": article.command, "name": article.name, **head, "sections": sections}


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
