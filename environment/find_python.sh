#!/usr/bin/env bash
# Prints the path of a Python of the asked version that runs and can make environments; fails when there is none.
#   environment/find_python.sh 3.13
set -euo pipefail
version=$1

candidates() {
    type -ap "python$version" || true
    # A pyenv shim on the PATH may refuse to run, the interpreter behind it does not.
    if command -v pyenv >/dev/null; then ls -d "$(pyenv root)/versions/$version"*"/bin/python$version" || true; fi
    if command -v uv >/dev/null; then uv python find --no-python-downloads "$version" || true; fi
}

real_path() {
    "$1" -c "import sys, venv, ensurepip; '%d.%d' % sys.version_info[:2] == '$version' and print(sys.executable)"
}

while read -r candidate; do
    found=$(real_path "$candidate" 2>/dev/null) || continue
    if [[ -n $found ]]; then
        echo "$found"
        exit
    fi
done < <(candidates 2>/dev/null)

echo "no Python $version with venv found on the PATH, in pyenv or in uv (on Debian: apt-get install python3-venv)" >&2
exit 1
