# SPDX-License-Identifier: BSD-3-Clause
"""A robot on a Zenoh network: the bridge, the messages, and the link of a client. See README.md."""
