"""Seeds of all random numbers that enter a result: each always the same, so that a record has one answer.

A diagnosis draws the swings that bound the missing force; what it proposes as a next experiment is judged with draws.
Random trains of a designed profile carry their seed in the profile, and are played as they stand there.
"""

from __future__ import annotations

#: Deviations of a rival's parameters, as far as the measured data leaves them open: they bound a predicted motion.
PREDICTION = 20140
#: Random steps that a design for narrower intervals is compared with.
RANDOM_STEPS = 20141
#: Swings of a record, with replacement: the interval of the missing force.
REMAINDER = 20142
#: Simulated copies of a record: strengths, noise and missing force.
CALIBRATION = 20143
#: Parameter sets of an exported posterior.
DRAWS = 20144
#: Noise of the encoder on positions that somebody else's simulation gives.
ENCODER = 20145

#: Lots between equal probabilities of a robot that is watched over days.
MONITORING = 20146

#: By what they are drawn for.
ALL = {
    "prediction of the next experiment": PREDICTION,
    "random steps beside a designed profile": RANDOM_STEPS,
    "interval of the missing force": REMAINDER,
    "simulated copies of the record": CALIBRATION,
    "draws of an exported posterior": DRAWS,
    "noise on a simulation that is compared": ENCODER,
    "lots between equal ranks of a watched robot": MONITORING,
}
