# SPDX-License-Identifier: BSD-3-Clause
"""From text to a syntax tree: files, tokens, the parser, and the formatter."""
