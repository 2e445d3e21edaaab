"""The demo: rig, recorder and identifier in a ROS domain of their own. Begin with ``demo``."""
