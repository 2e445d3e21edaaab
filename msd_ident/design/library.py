"""The family of profiles that a design chooses from, each of unit force, with times in periods of the plant."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from msd_ident.design.profile import Profile, Segment
from msd_ident.estimate.effort import A_SWING
from msd_ident.tuning import tuned

_REST = tuned(
    0.25, unit="periods", why="rest before the first push: it shows the noise and where zero is", chosen="by hand"
)
_LEAST_REST = tuned(0.1, unit="s", why="the same, at least", chosen="by hand")
#: Commands a period at the highest frequency of a sweep.
_FINE = 2.0 * A_SWING


@dataclass(frozen=True)
class TimeScale:
    """Time scale of a family of profiles.

    Attributes:
        period: of the plant [s].
        longest: duration of the longest experiment [s].
    """

    period: float
    longest: float


def family(pace: TimeScale, unit: str = "N") -> list[Profile]:
    """All experiments that are not longer than allowed, with forces between −1 and 1 unit.

    Steps of several sizes in both directions, releases from a held force, ramps with dwell, sweeps, staircases, small
    reversals, pseudo-random trains, a ring-down after resonance, and rest.

    Args:
        pace: period of the plant and longest experiment.
        unit: of the force.
    """
    rest = max(_REST * pace.period, _LEAST_REST)
    made: list[Profile] = []
    for name, segments in _shapes(pace, rest):
        whole = (Segment("hold", rest), *segments)
        fastest = max((max(s.low_hz, s.high_hz) for s in segments), default=0.0)
        rate = min(max(_FINE * fastest, 100.0, 20.0 / pace.period), 1000.0)
        if sum(segment.duration for segment in whole) <= pace.longest * (1.0 + 1e-9):
            made.append(Profile(whole, name, unit, rate))
    return made


def turned(profile: Profile) -> Profile:
    """The same profile with the opposite sign of all forces."""
    return replace(profile.scaled(-1.0), name=f"{profile.name}, turned")


Shape = tuple[str, tuple[Segment, ...]]


def _shapes(pace: TimeScale, rest: float) -> Iterator[Shape]:
    room = pace.longest - rest
    if room <= 0.0:
        return
    yield from _steps(pace.period)
    yield from _repeated(pace.period, room)
    yield from _staircases(pace.period, room)
    yield from _releases(pace.period)
    yield from _ramps(pace.period, room)
    yield from _sweeps(pace.period, room)
    yield from _reversals(pace.period)
    yield from _trains(pace.period, room)
    yield from _rings(pace.period)
    yield "rest", (Segment("hold", min(10.0 * pace.period, room)),)


def levels(values: tuple[float, ...], hold: float) -> tuple[Segment, ...]:
    """Segments that step to given forces and hold them; a force of 0 is a release.

    Args:
        values: forces [N].
        hold: duration of each [s].
    """
    return tuple(Segment("step", hold, force=v) if v else Segment("release", hold) for v in values)


def _steps(period: float) -> Iterator[Shape]:
    for turns in (3.0, 8.0):
        hold = turns * period
        yield f"step, {turns:g} periods", levels((1.0, 0.0), hold)
        yield f"steps both ways, {turns:g} periods", levels((1.0, 0.0, -1.0, 0.0), hold)
        yield (
            f"steps of two sizes both ways, {turns:g} periods",
            levels((1.0, 0.0, -1.0, 0.0, 0.3, 0.0, -0.3, 0.0), hold),
        )
    yield "small steps both ways, 3 periods", levels((0.1, 0.0, -0.1, 0.0), 3.0 * period)


def _repeated(period: float, room: float) -> Iterator[Shape]:
    """Steps again and again over the whole time: the ring-downs of a step that would have come to rest."""
    for turns in (3.0, 6.0):
        hold = turns * period
        count = int(room / hold / 4.0)
        for what, size in (("", 1.0), ("small ", 0.15)):
            if count >= 2:
                train = levels((size, 0.0, -size, 0.0) * count, hold)
                yield f"repeated {what}steps both ways, {turns:g} periods", train
    count = int(room / (6.0 * period) / 8.0)
    if count >= 1:
        train = levels((1.0, 0.0, -1.0, 0.0, 0.3, 0.0, -0.3, 0.0) * count, room / (8.0 * count))
        yield f"repeated steps of two sizes both ways, {room:.2g} s", train


def _staircases(period: float, room: float) -> Iterator[Shape]:
    up = (0.25, 0.5, 0.75, 1.0)
    both = (*up, *up[-2::-1], 0.0, *(-v for v in up), *(-v for v in up[-2::-1]), 0.0)
    for hold in (1.5 * period, min(4.0 * period, room / len(both))):
        yield f"staircase both ways, {hold / period:.2g} periods", levels(both, hold)


def _releases(period: float) -> Iterator[Shape]:
    def let_go(force: float, ring: float) -> tuple[Segment, ...]:
        lead = (Segment("ramp", 3.0 * period, force=force), Segment("hold", 2.0 * period))
        return (*lead, Segment("release", ring * period))

    yield "release", let_go(1.0, 12.0)
    yield "releases both ways", (*let_go(1.0, 8.0), *let_go(-1.0, 8.0))
    yield "releases of two sizes both ways", (
        *let_go(1.0, 8.0), *let_go(-1.0, 8.0), *let_go(0.3, 6.0), *let_go(-0.3, 6.0),
    )  # fmt: skip


def _ramps(period: float, room: float) -> Iterator[Shape]:
    for share in (0.25, 0.5, 1.0):
        leg = share * room / 5.0
        if leg < 2.0 * period:
            continue
        dwell = 0.5 * leg
        yield f"ramp both ways with dwell, {5.0 * leg:.2g} s", (
            Segment("ramp", leg, force=1.0), Segment("hold", dwell), Segment("ramp", 2.0 * leg, force=-1.0),
            Segment("hold", dwell), Segment("ramp", leg, force=0.0),
        )  # fmt: skip


def _sweeps(period: float, room: float) -> Iterator[Shape]:
    for share in (0.25, 0.5, 1.0):
        duration = share * room
        if duration < 6.0 * period:
            continue
        for what, low, high in (("", 0.15, 2.5), ("slow ", 0.05, 0.6), ("fast ", 1.2, 6.0)):
            yield (
                f"{what}sweep, {duration:.2g} s",
                (Segment("sweep", duration, amplitude=1.0, low_hz=low / period, high_hz=high / period),),
            )
    if room > 8.0 * period:
        duration = min(20.0 * period, room)
        yield (
            f"sweep beside a held force, {duration:.2g} s",
            (Segment("sweep", duration, amplitude=0.5, offset=0.5, low_hz=0.15 / period, high_hz=2.5 / period),),
        )


def _reversals(period: float) -> Iterator[Shape]:
    for turns in (1.0, 3.0):
        zigzag: list[Segment] = [Segment("ramp", 3.0 * period, force=0.6)]
        for size in (0.1, 0.1, 0.3, 0.3):
            zigzag += [Segment("ramp", turns * period, force=0.6 - size), Segment("ramp", turns * period, force=0.6)]
        zigzag.append(Segment("release", 3.0 * period))
        yield f"small reversals, {turns:g} periods", tuple(zigzag)


def _trains(period: float, room: float) -> Iterator[Shape]:
    for share in (0.25, 0.5, 1.0):
        duration = share * room
        for bit in (0.15, 0.5, 2.0):
            if duration > 10.0 * bit * period:
                train = Segment("prbs", duration, amplitude=1.0, shortest=bit * period, seed=round(100 * bit))
                yield f"pseudo-random train of {bit:g} periods, {duration:.2g} s", (train,)
    if room > 20.0 * period:
        large = Segment("prbs", 0.5 * room, amplitude=1.0, shortest=0.5 * period, seed=7)
        small = Segment("prbs", 0.5 * room, amplitude=0.2, shortest=0.5 * period, seed=8)
        yield f"pseudo-random trains of two sizes, {room:.2g} s", (large, small)


def _rings(period: float) -> Iterator[Shape]:
    near = Segment("sweep", 6.0 * period, amplitude=1.0, low_hz=0.85 / period, high_hz=1.1 / period)
    yield "resonance, then ring-down", (near, Segment("release", 12.0 * period))


_WHY = {
    "step": "a step shows the static gain and how fast it rings down",
    "steps both": "both directions show what differs between directions",
    "steps of two": "two sizes in both directions show what changes with amplitude and direction",
    "repeated": "successive ring-downs show the energy loss of each swing",
    "small steps": "small steps show what holds the cart against small forces",
    "staircase": "many levels at rest show how position depends on force",
    "release": "free motion does not depend on the input, and its decay over amplitude distinguishes friction from "
    "drag",
    "ramp": "slow motion excludes mass and damper, and dwelling shows what sticks or creeps",
    "sweep": "motion at all speeds, through resonance, shows what depends on speed, amplitude and time",
    "slow": "slow motion over the whole travel shows what depends on position and direction",
    "fast": "above resonance the phase shows lag and delay",
    "small reversals": "small reversals show effects with memory",
    "pseudo": "many frequencies at once, in little time",
    "resonance": "resonance gives a large motion with a small force, and its ring-down shows the energy loss",
    "rest": "without force only disturbances and drift are left",
}


def why(name: str) -> str:
    """What a profile of the family is good for."""
    fitting = [key for key in _WHY if name.startswith(key)]
    return _WHY[max(fitting, key=len)] if fitting else "the predictions of the rivals differ"
