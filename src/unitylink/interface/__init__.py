# SPDX-License-Identifier: BSD-3-Clause
"""The interface that a spec and its gateware share: settings, safe words, and the wire hash."""
