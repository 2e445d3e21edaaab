"""Base of export targets: a format with its own laws, a writer, and a replay where a library can run it."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from msd_ident.errors import UsageError
from msd_ident.export.support import BEFORE, Support
from msd_ident.model.effects.law import DELAY

if TYPE_CHECKING:
    from msd_ident.data.record import FloatArray, Record
    from msd_ident.estimate import Initial
    from msd_ident.export.plan import Plan
    from msd_ident.model import Model
    from msd_ident.model.effects import Effect


#: Modules that a program imports: a file of such a name hides them from every program that is begun in its folder.
_LIBRARIES = sys.stdlib_module_names | {"numpy", "scipy", "mujoco", "msd_ident", "pythonfmu"}


@dataclass(frozen=True)
class InitialState:
    """From where a record is replayed.

    Attributes:
        initial: state and zero at its first sample.
        record: its force, and the instants at which positions are wanted.
    """

    record: Record
    initial: Initial


class Target:
    """Base of all targets. One file each; ``TARGETS`` of the package lists them."""

    name: ClassVar[str]
    #: Endings that its main file may have.
    suffixes: ClassVar[tuple[str, ...]]
    #: Whether it runs the saved result itself, so that nothing else can be written in its place.
    itself: ClassVar[bool] = False
    #: Whether its main file is imported by its name.
    imported: ClassVar[bool] = False
    #: In a few words, for tables and help.
    what: ClassVar[str]
    #: What must be installed for the replay; empty for nothing more, ``None`` where nothing here replays it.
    library: ClassVar[str | None] = None
    #: Whether it takes forces for newtons, so that a result without a force scale is refused.
    needs_newtons: ClassVar[bool] = False
    #: Why nothing here replays it, where that is so.
    why_not: ClassVar[str] = ""
    #: Whether it is integrated in fixed steps that the file says.
    stepped: ClassVar[bool] = False
    #: Whether dry friction reverses and stops inside its steps, so that it asks for none of its own.
    located: ClassVar[bool] = False
    #: Whether it takes forces that act when they come, so that none can act before its stamp.
    commanded: ClassVar[bool] = False
    #: What is done with a force whose positive values move the encoder downwards.
    turned: ClassVar[str] = "the force of the actuator is inverted"
    #: Roles of effects (``roles``) that are written though the format does not say them exactly.
    kept: ClassVar[tuple[str, ...]] = ()

    def supports(self, effect: type[Effect]) -> Support:
        """How it carries an effect."""
        raise NotImplementedError

    def support(self, effect: Effect, model: Model) -> Support:
        """How the target carries an effect with the values that it has.

        Args:
            effect: the effect.
            model: the model that contains it.
        """
        del model
        if self.commanded and effect.structure == DELAY and effect.values[0] < 0.0:
            return BEFORE
        return self.supports(type(effect))

    def files(self, plan: Plan, out: Path) -> dict[Path, bytes]:
        """Content of each file to write, the main file first.

        Args:
            plan: what is exported.
            out: path of the main file.
        """
        raise NotImplementedError

    def check_name(self, out: Path) -> None:
        """Refuse a file name that the target's reader would not take.

        Raises:
            UsageError: another ending than ``suffixes``, no name that Python can import, or that of a library.
        """
        if out.suffix not in self.suffixes:
            raise UsageError(
                f"--out {out} for {self.name}; expected a name that ends in {' or '.join(self.suffixes)}, "
                f"e.g. --out {out.stem}{self.suffixes[0]}"
            )
        if self.imported and not out.stem.isidentifier():
            raise UsageError(f"--out {out} for {self.name}; expected a name that Python can import, e.g. rig.py")
        if self.imported and out.stem.lower() in _LIBRARIES:
            raise UsageError(
                f"--out {out} for {self.name}; expected a name of its own, e.g. --out rig.py: programs in its folder "
                f"would import it in the place of Python's {out.stem.lower()}"
            )

    def beside(self, out: Path) -> tuple[Path, ...]:
        """Files that it may write beside the main one."""
        del out
        return ()

    def replay(self, out: Path, plan: Plan, start: InitialState) -> FloatArray:
        """Readings (n,) of the written file, run in its target, at the record's samples and in the position unit.

        Args:
            out: path of the main file.
            plan: what was exported.
            start: record, and state at its first sample.
        """
        raise NotImplementedError
