#!/bin/busybox sh
# PID 1 of the guest: plugs the probe in, scans, says what came out, ends.
/bin/busybox --install -s /bin
export PATH=/bin LD_LIBRARY_PATH=/lib HOME=/tmp
mkdir -p /proc /sys /dev /tmp /var/run
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t devtmpfs devtmpfs /dev
for module in virtio_pci virtio_net vhci-hcd; do modprobe "$module"; done
ip link set lo up
ip addr add 10.0.2.15/24 dev eth0
ip link set eth0 up
mount -t tmpfs tmpfs /tmp
. /arguments
usbip --tcp-port "$tcp_port" attach -r 10.0.2.2 -b 1-1
# The device appears a moment after it was attached.
tries=0
until sonoloft devices | grep Mbit || [ "$tries" -ge 50 ]; do
  tries=$((tries + 1))
  sleep 0.2
done
# shellcheck disable=SC2086
sonoloft scan --simulated $probe $scan -o /tmp/loopback.ply
# shellcheck disable=SC2086
sonoloft scan $scan -o /tmp/usb.ply && cmp /tmp/loopback.ply /tmp/usb.ply && echo "GUEST: same mesh"
poweroff -f
