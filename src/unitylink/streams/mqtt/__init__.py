# SPDX-License-Identifier: BSD-3-Clause
"""A robot at an MQTT broker: its values, its set-points, and what Home Assistant wants to know of them."""
