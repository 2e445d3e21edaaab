"""Random faults from a seed, on nodes that are not restarted, and whether the nodes report them and recover."""

from __future__ import annotations

import random
import resource
import time
import traceback
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from bench.reliability.nodes.faults import FAULTS, Fault
from bench.reliability.nodes.world import Failed, World


@dataclass
class Found:
    """Result of a soak: how often each fault was done, what went wrong, memory [MB] early and at the end."""

    done: Counter[str] = field(default_factory=Counter)
    wrong: list[tuple[str, str]] = field(default_factory=list)
    memory: tuple[float, float] = (0.0, 0.0)
    seconds: float = 0.0
    processor: float = 0.0

    def outcome(self, name: str) -> str:
        """Of one fault, in words."""
        failures = [words for fault, words in self.wrong if fault == name]
        if failures:
            return f"{len(failures)} failed, the first: {failures[0]}"
        return "reported, data OK again, estimates within 1 %"


def inject(world: World, fault: Fault, rng: random.Random) -> str:
    """Do a fault and see that the nodes say it and recover; why they did not, or nothing."""
    try:
        world.forget()
        fault.do(world, rng)
        if fault.words:
            world.wait_said(fault.words)
        world.recover()
    except Failed as failure:
        return str(failure)
    except Exception:
        return traceback.format_exc()
    return ""


def soak(
    world: World,
    seconds: float,
    seed: int,
    tell: Callable[[str], None],
    pause: float = 0.0,
    faults: Sequence[Fault] = FAULTS,
) -> Found:
    """Faults drawn from a seed until the time is over; every one of them first once, in random order."""
    rng, found = random.Random(seed), Found()
    start, burnt = time.monotonic(), time.process_time()
    world.recover()
    waiting = rng.sample(faults, len(faults))
    while waiting or time.monotonic() - start < seconds:
        spent = time.process_time()
        fault = waiting.pop() if waiting else rng.choices(faults, [one.share for one in faults])[0]
        wrong = inject(world, fault, rng)
        found.done[fault.name] += 1
        if wrong:
            found.wrong.append((fault.name, wrong))
        spent = time.process_time() - spent
        tell(f"{time.monotonic() - start:7.1f} s  {fault.name} ({spent:.1f} s of processor time): {wrong or 'handled'}")
        if not waiting and not found.memory[0]:
            found.memory = (memory(), 0.0)
        time.sleep(min(pause, max(seconds - (time.monotonic() - start), 0.0)))
    found.memory = (found.memory[0], memory())
    found.seconds, found.processor = time.monotonic() - start, time.process_time() - burnt
    return found


def memory() -> float:
    """What this process has in memory now [MB]."""
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * resource.getpagesize() / 1e6
