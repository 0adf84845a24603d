# SPDX-License-Identifier: BSD-3-Clause
"""The shape of a robot, for the page's view in three dimensions. See README.md."""
