#!/usr/bin/env bash
# Takes the manual's pictures: manual/take.sh BLENDER CHARACTER.blend turgor.zip FOLDER
# Needs a Blender with a window, xvfb-run and ImageMagick.
set -euo pipefail
blender=$1 character=$2 archive=$3 folder=$4
BLENDER_USER_RESOURCES=$(mktemp -d)
export BLENDER_USER_RESOURCES
trap 'rm -rf "$BLENDER_USER_RESOURCES"' EXIT
xvfb-run --auto-servernum --server-args="-screen 0 1920x1080x24" \
    "$blender" --factory-startup --window-geometry 0 0 1920 1080 "$character" \
    --python manual/pictures.py -- "$folder" "$archive"
