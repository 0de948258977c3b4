#!/usr/bin/env bash
# The second group of tests: our interfaces built by ROS 2's own generators and used from Python, and our markers in a real
# RViz. Needs Debian's cmake, g++, rviz, xvfb, imagemagick and the packages of ROS 1 beside it; see CONTRIBUTING.md.
set -euo pipefail
cd "$(dirname "$0")/.."

work=$PWD/target/interfaces
python=$work/python
mkdir -p "$work"

requirements=tests/interfaces/requirements.txt
if ! cmp -s "$requirements" "$python/installed.txt"; then
  python3.11 -m venv --clear "$python"
  "$python/bin/pip" install -q -r "$requirements"
  cp "$requirements" "$python/installed.txt"
fi

# The wheels' exported targets name the include folders of the machine that they were built on.
wheels=/opt/python/cp311-cp311
headers=$("$python/bin/python" -c 'import sysconfig; print(sysconfig.get_paths()["include"])')
numpy=$("$python/bin/python" -c 'import numpy; print(numpy.get_include())')
mkdir -p "$wheels/include" "$wheels/lib/python3.11/site-packages/numpy/_core"
ln -sfn "$headers" "$wheels/include/python3.11"
ln -sfn "$numpy" "$wheels/lib/python3.11/site-packages/numpy/_core/include"

# CMake exports no include folder that is inside of the source: the environment is.
rm -rf "$work/source" "$work/build"
mkdir -p "$work/source/ellipsoid_slam"
cp -r package.xml CMakeLists.txt msg srv config launch "$work/source/ellipsoid_slam"
cp -r tests/interfaces/nav2_msgs "$work/source"

export PATH=$python/bin:$PATH AMENT_PREFIX_PATH=$python CMAKE_PREFIX_PATH=$python
colcon --log-base "$work/log" build --base-paths "$work/source" \
  --build-base "$work/build" --install-base "$work/install" \
  --cmake-args -DELLIPSOID_SLAM_PROGRAM=OFF -DBUILD_TESTING=OFF "-DPython3_EXECUTABLE=$python/bin/python"

set +u
# shellcheck disable=SC1091
source "$work/install/setup.bash"
set -u
"$python/bin/python" tests/interfaces/definitions.py
"$python/bin/python" tests/interfaces/messages.py
"$python/bin/python" tests/interfaces/launch_files.py
# As the tests have built it.
program=${CARGO_TARGET_DIR:-target}/debug/ellipsoid_slam
[ -x "$program" ] || cargo build
"$python/bin/python" tests/interfaces/go_to.py "$program"
