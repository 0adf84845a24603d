# SPDX-License-Identifier: BSD-3-Clause
"""Certificates for tests, made by the program `openssl` as docs/server.md says."""

from __future__ import annotations

import subprocess
from pathlib import Path


def certificate(folder: Path, name: str, *names: str) -> Path:
    """Return a file with a certificate that signs itself, and its key. `names` are those of the host."""
    made = folder / f"{name}.pem"
    key = folder / f"{name}-key.pem"
    words = ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1"]
    words += ["-nodes", "-days", "2", "-subj", f"/CN={name}", "-keyout", str(key), "-out", str(made)]
    if names:
        words += ["-addext", f"subjectAltName={','.join(names)}"]
    subprocess.run(words, check=True, capture_output=True)
    return made
