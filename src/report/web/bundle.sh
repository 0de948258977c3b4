#!/usr/bin/env bash
# Makes three.js, the part of the library three.js that the report uses, from its npm package. Needs node and npm.
# `bundle.sh --check` says instead whether what is committed is what would be made.
set -euo pipefail
cd "$(dirname "$0")"
work=../../../target/report_bundle
mkdir -p "$work"
cp package.json three.entry.js "$work"
(cd "$work" && npm install --silent --no-audit --no-fund --ignore-scripts > /dev/null)

{
  echo "/*! three.js, as bundle.sh makes it of"
  cat package.json three.entry.js
  cat "$work/node_modules/three/LICENSE"
  echo "*/"
  (cd "$work" && NODE_PATH=node_modules node node_modules/esbuild/bin/esbuild three.entry.js --bundle --minify --format=iife --global-name=THREE \
    --legal-comments=none --log-level=warning)
} > "$work/three.js"

if [ "${1:-}" = --check ]; then
  cmp "$work/three.js" three.js && echo "three.js is what bundle.sh makes"
else
  cp "$work/three.js" three.js
fi
