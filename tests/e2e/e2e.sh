#!/usr/bin/env bash
# End to end: a Linux kernel in QEMU gets a simulated probe plugged in, one way after the other; the tool there opens it
# through libusb and scans; every mesh must be, byte for byte, that of the loopback. All are made in the guest: another
# processor may round otherwise.
#   e2e.sh <tool> <work folder>
set -euo pipefail
tool="$(readlink -f "$1")"
work="$2"
here="$(dirname "$(readlink -f "$0")")"
patience_s=240
ways=("USB/IP" "usb-redir" "FunctionFS")
scan="--lossless --device cpu --threads 1 --resolution-mm 12 --box -120 -120 -120 120 120 120"
probe="--phantom organs --slices 4 --rate 0"

"$here/fetch_kernel.sh" "$work/kernel"
cd "$work"
began="$(date +%s.%N)"
servers=()
trap 'kill "${servers[@]}" 2>/dev/null || true' EXIT
fail() {
  echo "FAIL: $*" >&2
  exit 1
}

# serve <way>: sets ${port}, the TCP port where a simulated probe can be reached that way.
serve() {
  # shellcheck disable=SC2086
  "$tool" probe "--$1" --port 0 $probe >"$1.log" 2>&1 &
  servers+=($!)
  port=""
  until [ -n "$port" ]; do
    kill -0 "${servers[-1]}" 2>/dev/null || fail "$(cat "$1.log")"
    sleep 0.1
    port="$(sed -n 's/.*TCP port \([0-9]*\);.*/\1/p' "$1.log")"
  done
}

# boot <TCP port of the probe behind the machine's own controller>. Where other programs keep the processors busy the
# kernel takes the TSC for faster or slower than it is, and with it every timeout: it has to use another clock.
boot() {
  timeout "$patience_s" qemu-system-x86_64 -cpu qemu64 -smp 1 -m 1024 -nodefaults -display none -serial stdio -no-reboot \
    -accel tcg -kernel kernel/vmlinux -initrd initrd.cpio \
    -append "console=ttyS0 quiet panic=-1 mitigations=off nokaslr no_timer_check tsc=unstable lpj=1000000 cryptomgr.notests audit=0" \
    -netdev user,id=net -device virtio-net-pci,netdev=net,romfile= \
    -device qemu-xhci -chardev "socket,id=probe,host=127.0.0.1,port=$1" -device usb-redir,chardev=probe \
    </dev/null >guest.log 2>&1 || true
}

serve usbip
usbip_port="$port"
serve usbredir
printf 'usbip_port=%s\nscan="%s"\nprobe="%s"\n' "$usbip_port" "$scan" "$probe" >arguments
"$here/make_initrd.sh" kernel initrd.cpio "$tool" arguments
boot "$port"
for way in "${ways[@]}"; do
  took="$(sed -n "s|.*GUEST: $way: same mesh, \([0-9.]* s\).*|\1|p" guest.log)"
  if [ -z "$took" ]; then
    tail -n 40 guest.log >&2
    fail "$way: not the mesh of the loopback, or none; the guest's last words are above, all are in $work/guest.log"
  fi
  echo "PASS: $way: the mesh is the loopback's, $took"
done
echo "$began $(date +%s.%N)" | awk '{printf "e2e: %.1f s, with the guest from its start to its end\n", $2 - $1}'
