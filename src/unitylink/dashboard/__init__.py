# SPDX-License-Identifier: BSD-3-Clause
"""The dashboard: a page in the browser with the values of a robot, made from its spec."""
