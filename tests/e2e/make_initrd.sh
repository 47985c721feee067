#!/usr/bin/env bash
# What the guest starts from, in memory: BusyBox, the tool, usbip, the libraries and kernel modules that these need.
#   make_initrd.sh <kernel folder> <initrd.cpio> <tool> <arguments>   (the last: a file that the guest sources)
set -euo pipefail
kernel="$(readlink -f "$1")"
output="$(readlink -f "$2")"
tool="$3"
arguments="$4"
here="$(dirname "$(readlink -f "$0")")"
root="$(mktemp -d)"
trap 'rm -r "$root"' EXIT

copy_program() {
  cp "$1" "$root/bin/"
  ldd "$1" | awk '/=> \// {print $3} /^\t\/lib64\// {print $1}' | while read -r library; do
    cp -Ln "$library" "$root/lib/"
  done
}

copy_modules() {
  local version module file
  version="$(basename "$kernel"/lib/modules/*)"
  mkdir -p "$root/lib/modules/$version"
  for module in "$@"; do
    modprobe -d "$kernel" -S "$version" --show-depends "$module" | awk '/^insmod/ {print $2}'
  done | sort -u | while read -r file; do
    mkdir -p "$root/$(dirname "${file#"$kernel/"}")"
    cp "$file" "$root/${file#"$kernel/"}"
  done
  depmod -b "$root" "$version" 2>/dev/null
}

mkdir -p "$root/bin" "$root/lib"
ln -s lib "$root/lib64"
cp "$(command -v busybox)" "$root/bin/busybox"
cp "$here/guest_init.sh" "$root/init"
chmod +x "$root/init"
cp "$arguments" "$root/arguments"
cp "$here/../../device_sim/port/functionfs/gadget.sh" "$root/bin/"
copy_program "$tool"
copy_program "$(command -v usbip)"
copy_modules virtio_pci virtio_net vhci-hcd xhci-pci dummy_hcd usb_f_fs
(cd "$root" && find . | cpio --quiet -o -H newc) >"$output"  # not packed: unpacking costs more under TCG
