"""Result codes of requests, those of ``msd_interfaces/msg/ResultCode``."""

from __future__ import annotations

import traceback

from rclpy.impl.rcutils_logger import RcutilsLogger

from msd_ident.cancellation import Cancelled
from msd_ident.errors import DataError, SetupError, UsageError
from msd_interfaces.msg import ResultCode

DONE, CANCELLED, BUSY = ResultCode.DONE, ResultCode.CANCELLED, ResultCode.BUSY

_CODES = (
    (Cancelled, ResultCode.CANCELLED),
    (UsageError, ResultCode.BAD_REQUEST),
    (DataError, ResultCode.BAD_DATA),
    (SetupError, ResultCode.UNAVAILABLE),
)


def code_of(error: BaseException) -> int:
    """The code of what went wrong; what nobody expected is a fault of the node."""
    return next((code for kind, code in _CODES if isinstance(error, kind)), ResultCode.INTERNAL)


def internal(error: Exception, logger: RcutilsLogger) -> tuple[str, int]:
    """Message and code of an error that nobody expected; its traceback goes to the log."""
    logger.error(traceback.format_exc())
    return f"internal error, please report it: {type(error).__name__}: {error}", ResultCode.INTERNAL


def with_nan(message: object) -> None:
    """Put NaN into every floating-point field, nested ones too: 0.0 would be a result."""
    for name, kind in message.get_fields_and_field_types().items():  # type: ignore[attr-defined]
        if kind == "double":
            setattr(message, name, float("nan"))
        elif "/" in kind and not kind.startswith("sequence"):
            with_nan(getattr(message, name))
