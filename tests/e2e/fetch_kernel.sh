#!/usr/bin/env bash
# Debian's kernel with its modules, unpacked only: nothing of it is installed here. Once; 70 MB.
#   fetch_kernel.sh <folder>
set -euo pipefail
folder="$1"
[ ! -e "$folder/complete" ] || exit 0

extract_vmlinux() {
  local offset
  offset="$(LC_ALL=C grep -abo $'\xfd7zXZ' "$1" | awk -F: 'NR == 1 {print $1}')"
  xz -dc --single-stream < <(tail -c "+$((offset + 1))" "$1")  # what follows the kernel is not its
}

package="$(apt-cache depends linux-image-amd64 | awk '/Depends:/ && !kernel {kernel = $2} END {print kernel}')"
[ -n "$package" ] || {
  echo "fetch_kernel: no linux-image-amd64 is known here: run apt-get update first" >&2
  exit 1
}
rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
apt-get -o APT::Sandbox::User=root download -qq "$package"
dpkg-deb -x ./*.deb .
rm ./*.deb
extract_vmlinux boot/vmlinuz-* >vmlinux  # uncompressed it boots twice as fast without virtualisation
depmod -b . "$(basename lib/modules/*)"
touch complete
