#!/usr/bin/env bash
# Makes .venv-VERSION with the Blender of that Python and the tools, all pinned by requirements-VERSION.txt.
#   environment/create.sh 3.11
set -euo pipefail
cd "$(dirname "$0")/.."
version=$1
environment=.venv-$version

python=$(environment/find_python.sh "$version")
[[ -x $environment/bin/python ]] || "$python" -m venv "$environment"
"$environment/bin/python" -m pip install --quiet --disable-pip-version-check --no-deps \
    --requirement "environment/requirements-$version.txt"
environment/check_libraries.sh "$environment"
