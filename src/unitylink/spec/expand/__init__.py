# SPDX-License-Identifier: BSD-3-Clause
"""Macro expansion: from constructors to the model."""
