# SPDX-License-Identifier: BSD-3-Clause
"""One board, many users: who may do what. The server's data path is in `native/`."""
