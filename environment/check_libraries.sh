#!/usr/bin/env bash
# Fails with the packages to install when Blender's module of an environment misses a library of the system.
#   environment/check_libraries.sh .venv-3.11
set -euo pipefail
directory=$(dirname "$0")

missing=$(ldd "$1"/lib/python*/site-packages/bpy/__init__.so | awk '/not found/ { print $1 }' | sort -u)
if [[ -n $missing ]]; then
    echo "Blender's Python module needs libraries that this system lacks:" >&2
    echo "$missing" | sed 's/^/    /' >&2
    echo "On Debian: apt-get install $(xargs <"$directory/debian-packages.txt")" >&2
    exit 1
fi
