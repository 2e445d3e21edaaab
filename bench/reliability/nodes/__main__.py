"""``python -m bench.reliability.nodes``: a soak with random faults from a seed; a table for docs/reliability.md."""

from __future__ import annotations

import argparse
import sys
import tempfile
from functools import partial
from pathlib import Path

from bench.reliability.nodes.faults import FAULTS
from bench.reliability.nodes.soak import Found, soak
from bench.reliability.nodes.world import as_between_processes, world
from msd_ident.ros.common.domain import private_domain

PAGE = Path(__file__).resolve().parents[3] / "docs" / "reliability.md"
BEGIN, END = "<!-- soak: made by `make soak` -->", "<!-- end of soak -->"


def table(found: Found, seed: int) -> str:
    """The result of a soak, for the page."""
    early, late = found.memory
    wrong = f"{len(found.wrong)} were handled wrongly" if found.wrong else "none was handled wrongly"
    lines = [
        "## Nodes under faults",
        "",
        f"`make soak`, seed {seed}: {sum(found.done.values())} faults in {found.seconds / 60.0:.0f} minutes, on one",
        f"identifier and one recorder that are not restarted; {wrong}. After each fault the data must be OK again",
        "on `/diagnostics`, and mass and stiffness, identified from the live buffer, must be within 1 % of the rig's.",
        "If an estimate leaves more than two noise floors, it is requested again, at most twice.",
        f"Memory of the process: {early:.0f} MB after each fault was tried once, {late:.0f} MB at the end.",
        "",
        "| fault | part of the message on `/diagnostics` | times | result |",
        "|---|---|---|---|",
    ]
    for fault in FAULTS:
        said = f"“{fault.words}”" if fault.words else "reported to the caller"
        lines.append(f"| {fault.name} | {said} | {found.done[fault.name]} | {found.outcome(fault.name)} |")
    return "\n".join(lines)


def write(text: str, page: Path) -> None:
    """Put the table where the last one stood, or at the end."""
    old = page.read_text(encoding="utf-8") if page.exists() else "# Reliability\n"
    new = f"{BEGIN}\n\n{text}\n\n{END}"
    if BEGIN in old:
        head, _, rest = old.partition(BEGIN)
        made = head + new + rest.partition(END)[2]
    else:
        made = f"{old.rstrip()}\n\n{new}\n"
    page.write_text(made, encoding="utf-8")


def main() -> int:
    """Run the soak; 0 when every fault was handled, else 1."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="only faults with these words in their name")
    parser.add_argument("--pause", type=float, default=0.5, help="seconds between two faults")
    parser.add_argument("--write", type=Path, nargs="?", const=PAGE, help="page to write the table into")
    given = parser.parse_args()
    faults = [fault for fault in FAULTS if given.only in fault.name]
    if not faults or (given.only and given.write):
        parser.error("no fault has these words in its name" if not faults else "--write needs all faults")
    with private_domain() as domain, tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as settings:
        as_between_processes(Path(settings))
        with world(domain, Path(folder)) as nodes:
            tell = partial(print, flush=True)
            found = soak(nodes, 60.0 * given.minutes, given.seed, tell, given.pause, faults)
    text = table(found, given.seed)
    print(text)
    if given.write:
        write(text, given.write)
    return 1 if found.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
