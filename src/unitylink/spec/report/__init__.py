# SPDX-License-Identifier: BSD-3-Clause
"""Diagnostics and differences: what is wrong in a spec, where, and what to do about it."""
