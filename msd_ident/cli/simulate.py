"""``msd simulate``: an experiment on a simulated rig, without ROS, as a CSV file or a bag."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from msd_ident.cli import options
from msd_ident.errors import SetupError, UsageError

if TYPE_CHECKING:
    from msd_ident.data.record import Record

#: Entry points that simulate: a mapping in, an object with time, force_time, force, position, hold and truth out.
RIGS = "msd.rigs"

RigOption = Annotated[str, options.rig_option("--rig", metavar="NAME|FILE", help="name of a rig, or its YAML file")]
ExperimentOption = Annotated[
    str,
    options.rig_option(metavar="NAME[:OPTION=NUMBER,…]", help="experiment, e.g. paper, steps, release, sweep:force=2"),
]
OutOption = Annotated[
    Path, options.output_option("--out", metavar="FILE.csv|FOLDER", help="CSV file, or folder of a bag")
]
EffectOption = Annotated[
    list[str] | None,
    options.rig_option(
        "--effect", metavar="NAME[:PARAMETER=NUMBER,…]", help="effect that the rig has, e.g. backlash; repeatable"
    ),
]
SetOption = Annotated[
    list[str] | None,
    options.rig_option(
        "--set", metavar="PARAMETER=NUMBER", help="parameter of the rig, e.g. mass=2 or encoder.noise=1e-5; repeatable"
    ),
]
ReplaceOption = Annotated[
    bool, options.output_option("--force", "--overwrite", help="replace files that already exist")
]


SeedOption = Annotated[int | None, options.rig_option(help="seed of the encoder noise")]
RateOption = Annotated[float | None, options.rig_option(help="sampling rate, in Hz")]
DurationOption = Annotated[
    float | None, options.rig_option(help="duration, in seconds; default: that of the experiment")
]
JsonOption = Annotated[
    str, options.output_option("--json", metavar="FILE|-", help="write the true parameters as a JSON object")
]


def simulate(
    out: OutOption,
    rig: RigOption = "ecp",
    experiment: ExperimentOption = "paper",
    effect: EffectOption = None,
    parameter: SetOption = None,
    seed: SeedOption = None,
    rate: RateOption = None,
    duration: DurationOption = None,
    json: JsonOption = "",
    quiet: options.QuietOption = False,
    overwrite: ReplaceOption = False,
) -> int:
    """Simulate an experiment on a rig and write force and encoder signal to a CSV file or a bag."""
    from msd_ident import io
    from msd_ident.cli import results

    output = results.Output(json=json, quiet=quiet, overwrite=overwrite)
    output.check(written=[out])
    if out.suffix not in ("", ".csv") and not out.suffix[1:].isdigit():
        raise UsageError(f"{out} ends in {out.suffix}; expected a name that ends in .csv, or a folder's for a bag")
    if out.exists() and not overwrite:
        raise UsageError(f"{out} exists; expected a new name: give another one, or --overwrite to replace it")
    name, options = _named_numbers("--experiment", experiment)
    spec: dict[str, Any] = {"rig": rig, "experiment": {"name": name, **options}}
    spec["effects"] = effects_of(effect or ())
    spec |= _numbers("--set", ",".join(parameter or ()))
    spec |= {k: v for k, v in (("seed", seed), ("rate", rate), ("duration", duration)) if v is not None}
    try:
        simulated = _rig()(spec)
    except ValueError as error:
        raise UsageError(str(error)) from None
    record = _record(simulated, out.stem)
    if out.suffix == ".csv":
        io.write_csv(_one_clock(record), out, overwrite)
    else:
        io.write_bag(record, out, overwrite)
    results.write([{"schema": "msd.simulation/1", "path": str(out), **simulated.truth}], output)
    if output.tables:
        print(f"{out}: {record.samples} samples in {record.duration:.3f} s, experiment {name} on rig {rig}")
    return 0


def _rig() -> Callable[[Mapping[str, Any]], Any]:
    """The first simulator that is installed: the world is reached by its entry point, never imported."""
    from importlib.metadata import entry_points

    for point in entry_points(group=RIGS):
        try:
            found: Callable[[Mapping[str, Any]], Any] = point.load()
        except ImportError as error:
            raise SetupError(
                f"{point.value} cannot be loaded ({error}); expected it with this package: install again"
            ) from None
        return found
    raise SetupError(f"no simulated rig is installed; expected an entry point in {RIGS}: install this package with pip")


def effects_of(texts: Sequence[str]) -> dict[str, dict[str, float]]:
    """Effects with their parameters from the texts of ``--effect``.

    Raises:
        UsageError: a text that is no effect, or an effect that is given twice.
    """
    found: dict[str, dict[str, float]] = {}
    for text in texts:
        name, numbers = _named_numbers("--effect", text)
        if name in found:
            raise UsageError(f"--effect {name} is given twice; expected it once, with all its parameters: join them")
        found[name] = numbers
    return found


def _named_numbers(option: str, text: str) -> tuple[str, dict[str, float]]:
    """("backlash", {"backlash_half_width": 0.002}) from ``backlash:backlash_half_width=0.002``."""
    name, _, rest = text.partition(":")
    if not name:
        raise UsageError(f"{option} {text!r} has no name; expected NAME or NAME:PARAMETER=NUMBER,PARAMETER=NUMBER")
    return name, _numbers(option, rest)


def _numbers(option: str, text: str) -> dict[str, float]:
    numbers = {}
    for part in filter(None, text.split(",")):
        name, _, text_of_value = part.partition("=")
        try:
            value = float(text_of_value)
        except ValueError:
            raise UsageError(f"{option}: {part!r} is no setting; expected PARAMETER=NUMBER, e.g. mass=1.5") from None
        if name.strip() in numbers:
            raise UsageError(f"{option}: {name.strip()} is given twice; expected one value: remove one of them")
        numbers[name.strip()] = value
    return numbers


def _record(simulated: Any, name: str) -> Record:
    from msd_ident.data.record import Record

    return Record(
        time=simulated.time,
        position=simulated.position,
        force_time=simulated.force_time,
        force=simulated.force,
        hold=simulated.hold,
        name=name,
    )


def _one_clock(record: Record) -> Record:
    """The record with the force at each position's stamp, wherever that says the same: a table without gaps."""
    import numpy as np

    from msd_ident.data.record import from_samples

    if record.hold == "zero" and np.isin(record.force_time, record.time).all():
        return from_samples(record.time, record.force_at(record.time), record.position, name=record.name)
    return record
