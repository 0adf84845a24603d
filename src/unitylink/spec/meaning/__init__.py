# SPDX-License-Identifier: BSD-3-Clause
"""What the names, expressions and members of a syntax tree mean."""
