#!/bin/busybox sh
# shellcheck shell=dash disable=SC2086,SC2154  # options are words; those come from /arguments
# PID 1 of the guest: plugs the probe in one way after the other, scans each time, says what came out, ends.
/bin/busybox --install -s /bin
export PATH=/bin LD_LIBRARY_PATH=/lib HOME=/tmp
mkdir -p /proc /sys /dev /tmp /var/run
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t devtmpfs devtmpfs /dev
mount -t tmpfs tmpfs /tmp
# shellcheck source=/dev/null
. /arguments

now() { cut -d ' ' -f 1 /proc/uptime; }

# until_probes <count>: devices come and go a moment after they were plugged in or out.
until_probes() {
  tries=0
  until [ "$(sonoloft devices | grep -c Mbit)" -eq "$1" ] || [ "$tries" -ge 100 ]; do
    tries=$((tries + 1))
    sleep 0.2
  done
}

# check <way>: scans with the probe that was plugged in since $began, and sends it a file.
check() {
  until_probes 1
  sonoloft scan $scan -o /tmp/usb.ply && cmp /tmp/loopback.ply /tmp/usb.ply && sonoloft send firmware /tmp/image &&
    echo "GUEST: $1: same mesh, $(echo "$(now) $began" | awk '{printf "%.1f s", $1 - $2}')"
}

sonoloft scan --simulated $probe $scan -o /tmp/loopback.ply
dd if=/dev/urandom of=/tmp/image bs=1k count=300

began="$(now)"
for module in virtio_pci virtio_net vhci-hcd; do modprobe "$module"; done
ip link set lo up
ip addr add 10.0.2.15/24 dev eth0
ip link set eth0 up
usbip --tcp-port "$usbip_port" attach -r 10.0.2.2 -b 1-1
check "USB/IP"
usbip detach -p 0
until_probes 0

began="$(now)"
modprobe xhci-pci # its controller has had the probe since the machine was switched on
check "usb-redir"
rmmod xhci-pci
until_probes 0

began="$(now)"
modprobe dummy_hcd # a controller whose device's side and host's side are both this machine
gadget.sh sonoloft $probe &
check "FunctionFS"
kill $!
until_probes 0

poweroff -f
