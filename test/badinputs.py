"""Bad and odd inputs, made from one clean step response: what ``msd identify`` is given, and what it must say.

``python test/badinputs.py`` runs them all as a user does and prints the table: input, exit code, seconds, line.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from bagmaker import JOINTS, START_NS, WRENCH, Message, joints, make_bag, storage, wrench
from mcap.writer import Writer

from msd_ident.cli import main
from msd_sim.api import simulate

Columns = tuple[np.ndarray, np.ndarray, np.ndarray]
Make = Callable[[Path], Path]


@dataclass(frozen=True)
class Case:
    """An input and what must come of it.

    Attributes:
        name: the input in words.
        make: writes it into a folder; gives its path.
        code: exit code.
        says: words that must be in the one line on stderr (code 2), or among the warnings (code 0).
        options: of the command line, after the path.
    """

    name: str
    make: Make
    code: int
    says: str
    options: tuple[str, ...] = ()


@dataclass(frozen=True)
class Outcome:
    """What came of it: exit code, standard output and error, seconds."""

    code: int
    out: str
    err: str
    seconds: float

    @property
    def line(self) -> str:
        """The one line of a refusal; the warnings of a result; what a result left open where there is none."""
        if self.code:
            return self.err.strip()
        found = json.loads(self.out.splitlines()[-1])
        return " / ".join(found.get("warnings") or found.get("open") or ["no warning"])


def run(*words: str | Path) -> Outcome:
    """The command, in this process."""
    out, err = io.StringIO(), io.StringIO()
    before, began = sys.argv, time.perf_counter()
    sys.argv = ["msd", *map(str, words)]
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = main.main()
    finally:
        sys.argv = before
    return Outcome(code, out.getvalue(), err.getvalue(), time.perf_counter() - began)


def identify(case: Case, folder: Path) -> Outcome:
    """What ``msd identify`` makes of a case."""
    return run("identify", case.make(folder), *case.options, "--json", "-")


def step(rate: float = 250.0, **options: object) -> Columns:
    """Time [s], force [N] and position [m] of the ECP rig: 10 N for 2 s, then none for 2 s."""
    experiment = {"name": "paper", "force": 10.0, "hold": 2.0}
    data = simulate({"rig": "ecp", "experiment": experiment, "rate": rate, "seed": 1, **options})
    index = np.searchsorted(data.force_time, data.time, side="right") - 1
    return data.time, np.where(index < 0, 0.0, data.force[index]), data.position


def table(columns: Columns, path: Path, header: str = "time_s,force_n,position_m") -> Path:
    """The columns as a CSV file."""
    lines = [",".join(map(repr, row)) for row in zip(*(column.tolist() for column in columns), strict=True)]
    path.write_text("\n".join([header, *lines]) + "\n", encoding="utf-8")
    return path


def changed(change: Callable[[np.ndarray, np.ndarray, np.ndarray], Columns], header: str = "") -> Make:
    """The step's table with its columns changed, under another header if given."""
    return lambda folder: table(change(*step()), folder / "in.csv", header or "time_s,force_n,position_m")


def written(content: bytes | str, name: str = "in.csv") -> Make:
    """A file with this content."""

    def make(folder: Path) -> Path:
        path = folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return make


def with_line(text: str) -> Make:
    """The step's table with line 51 replaced."""

    def make(folder: Path) -> Path:
        path = table(step(), folder / "in.csv")
        lines = path.read_text().splitlines()
        path.write_text("\n".join([*lines[:50], text, *lines[51:]]) + "\n")
        return path

    return make


def cut_short(folder: Path) -> Path:
    """The step's table as a killed logger leaves it: without the end of its last line."""
    path = table(step(), folder / "in.csv")
    text = path.read_text()
    path.write_text(text[: text.rindex(",")])
    return path


def put(values: np.ndarray, index: int | list[int], value: float) -> np.ndarray:
    """The values with some of them replaced."""
    values = values.copy()
    values[index] = value
    return values


def bag(
    change: Callable[[np.ndarray], np.ndarray] = lambda x: x,
    stamps: Callable[[np.ndarray], np.ndarray] = lambda ns: ns,
    force_ns: int = START_NS,
    cut: float = 1.0,
    names: tuple[str, ...] = ("cart",),
) -> Make:
    """The first 2 s of the step as a bag, its positions or stamps changed; cut off, as one file, for ``cut`` < 1."""

    def make(folder: Path) -> Path:
        time, _, position = (column[:500] for column in step())
        logged = START_NS + np.rint(time * 1e9).astype(np.int64)
        messages: list[Message] = [("/msd/force", WRENCH, wrench(force_ns, 10.0), START_NS)]
        for ns, x, at in zip(stamps(logged).tolist(), change(position).tolist(), logged.tolist(), strict=False):
            messages.append(("/msd/encoder", JOINTS, joints(ns, [x] * len(names), names), at))
        path = make_bag(folder / "bag", messages)
        if cut == 1.0:
            return path
        damaged = folder / "cut.mcap"
        damaged.write_bytes(storage(path).read_bytes()[: int(cut * storage(path).stat().st_size)])
        return damaged

    return make


def strange_encoding(folder: Path) -> Path:
    """An MCAP file whose only topic is in JSON."""
    path = folder / "in.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        schema = writer.register_schema("Position", "jsonschema", b"{}")
        channel = writer.register_channel("/msd/encoder", "json", schema)
        writer.add_message(channel, START_NS, b'{"position": 0.1}', START_NS)
        writer.finish()
    return path


def only(topic: str, type_name: str, raw: bytes) -> Make:
    """A bag of one message."""
    return lambda folder: make_bag(folder / "bag", [(topic, type_name, raw, START_NS)])


def _clean(t: np.ndarray, f: np.ndarray, x: np.ndarray) -> Columns:
    return t, f, x


def _noise(x: np.ndarray) -> np.ndarray:
    return np.random.default_rng(0).standard_normal(x.size)


def _sparse(values: np.ndarray) -> np.ndarray:
    return np.concatenate((values[:500], values[500::4]))


#: Every one of them is run by test/cli/test_bad_input.py.
CASES = (
    Case("no such path", lambda folder: folder / "nothing.csv", 2, "does not exist; expected a bag folder"),
    Case("name that is too long", lambda folder: folder / ("x" * 300), 2, "cannot read"),
    Case("empty folder", lambda folder: folder, 2, "holds no .mcap or .db3 file"),
    Case("empty CSV file", written(""), 2, "is empty; expected a header like time_s,force_n,position_m"),
    Case("empty MCAP file", written("", "in.mcap"), 2, "is empty; expected an MCAP file"),
    Case("text called .mcap", written("hello\n", "in.mcap"), 2, "does not begin like an MCAP file"),
    Case("text called .db3", written("hello\n", "in.db3"), 2, "file is not a database"),
    Case("bag of ROS 1", written("#ROSBAG V2.0\n", "in.bag"), 2, "is a bag of ROS 1"),
    Case("binary file called .csv", written(bytes(range(1, 256)) * 9), 2, "is not text; expected a CSV file"),
    Case("JSON file", written('{\n "a": 1\n}\n', "in.json"), 2, "begins with one cell, '{'"),
    Case("header only", written("time_s,force_n,position_m\n"), 2, "has one line; expected a header"),
    Case("no header", written("0,1,2\n1,2,3\n"), 2, "no column called time; the columns are: 1, 2, 3"),
    Case("no force column", changed(_clean, "time_s,push,position_m"), 2, "the columns are: time_s, push, position_m"),
    Case("no position column", changed(_clean, "time_s,force_n,x"), 2, "the columns are: time_s, force_n, x"),
    Case(
        "column that is not there", changed(_clean), 2, "has no column torque; the columns are:", ("--force", "torque")
    ),
    Case("one column taken twice", changed(_clean), 2, "column position_m is taken twice", ("--force", "position_m")),
    Case("NaN", changed(lambda t, f, x: (t, f, put(x, 100, np.nan))), 0, "1 of 1000 samples (0.1 %) are missing"),
    Case("NaN as force", changed(lambda t, f, x: (t, put(f, 99, np.nan), x)), 0, "force_n is empty in 1 of the lines"),
    Case("NaN as time", changed(lambda t, f, x: (put(t, 100, np.nan), f, x)), 2, "1 lines have no time_s; expected a"),
    Case("infinite force", changed(lambda t, f, x: (t, put(f, 7, np.inf), x)), 2, "line 9, column force_n holds 'inf'"),
    Case("word in a cell", with_line("0.2,1,abc"), 2, "line 51, column position_m holds 'abc'"),
    Case("line cut short", with_line("0.2,1"), 2, "line 51 has 2 cells; expected 3"),
    Case("last line cut short", cut_short, 0, "line 1001 was left out: the file ends in the middle of it, behind"),
    Case("position of 1e300", changed(lambda t, f, x: (t, f, put(x, 9, 1e300))), 2, "position reaches 1e+300 m"),
    Case("force of 1e300", changed(lambda t, f, x: (t, f * 1e299, x)), 2, "force reaches 1e+300 N"),
    Case("times of 1e300", changed(lambda t, f, x: (t * 1e300, f, x)), 2, "expected times in seconds"),
    Case("constant position", changed(lambda t, f, x: (t, f, 0 * x + 0.3)), 2, "never changes (0.3 m in all 1000"),
    Case("noise alone", changed(lambda t, f, x: (t, f, 1e-5 * _noise(x))), 2, "which is noise: push harder"),
    Case("force is the position", changed(lambda t, f, x: (t, -694 * x, x)), 2, "is the position times -694 in every"),
    Case("time running backwards", changed(lambda t, f, x: (t[::-1], f, x)), 2, "position stamps run backwards"),
    Case("recording looped", changed(lambda t, f, x: (t % 2.0, f, x)), 2, "the recording was looped"),
    Case("all stamps equal", changed(lambda t, f, x: (0 * t, f, x)), 2, "1000 position samples have only 1 different"),
    Case("duplicate stamps", changed(lambda t, f, x: (np.repeat(t[::2], 2), f, x)), 0, "500 samples with duplicate"),
    Case("two rates mixed", changed(lambda *c: (_sparse(c[0]), _sparse(c[1]), _sparse(c[2]))), 0, "250 Hz and 62.5 Hz"),
    Case("5 samples", changed(lambda t, f, x: (t[:5], f[:5], x[:5])), 2, "5 position samples; expected at least 20"),
    Case(
        "window beyond the end",
        changed(_clean),
        2,
        "0 position samples from 100.000 s on; expected at least 20",
        ("--start", "100"),
    ),
    Case("NaN as start", changed(_clean), 2, "the window from nan s to inf s is empty", ("--start", "nan")),
    Case("NaN as scale", changed(_clean), 2, "force scale is nan; expected a finite number", ("--force-scale", "nan")),
    Case("millimetres as metres", changed(lambda t, f, x: (t, f, 1e3 * x)), 0, "spans 36.44 m"),
    Case("kN as N", changed(lambda t, f, x: (t, f / 1e3, x)), 0, "the moving mass is about 0.00037 kg"),
    Case(
        "mN as N",
        changed(lambda t, f, x: (t, f * 1e3, x)),
        0,
        "The mass is 940.7 kg: is a unit wrong by a factor of 1000",
    ),
    Case("milliseconds as seconds", changed(lambda t, f, x: (t * 1e3, f, x)), 0, "the samples lie 4 s apart"),
    Case("nanoseconds as seconds", changed(lambda t, f, x: (t * 1e9, f, x)), 0, "the samples lie 4e+06 s apart"),
    Case("counts as metres", changed(lambda t, f, x: (t, f, np.rint(226600 * x) + 1e6)), 0, "spans 8257 m"),
    Case("force of 0 with motion", changed(lambda t, f, x: (t[500:], 0 * t[500:], x[500:])), 0, "only as ratios"),
    Case(
        "single wild readings", changed(lambda t, f, x: (t, f, put(x, [9, 300, 700], 1.0))), 0, "3 single readings jump"
    ),
    Case("position downwards", changed(lambda t, f, x: (t, f, -x)), 0, "A positive force moves the encoder downwards"),
    Case("spring taken for none", changed(_clean), 0, "times the noise floor", ("--model", "no_spring")),
    Case("bag cut off at 99 %", bag(cut=0.99), 0, "the file ends without its index; 501 messages could be read"),
    Case("bag cut off at 1 %", bag(cut=0.01), 2, "the file is cut off or damaged at byte"),
    Case("unknown encoding", strange_encoding, 2, "encoded as 'json'; expected 'cdr', the encoding of ROS 2"),
    Case("bag without force", only("/msd/encoder", JOINTS, joints(START_NS, [0.0])), 2, "no topic called force"),
    Case("bag without encoder", only("/msd/force", WRENCH, wrench(START_NS, 1.0)), 2, "there are: /msd/force"),
    Case("topic that is not there", bag(), 2, "there are: /msd/encoder, /msd/force", ("--position", "/nope:x")),
    Case(
        "field that is not there", bag(), 2, "the fields are: header, name, position", ("--position", "/msd/encoder:x")
    ),
    Case(
        "joint that is not there",
        bag(names=("left", "right")),
        2,
        "the joints are: left, right",
        ("--position", "/msd/encoder:position[elbow]"),
    ),
    Case(
        "effort that is empty",
        bag(),
        2,
        "no message holds /msd/encoder:effort[0]",
        ("--force", "/msd/encoder:effort[0]"),
    ),
    Case("NaN in a bag", bag(lambda x: put(x, 50, np.nan)), 0, "is NaN in 1 of 500 samples, which are left out"),
    Case("infinity in a bag", bag(lambda x: put(x, 50, np.inf)), 2, "position holds 1 values that are not finite"),
    Case("backwards in a bag", bag(stamps=lambda ns: ns[::-1]), 2, "position stamps run backwards"),
    Case("one stamp for all in a bag", bag(stamps=lambda ns: 0 * ns + START_NS), 2, "have only 1 different stamps"),
    Case("5 samples in a bag", bag(lambda x: x[:5]), 2, "5 position samples; expected at least 20"),
    Case("no stamps in a bag", bag(stamps=lambda ns: 0 * ns), 0, "500 of 500 messages have no stamp"),
    Case(
        "force after the last position", bag(force_ns=START_NS + 3 * 10**9), 2, "expected signals that overlap in time"
    ),
    Case("force long before the positions", bag(force_ns=START_NS - 10**13), 0, "only as ratios"),
    Case("millimetres in a bag", bag(lambda x: 1e3 * x), 0, "wrong by a factor of 1000"),
)


def _table() -> Iterator[str]:
    """Lines of the table of all cases, in Markdown."""
    yield "| input | exit code | line on stderr, or warnings beside the result | s |"
    yield "|---|---|---|---|"
    for case in CASES:
        with tempfile.TemporaryDirectory() as folder:
            found = identify(case, Path(folder))
            line = found.line.replace(folder + os.sep, "").replace(folder, "FOLDER").replace("|", "\\|")
            yield f"| {' '.join((case.name, *case.options))} | {found.code} | {line[:400]} | {found.seconds:.1f} |"


if __name__ == "__main__":
    for row in _table():
        print(row, flush=True)
