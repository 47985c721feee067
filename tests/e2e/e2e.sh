#!/usr/bin/env bash
# End to end: a Linux kernel in QEMU plugs in the simulated probe by USB/IP, the tool there opens it through libusb and
# scans; its mesh must be, byte for byte, that of the loopback. Both are made in the guest: another processor may round
# otherwise.
#   e2e.sh <tool> <work folder>
set -euo pipefail
tool="$(readlink -f "$1")"
work="$2"
here="$(dirname "$(readlink -f "$0")")"
patience_s=110
scan=(--lossless --device cpu --threads 1 --resolution-mm 12 --box -120 -120 -120 120 120 120)
probe=(--phantom organs --slices 12 --rate 0)

mkdir -p "$work"
cd "$work"
now() { date +%s.%N; }
since() { echo "$(now) $1" | awk '{printf "%.1f s", $1 - $2}'; }
fail() {
  echo "FAIL: $*" >&2
  exit 1
}

# The kernel with its modules, unpacked only: nothing of it is installed here.
fetch_kernel() {
  [ ! -e kernel/done ] || return 0
  rm -rf kernel
  mkdir -p kernel
  local package
  package="$(apt-cache depends linux-image-amd64 | awk '/Depends:/ {print $2; exit}')"
  (cd kernel && apt-get download -qq "$package" && dpkg-deb -x ./*.deb . && rm ./*.deb)
  # Uncompressed it boots twice as fast without virtualisation.
  extract_vmlinux kernel/boot/vmlinuz-* >kernel/vmlinux
  depmod -b kernel "$(basename kernel/lib/modules/*)"
  touch kernel/done
}

extract_vmlinux() {
  local offset
  offset="$(LC_ALL=C grep -abo $'\xfd7zXZ\x00' "$1" | head -1 | cut -d: -f1)"
  tail -c "+$((offset + 1))" "$1" | { xz -dc 2>/dev/null || true; }
}

# copy_program <program>: with the libraries that it needs.
copy_program() {
  cp "$1" initrd/bin/
  ldd "$1" | awk '/=> \// {print $3} /^\t\/lib64\// {print $1}' | while read -r library; do
    cp -Ln "$library" "initrd/lib/" 2>/dev/null || true
  done
}

copy_modules() {
  local version module file
  version="$(basename kernel/lib/modules/*)"
  mkdir -p "initrd/lib/modules/$version"
  for module in virtio_pci virtio_net vhci-hcd; do
    modprobe -d "$PWD/kernel" -S "$version" --show-depends "$module" | awk '/^insmod/ {print $2}'
  done | sort -u | while read -r file; do
    mkdir -p "initrd/$(dirname "${file#"$PWD/kernel/"}")"
    cp "$file" "initrd/${file#"$PWD/kernel/"}"
  done
  depmod -b initrd "$version" 2>/dev/null
}

make_initrd() { # <tcp port>
  rm -rf initrd
  mkdir -p initrd/bin initrd/lib initrd/usr
  ln -s lib initrd/lib64
  cp "$(command -v busybox)" initrd/bin/busybox
  cp "$here/guest_init.sh" initrd/init
  chmod +x initrd/init
  printf 'tcp_port=%s\nscan="%s"\nprobe="%s"\n' "$1" "${scan[*]}" "${probe[*]}" >initrd/arguments
  copy_program "$tool"
  copy_program "$(command -v usbip)"
  copy_modules
  (cd initrd && find . | cpio --quiet -o -H newc) >initrd.cpio  # not packed: unpacking costs more under TCG
}

boot() {
  timeout "$patience_s" qemu-system-x86_64 -cpu qemu64 -smp 1 -m 1024 -nodefaults -display none -serial stdio -no-reboot \
    -accel tcg -kernel kernel/vmlinux -initrd initrd.cpio \
    -append "console=ttyS0 quiet panic=-1 mitigations=off nokaslr no_timer_check tsc=reliable lpj=1000000 cryptomgr.notests audit=0" \
    -netdev user,id=net -device virtio-net-pci,netdev=net,romfile= </dev/null >guest.log 2>&1 || true
}

fetch_kernel
began="$(now)"
"$tool" probe --usbip --port 0 "${probe[@]}" >probe.log &
server=$!
trap 'kill $server 2>/dev/null || true' EXIT
until port="$(sed -n 's/.*TCP port \([0-9]*\).*/\1/p' probe.log)" && [ -n "$port" ]; do sleep 0.1; done
make_initrd "$port"
boot
grep -q "GUEST: same mesh" guest.log || fail "not the mesh of the loopback, or none: $work/guest.log"
echo "PASS: USB/IP, vhci-hcd, libusb: the mesh is the loopback's, $(since "$began")"
