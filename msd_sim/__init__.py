"""The world: rigs with a hidden truth, simulated to tight tolerances, without ROS or behind a ROS node.

Batch use (numpy alone; ``msd_sim.api`` says what a spec may hold)::

    from msd_sim.api import simulate

    record = simulate({"rig": "ecp", "experiment": "paper", "seed": 1})
    record = simulate({
        "mass": 1.0, "damping": 2.0, "stiffness": 700.0,
        "effects": {"coulomb_friction": {"coulomb_force": 0.2}, "backlash": {"backlash_half_width": 0.002}},
        "time": t, "force_time": t, "force": u, "hold": "linear",  # or "experiment": {"name": "sweep", "force": 2.0}
        "initial_position": 0.01, "initial_velocity": 0.0,
        "encoder": {"counts_per_metre": 226600.0, "noise": 1e-5}, "seed": 3,   # without "encoder": exact readings
    })
    record.time, record.position                    # what the encoder said
    record.force_time, record.force, record.hold    # what was commanded
    record.motion.position, record.motion.velocity, record.motion.force, record.truth   # what truly happened

Stepping use (the node)::

    from msd_sim.rig import Rig
    from msd_sim.truth import Truth

    rig = Rig(Truth(1.0, 2.0, 700.0, {"coulomb_friction": {"coulomb_force": 0.2}}))
    rig.push(0.0, 5.0)                # 5 N from 0 s on
    motion = rig.sample([0.001, 0.002])

Conventions: SI. A command goes stamp + time_offset -> static gain and saturation (of the samples) -> lag (exact) ->
cart; before the first stamp it is 0, and the lag starts from 0 there. Effects stand on the left-hand side of
m x'' + ... = F, also ``force_offset``. ``backlash`` is in the path of the linear spring (with its drift) alone: the
cubic and the quadratic term act on x itself. A reading is x(t - delay) + sensor_drift_rate * t, then noise, then
counts. Time counts from 0 on the clock of the stamps; a record whose first sampling instant is not 0 begins there with
its initial position.
"""
