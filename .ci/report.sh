#!/usr/bin/env bash
# Looks at reports in a real Chromium (Debian's) without a screen: of the demo, of an empty map, of 1,000 objects, and of a
# real recording where there is one. Pictures of them are in target/report; those in docs/images have to look like them, and
# `report.sh --pictures` makes these anew.
set -euo pipefail
cd "$(dirname "$0")/.."
work=$PWD/target/report
python=$work/python
mkdir -p "$work"

requirements=tests/report/requirements.txt
if ! cmp -s "$requirements" "$python/installed.txt"; then
  python3 -m venv --clear "$python"
  "$python/bin/pip" install -q -r "$requirements"
  cp "$requirements" "$python/installed.txt"
fi

program=target/debug/ellipsoid_slam
[ -f target/demo/report.html ] || "$program" demo > /dev/null
cp target/demo/report.html "$work/demo.html"
# Nothing has as many points as this asks for, and no box alone makes an object.
printf '%s\n' 'ellipsoid_slam:' '  ros__parameters:' '    perception:' '      glimpses: false' '      segmentation:' \
  '        min_points: 1000000' > "$work/nothing.yaml"
"$program" replay bags/desk.mcap --config "$work/nothing.yaml" --output "$work/nothing" --force > /dev/null
cp "$work/nothing/report.html" "$work/empty.html"

# What a report costs beside the same replay without: processor time (the least of three) and memory at the peak.
least() {
  for _ in 1 2 3; do
    { time "$program" replay bags/desk.mcap --output "$work/cost" --force "$@" > /dev/null 2>&1; } 2>&1
  done | sort -n | head -1
}
memory() { sed -n 's/.*"peak_memory_mb": \([0-9.]*\).*/\1/p' "$work/cost/summary.json"; }
TIMEFORMAT=%U
with=$(least) with_mb=$(memory) without=$(least --no-report) without_mb=$(memory)
awk -v a="$with" -v b="$without" -v c="$with_mb" -v d="$without_mb" 'BEGIN {
  printf "report: a replay with it takes %.2f times the processor time (%s s, %s s without) and %.2f times the memory (%d MB, %d MB)\n", a / b, a, b, c / d, c, d
  exit !(a < 1.5 * b && c < 1.5 * d)
}' || { echo "a report costs too much" >&2; exit 1; }

recordings=()
data=${ELLIPSOID_SLAM_DATA:-../shared/data}
if [ -d "$data/tum_fr3_cabinet" ]; then
  "$program" import tum "$data/tum_fr3_cabinet" --output "$work/cabinet.mcap" --force > /dev/null
  "$program" replay "$work/cabinet.mcap" --output "$work/cabinet" --force > /dev/null
  cp "$work/cabinet/report.html" "$work/recording.html"
  recordings=("$work/recording.html")
fi
"$python/bin/python" tests/report/check.py "$work" "$work/demo.html" "$work/empty.html" "${recordings[@]}"

pictures=(report_demo)
if [ ${#recordings[@]} -gt 0 ]; then
  "$program" simulate --scene home --trajectory forward --seed 3 --no-color --output "$work/home.mcap" --force > /dev/null
  "$program" replay "$work/home.mcap" --output "$work/home" --ground-truth "$work/home.gt.json" --force > /dev/null
  "$python/bin/python" tests/report/figures.py "$work" "$work/recording.html" "$work/home/report.html"
  montage "$work"/process_image_?.png "$work"/process_view_?.png -tile 3x2 -geometry 420x320+4+4 -quality 86 "$work/process.jpg"
  convert "$work/forward.png" -resize 1000x -quality 86 "$work/forward.jpg"
  convert "$work/recording.png" -resize 1080x -quality 86 "$work/report_recording.jpg"
  pictures+=(report_recording process forward)
fi
convert "$work/demo.png" -resize 1080x -quality 86 "$work/report_demo.jpg"

# What of a picture may differ: letters, the clock's readings.
for name in "${pictures[@]}"; do
  kept=docs/images/$name.jpg
  [ "${1:-}" = --pictures ] && cp "$work/$name.jpg" "$kept"
  off=$(compare -metric RMSE "$work/$name.jpg" "$kept" null: 2>&1 | sed 's/.*(\(.*\))/\1/' || true)
  echo "report: $kept is off by $off"
  awk -v off="$off" 'BEGIN { exit !(off < 0.06) }' || { echo "run .ci/report.sh --pictures and look at $kept" >&2; exit 1; }
done
[ "${1:-}" != --pictures ] || cp target/demo/map.svg docs/images/map.svg
