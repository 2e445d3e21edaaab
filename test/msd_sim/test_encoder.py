"""What the encoder makes of a position."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from msd_sim.api import simulate
from msd_sim.encoder import Encoder, EncoderReader

SPEC = {"rig": "ecp", "experiment": "paper"}


def test_readings_are_whole_counts_nearest_to_the_truth():
    seen = simulate(SPEC)
    counts = seen.position * 226600.0
    assert np.abs(counts - np.round(counts)).max() < 1e-9
    assert np.abs(seen.position - seen.motion.position).max() <= 0.5 / 226600.0 * (1 + 1e-9)


def test_noise_has_its_size_and_comes_before_the_counts():
    seen = simulate(SPEC | {"encoder": {"noise": 5e-5, "counts_per_metre": 0.0}})
    assert 0.97 < np.std(seen.position - seen.motion.position) / 5e-5 < 1.03
    coarse = simulate(SPEC | {"encoder": {"noise": 5e-5, "counts_per_metre": 1000.0}})
    assert np.abs(coarse.position * 1000.0 - np.round(coarse.position * 1000.0)).max() < 1e-9


def test_the_seed_decides_the_noise():
    noisy = SPEC | {"encoder": {"noise": 1e-5}}
    one, same, other = (simulate(noisy | {"seed": seed}).position for seed in (7, 7, 8))
    assert np.array_equal(one, same) and not np.array_equal(one, other)


@given(cuts=st.lists(st.integers(1, 199), max_size=6, unique=True), seed=st.integers(0, 2**31))
def test_chunks_read_the_same(cuts, seed):
    encoder = Encoder(
        counts_per_metre=1e5, noise=1e-4, jitter=1e-4, dropout=0.1, dropout_length=3.0, noise_correlation=4.0,
        speed_noise=1e-3,
    )  # fmt: skip
    x, t, v = np.linspace(0.0, 0.01, 200), np.arange(200) * 1e-3, np.sin(np.arange(200) * 0.1)
    whole, chunked = EncoderReader(encoder, seed), EncoderReader(encoder, seed)
    parts = [(chunked.read(x[i], v[i]), chunked.stamps(t[i], 1e-3), chunked.arrives(i.size))
             for i in np.split(np.arange(200), sorted(cuts))]  # fmt: skip
    read, stamps, arrives = (np.concatenate(part) for part in zip(*parts, strict=True))
    assert np.array_equal(read, whole.read(x, v)) and np.array_equal(stamps, whole.stamps(t, 1e-3))
    assert np.array_equal(arrives, whole.arrives(200))


def test_coloured_noise_has_its_size_and_forgets_itself_in_its_time():
    for samples in (1.0, 20.0):
        reader = EncoderReader(Encoder(noise=1e-4, noise_correlation=samples), 3)
        noise = reader.read(np.zeros(400_000)) / 1e-4
        assert 0.97 < np.std(noise) < 1.03
        for lag in (1, 5, 20):
            assert abs(np.mean(noise[lag:] * noise[:-lag]) - np.exp(-lag / samples)) < 0.03


def test_noise_grows_with_speed():
    """Standard deviations of the noise at rest and of 2e-4 m per m/s, in squares."""
    reader = EncoderReader(Encoder(noise=1e-4, speed_noise=2e-4), 3)
    still = np.zeros(100_000)
    fast, slow = reader.read(still, still - 2.0), reader.read(still, still)
    assert 0.98 < np.std(fast) / np.hypot(1e-4, 4e-4) < 1.02 and 0.98 < np.std(slow) / 1e-4 < 1.02
    seen = simulate(SPEC | {"encoder": {"counts_per_metre": 0.0, "speed_noise": 1e-3}})
    error, speed = np.abs(seen.position - seen.motion.position), np.abs(seen.motion.velocity)
    assert 0.9 < np.mean(error[speed > 0.01]) / np.mean(1e-3 * speed[speed > 0.01] * np.sqrt(2.0 / np.pi)) < 1.1


def test_delay_shows_an_older_position():
    late, prompt = (
        simulate(SPEC | {"encoder": {"counts_per_metre": 0.0, "delay": delay}}).position for delay in (0.004, 0.0)
    )
    assert np.abs(late[4:] - prompt[:-4]).max() < 1e-12 and not late[:4].any()


def test_jitter_moves_stamps_but_not_readings():
    shaken, steady = simulate(SPEC | {"encoder": {"jitter": 1e-4}}), simulate(SPEC)
    assert np.array_equal(shaken.position, steady.position)
    assert 0.9 < np.std(shaken.time - steady.time) / 1e-4 < 1.1
    assert np.diff(simulate(SPEC | {"encoder": {"jitter": 0.1}}).time).min() > 0.0


def test_dropouts_take_their_share_in_gaps_of_their_length():
    encoder = Encoder(dropout=0.02, dropout_length=5.0)
    kept = EncoderReader(encoder, 1).arrives(200_000)
    begins = np.count_nonzero(kept[:-1] & ~kept[1:])
    assert 4.7 < np.count_nonzero(~kept) / begins < 5.3
    assert 0.018 < begins / np.count_nonzero(kept) < 0.022
    assert simulate(SPEC | {"encoder": {"dropout": 0.02}}).time.size < 6000
