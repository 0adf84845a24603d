# SPDX-License-Identifier: BSD-3-Clause
"""Do what `ros2 topic` and `ros2 service` do, with genuine rclpy. The wheels of ROS 2 have no command line.

Each line of JSON on standard input is a question. A line on standard output answers it. The value of "ask" is
one of five. "echo" with "topic" and "type" waits for a message. "pub" with "fields" publishes as soon as
somebody listens. "call" calls a service. "sim_time" is a node with
use_sim_time. "graph" tells nodes, topics, the quality of service of a topic's
publishers, and the topics of a node, as `ros2 node info` does.
"""

from __future__ import annotations

import json
import sys
from importlib import import_module
from typing import Any

import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter

PATIENCE_S = 100.0


def kind(name: str, part: str) -> Any:
    package, _, message = name.partition("/")
    return getattr(import_module(f"{package}.{part}"), message)


def plain(value: Any) -> Any:
    """Return a message as types that JSON has."""
    if hasattr(value, "get_fields_and_field_types"):
        return {name: plain(getattr(value, name)) for name in value.get_fields_and_field_types()}
    if isinstance(value, bytes):
        return list(value)
    if isinstance(value, (str, int, float, bool)):
        return value
    return [plain(one) for one in value]


def fill(message: Any, fields: dict[str, Any]) -> Any:
    for name, value in fields.items():
        own = getattr(message, name)
        setattr(message, name, fill(own, value) if isinstance(value, dict) else value)
    return message


class Peer:
    def __init__(self) -> None:
        rclpy.init()
        self.node: Node = rclpy.create_node("peer")
        self.publishers: dict[str, Any] = {}

    def until(self, holds: Any) -> None:
        deadline = self.node.get_clock().now().nanoseconds + int(PATIENCE_S * 1e9)
        while not holds():
            assert self.node.get_clock().now().nanoseconds < deadline, "waited in vain"
            rclpy.spin_once(self.node, timeout_sec=0.05)

    def echo(self, topic: str, type: str, count: int = 1) -> Any:
        found: list[Any] = []
        subscription = self.node.create_subscription(kind(type, "msg"), topic, found.append, 50)
        self.until(lambda: len(found) >= count)
        self.node.destroy_subscription(subscription)
        return [plain(message) for message in found[:count]]

    def pub(self, topic: str, type: str, fields: dict[str, Any]) -> Any:
        if topic not in self.publishers:
            self.publishers[topic] = self.node.create_publisher(kind(type, "msg"), topic, 1)
        publisher = self.publishers[topic]
        self.until(lambda: publisher.get_subscription_count() > 0)
        publisher.publish(fill(kind(type, "msg")(), fields))
        return publisher.get_subscription_count()

    def call(self, service: str, type: str, fields: dict[str, Any]) -> Any:
        client = self.node.create_client(kind(type, "srv"), service)
        assert client.wait_for_service(PATIENCE_S), f"no service {service}"
        answer = client.call_async(fill(kind(type, "srv").Request(), fields))
        self.until(answer.done)
        return plain(answer.result())

    def sim_time(self, advance: float) -> Any:
        """Follow /clock as every node with use_sim_time does, until it has gone on by `advance` seconds."""
        follows = Parameter("use_sim_time", Parameter.Type.BOOL, True)
        node = rclpy.create_node("follower", parameter_overrides=[follows])
        times = [0]

        def on() -> bool:
            rclpy.spin_once(node, timeout_sec=0.05)
            times.append(node.get_clock().now().nanoseconds)
            first = next((one for one in times if one), 0)
            return first > 0 and times[-1] >= first + advance * 1e9

        self.until(on)
        node.destroy_node()
        return [one / 1e9 for one in times if one]

    def graph(self, topic: str = "", node: str = "", namespace: str = "/") -> Any:
        qos = [one.qos_profile for one in self.node.get_publishers_info_by_topic(topic)] if topic else []
        if node:
            wanted = [node, namespace]
            self.until(lambda: wanted in map(list, self.node.get_node_names_and_namespaces()))
        return {
            "publishes": dict(
                self.node.get_publisher_names_and_types_by_node(node, namespace) if node else ()
            ),
            "subscribes": dict(
                self.node.get_subscriber_names_and_types_by_node(node, namespace) if node else ()
            ),
            "nodes": self.node.get_node_names_and_namespaces(),
            "topics": dict(self.node.get_topic_names_and_types()),
            "reliability": [one.reliability.name for one in qos],
        }


def main() -> None:
    peer = Peer()
    for line in sys.stdin:
        asked = json.loads(line)
        answer = getattr(peer, asked.pop("ask"))(**asked)
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
