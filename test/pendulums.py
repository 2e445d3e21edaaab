"""A joint with or without a weight on it, which a torque turns, simulated by code of its own."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from msd_ident.data.record import Record

#: Samples a second, and steps of the integration within a sample.
RATE, STEPS = 250.0, 8

#: Torque [N·m] at a time [s], an angle [rad] from where the joint hangs and a speed [rad/s].
Torque = Callable[[float, float, float], float]


def pumped(most: float) -> Torque:
    """A torque [N·m] that pushes with the motion, with pauses: the joint swings further and further, and goes round."""

    def torque(t: float, angle: float, speed: float) -> float:
        return most if t < 0.6 else math.copysign(most, speed) * float(t % 2.5 < 1.6)

    return torque


def led(path: Callable[[float], float], stiffness: float, damping: float) -> Torque:
    """Torque of a controller that leads the joint along a path [rad] over the time [s]."""

    def torque(t: float, angle: float, speed: float) -> float:
        return stiffness * (path(t) - angle) - damping * speed

    return torque


def turned(
    torque: Torque,
    seconds: float,
    plant: tuple[float, float, float],
    hangs: float = 0.0,
    rest: Callable[[float], float] | None = None,
    rubs: Callable[[float], float] | None = None,
) -> Record:
    """A record of J q'' + b q' + G sin(q − hangs) = torque + rest(q − hangs), from rest at q = hangs.

    Args:
        torque: held over each sample, and recorded.
        seconds: length of the record.
        plant: J [kg·m²], b [N·m·s/rad] and G [N·m].
        hangs: reading [rad] where the joint hangs.
        rest: further moment [N·m] over the angle [rad], which is not recorded.
        rubs: moment of dry friction [N·m] over the angle [rad].

    Returns:
        The record; its readings have a noise of 1 mrad.
    """
    inertia, damping, moment = plant
    count, step = int(seconds * RATE), 1.0 / (RATE * STEPS)
    angle, speed = 0.0, 0.0
    angles, torques = np.empty(count), np.empty(count)
    for i in range(count):
        angles[i], torques[i] = angle, torque(i / RATE, angle, speed)
        for _ in range(STEPS):  # of Störmer and Verlet
            middle = angle + 0.5 * step * speed
            more = rest(middle) if rest else 0.0
            speed += step * (torques[i] + more - damping * speed - moment * math.sin(middle)) / inertia
            if rubs:
                speed = math.copysign(max(abs(speed) - step * rubs(middle) / inertia, 0.0), speed)
            angle = middle + 0.5 * step * speed
    time = np.arange(count) / RATE
    readings = angles + hangs + np.random.default_rng(0).normal(0.0, 1e-3, count)
    return Record(time, readings, time, torques, force_unit="N·m", position_unit="rad")


def dropped(seconds: float, plant: tuple[float, float, float], friction: float, angle: float, held: float) -> Record:
    """A record of q'' + b q' + G sin q = -Fc sign(q') for 1 kg·m², held at an angle and then let go.

    Args:
        seconds: length of the record, of 200 samples a second.
        plant: b [N·m·s/rad] and G [N·m] for an inertia of 1 kg·m², and the noise of the readings [rad].
        friction: Fc [N·m].
        angle: where it is held [rad].
        held: how long [s].
    """
    damping, moment, noise = plant
    count, step = round(200.0 * seconds), 1.0 / (200.0 * STEPS)
    angles, speed = np.empty(count), 0.0
    for i in range(count):
        angles[i] = angle
        for _ in range(STEPS if i >= 200.0 * held else 0):
            speed -= step * (moment * math.sin(angle) + damping * speed)
            speed = math.copysign(max(abs(speed) - step * friction, 0.0), speed)
            angle += step * speed
    time = np.arange(count) / 200.0
    readings = angles + np.random.default_rng(0).normal(0.0, noise, count)
    return Record(time, readings, time[:1], np.zeros(1), force_unit="N·m", position_unit="rad")
