"""The recorder node: any topics into a rosbag2 folder. Begin with ``node``."""
