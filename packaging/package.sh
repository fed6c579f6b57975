#!/usr/bin/env bash
# Creates the packages for Debian 12 from built programs and the pages of the C++ API: a Debian package, an archive with
# the same files, and a list of their components (SPDX). The same build and commit give the same bytes.
set -euo pipefail
unset CDPATH
(($# == 2)) || { echo "usage: package.sh BUILD_DIRECTORY OUTPUT_DIRECTORY" >&2; exit 2; }
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$(realpath "$1")
mkdir -p "$2"
output=$(realpath "$2")

fail() {
    echo "package.sh: $*" >&2
    exit 1
}

[[ -x $build/bin/scanloom-server ]] || fail "there is no scanloom-server in $build/bin; build it first"
[[ -f $build/web/index.html ]] || fail "there is no viewer in $build/web; build it first, which needs node and npm"
[[ -n $(type -P doxygen) ]] || fail "doxygen is not installed; ./scanloom install package installs it"

version=$("$build/bin/scanloom-server" --version)
version=${version##* }
architecture=$(dpkg --print-architecture)
name=scanloom_${version}_$architecture
# The build time: the commit's time, or SOURCE_DATE_EPOCH (reproducible-builds.org).
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git -C "$source" log -1 --format=%ct 2>/dev/null || stat --format=%Y "$build/bin/scanloom-server")}
export SOURCE_DATE_EPOCH

work=$(mktemp --directory --tmpdir scanloom-package.XXXXXX)
trap 'rm -rf "$work"' EXIT
umask 022

# --- Files and their paths ---
root=$work/root
docs=$root/usr/share/doc/scanloom
cmake --install "$build" --component programs --prefix "$root/usr" --strip >"$work/install.log" || fail "$(cat "$work/install.log")"
cd "$source"
install -D --mode 644 packaging/scanloom-server.service "$root/lib/systemd/system/scanloom-server.service"
install -D --mode 644 packaging/scanloom-server.toml "$root/etc/scanloom/scanloom-server.toml"
install -D --mode 644 packaging/sysusers.conf "$root/usr/lib/sysusers.d/scanloom.conf"
install -D --mode 644 -t "$docs" packaging/debian/copyright
packaging/documents.sh "$docs"
packaging/api_pages.sh "$version" "$docs/api"
# The node of ROS, as a folder for a workspace, with the client instead of a link to it.
mkdir "$root/usr/share/scanloom/ros"
cp --recursive --dereference robot_client/ros_bridge "$root/usr/share/scanloom/ros/scanloom_bridge"
find "$root/usr/share/scanloom/ros" -name __pycache__ -prune -exec rm -r {} +
node packaging/sbom.mjs "$version" "$architecture" web/package-lock.json "$root"/usr/bin/* >"$output/$name.spdx.json"
install -D --mode 644 "$output/$name.spdx.json" "$docs/scanloom.spdx.json"

# --- Dependencies: libraries of at least the versions whose symbols are used ---
mkdir -p "$work/debian"
# dpkg-shlibdeps expands it
printf 'Source: scanloom\n\nPackage: scanloom\nArchitecture: any\nDepends: ${shlibs:Depends}\n' >"$work/debian/control"
depends=$(cd "$work" && dpkg-shlibdeps -O "$root"/usr/bin/* 2>"$work/shlibdeps.log") || fail "$(cat "$work/shlibdeps.log")"
depends=${depends#shlibs:Depends=}

# --- The package and the archive ---
mkdir "$root/DEBIAN"
sed -e "s/@VERSION@/$version/" -e "s/@ARCHITECTURE@/$architecture/" -e "s/@DEPENDS@/$depends/" packaging/debian/control.in >"$root/DEBIAN/control"
install --mode 644 packaging/debian/conffiles "$root/DEBIAN/"
install --mode 755 -t "$root/DEBIAN" packaging/debian/{postinst,prerm,postrm}
find "$root" -exec touch --no-dereference --date "@$SOURCE_DATE_EPOCH" {} +
dpkg-deb --root-owner-group -Zxz --build "$root" "$output/$name.deb" >/dev/null
tar --create --gzip --file "$output/$name.tar.gz" --directory "$root" --exclude ./DEBIAN --sort=name --owner=root:0 --group=root:0 \
    --mtime "@$SOURCE_DATE_EPOCH" .
echo "$output/$name.deb"
echo "$output/$name.tar.gz"
echo "$output/$name.spdx.json"
