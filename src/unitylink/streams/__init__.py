# SPDX-License-Identifier: BSD-3-Clause
"""The values of a robot for the tools that people already have: PlotJuggler, Foxglove, MQTT."""
