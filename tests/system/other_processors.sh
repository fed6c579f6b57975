#!/usr/bin/env bash
# Runs the kernels on another processor: built for 64-bit ARM (NEON), in an emulator; checks that the bits are equal.
# Needs Debian's g++-aarch64-linux-gnu and qemu-user-static; takes a minute.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

readonly sources=(tests/system/sweep_fingerprint.cpp common/scan/beam_angles.cpp common/scan/scan.cpp
    core/mapping/beam_fan.cpp core/mapping/chunk_kernels.cpp core/mapping/sweep/*.cpp)
readonly options=(-std=c++20 -O2 -ffp-contract=off -static -DHWY_COMPILE_ONLY_STATIC -I.)
place=$(mktemp --directory --tmpdir scanloom-neon.XXXXXX)
trap 'rm -rf "$place"' EXIT
# Only the headers of Highway and Eigen are used here, which are equal for all processors; other headers of this machine
# are not.
mkdir "$place/include"
ln -s /usr/include/hwy /usr/include/eigen3/Eigen /usr/include/boost "$place/include"

# Compiled with the project's options, for every instruction set of its processors.
sets=$(grep -o 'HWY_[A-Z]*_TARGETS=[^"]*' core/mapping/CMakeLists.txt)
for source in core/mapping/chunk_kernels.cpp core/mapping/sweep/{contours,crossings,fill}.cpp; do
    aarch64-linux-gnu-g++ -std=c++20 -O2 -ffp-contract=off "-D$sets" -I. -isystem "$place/include" -c "$source" \
        -o "$place/$(basename "$source").o"
done

g++ "${options[@]}" -isystem "$place/include" "${sources[@]}" -o "$place/here"
aarch64-linux-gnu-g++ "${options[@]}" -isystem "$place/include" "${sources[@]}" -o "$place/arm"
here=$("$place/here")
arm=$(qemu-aarch64-static "$place/arm")
echo "here $here, ARM with NEON $arm"
[[ $here == "$arm" ]] || { echo "the kernels give different results on ARM" >&2; exit 1; }
