"""A joint behind a geared position servo, as hobby arms have them, and one whose drive tells its torque."""

from __future__ import annotations

import numpy as np

from msd_ident.data.record import Record

#: Samples a second of an arm's joint states.
RATE = 100.0


def commanded(seconds: float = 20.0) -> tuple[np.ndarray, np.ndarray]:
    """Instants [s], and a trajectory that a user teaches [rad]."""
    time = np.arange(int(seconds * RATE)) / RATE
    return time, 0.8 * np.sin(1.3 * time) + 0.3 * np.sin(0.37 * time + 1.0) + 0.1 * np.sin(3.1 * time)


def geared(seed: int) -> Record:
    """The load of a servo: friction in the gear, a dead band, gravity a little, rounded to a tenth of a percent."""
    random = np.random.default_rng(seed)
    time, x = commanded()
    speed = np.gradient(x, time)
    friction = 0.12 * np.tanh(speed / 0.02) * (1.0 + 0.25 * random.normal(size=time.size))
    load = friction + 0.05 * np.sin(x) + 0.03 * np.convolve(random.normal(size=time.size), np.ones(15) / 4.0, "same")
    load[np.abs(load) < 0.03] = 0.0
    steps = 2.0 * np.pi / 4096.0
    return Record(time, np.round(x / steps) * steps, time, np.round(load, 3), force_unit="N·m", position_unit="rad")


def torque(seed: int) -> Record:
    """The torque of a direct drive: inertia, viscous and dry friction, gravity, noise of a sensor."""
    random = np.random.default_rng(seed)
    time, x = commanded()
    speed = np.gradient(x, time)
    force = 0.4 * np.gradient(speed, time) + 0.2 * speed + 0.1 * np.tanh(speed / 0.02) + 0.3 * np.sin(x)
    force = force + 0.02 * random.normal(size=time.size)
    steps = 2.0 * np.pi / 65536.0
    return Record(time, np.round(x / steps) * steps, time, force, force_unit="N·m", position_unit="rad")
