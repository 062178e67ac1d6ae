#!/bin/busybox sh
# The first process of the guest: loads the kernel's HID modules, runs each case, says "HID-RESULT N" (N failed), and halts.
/bin/busybox mkdir -p /proc /sys /dev /tmp
/bin/busybox mount -t proc proc /proc
/bin/busybox mount -t sysfs sysfs /sys
/bin/busybox mount -t devtmpfs devtmpfs /dev
export PATH=/bin HOME=/tmp LD_LIBRARY_PATH=/lib
for module in hid uhid hid-generic usb-common usbcore usbhid usbip-core vhci-hcd; do busybox insmod /modules/$module.ko || echo "no module $module"; done

failed=0
try() { # BACKEND CASE DEVICE...: with the device running beside
  echo "== $1 $2"
  backend=$1 name=$2; shift 2
  if [ $# -gt 0 ]; then "$@" & device=$!; busybox sleep 1; else device=; fi
  busybox timeout 60 guest_client $backend $name || failed=$((failed + 1))
  [ -z "$device" ] || { busybox kill $device; wait $device 2>/dev/null; busybox sleep 1; }
}
try hidraw none
try hidraw loop uhid_polhem
try hidraw silent uhid_polhem --silent
try hidraw gadget uhid_polhem --other-usage
try hidraw two uhid_polhem --count 2
try hidraw faults uhid_polhem --faults 0.05
try hidraw replug uhid_polhem --unplug-after 200
try hidraw stall uhid_polhem --silent-after 200
try hidraw loop usbip_polhem
try hidraw replug usbip_polhem --unplug-after 200
try libusb none
try libusb loop usbip_polhem
try libusb silent usbip_polhem --silent-after 0
try libusb two usbip_polhem --count 2
try libusb faults usbip_polhem --faults 0.05
try libusb stall usbip_polhem --silent-after 200
# In a servo's sandbox, from which devices are found and used, also one that is plugged in after it was entered.
try hidraw-sandboxed loop uhid_polhem
try hidraw-sandboxed replug uhid_polhem --unplug-after 200
try hidraw-sandboxed replug usbip_polhem --unplug-after 200
try libusb-sandboxed loop usbip_polhem
# libusb hears of a device that comes later from udev, which this guest has not.
try libusb unplug usbip_polhem --unplug-after 200
echo "HID-RESULT $failed"
busybox poweroff -f
