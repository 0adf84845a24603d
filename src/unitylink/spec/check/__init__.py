# SPDX-License-Identifier: BSD-3-Clause
"""Checks of an expanded spec."""
