# SPDX-License-Identifier: BSD-3-Clause
"""Many robots on a Zenoh network, from one description."""
