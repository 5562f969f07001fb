#!/usr/bin/env bash
# Resolves requirements-VERSION.in anew and writes every version it chose into requirements-VERSION.txt.
#   environment/lock.sh 3.11
set -euo pipefail
cd "$(dirname "$0")/.."
version=$1
fresh=$(mktemp -d)
trap 'rm -rf "$fresh"' EXIT

"$(environment/find_python.sh "$version")" -m venv "$fresh"
"$fresh/bin/python" -m pip install --quiet --disable-pip-version-check --requirement "environment/requirements-$version.in"
{
    echo "# Written by environment/lock.sh $version from requirements-$version.in."
    "$fresh/bin/python" -m pip freeze --exclude pip --exclude setuptools
} >"environment/requirements-$version.txt"
