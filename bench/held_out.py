"""``python -m bench.held_out``: is a useless effect rejected on left-out data, and a true one accepted?

python -m bench.held_out [--experiment steps] [--seeds 30] [--noise]

Random rigs obey m x'' + b x' + k x = F exactly; each is extended by two effects that it does not have, and the
extension must not be called better. Then each effect of the library acts, and the extension must be called better; with
``--noise`` the noise is so large that the effect is hardly visible.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from msd_ident import parallel

parallel.one_blas_thread()  # as the `msd` command does, before numpy is imported

from msd_ident.data.record import Record  # noqa: E402
from msd_ident.estimate.problem import Initial  # noqa: E402
from msd_ident.model import Plant  # noqa: E402
from msd_ident.model.effects import LIBRARY, by_name  # noqa: E402
from msd_ident.residuals import noise_model  # noqa: E402
from msd_ident.selection.cross_validation import HeldOut, predict  # noqa: E402
from msd_ident.selection.experiment import Experiment  # noqa: E402
from msd_ident.selection.hypothesis import Hypothesis  # noqa: E402
from msd_ident.selection.hypothesis_fit import refine  # noqa: E402
from msd_sim import lottery  # noqa: E402
from msd_sim.api import simulate  # noqa: E402

#: Effects that each rig without any is extended by, one after the other.
USELESS = 2
_NAMES = tuple(effect.name for effect in LIBRARY if effect.name in lottery.NAMES)
#: Fall of chi² that a true effect must be worth to be counted: less is not named by any evidence.
_VISIBLE = 50.0


@dataclass(frozen=True)
class Trial:
    """One comparison: the rig's seed, the effect that extends the base model, the fall of chi² over all data, what the
    left-out data says and the processor time it took [s].
    """

    seed: int
    effect: str
    fall: float
    held: HeldOut
    seconds: float

    def line(self) -> str:
        """For a terminal."""
        low, high = self.held.interval_percent
        better = "better" if self.held.better else "not better"
        return (
            f"{self.seed:5d} {self.effect:28s} chi² falls by {self.fall:12.2f}; left out "
            f"{self.held.reduction_percent:9.4f} % ({low:.4f} to {high:.4f}): {better}, {self.seconds:.3f} s"
        )


def useless(seeds: Sequence[int], experiment: str = "steps") -> Iterator[Trial]:
    """Rigs without any effect, each extended by two effects of the library in turn."""
    for seed in seeds:
        data, start, _ = _measured(seed, None, experiment)
        base = refine(data, frozenset(), data.base, (start,))
        for turn in range(USELESS):
            name = _NAMES[(USELESS * seed + turn) % len(_NAMES)]
            if name in data.library:
                yield _trial(seed, name, data, base, _guessed(data, base, name))


def true(seeds: Sequence[int], experiment: str = "steps", fall: float = math.inf) -> Iterator[Trial]:
    """Rigs with one effect each, the library's in turn, where it is worth anything.

    If ``fall`` is finite, under so much noise that chi² falls by about that much with it.
    """
    for seed in seeds:
        name = _NAMES[seed % len(_NAMES)]
        data, start, law = _measured(seed, name, experiment)
        if name not in data.library or (trial := _of_truth(seed, name, data, start, law)).fall < _VISIBLE:
            continue
        if math.isfinite(fall):
            noise = data.readings[0].noise * math.sqrt(trial.fall / fall)
            data, start, law = _measured(seed, name, experiment, noise)
            trial = _of_truth(seed, name, data, start, law)
        yield trial


def _of_truth(seed: int, name: str, data: Experiment, start: Initial, law: dict[str, float]) -> Trial:
    base = refine(data, frozenset(), data.base, (start,))
    kind = by_name(name)
    absent = {parameter.name: math.inf for parameter in kind.parameters} | dict(kind.neutral)
    model = data.base + kind.from_values(absent | law)
    return _trial(seed, name, data, base, refine(data, frozenset({name}), model, (start,)))


def _trial(seed: int, name: str, data: Experiment, base: Hypothesis, extended: Hypothesis) -> Trial:
    began = time.process_time()
    held = predict(data, base, extended)
    return Trial(seed, name, base.chi - extended.chi, held, time.process_time() - began)


def _guessed(data: Experiment, base: Hypothesis, name: str) -> Hypothesis:
    """The base model with one effect more, the best from its first guesses."""
    guesses = by_name(name).guess(data.records[0], base.model)[:2]
    found = [refine(data, frozenset({name}), base.model + guess, base.initial) for guess in guesses]
    return min(found, key=lambda fitted: fitted.chi)


def _measured(
    seed: int, hidden: str | None, experiment: str, noise: float | None = None
) -> tuple[Experiment, Initial, dict[str, float]]:
    """A rig's record as evidence, with the true plant; how it begins; the true law of what is hidden."""
    drawn = lottery.draw(seed, hidden, experiment=experiment)
    spec = dict(drawn.spec)
    if noise is not None:
        spec["encoder"] = {"counts_per_metre": 0.0, "noise": noise}
    made = simulate(spec)
    record = Record(made.time, made.position, made.force_time, made.force, hold=made.hold)
    plant = Plant(spec["mass"], spec["damping"], spec["stiffness"])
    fixed = frozenset() if record.force.any() else frozenset({"mass"})
    first = float(record.position[0])
    start = Initial(first) if experiment == "release" else Initial(zero=first)
    law = dict(spec["effects"].get(hidden, {}))
    return Experiment(noise_model.prepare([record]), plant, fixed), start, law


def main(arguments: Sequence[str] | None = None) -> int:
    """Print both tables; exit code 1 where more than one useless effect in thirty is called better."""
    parser = argparse.ArgumentParser(prog="python -m bench.held_out", description="Useless effects on left-out data.")
    parser.add_argument("--experiment", choices=lottery.EXPERIMENTS, default="steps")
    parser.add_argument("--seeds", type=int, default=30)
    parser.add_argument(
        "--noise", type=float, default=math.inf, metavar="FALL", help="chi² that a true effect is worth"
    )
    given = parser.parse_args(arguments)
    lost = list(useless(range(given.seeds), given.experiment))
    print("\n".join(trial.line() for trial in lost))
    won = list(true(range(100, 100 + given.seeds), given.experiment, given.noise))
    print("\n".join(trial.line() for trial in won))
    wrong, right = (sum(trial.held.better for trial in trials) for trials in (lost, won))
    print(f"\ncalled better: {wrong} of {len(lost)} useless effects, {right} of {len(won)} true ones")
    print(f"processor time: {max(trial.seconds for trial in (*lost, *won)):.3f} s at most")
    return int(30 * wrong > len(lost))


if __name__ == "__main__":
    sys.exit(main())
