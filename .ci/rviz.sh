#!/usr/bin/env bash
# Draws a result in a real RViz (Debian's, of ROS 1: markers, path and image are the same) without a screen, and checks that
# the picture has their colours: rviz.sh [RESULT.mcap], by default the demo's, which is made if it is not there.
set -euo pipefail
cd "$(dirname "$0")/.."
bag=$(realpath -m "${1:-target/demo/result.mcap}")
work=$PWD/target/rviz
python=$work/python
mkdir -p "$work"
[ -f "$bag" ] || cargo run -q -- demo > /dev/null

requirements=tests/interfaces/rviz_requirements.txt
if ! cmp -s "$requirements" "$python/installed.txt"; then
  python3 -m venv --clear "$python"
  "$python/bin/pip" install -q -r "$requirements"
  cp "$requirements" "$python/installed.txt"
fi
"$python/bin/python" tests/interfaces/markers_of.py "$bag" > "$work/markers.json"
/usr/bin/python3 tests/interfaces/rviz1.py config/ellipsoid_slam.rviz "$work/markers.json" > "$work/config.rviz"

export DISPLAY=:${RVIZ_DISPLAY:-97} LIBGL_ALWAYS_SOFTWARE=1 ROS_MASTER_URI=http://localhost:${RVIZ_PORT:-11397} ROS_HOME=$work
export ROS_HOSTNAME=localhost PYTHONPATH=
started=()
trap 'kill "${started[@]}" 2> /dev/null || true' EXIT
Xvfb "$DISPLAY" -screen 0 1400x900x24 +extension GLX > "$work/xvfb.log" 2>&1 & started+=($!)
/usr/bin/python3 /usr/bin/roscore -p "${ROS_MASTER_URI##*:}" > "$work/roscore.log" 2>&1 & started+=($!)
sleep 6
/usr/bin/python3 tests/interfaces/show_markers.py "$work/markers.json" > "$work/relay.log" 2>&1 & started+=($!)
rviz -d "$work/config.rviz" > "$work/rviz.log" 2>&1 & started+=($!)

# RViz takes its time on a busy machine. Gray is the grid: what counts is pixels with a colour.
for _ in $(seq 30); do
  sleep 2
  import -window root "$work/shot.png" 2> /dev/null || continue
  colored=$(convert "$work/shot.png" -crop 900x700+450+100 +repage -colorspace HSL -channel G -separate -threshold 35% -format '%[fx:int(mean*w*h)]' info:)
  [ "$colored" -gt 5000 ] && break
done
# What was published comes one after the other.
sleep 6
import -window root "$work/shot.png"
echo "$colored coloured pixels in $work/shot.png"
[ "$colored" -gt 5000 ]
