# SPDX-License-Identifier: BSD-3-Clause
"""Measurements of Unity-Link, and comparisons with others.

This package is only in a checkout of the source, not in a wheel.
"""
