"""Speed and accuracy of the solver beside a bare recurrence, SciPy and python-control."""

from __future__ import annotations

import itertools
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from bench.measure import LENGTHS, Row, linearity, median_seconds
from msd_ident.data.record import Record
from msd_ident.errors import UsageError
from msd_ident.model import Model, Plant, Simulator
from msd_ident.model.effects import LIBRARY
from msd_ident.model.effects.coulomb_friction import CoulombFriction
from msd_ident.model.effects.force_offset import ForceOffset
from msd_ident.model.linear import transfer_function

FloatArray = npt.NDArray[np.float64]
SAMPLES, RATE = 3000, 1000.0
#: Slowest combinations of a first look that are measured again.
_AGAIN = 60
PLANT = Plant(0.9407, 3.927, 694.1)
RUBBING = PLANT + CoulombFriction(0.3) + ForceOffset(0.1)

#: Strengths at which these effects are plainly at work on the plant above.
STRENGTHS: dict[str, dict[str, float]] = {
    "actuator_lag": {"lag_time": 0.004},
    "asymmetric_spring": {"quadratic_stiffness": 4e3},
    "backlash": {"backlash_half_width": 0.002},
    "cogging": {"cogging_amplitude": 0.3, "cogging_pitch": 0.01, "cogging_phase": 0.4},
    "coulomb_friction": {"coulomb_force": 0.3},
    "cubic_spring": {"cubic_stiffness": 2e5},
    "end_stop": {"stop_position": 0.018, "stop_stiffness": 5e3},
    "force_gain_nonlinearity": {"gain_slope": 0.01},
    "force_offset": {"offset_force": 0.5},
    "hysteresis": {"hysteresis_force": 0.4, "hysteresis_length": 0.003},
    "periodic_disturbance": {"disturbance_amplitude": 0.3, "disturbance_frequency": 60.0},
    "position_dependent_friction": {"coulomb_force": 0.3, "position_friction_slope": 20.0},
    "quadratic_drag": {"drag_coefficient": 3.0},
    "second_mode": {"second_mass": 0.2, "second_stiffness": 800.0, "second_damping": 0.5},
    "sensor_drift": {"sensor_drift_rate": 1e-4},
    "stiffness_drift": {"stiffness_drift_rate": 0.02},
    "stribeck_friction": {"coulomb_force": 0.2, "static_force": 0.4, "stribeck_velocity": 0.02},
    "time_offset": {"time_offset": 0.0023},
}


def record(samples: int = SAMPLES) -> Record:
    """A square wave of 10.4 N at 1.5 Hz, at 1 kHz: the cart never comes to rest, so nothing is skipped."""
    time = np.arange(samples) / RATE
    force = 10.4 * np.sign(np.sin(2.0 * np.pi * 1.5 * (time + 1e-4)))
    return Record(time=time, position=0.0 * time, force_time=time, force=force)


def rows() -> list[Row]:
    """All figures of the solver."""
    bare = bare_recurrence()
    exact = simulation_seconds(RUBBING, record())
    return [
        Row("bare two-state recurrence in numba", bare, "ns/sample"),
        Row("exact path (m, b, k, Fc, offset)", 1e9 * exact / SAMPLES / bare, "× bare", must=4.0, aim=2.0,
            detail=f"{1e9 * exact / SAMPLES:.2f} ns/sample, {1e6 * exact:.1f} µs for {SAMPLES} samples"),
        *three_effects(),
        against_solve_ivp(exact),
        *against_linear(),
        length_row(),
        compile_row(),
    ]  # fmt: skip


def bare_recurrence() -> float:
    """ns a sample of x, v <- A (x, v) + B f, compiled, and nothing else."""
    import numba

    @numba.njit
    def recur(a: float, b: float, c: float, d: float, e: float, g: float, force: FloatArray, out: FloatArray) -> None:
        x, v = 0.0, 0.0
        for i in range(force.size):
            f = force[i]
            x, v = a * x + b * v + e * f, c * x + d * v + g * f
            out[i] = x

    force, out = record().force.copy(), np.empty(SAMPLES)
    return 1e9 * median_seconds(lambda: recur(0.999, 1e-3, -0.7, 0.99, 5e-7, 1e-3, force, out)) / SAMPLES


def simulation_seconds(model: Model, measured: Record, budget: float = 0.5) -> float:
    """Median duration of one simulation, call included."""
    simulator, values = Simulator(model, measured), model.values
    return median_seconds(lambda: simulator.positions(values), budget=budget)


def three_effects() -> list[Row]:
    """Every sensible combination of three effects: the median and the slowest, which is measured again at length.

    The largest of so many short measurements is where the machine was busy with something else.
    """
    measured, models = record(), {}
    for names in itertools.combinations(sorted(STRENGTHS), 3):
        try:
            model = PLANT
            for effect in LIBRARY:
                if effect.name in names:
                    model = model + effect(**STRENGTHS[effect.name])
        except UsageError:
            continue
        models[names] = model

    def nanoseconds(names: tuple[str, ...], budget: float) -> float:
        return 1e9 * simulation_seconds(models[names], measured, budget=budget) / SAMPLES

    first = {names: nanoseconds(names, 0.004) for names in models}
    slow = sorted(models, key=lambda names: -first[names])[:_AGAIN]
    long = {names: nanoseconds(names, 0.1) for names in slow}
    slowest = max(slow, key=lambda names: long[names])
    middle = statistics.median(first.values())
    within = sum(value <= 120.0 for value in first.values())
    return [
        Row("any three effects, median of all combinations", middle, "ns/sample", must=120.0, aim=50.0,
            detail=f"{len(models)} combinations, {within} of them within 120 ns at the first look"),
        Row("any three effects, slowest combination", long[slowest], "ns/sample", must=120.0, aim=50.0,
            detail=" + ".join(slowest)),
    ]  # fmt: skip


def against_solve_ivp(ours: float) -> Row:
    """The exact path's model through ``solve_ivp`` with events, at the loosest rtol that reaches 1e-6."""
    measured = record()
    truth = Simulator(RUBBING, measured).positions(RUBBING.values)
    amplitude = float(np.max(np.abs(truth)))
    for exponent in range(5, 12):
        rtol = 10.0**-exponent
        error = float(np.max(np.abs(solve_ivp_positions(measured, rtol) - truth))) / amplitude
        if error <= 1e-6:
            break
    theirs = median_seconds(lambda: solve_ivp_positions(measured, rtol), budget=0.3)
    detail = f"solve_ivp {1e3 * theirs:.1f} ms at rtol {rtol:.0e}, its error {error:.1e} of the amplitude"
    return Row("against solve_ivp with events at 1e-6", theirs / ours, "× faster", 300.0, 1000.0, True, detail)


def solve_ivp_positions(measured: Record, rtol: float) -> FloatArray:
    """RUBBING through SciPy: an integration from each event or change of the force to the next."""
    from scipy.integrate import solve_ivp

    m, b, k, friction, offset = (RUBBING[n] for n in ("mass", "damping", "stiffness", "coulomb_force", "offset_force"))
    time, force = measured.time, measured.force
    cuts = np.concatenate([[0], np.flatnonzero(np.diff(force)) + 1, [time.size - 1]])
    out, state = np.zeros(time.size), np.zeros(2)
    for first, last in itertools.pairwise(cuts):
        now, f = time[first], force[first] - offset
        direction = math.copysign(1.0, state[1]) if state[1] else 0.0
        while now < time[last]:
            if direction == 0.0:
                net = f - k * state[0]
                if abs(net) <= friction:
                    out[(time > now) & (time <= time[last])] = state[0]
                    break
                direction = math.copysign(1.0, net)

            def slope(_t: float, y: FloatArray, push: float = f - direction * friction) -> list[float]:
                return [y[1], (push - b * y[1] - k * y[0]) / m]

            def turns(_t: float, y: FloatArray) -> float:
                return float(y[1])

            turns.terminal, turns.direction = True, -direction  # type: ignore[attr-defined]
            inside = (time > now) & (time <= time[last])
            done = solve_ivp(
                slope, (now, time[last]), state, t_eval=time[inside], events=turns, rtol=rtol, atol=1e-3 * rtol
            )
            out[np.flatnonzero(inside)[: done.t.size]] = done.y[0]
            turned = done.status == 1
            now = float(done.t_events[0][0]) if turned else time[last]
            state = np.array([done.y_events[0][0][0], 0.0]) if turned else done.y[:, -1]
            direction = 0.0 if turned else direction
    return out


def against_linear() -> list[Row]:
    """The plain plant beside ``control.forced_response`` and ``scipy.signal.lsim``."""
    import control
    from scipy.signal import StateSpace, lsim

    measured = record()
    ours = simulation_seconds(PLANT, measured)
    system = transfer_function(PLANT)
    space = control.ss(system)
    plain = StateSpace(space.A, space.B, space.C, space.D)
    theirs = {
        "control.forced_response": lambda: control.forced_response(system, measured.time, measured.force),
        "scipy.signal.lsim": lambda: lsim(plain, measured.force, measured.time),
    }
    rows = []
    for name, call in theirs.items():
        seconds = median_seconds(call, budget=0.3)
        rows.append(Row(f"plain plant against {name}", seconds / ours, "× faster", detail=f"{1e3 * seconds:.1f} ms"))
    return rows


def length_row() -> Row:
    """Cost of one simulation against length."""
    simulators = {n: Simulator(RUBBING, record(n)) for n in LENGTHS}

    def prepare(samples: int, _: int) -> Callable[[], object]:
        return lambda: simulators[samples].positions(RUBBING.values)

    return linearity("simulation", prepare, rounds=60)


_COLD = """
import json, time
begun = time.perf_counter()
from msd_ident.model import warm_up
said = []
warm_up(said.append)
print(json.dumps({"seconds": time.perf_counter() - begun, "said": said}))
"""


def compile_row() -> Row:
    """First run with an empty cache, and the next one, each a process of its own with all imports."""
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "XDG_CACHE_HOME": folder}
        environment.pop("NUMBA_CACHE_DIR", None)
        runs = []
        for _ in range(2):
            done = subprocess.run(
                [sys.executable, "-c", _COLD], env=environment, capture_output=True, text=True, check=True
            )
            runs.append(json.loads(done.stdout))
    cold, warm = runs
    if not cold["said"] or warm["said"]:
        raise RuntimeError(f"expected one compilation, in the first of two runs; they said {runs}")
    return Row("first run, compiles the whole library", cold["seconds"], "s", must=20.0,
               detail=f"next run {warm['seconds']:.2f} s, imports included")  # fmt: skip
