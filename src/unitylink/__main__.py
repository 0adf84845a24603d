# SPDX-License-Identifier: BSD-3-Clause
"""`python -m unitylink` is the command `unitylink`."""

from __future__ import annotations

import sys

from unitylink.cli import main

if __name__ == "__main__":
    sys.exit(main())
