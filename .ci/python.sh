#!/usr/bin/env bash
# The Python package in a fresh environment, installed as README.md says, and its tests. The wheel is built with what
# `cargo test` has built already: its profile, its target folder, its features.
set -euo pipefail
cd "$(dirname "$0")/.."
environment=$PWD/target/python_package
python3 -m venv --clear "$environment"
export PATH=$environment/bin:$PATH
export MATURIN_PEP517_ARGS="--profile dev --features ellipsoid_slam/default"

install="pip install ./python"
grep -qxF "$install" README.md || { echo "not in README.md: $install" >&2; exit 1; }
$install
pip install -q ./python[test]
mypy --config-file python/pyproject.toml python/ellipsoid_slam python/tests
python -m mypy.stubtest --mypy-config-file python/pyproject.toml ellipsoid_slam._native
pytest -q python/tests
