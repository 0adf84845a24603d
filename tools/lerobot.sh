#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Puts LeRobot into build/lerobot and lets tools/lerobot/check.py work with it. It fetches 2.2 GB, and takes 5.4 GB.
set -euo pipefail
cd "$(dirname "$0")/.."
env=build/lerobot python=.venv/bin/python
# its newest version wants Python 3.12
version=$("$python" -c 'import sys; print("0.6.1" if sys.version_info >= (3, 12) else "0.4.4")')
extra=$("$python" -c 'import sys; print("[dataset]" if sys.version_info >= (3, 12) else "")')
if [ "$(cat "$env/made-of.txt" 2>/dev/null)" != "$version" ]; then
  rm -rf "$env"
  "$python" -m venv "$env"
  echo "installing LeRobot $version into $env (2.2 GB; ten minutes)"
  "$env/bin/python" -m pip install --quiet "lerobot$extra==$version" setuptools
  site=$("$env/bin/python" -c 'import site; print(site.getsitepackages()[0])')
  here=$("$python" -c 'import site; print(site.getsitepackages()[0])')
  echo "import site; site.addsitedir('$here')" > "$site/zz_checkout.pth"  # behind its own packages
  echo "$version" > "$env/made-of.txt"
fi
"$env/bin/python" tools/lerobot/check.py build/lerobot-check
