"""Work on one record: fetch, read, diagnose, and make rows. Only paths go to a worker, and only rows come back."""

from __future__ import annotations

import hashlib
import os
import socket
import time
from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path

from msd_ident import parallel
from msd_ident.batching import locations
from msd_ident.batching.code import code_version
from msd_ident.batching.job import Job
from msd_ident.batching.row import Row, finite, identity, of_diagnosis, of_record
from msd_ident.data.joint_effort import judge
from msd_ident.data.provenance import fingerprint
from msd_ident.data.record import Record
from msd_ident.diagnosis import Diagnosis
from msd_ident.errors import MsdError, SetupError
from msd_ident.io import covariates, joints, read_all, source_of
from msd_ident.io.joints import Joint
from msd_ident.workflow import pipeline
from msd_ident.writing import readable

#: Writes a record's page: the diagnosis, the record's path, the file to write. Handed in, as pages know of rows.
Draw = Callable[[Diagnosis, str, Path], None]


@dataclass(frozen=True)
class Done:
    """Result of one path.

    Attributes:
        rows: of the record; none if its content is known already.
        known: digest of that content, else empty.
    """

    rows: tuple[Row, ...]
    known: str = ""


@dataclass(frozen=True)
class Work:
    """What a worker is sent, the same for all records.

    Attributes:
        job: what is asked.
        known: digests of contents that have their rows already.
        draw: makes a record's page where the job asks for pages.
        threads: that a diagnosis may use; 0 for one a core. One where other workers use the other cores.
    """

    job: Job
    known: Collection[str] = ()
    draw: Draw | None = None
    threads: int = 0

    def __call__(self, path: str) -> Done:
        """All rows of one path; whatever is wrong with it is a row too.

        Raises:
            SetupError: the code here is not the one that was asked for.
        """
        if code_version() != self.job.code:
            raise SetupError(
                f"worker {_here()} runs msd_ident {code_version()}, and {self.job.code} was asked for; expected one "
                "version everywhere: install the same on all workers and start them again"
            )
        began = time.perf_counter()
        columns = {**identity(path, self.job.labels), "code": self.job.code, "job": self.job.digest}
        columns |= {"options": self.job.changes(), "worker": _here()}
        try:
            with locations.local(path) as copy:
                size, digest = fingerprint(copy)
                columns |= {"sha256": digest, "bytes": size}
                if digest in self.known:
                    return Done((), digest)
                with parallel.limited_to(self.threads or parallel.threads()):
                    rows = self._rows(path, copy)
        except Exception as error:
            rows = [{"error": in_words(error)}]
        seconds = (time.perf_counter() - began) / len(rows)
        return Done(tuple({**columns, "seconds": seconds, **row} for row in rows))

    def _rows(self, path: str, copy: Path) -> list[Row]:
        beside = finite(covariates(copy, self.job.covariates))
        if self.job.all_joints:
            return [{**beside, "joint": joint.name, **self._joint(path, copy, joint)} for joint in joints(copy)]
        records = read_all(copy, self.job.source)
        several = len(records) > 1  # runs side by side in one file
        named = [f"run {number}" if several else "" for number in range(1, len(records) + 1)]
        return [
            {**beside, **({"joint": name} if several else {}), **self._row(path, record, name)}
            for name, record in zip(named, records, strict=True)
        ]

    def _joint(self, path: str, copy: Path, joint: Joint) -> Row:
        if not joint.has_effort:
            return {"error": "its messages contain no effort, so there is no force"}
        try:
            (record,) = read_all(copy, source_of(self.job.source, joint))
            judged = judge(record)
        except MsdError as error:
            return {"error": str(error)}
        if not judged.usable:
            return {**of_record(record), "error": judged.sentence}
        return self._row(path, record, joint.name)

    def _row(self, path: str, record: Record, part: str) -> Row:
        row, began = of_record(record), time.perf_counter()
        try:
            found = pipeline.diagnose([record], self.job.options)
            row |= {"diagnosis_seconds": time.perf_counter() - began, **of_diagnosis(found)}
            if self.draw is not None and self.job.pages:
                page = Path(self.job.pages) / page_name(path, part)
                self.draw(found, path, page)
                row["page"] = str(page)
        except Exception as error:
            row |= {"diagnosis_seconds": time.perf_counter() - began, "error": in_words(error)}
        return row


def page_name(path: str, part: str) -> str:
    """File name of a record's page, different for each path and part.

    Args:
        path: of the record.
        part: of the record, such as a joint; may be empty.
    """
    text = readable(f"{path}\n{part}").encode()
    return f"{hashlib.sha256(text).hexdigest()[:16]}.html"


def in_words(error: Exception) -> str:
    """Why a record has no result, one line."""
    if isinstance(error, MsdError):
        return str(error)
    return f"internal error, please report it: {type(error).__name__}: {' '.join(str(error).split())}"


def _here() -> str:
    return f"{socket.gethostname()}:{os.getpid()}"
