"""Bags and CSV files in and out, without ROS."""

from msd_ident.bag.bag import Bag, iterate_messages, open_bag
from msd_ident.bag.qos import OfferedQos, qos_from_yaml, qos_to_yaml
from msd_ident.bag.topic import RawMessage, Topic
from msd_ident.bag.writer import BagWriter

__all__ = [
    "Bag",
    "BagWriter",
    "OfferedQos",
    "RawMessage",
    "Topic",
    "iterate_messages",
    "open_bag",
    "qos_from_yaml",
    "qos_to_yaml",
]
