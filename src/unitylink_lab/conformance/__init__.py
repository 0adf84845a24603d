# SPDX-License-Identifier: BSD-3-Clause
"""Recorded exchanges of the 2012 gateware, replayed against the twin or the VHDL: `unitylink conformance`."""
