"""Values that the kernel's functions hand on together: named tuples, the records that numba compiles.

The innermost functions (``rk.net_force``, ``rk.acceleration``, ``rk.step4``, ``adams.step_adams``, ``general._alone``)
take single numbers instead: with larger tuples inside their loops the compiler arranges the sums in another order, and
results change in their last digits.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]


class Command(NamedTuple):
    """The commanded force [N] at rising stamps [s], straight between them or held; ``shift`` moves all stamps."""

    time: FloatArray
    force: FloatArray
    straight: bool
    shift: float


class Segments(NamedTuple):
    """The N segments of a record, in each of which the force is level + slope t + transient exp(-decay t).

    Attributes:
        start, length: (N,) [s].
        kind: (N,) place of the length in ``lengths``, -1 for an odd one.
        lengths: the distinct lengths [s] whose propagators are kept.
        level: (N,) force at the start [N], without the transient.
        slope: (N,) [N/s], or (0,) where the force is held.
        transient: (N,) [N], or (0,) without a lag.
        decay: rate [1/s] of the transient, 0 without one.
    """

    start: FloatArray
    length: FloatArray
    kind: npt.NDArray[np.int8]
    lengths: FloatArray
    level: FloatArray
    slope: FloatArray
    transient: FloatArray
    decay: float


class Spring(NamedTuple):
    """The spring as straight pieces: ``edges`` (n + 1,) [m] and ``lines`` (5, n), see ``spring.characteristic``."""

    edges: FloatArray
    lines: FloatArray


class Motion(NamedTuple):
    """Position [m] and velocity [m/s]."""

    x: float
    v: float


class Path(NamedTuple):
    """Room for the motion: positions ``x`` (n,) [m], velocities ``v`` (n,) [m/s] or (0,) when nobody wants them."""

    x: FloatArray
    v: FloatArray


class Linear(NamedTuple):
    """The linear plant: mass [kg], damping [N s/m], stiffness [N/m]."""

    m: float
    b: float
    k: float


class Line(NamedTuple):
    """A force f + r t + e exp(-decay t) [N]; ``decay`` is 0 without a transient."""

    f: float
    r: float
    e: float
    decay: float


class Series(NamedTuple):
    """A motion as a Taylor series: its coefficients ``c``, and how many ``terms`` of them count."""

    c: FloatArray
    terms: int


class Ends(NamedTuple):
    """A motion in an interval, along its direction: velocity at the beginning, accelerations at beginning and end."""

    v0: float
    a0: float
    a1: float


class Axis(NamedTuple):
    """A plant of the exact path: linear between its events.

    Attributes:
        m, b: mass [kg], damping [N s/m].
        constant: force against +x [N].
        kinetic: dry friction while sliding [N].
        hold: the most that dry friction holds at rest [N].
        spring: its pieces.
        eventful: whether it has any events: friction, or a spring of more than one piece.
    """

    m: float
    b: float
    constant: float
    kinetic: float
    hold: float
    spring: Spring
    eventful: bool


class Slide(NamedTuple):
    """A motion of the exact path under ``line`` in direction ``s``, on the piece of the spring from low to high [m]."""

    s: int
    low: float
    high: float
    plant: Linear
    motion: Motion
    line: Line


class Glide(NamedTuple):
    """A stretch without events on the exact path.

    Attributes:
        s: direction of motion; 0: none to keep, no event at v = 0.
        low, high: where the piece of the spring ends [m].
        plant: m, b and k of the piece.
        load: constant force against +x [N].
        table: (kinds, 10) propagators of each kind of segment.
    """

    s: int
    low: float
    high: float
    plant: Linear
    load: float
    table: FloatArray


class Going(NamedTuple):
    """Where a motion of the exact path is: x [m], v [m/s], direction (0 at rest), piece of the spring."""

    x: float
    v: float
    s: int
    i: int


class Cart(NamedTuple):
    """The cart's linear part, and what is coupled to it.

    Attributes:
        active: set of effects, see ``places.BIT``.
        lightness: 1/m [1/kg]; 0 for a held cart, beside which the second mass moves alone.
        b: damping [N s/m].
        constant: force against +x [N].
        m2, k2, b2: the second mass [kg] and its spring and damper; m2 = 0 without one.
    """

    active: int
    lightness: float
    b: float
    constant: float
    m2: float
    k2: float
    b2: float


class World(NamedTuple):
    """What acts on the cart in one run of the general path.

    Attributes:
        cart: its linear part.
        p, w: parameters and memory of all effects.
        stages: room for the slopes of a fifth-order step, of shape ``rk.STAGES``.
    """

    cart: Cart
    p: FloatArray
    w: FloatArray
    stages: FloatArray


class Elastic(NamedTuple):
    """The spring force on one piece, intercept + slope x; that of the linear spring alone; a place [m] in the piece."""

    slope: float
    intercept: float
    own_slope: float
    own_intercept: float
    inside: float


class Piece(NamedTuple):
    """Piece ``i`` of the spring: where it ends [m], and its force."""

    i: int
    low: float
    high: float
    elastic: Elastic


class Drive(NamedTuple):
    """Force on one segment, which begins at ``start`` [s]: f + r t + e exp(-decay t)."""

    start: float
    f: float
    r: float
    e: float
    decay: float


class Phase(NamedTuple):
    """Motion in one direction ``s`` (0 at rest) on one piece of the spring within one segment of this length [s]."""

    world: World
    piece: Piece
    drive: Drive
    length: float
    s: float


class Place(NamedTuple):
    """Positions [m] and velocities [m/s] of the cart (x, v) and the second mass (y, u)."""

    x: float
    v: float
    y: float
    u: float


class State(NamedTuple):
    """The same with the accelerations [m/s²] a and c."""

    x: float
    v: float
    a: float
    y: float
    u: float
    c: float


class Step(NamedTuple):
    """A step of length h [s] by a method of ``methods``, begun t [s] into the segment, from start to end."""

    method: int
    t: float
    h: float
    start: State
    end: State


class Longest(NamedTuple):
    """Longest steps [s] that the methods of fourth and of fifth order may take now."""

    fourth: float
    fifth: float


class Tolerances(NamedTuple):
    """Errors of position [m] and velocity [m/s] that are accepted of a step, by method."""

    x4: float
    v4: float
    x5: float
    v5: float
    adams: float


class Run(NamedTuple):
    """All that stays the same during a run of the general path.

    Attributes:
        world, spring: what acts on the cart.
        eventful: whether turns and knees are events.
        restless: whether forces change by themselves at rest.
        quick: whether forces change quickly after a turn.
        speedy: the same, or whether they change with the speed in another way than damping does.
        far: distance [m] from where it begins at which the motion is given up.
        tolerances: accepted errors.
    """

    world: World
    spring: Spring
    eventful: bool
    restless: bool
    quick: bool
    speedy: bool
    far: float
    tolerances: Tolerances


class Pace(NamedTuple):
    """How segments are cut into even parts of one step each.

    Attributes:
        parts: their number, a power of 2.
        part: the next one of the present segment, from 0.
        since: segments done since their number changed.
        patience: segments after which half as many are tried.
        fewer: whether their number was halved last.
    """

    parts: int
    part: int
    since: int
    patience: int
    fewer: bool


class Progress(NamedTuple):
    """How far a run is: state, direction, piece of the spring, longest steps, and the number of steps left."""

    state: State
    s: float
    i: int
    longest: Longest
    budget: int
