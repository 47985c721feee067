#!/usr/bin/env bash
# Builds protocol/ and device_sim/firmware/ for a Cortex-M7, says what they take, and runs their unit tests there.
#   run.sh <build folder>      exit status 77: a tool is missing
set -euo pipefail
here="$(dirname "$(readlink -f "$0")")"
build="$1"

for tool in arm-none-eabi-g++ qemu-system-arm; do
  if ! command -v "$tool" >/dev/null; then
    echo "SKIP: no $tool; on Debian: apt-get install gcc-arm-none-eabi libnewlib-arm-none-eabi" \
         "libstdc++-arm-none-eabi-newlib qemu-system-arm"
    exit 77
  fi
done

mkdir -p "$build"
cmake -S "$here" -B "$build" -G Ninja --toolchain "$here/toolchain.cmake" -DCMAKE_BUILD_TYPE=Release >"$build/configure.log" ||
  { cat "$build/configure.log"; exit 1; }
cmake --build "$build" >"$build/build.log" || { cat "$build/build.log"; exit 1; }

# Flash is code, constants and the first values of variables; the ring's memory holds the record on the bus, too.
image="$build/bin/firmware.elf"
read -r text data bss _ < <(arm-none-eabi-size "$image" | tail -n1)
ring=$((16#$(arm-none-eabi-nm -S "$image" | awk '/ring_memory/ {print $2}')))
flash=$((text + data))
ram=$((data + bss - ring))
printf 'flash %d bytes of 65536, RAM %d bytes of 16384 and a ring of %d\n' "$flash" "$ram" "$ring"
((flash <= 65536 && ram <= 16384)) || { echo "over the budget"; exit 1; }

# The tests read the golden files from where they run.
cd "$here/../.."
exec timeout 300 qemu-system-arm -M mps2-an500 -cpu cortex-m7 -semihosting -nographic -kernel "$build/bin/tests.elf"
