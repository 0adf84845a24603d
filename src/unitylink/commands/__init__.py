# SPDX-License-Identifier: BSD-3-Clause
"""What the command line does: one file per command."""
