"""From records to a result: the one path that command line, nodes and tests share."""

from __future__ import annotations

from msd_ident.workflow.diagnose import diagnose
from msd_ident.workflow.identify import Progress, identify
from msd_ident.workflow.options import LOSSES, MODELS, Options

__all__ = ["LOSSES", "MODELS", "Options", "Progress", "diagnose", "identify"]
