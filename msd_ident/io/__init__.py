"""Bags, CSV and MAT files in and out, without ROS.

In: a path and ``SourceOptions``. Out: a ``Record``, or from a ``Record`` a bag or CSV file.
Begin with ``read``, then ``signal_choice`` and ``bag`` or ``csv_table``; for recording, ``writer``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from msd_ident.io.bag import Bag, iterate_messages, open_bag
from msd_ident.io.covariates import covariates
from msd_ident.io.csv_file import write_csv
from msd_ident.io.describe import BagInfo, describe
from msd_ident.io.joints import Joint, joints, source_of
from msd_ident.io.qos import OfferedQos, qos_from_yaml, qos_to_yaml
from msd_ident.io.read import each_run, read, read_all
from msd_ident.io.repair import Repair, repair
from msd_ident.io.source_options import SourceOptions
from msd_ident.io.topics import RawMessage

if TYPE_CHECKING:
    from msd_ident.io.record_writer import write_bag
    from msd_ident.io.writer import BagWriter

__all__ = [
    "Bag",
    "BagInfo",
    "BagWriter",
    "Joint",
    "OfferedQos",
    "RawMessage",
    "Repair",
    "SourceOptions",
    "covariates",
    "describe",
    "each_run",
    "iterate_messages",
    "joints",
    "open_bag",
    "qos_from_yaml",
    "qos_to_yaml",
    "read",
    "read_all",
    "repair",
    "source_of",
    "write_bag",
    "write_csv",
]


def __getattr__(name: str) -> Any:
    """What writes bags is imported when it is asked for: reading a table needs no library for bags."""
    if name == "BagWriter":
        from msd_ident.io.writer import BagWriter

        return BagWriter
    if name == "write_bag":
        from msd_ident.io.record_writer import write_bag

        return write_bag
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
