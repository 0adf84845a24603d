# SPDX-License-Identifier: BSD-3-Clause
"""What all tests share: nothing is judged by how long it took, for the machine may be busy."""

from __future__ import annotations

from hypothesis import settings

settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")
