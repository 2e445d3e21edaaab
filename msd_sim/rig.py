"""The rig in motion: one integrator, stepped by the node in real time and run whole for files."""

from __future__ import annotations

import bisect
import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from msd_sim import kernel
from msd_sim.errors import RigError
from msd_sim.truth import Truth

FloatArray = npt.NDArray[np.float64]
Hold = Literal["zero", "linear"]


@dataclass(frozen=True)
class Motion:
    """What truly happened: (n,) time [s], position [m], velocity [m/s], force on the cart [N]."""

    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    force: FloatArray


class Rig:
    """A cart with a hidden truth, driven by a commanded force.

    The path of a command: stamp + time offset -> static gain of the actuator -> lag -> cart. A command is held until
    the next one (``hold="zero"``, commands may be added while the rig runs) or joined to it by a straight line
    (``hold="linear"``, all commands given before the first step). Before the first command the force is 0.

    Args:
        truth: plant and effects.
        position: at ``time`` [m].
        velocity: at ``time`` [m/s].
        time: start of the clock of everything that depends on time [s].
        hold: how a command goes on.
    """

    def __init__(
        self, truth: Truth, position: float = 0.0, velocity: float = 0.0, time: float = 0.0, hold: Hold = "zero"
    ) -> None:
        if not all(math.isfinite(value) for value in (position, velocity, time)):
            raise RigError(f"the rig starts at {position} m with {velocity} m/s at {time} s; expected finite numbers")
        if hold not in ("zero", "linear"):
            raise RigError(f"hold is {hold!r}; expected 'zero' or 'linear'")
        self._hold = hold
        self._stamps: list[float] = []
        self._commands: list[float] = []
        self._command = 0.0
        self._segment = np.array([time - 1.0, 0.0, 0.0, 0.0])
        self._take(truth)
        self._place(position, velocity, time)

    def _take(self, truth: Truth) -> None:
        self.truth = truth
        self._parameters = truth.parameters(kernel.PARAMETERS)
        self._edges, self._instants = truth.edges(), truth.instants()

    def _place(self, position: float, velocity: float, time: float) -> None:
        self._y = np.array([position, velocity, position, velocity, 0.0, 0.0])
        self._reach = np.abs(self._y)
        self._begin(time)

    def _begin(self, time: float) -> None:
        self._mode = np.zeros(1, kernel.MODE)
        self._mode["t"] = self._mode["t_side"] = time
        self._mode["step"] = 1e-3
        kernel.begin(*self._world(self._segment.reshape(1, 4)))

    def _world(self, segments: FloatArray) -> tuple[npt.NDArray[Any], ...]:
        return (self._parameters, self._mode, self._y, self._reach, segments, self._edges, self._instants)

    @property
    def time(self) -> float:
        """Instant up to which the motion is known [s]."""
        return float(self._mode["t"][0])

    @property
    def sticks(self) -> bool:
        """Whether dry friction holds the cart at this instant."""
        return bool(self._mode["direction"][0] == 0.0)

    @property
    def command(self) -> float:
        """Commanded force that acts at this instant, before offset, gain and lag [N]."""
        return self._command

    @property
    def pushed(self) -> bool:
        """Whether a force acts by command, or will."""
        return self._command != 0.0 or any(self._commands)

    def release(self) -> float:
        """Force 0 from now on, commands ahead forgotten; the instant [s]."""
        self._stamps.clear()
        self._commands.clear()
        self.push(self.time, 0.0)
        return self.time

    def push(self, time: float, force: float) -> bool:
        """Command ``force`` [N] from ``time`` [s] on; False when that is past, so that it acts from now on instead.

        Raises:
            RigError: the force is no finite number.
        """
        if not (math.isfinite(force) and math.isfinite(time)):
            raise RigError(f"a force of {force} N at {time} s; expected finite numbers")
        acts = time + self.truth.value("time_offset", "time_offset")
        in_time = acts >= self.time
        acts = max(acts, self.time)
        index = bisect.bisect_right(self._stamps, acts)
        self._stamps.insert(index, acts)
        self._commands.insert(index, float(force))
        return in_time

    def drive(self, stamps: npt.ArrayLike, forces: npt.ArrayLike) -> None:
        """Command many forces before the rig runs: (p,) rising stamps [s], also before its start, and (p,) forces [N].

        Raises:
            RigError: lengths differ, stamps do not rise, or a value is not finite.
        """
        at = np.asarray(stamps, dtype=np.float64) + self.truth.value("time_offset", "time_offset")
        force = np.asarray(forces, dtype=np.float64)
        if at.ndim != 1 or at.shape != force.shape:
            raise RigError(f"{at.size} force stamps for {force.size} forces; expected as many of each")
        if not (np.isfinite(at).all() and np.isfinite(force).all()):
            raise RigError("force stamps or forces that are not finite; expected numbers only")
        if np.any(np.diff(at) <= 0.0):
            raise RigError("force stamps do not rise; expected each later than the one before")
        self._stamps, self._commands = at.tolist(), force.tolist()
        if at.size:
            self._segment[0] = min(self._segment[0], at[0] - 1.0)

    def sample(self, times: npt.ArrayLike) -> Motion:
        """Motion at (n,) rising instants, none before ``time`` [s]; the rig then stands at the last one.

        Raises:
            RigError: instants that run backwards, or a motion that runs away.
        """
        at = np.array(times, dtype=np.float64)  # its own: for one that cannot be written to, numba would compile anew
        if at.size and (at[0] < self.time or np.any(np.diff(at) < 0.0) or not np.isfinite(at).all()):
            raise RigError(f"instants must be finite and rise from the rig's present {self.time:g} s on")
        segments = self._segments()
        motion = np.empty((3, at.size))
        trouble, done = kernel.run(*self._world(segments), at, motion)  # type: ignore[call-arg]
        if trouble != 0:
            what = "the motion runs away" if trouble == kernel.RUNS_AWAY else "the rig chatters without end"
            largest = max(map(abs, (self._command, *self._commands)))
            raise RigError(
                f"{what} at {self.time:.6g} s, x = {self._y[0]:.3g} m, after {done} samples, under commands up to "
                f"{largest:.3g} N; expected forces that stay finite: check the commands, softening springs, magnets "
                "and signs"
            )
        self._forget(segments)
        return Motion(at, motion[0], motion[1], motion[2])

    def step_to(self, time: float) -> Motion:
        """Motion at one instant: ``sample([time])``."""
        return self.sample([time])

    def change(self, truth: Truth) -> None:
        """Go on from the present state with another truth (a parameter set at run time)."""
        force = self._force_now()
        self._take(truth)
        self._segment = np.array([self.time, float(truth.actuate(np.array([self._command]))[0]), 0.0, force])
        anchor = self._mode["anchor_z"].copy()
        self._begin(self.time)
        self._mode["anchor_z"] = anchor

    def restart(self) -> None:
        """Cart at rest at zero and clock at zero; the present command goes on, later ones keep their distance."""
        now = self.time
        self._stamps = [stamp - now for stamp in self._stamps]
        made = float(self.truth.actuate(np.array([self._command]))[0])
        self._segment = np.array([-1.0, made, 0.0, made])
        self._place(0.0, 0.0, 0.0)

    def _force_now(self) -> float:
        return float(kernel.applied_force(self._parameters[0], self._segment, self.time))

    def _segments(self) -> FloatArray:
        """(s, 4) start, value, slope and lagged force of the present command and all later ones."""
        stamps, commands = np.array(self._stamps), np.array(self._commands)
        made = self.truth.actuate(commands)
        if self._hold == "zero" and made.size:
            changes = np.diff(made, prepend=self._segment[1]) != 0.0
            stamps, made = stamps[changes], made[changes]
        table = np.zeros((made.size + 1, 4))
        table[0] = self._segment
        table[1:, 0], table[1:, 1] = stamps, made
        if self._hold == "linear" and made.size > 1:
            table[1:-1, 2] = np.diff(made) / np.diff(stamps)
        kernel.lag(self._parameters, table)
        return table

    def _forget(self, segments: FloatArray) -> None:
        """Drop the commands that later ones have replaced."""
        if self._hold == "linear":
            return
        self._segment = segments[self._mode["segment"][0]].copy()
        self._mode["segment"] = 0
        gone = bisect.bisect_right(self._stamps, self.time)
        if gone:
            self._command = self._commands[gone - 1]
            del self._stamps[:gone], self._commands[:gone]
