"""Cases of each blind study: which effects are hidden, in which experiment, at which rate and noise."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count, cycle

import numpy as np

from bench.blind.cases import SEVERAL, Case
from bench.blind.truth import DRY, FAMILIES, UNNAMED
from bench.mujoco_rigs.rig import EXPERIMENTS, LEVELS, OF_DRIVE
from bench.several_faults import rig as several_rig
from msd_sim import foreign, lottery

#: Effects of which a spring-mass rig in free decay feels nothing.
_INPUT = ("actuator_lag", "time_offset", "force_gain_nonlinearity")
_OTHERS = (("step", 1000.0), ("release", 1000.0), ("sweep", 500.0), ("ramp", 250.0), ("steps", 200.0))
#: Faults of a round of MuJoCo's rigs, and whether frictionloss acts beside them.
_MUJOCO = (
    (None, False), ("frictionloss", False), ("limit", False), ("limit", True), ("lag", False), ("lag", True),
    ("saturation", False), ("saturation", True), ("dead_zone", False), ("dead_zone", True),
)  # fmt: skip
#: Of a round: clean rigs, pairs without Coulomb friction, effects under noise that is not white.
_CLEAN, _PAIRS, _NOISY = 6, 12, 8


def study(rounds: int, seed: int) -> list[Case]:
    """``rounds`` of everything: see ``_round``; each case has a seed of its own, from ``seed`` on."""
    seeds = count(seed)
    return [
        Case(next(seeds), hidden, beside, experiment, rate, other, "wide", noise)
        for turn in range(rounds)
        for hidden, beside, experiment, rate, other, noise in _round(turn, np.random.default_rng([seed, turn]))
    ]


def variants(rounds: int, seed: int) -> list[Case]:
    """Each foreign law once a round, in turn in each of the experiments in which it shows."""
    seeds = count(seed)
    return [
        Case(next(seeds), law.name, False, law.experiments[turn % len(law.experiments)], author="foreign")
        for turn in range(rounds)
        for law in foreign.LAWS.values()
    ]


def variant_pairs(rounds: int, seed: int) -> list[Case]:
    """Two foreign laws of different modules and families at once: ten rigs a round, half of them released."""
    return [
        Case(number, *_two_foreign(experiment, np.random.default_rng([number, 2])), author="foreign")
        for number, experiment in zip(range(seed, seed + 10 * rounds), cycle(("steps", "release")), strict=False)
    ]


def _two_foreign(experiment: str, rng: np.random.Generator) -> tuple[str, bool, str, float, str]:
    """A case's two laws by lot, of those that the experiment shows and that have a cause which must be named."""
    shown = [
        (table, law.name)
        for table in foreign.TABLES
        for law in table.LAWS
        if experiment in law.experiments and law.name not in UNNAMED
    ]
    table, one = shown[int(rng.integers(len(shown)))]
    others = [name for other, name in shown if other is not table and FAMILIES[name].isdisjoint(FAMILIES[one])]
    return one, False, experiment, 1000.0, others[int(rng.integers(len(others)))]


def forms(rounds: int, seed: int) -> list[Case]:
    """Our own rig with laws that are forms of known causes; every other round in a release, where no force is."""
    seeds = count(seed)
    return [
        Case(next(seeds), name, False, *_experiment(name, turn), None, "narrow")
        for turn in range(rounds)
        for name in lottery.VARIANTS
    ]


def mujoco(rounds: int, seed: int) -> list[Case]:
    """Each fault alone and beside frictionloss, frictionloss alone, and nothing: ten rigs a round."""
    seeds = count(seed)
    return [
        Case(next(seeds), fault, beside, experiment, EXPERIMENTS[experiment], author="mujoco")
        for turn in range(rounds)
        for index, (fault, beside) in enumerate(_MUJOCO)
        for experiment in (_shows(fault, turn + index),)
    ]


def several(rounds: int, seed: int) -> list[Case]:
    """Rigs with three to five faults: ten a round, their experiments in turn."""
    seeds = count(seed)
    experiments = several_rig.EXPERIMENTS
    return [
        Case(next(seeds), SEVERAL, False, experiments[turn % len(experiments)], author="several")
        for turn in range(10 * rounds)
    ]


def _shows(fault: str | None, turn: int) -> str:
    """An experiment of MuJoCo's rigs that shows a fault, another one each turn; steps half of the time."""
    hidden = {"release", "step"} if fault in LEVELS else {"release"} if fault in OF_DRIVE else set()
    others = [name for name in EXPERIMENTS if name not in hidden | {"steps"}]
    return "steps" if turn % 2 == 0 else others[turn // 2 % len(others)]


def _experiment(variant: str, turn: int) -> tuple[str, float]:
    """In which a variant is hidden, and samples a second [Hz]: about twenty a period where the force between counts."""
    if variant == lottery.BAND_LIMITED:
        return "sweep", 100.0
    return ("release", 1000.0) if turn % 2 and variant not in ("soft_saturation", "drive_brake") else ("steps", 1000.0)


_Drawn = tuple[str | None, bool, str, float, str | None, lottery.Noise]


def _round(turn: int, rng: np.random.Generator) -> Iterator[_Drawn]:
    """All effects alone and beside friction, pairs, nothing, all oddities, other experiments, other noise."""
    for name in lottery.NAMES:
        yield name, False, "steps", 1000.0, None, "white"
        if name not in DRY - {"hysteresis"}:
            yield name, True, "steps", 1000.0, None, "white"
    for one, two in _pairs(rng):
        yield one, False, "steps", 1000.0, two, "white"
    for _ in range(_CLEAN):
        yield None, False, "steps", 1000.0, None, "white"
    for name in lottery.ODDITIES:
        yield name, False, "steps", 1000.0, None, "white"
    yield from _others(turn)
    for noise in ("coloured", "speed"):
        yield from _noisy(turn, noise)


def _others(turn: int) -> Iterator[_Drawn]:
    """Each effect in one of the other experiments, another one each turn, and nothing in each of them."""
    for index, name in enumerate(lottery.NAMES):
        experiment, rate = _OTHERS[(index + turn) % len(_OTHERS)]
        if experiment != "release" or name not in _INPUT:
            yield name, turn % 2 == 1, experiment, rate, None, "white"
    for experiment, rate in _OTHERS:
        yield None, False, experiment, rate, None, "white"


def _noisy(turn: int, noise: lottery.Noise) -> Iterator[_Drawn]:
    """Nothing, in all experiments, and some effects, alone and beside friction, under this noise."""
    for experiment, rate in (("steps", 1000.0), *_OTHERS):
        yield None, False, experiment, rate, None, noise
    for index in range(_NOISY):
        name = lottery.NAMES[(turn * _NOISY + index) % len(lottery.NAMES)]
        yield name, index % 2 == 1, "steps", 1000.0, None, noise


def _pairs(rng: np.random.Generator) -> list[tuple[str, str]]:
    """Two effects that are not Coulomb friction, and not two laws of dry friction."""
    names = [name for name in lottery.NAMES if name != "coulomb_friction"]
    every = [(one, two) for i, one in enumerate(names) for two in names[i + 1 :] if not {one, two} <= DRY]
    return [every[index] for index in rng.choice(len(every), _PAIRS, replace=False)]
