"""Which cases are drawn."""

from __future__ import annotations

from bench.blind.cases import Case
from msd_sim import lottery

#: Effects of which a spring-mass rig in free decay feels nothing.
_INPUT = ("actuator_lag", "time_offset", "force_gain_nonlinearity")
_OTHERS = (("step", 1000.0), ("release", 1000.0), ("sweep", 500.0), ("ramp", 250.0), ("steps", 200.0))


def study(rounds: int, seed: int) -> list[Case]:
    """``rounds`` of all effects alone and beside friction, of nothing, of all oddities, and of other experiments."""
    cases: list[Case] = []

    def add(hidden: str | None, beside: bool, experiment: str = "steps", rate: float = 1000.0) -> None:
        cases.append(Case(seed + len(cases), hidden, beside, experiment, rate))

    for turn in range(rounds):
        for name in lottery.NAMES:
            add(name, False)
            if name not in ("coulomb_friction", "stribeck_friction", "position_dependent_friction"):
                add(name, True)
        for _ in range(6):
            add(None, False)
        for name in lottery.ODDITIES:
            add(name, False)
        for index, name in enumerate(lottery.NAMES):
            experiment, rate = _OTHERS[(index + turn) % len(_OTHERS)]
            if experiment != "release" or name not in _INPUT:
                add(name, turn % 2 == 1, experiment, rate)
        for experiment, rate in _OTHERS:
            add(None, False, experiment, rate)
    return cases
