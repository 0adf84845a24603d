#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes the packages of packaging/ in build/packages, as far as they can be made here, and checks them: a package of
# Debian, which lintian must accept and whose command must run; the recipe of conda; the formula of Homebrew.
set -euo pipefail
cd "$(dirname "$0")/.."
bin=$PWD/.venv/bin out=$PWD/build/packages
version=$(sed -n 's/^version = "\(.*\)"$/\1/p' pyproject.toml)
say() { printf '\n== %s\n' "$1"; }
stop() { printf 'unitylink: %s\n' "$1" >&2; exit 1; }

python_of() { "$1" -c 'import sys; print(*sys.version_info[:2], sep=".")'; }
wanted=$(python_of /usr/bin/python3)
[ "$(python_of "$bin/python")" = "$wanted" ] \
  || stop "the package is for /usr/bin/python3, $wanted; build with it: make PYTHON=/usr/bin/python3"
rm -rf "$out" && mkdir -p "$out"
say "the wheel and the sdist"
tools/wheel.sh "$out/wheels"

say "Debian"
source=$out/debian/unitylink-$version root=$out/debian/root
mkdir -p "$source"
cp -r packaging/debian "$source"
cp "$out"/wheels/*.whl "$source"
maintainer=$(sed -n 's/^Maintainer: //p' packaging/debian/control)
time=$(LC_ALL=C date --rfc-email --date="@$(git log -1 --format=%ct)")
cat > "$source/debian/changelog" <<EOF
unitylink ($version) unstable; urgency=medium

  * The changes are in CHANGELOG.md of the sources.

 -- $maintainer  $time
EOF
(cd "$source" && dpkg-buildpackage --unsigned-changes --build=binary) > "$out/debian/log" 2>&1 \
  || { tail -20 "$out/debian/log" >&2; exit 1; }
lintian $([ "$(id -u)" != 0 ] || echo --allow-root) --fail-on error,warning "$out"/debian/*.changes
echo "lintian accepts it"
dpkg-deb --extract "$out"/debian/unitylink_*.deb "$root"
# What it depends on is that of .venv here, without the checkout that is installed there.
cat > "$out/debian/run.py" <<'EOF'
import pathlib, sys
sys.meta_path = [one for one in sys.meta_path if "editable" not in type(one).__module__]
sys.path.insert(0, f"{sys.argv.pop(1)}/usr/lib/python3/dist-packages")
import unitylink.cli
assert pathlib.Path(unitylink.__file__).is_relative_to(sys.path[0]), unitylink.__file__
sys.exit(unitylink.cli.main(sys.argv[1:]))
EOF
(cd "$out/debian" && "$bin/python" -P run.py "$root" --version && "$bin/python" -P run.py "$root" demo hello_led)

say "conda"
"$bin/python" - "$version" <<'EOF'
import sys
from rattler_build import RenderConfig, Stage0Recipe, VariantConfig
from rattler_build.tool_config import PlatformConfig

pythons = ["3.10.*", "3.11.*", "3.12.*", "3.13.*"]
compilers = {"c_compiler": ["gcc"], "cxx_compiler": ["gxx"], "c_stdlib": ["sysroot"], "c_stdlib_version": ["2.28"]}
recipe = Stage0Recipe.from_file("packaging/conda/recipe.yaml")
platform = RenderConfig(platform=PlatformConfig(target_platform="linux-64"))
made = [one.recipe for one in recipe.render(VariantConfig({"python": pythons, **compilers}), platform)]
assert len(made) == len(pythons) and all(str(one.package.version) == sys.argv[1] for one in made), made
print("rattler-build renders the recipe:", *(one.build.string for one in made))
EOF

say "Homebrew"
sdist=$(echo "$out"/wheels/*.tar.gz)
sed -e "s|@URL@|${URL:-file://$sdist}|" -e "s|@SHA256@|$(sha256sum "$sdist" | cut -d ' ' -f 1)|" \
  packaging/homebrew/unitylink.rb.in > "$out/unitylink.rb"
ruby -c "$out/unitylink.rb"
printf '\nmade: %s %s\n' "$out"/debian/*.deb "$out/unitylink.rb"
