"""``msd info``: what a bag or a table holds, what would be used of it, and what is wrong with it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from msd_ident.cli import groups, options, results
from msd_ident.errors import MsdError

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from msd_ident.data.quality import Finding
    from msd_ident.data.record import Record
    from msd_ident.io import BagInfo, SourceOptions

#: Narrowest column of types.
_TYPE = 8


@groups.grouped("json", "overwrite")
def info(
    paths: options.PathsArgument,
    source: groups.Source,
    output: results.Output,
) -> int:
    """Show topics, types, rates and gaps, the signals that would be used, and problems with them."""
    from rich.console import Console

    console = Console(highlight=False)

    def handle(path: Path) -> dict[str, Any]:
        found = _look(path, source)
        if output.tables:
            _show(found, console)
        return _to_json(found)

    return results.each_path(paths, output, handle)


@dataclass(frozen=True)
class _Contents:
    """A bag or table, the record that it gives with its numbers (or why it gives none), and the findings about that."""

    info: BagInfo
    record: Record | None = None
    numbers: dict[str, Any] | None = None
    problem: str = ""
    findings: tuple[Finding, ...] = ()


def _look(path: Path, source: SourceOptions) -> _Contents:
    from msd_ident.data import quality
    from msd_ident.io import describe, read

    info = describe(path, source)
    try:
        record = read(path, source)
    except MsdError as error:
        return _Contents(info, problem=str(error))
    return _Contents(info, record, _numbers(record), findings=quality.check(record))


def _numbers(record: Record) -> dict[str, Any]:
    """The record in the JSON contract."""
    from msd_ident.data import quality

    return {
        "samples": record.samples,
        "duration_s": record.duration,
        "rate_hz": 1 / record.period,
        "missing_samples": quality.missing_samples(record),
        "position_unit": record.position_unit,
        "encoder_step": quality.encoder_step(record),
        "noise_floor": quality.noise_floor(record),
        "force_samples": int(record.force.size),
        "force_unit": record.force_unit,
    }


def _to_json(found: _Contents) -> dict[str, Any]:
    info = found.info
    return {
        "schema": "msd.info/1",
        "path": info.path,
        "kind": info.kind,
        "start_ns": info.start_ns,
        "duration_s": info.duration,
        "messages": info.messages,
        "topics": [
            {
                "name": topic.name,
                "type": topic.type,
                "messages": topic.messages,
                "rate_hz": topic.rate,
                "longest_gap_s": topic.longest_gap,
                "reliability": topic.reliability,
                "durability": topic.durability,
            }
            for topic in info.topics
        ],
        "position": info.position,
        "force": info.force,
        "joints": [{"name": one.name, "moves": moves, "options": one.options} for one, moves in info.joints.items()],
        "record": found.numbers,
        "problem": found.problem,
        "findings": [vars(finding) for finding in found.findings],
        "notes": list(_notes(found)),
    }


def _notes(found: _Contents) -> tuple[str, ...]:
    """Notes of the reader, those of the whole file without repeating them."""
    of_record = found.record.notes if found.record is not None else ()
    return tuple(dict.fromkeys((*found.info.notes, *of_record)))


def _show(found: _Contents, console: Console) -> None:
    from rich.markup import escape

    info = found.info
    console.print(f"[bold]{escape(info.path)}[/bold]", soft_wrap=True)
    unit = "lines" if info.is_table else "messages"
    console.print(f"{info.kind}, {info.messages} {unit} in {info.duration:.3f} s{_start(info.start_ns)}\n")
    console.print(_topics(info, console.width))
    console.print()
    _show_signals(found, console)
    for finding in found.findings:
        colour = {"error": "red", "warning": "yellow"}.get(finding.severity, "cyan")
        console.print(f"[{colour}]{finding.severity}[/{colour}]: {escape(finding.sentence)}")
    for note in _notes(found):
        console.print(f"note: {escape(note)}")
    console.print()


def _topics(info: BagInfo, width: int) -> Table:
    """Topics or columns; names are whole where types can be folded for it, since options take them."""
    from rich.markup import escape
    from rich.table import Table

    table = Table(box=None, pad_edge=False, header_style="bold")
    heads = ("column" if info.is_table else "topic", "type", "number", "rate, Hz", "longest gap, s")
    rows = [
        (escape(topic.name), topic.type, str(topic.messages), _number(topic.rate), _number(topic.longest_gap))
        for topic in info.topics
    ]
    widths = [max(map(len, column)) for column in zip(heads, *rows, strict=True)]
    room = width - sum(widths) + widths[1] - 2 * (len(heads) - 1)
    for place, head in enumerate(heads):
        most = room if place == 1 and room >= _TYPE else None
        table.add_column(head, justify="left" if place < 2 else "right", overflow="fold", max_width=most)
    for row in rows:
        table.add_row(*row)
    return table


def _show_signals(found: _Contents, console: Console) -> None:
    from rich.markup import escape

    record, info, numbers = found.record, found.info, found.numbers
    if record is None or numbers is None:
        console.print(f"[yellow]not usable as it is[/yellow]: {escape(found.problem)}")
        _show_joints(info, console)
        return
    size = numbers["encoder_step"]
    step = f"encoder step {size:.4g} {record.position_unit}" if size else "no encoder step to be seen"
    console.print(f"position: {escape(info.position)}")
    console.print(
        f"          {record.samples} samples in {record.duration:.3f} s, {1 / record.period:.4g} Hz, "
        f"{numbers['missing_samples']} missing"
    )
    console.print(f"          {step}, noise floor {numbers['noise_floor']:.3g} {record.position_unit}")
    if info.force == "none":
        console.print("force:    none, a free decay")
    else:
        low, high = float(record.force.min()), float(record.force.max())
        console.print(f"force:    {escape(info.force)}")
        console.print(f"          {record.force.size} samples, {low:.4g} to {high:.4g} {record.force_unit}")


def _show_joints(info: BagInfo, console: Console) -> None:
    """Options to paste for each joint that moves."""
    from rich.markup import escape

    if not info.joints:
        return
    console.print("\noptions for the joints that move (for one that slides: N and m):")
    for joint, moves in info.joints.items():
        if moves:
            console.print(f"  {escape(joint.options)}", soft_wrap=True)
    resting = [joint.name for joint, moves in info.joints.items() if not moves]
    if resting:
        console.print(f"  at rest: {escape(', '.join(resting))}")


def _start(start_ns: int) -> str:
    if start_ns < 10**18:  # a clock of its own, as in simulation
        return ""
    from datetime import datetime, timezone

    return f", from {datetime.fromtimestamp(start_ns // 10**9, timezone.utc):%Y-%m-%d %H:%M:%S} UTC"


def _number(value: float) -> str:
    return f"{value:.4g}" if value == value else "–"
