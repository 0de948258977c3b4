#!/usr/bin/env bash
# Makes Debian packages in target/debian: the program, stripped, with its man pages, completions and parameter files, and its
# debug information apart. `packaging/deb.sh PROGRAM` packs a program that is there; without, a release is built.
set -euo pipefail
cd "$(dirname "$0")/.."

program=${1:-}
if [ -z "$program" ]; then
  cargo build --release --locked
  program=target/release/ellipsoid_slam
fi
version=$("$program" --version | cut -d' ' -f2)
architecture=$(dpkg --print-architecture)
work=target/debian
rm -rf "$work"
mkdir -p "$work"

# Everything under a package's root has the same time, so that the same program gives the same package.
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2> /dev/null || date +%s)}
export SOURCE_DATE_EPOCH

# pack NAME SECTION DESCRIPTION DEPENDS
pack() {
  local name=$1 root=$work/$1
  mkdir -p "$root/DEBIAN"
  install -Dm644 LICENSE "$root/usr/share/doc/$name/copyright"
  cat > "$root/DEBIAN/control" << EOF
Package: $name
Version: $version
Architecture: $architecture
Section: $2
Priority: optional
Maintainer: $(sed -n 's:.*<maintainer email="\([^"]*\)">\(.*\)</maintainer>.*:\2 <\1>:p' package.xml)
Installed-Size: $(du -ks "$root/usr" | cut -f1)
Depends: $4
Description: $3
EOF
  find "$root" -exec touch -h -d "@$SOURCE_DATE_EPOCH" {} +
  dpkg-deb --root-owner-group --build "$root" "$work/${name}_${version}_$architecture.deb" > /dev/null
  du -h "$work/${name}_${version}_$architecture.deb"
}

# Debuggers find the information by the program's build id.
id=$(readelf -n "$program" | sed -n 's/.*Build ID: //p')
debug=$work/ellipsoid-slam-dbgsym/usr/lib/debug/.build-id/${id:0:2}/${id:2}.debug
mkdir -p "$(dirname "$debug")"
objcopy --only-keep-debug --compress-debug-sections "$program" "$debug"
chmod 644 "$debug"

root=$work/ellipsoid-slam
install -D "$program" "$root/usr/bin/ellipsoid_slam"
strip "$root/usr/bin/ellipsoid_slam"
for file in config/*; do
  install -Dm644 "$file" "$root/usr/share/ellipsoid_slam/$file"
done
share=$root/usr/share
mkdir -p "$share/bash-completion/completions" "$share/zsh/vendor-completions" "$share/fish/vendor_completions.d" "$share/man/man1"
"$program" completions bash > "$share/bash-completion/completions/ellipsoid_slam"
"$program" completions zsh > "$share/zsh/vendor-completions/_ellipsoid_slam"
"$program" completions fish > "$share/fish/vendor_completions.d/ellipsoid_slam.fish"
"$program" man "$share/man/man1"
gzip -9n "$share/man/man1/"*.1
# The newest function of the C library that is used says how old it may be.
libc=$(objdump -T "$program" | sed -n 's/.*(GLIBC_\([0-9.]*\)).*/\1/p' | sort -V | tail -1)

pack ellipsoid-slam science "Object-level SLAM for indoor robots: ellipsoid landmarks from RGB-D frames and 2D boxes" \
  "libc6 (>= $libc), libgcc-s1"
pack ellipsoid-slam-dbgsym debug "Debug information of ellipsoid-slam" "ellipsoid-slam (= $version)"
