# SPDX-License-Identifier: BSD-3-Clause
"""What measures and compares Unity-Link itself. It is in a checkout of the source only, not in a wheel."""
