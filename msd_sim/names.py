"""Names and qualities of service of the rig's topics, written once. Relative names: launch files give the namespace."""

from __future__ import annotations

NODE = "rig"
FORCE = "force"
ENCODER = "encoder"
ENCODER_BATCH = "encoder_batch"
RESET = "rig/reset"  # the node names it ~/reset
CLOCK = "/clock"
DIAGNOSTICS = "/diagnostics"

#: Name of the cart's joint in JointState messages, unless the parameter ``joint_name`` says otherwise.
JOINT = "cart"

#: Depth of reliable queues: at 1 kHz a subscriber may stall for nearly two seconds and lose nothing, on cores that
#: have time. Ten thousand were tried: a stall of eight seconds is borne, and overloaded cores lose samples all the
#: same. Never keep-all here: it would block the rig behind a subscriber that hangs.
DEPTH = 2000
CLOCK_DEPTH = 10

#: How long after its start the rig asks for commands that were latched before [s]: discovery took up to 2.8 s here.
LATECOMER = 5.0
#: Longest time between two signs of life of a publisher that promises them (liveliness manual by topic) [s].
LEASE = 1.0

#: Above this many samples per second of the wall's time they go out in batches.
MOST_SINGLE = 2000.0
