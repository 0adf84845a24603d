# SPDX-License-Identifier: BSD-3-Clause
"""The bridge between a board and a Zenoh network. Start with bridge.py."""
