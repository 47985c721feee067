#!/bin/sh
# Makes this machine, by its USB device controller, a simulated probe for the host at the other end of the cable. As
# root, until Ctrl-C.
#   gadget.sh <sonoloft> [options of sonoloft probe]
set -eu
tool="$1"
shift
gadget=/sys/kernel/config/usb_gadget/sonoloft
pid=""

fail() {
  echo "gadget.sh: $*" >&2
  exit 1
}

take_apart() {
  echo "" >"$gadget/UDC" || true
  if [ -n "$pid" ]; then
    kill "$pid" || true
    wait "$pid" || true
  fi
  umount "$folder/function" && rm -r "$folder"
  rm "$gadget/configs/c.1/ffs.sonoloft"
  rmdir "$gadget/configs/c.1" "$gadget/functions/ffs.sonoloft" "$gadget/strings/0x409" "$gadget"
}

modprobe usb_f_fs
grep -q " /sys/kernel/config " /proc/mounts || mount -t configfs none /sys/kernel/config
for controller in /sys/class/udc/*; do break; done
[ -e "$controller" ] || fail "no USB device controller here: take a board that has one, or modprobe dummy_hcd"
mkdir "$gadget"
folder="$(mktemp -d)"
mkdir "$folder/function"
trap take_apart EXIT
trap exit INT TERM
mkdir "$gadget/strings/0x409" "$gadget/functions/ffs.sonoloft" "$gadget/configs/c.1"
ln -s "$gadget/functions/ffs.sonoloft" "$gadget/configs/c.1/"
echo high-speed >"$gadget/max_speed"
mount -t functionfs sonoloft "$folder/function"

"$tool" probe --functionfs "$folder/function" "$@" >"$folder/said" &
pid=$!
until grep -q serialnumber "$folder/said"; do
  kill -0 "$pid" 2>/dev/null || fail "the probe did not start"
  sleep 0.1
done
cat "$folder/said"
sed -n 's/^  //p' "$folder/said" | while read -r attribute value; do
  echo "$value" >"$gadget/$attribute"
done
basename "$controller" >"$gadget/UDC"
wait "$pid"
