# SPDX-License-Identifier: BSD-3-Clause
"""The dashboard in a terminal. See README.md."""
