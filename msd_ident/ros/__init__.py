"""The ROS 2 nodes: they translate messages and call one function of the library.

In: topics, services, actions and parameters. Out: estimates, diagnoses, bags, and forces on the rig.
Begin with ``identifier.node``, then ``common.names`` (all names and QoS) and ``common.node_runner``.
"""
