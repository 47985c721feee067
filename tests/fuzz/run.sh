#!/usr/bin/env bash
# Builds the fuzzers and runs each for some seconds, beginning with the committed corpus. What is found new stays in
# <build folder>/corpus; what breaks something, in the folder that the message names: fix it, and commit the file.
#   run.sh <build folder> [seconds each] [target...]
set -euo pipefail
here="$(dirname "$(readlink -f "$0")")"
build="$1"
seconds="${2:-20}"
shift $(($# < 2 ? $# : 2))

mkdir -p "$build"
cmake -S "$here" -B "$build" -G Ninja -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ >"$build/configure.log" ||
  { cat "$build/configure.log"; exit 1; }
cmake --build "$build" >"$build/build.log" || { cat "$build/build.log"; exit 1; }

targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(accept clock contour csl igtl mesh recording replies requests sequence usbip usbredir)
for target in "${targets[@]}"; do
  mkdir -p "$build/corpus/$target" "$build/found"
  log="$build/$target.log"
  "$build/bin/fuzz_$target" -max_total_time="$seconds" -max_len=16384 -rss_limit_mb=2048 -timeout=10 -print_final_stats=1 \
    -artifact_prefix="$build/found/$target-" "$build/corpus/$target" "$here/corpus/$target" >"$log" 2>&1 ||
    { tail -n 60 "$log"; exit 1; }
  printf '%-9s %9s executions, nothing found\n' "$target" \
    "$(awk '/stat::number_of_executed_units/ {print $2}' "$log")"
done
