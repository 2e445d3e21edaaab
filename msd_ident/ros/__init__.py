"""The ROS 2 shell around the library: nodes translate messages and call one function."""
