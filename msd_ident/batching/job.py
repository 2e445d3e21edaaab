"""The job of a batch: how every record is read and diagnosed, with a digest that each row stores."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from typing import Any

from msd_ident.batching.code import code_version
from msd_ident.errors import UsageError
from msd_ident.io import SourceOptions
from msd_ident.workflow import pipeline

#: Columns that a user may fill from paths.
LABELS = ("robot", "day")


@dataclass(frozen=True)
class Job:
    """What to do with each record.

    Attributes:
        source: how records are read.
        options: of the diagnosis.
        all_joints: every joint of a bag, a row each.
        labels: column → regular expression whose first group in the record's path fills it.
        covariates: name → where it is, see ``msd_ident.io.covariates``; empty text: where it is found.
        pages: folder for a page of each record; empty for none.
        code: version of the code that is asked for.

    Raises:
        UsageError: a label that is no column, or an expression without a group.
    """

    source: SourceOptions = SourceOptions()
    options: pipeline.Options = pipeline.Options()
    all_joints: bool = False
    labels: Mapping[str, str] = field(default_factory=dict)
    covariates: Mapping[str, str] = field(default_factory=lambda: {"temperature": "", "load": ""})
    pages: str = ""
    code: str = field(default_factory=code_version)

    def __post_init__(self) -> None:
        for name, text in self.labels.items():
            if name not in LABELS:
                raise UsageError(f"label {name!r}; expected one of {', '.join(LABELS)}, as in --label robot='arm_(.)'")
            try:
                groups = re.compile(text).groups
            except re.error as error:
                raise UsageError(f"label {name}: {text!r} is no regular expression: {error}") from None
            if not groups:
                raise UsageError(f"label {name}: {text!r} has no group; expected one in brackets, e.g. 'arm_([0-9]+)'")
        if self.all_joints and (self.source.force or self.source.position):
            raise UsageError("--all-joints takes force and position of each joint; expected no --force and --position")

    def check_labels(self, paths: Sequence[str]) -> None:
        """Refuse a label whose column would be empty in all rows.

        Args:
            paths: of all records.

        Raises:
            UsageError: its expression matches none of them.
        """
        for name, text in self.labels.items():
            if paths and not any(re.search(text, path) for path in paths):
                raise UsageError(
                    f"label {name}: {text!r} matches no path, e.g. not {paths[0]}; expected an expression that is in "
                    "the paths of records, with the name in brackets"
                )

    def changes(self) -> str:
        """What was asked for beyond the defaults, as JSON; the same text on every computer."""
        plain = Job(code=self.code)
        changed: dict[str, Any] = {}
        for one in fields(self):
            value = getattr(self, one.name)
            if one.name not in ("code", "pages") and value != getattr(plain, one.name):
                changed[one.name] = _plain(value, getattr(plain, one.name))
        return json.dumps(changed, sort_keys=True, ensure_ascii=False)

    @property
    def digest(self) -> str:
        """Of what is asked and of the code: two rows of one content with the same digest are the same row."""
        return hashlib.sha256(f"{self.code}\n{self.changes()}\n{bool(self.pages)}".encode()).hexdigest()[:16]


def _plain(value: Any, default: Any) -> Any:
    if hasattr(value, "__dataclass_fields__"):
        other = asdict(default)
        return {name: given for name, given in asdict(value).items() if given != other[name]}
    return dict(value) if isinstance(value, Mapping) else value
