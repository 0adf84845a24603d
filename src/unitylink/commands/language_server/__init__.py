# SPDX-License-Identifier: BSD-3-Clause
"""The language server of UL-spec. See README.md."""
