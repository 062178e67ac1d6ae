#!/usr/bin/env bash
# run.sh BUILD CACHE: the devices code on a real kernel, in QEMU without KVM, with emulated arms by uhid and by USB/IP.
# Deterministic: one processor whose clock counts instructions. Takes under two minutes; the first time fetches a kernel (70 MB).
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$1 cache=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

mkdir -p "$cache"
if [ ! -f "$cache/vmlinux" ]; then
  package=$(apt-cache search --names-only '^linux-image-6\.1\.0-[0-9]+-amd64$' | cut -d' ' -f1 | sort -V | tail -1)
  [ -n "$package" ] || { echo "no Debian kernel 6.1 is known to apt; run apt-get update" >&2; exit 1; }
  (cd "$work" && apt-get -qq -o APT::Sandbox::User=root download "$package" && dpkg-deb -x "$package"_*.deb kernel)
  mkdir -p "$cache/modules"
  find "$work/kernel" \( -name hid.ko -o -name uhid.ko -o -name hid-generic.ko -o -name usb-common.ko -o -name usbcore.ko -o -name usbhid.ko \
    -o -name usbip-core.ko -o -name vhci-hcd.ko \) -exec cp {} "$cache/modules/" \;
  strip --strip-debug "$cache"/modules/*.ko
  python3 "$here/unpack_kernel.py" "$work"/kernel/boot/vmlinuz-* "$cache/vmlinux.new"
  mv "$cache/vmlinux.new" "$cache/vmlinux"
fi

root=$work/root
mkdir -p "$root"/{bin,lib/palpate,modules}
cp "$cache"/modules/*.ko "$root/modules/"
cp "$(command -v busybox)" "$root/bin/busybox"
cp "$here/init.sh" "$root/init"
cp "$build"/test-bin/{guest_client,uhid_polhem,usbip_polhem} "$root/bin/"
cp "$build"/lib/palpate/{hidraw,hidusb}.so "$root/lib/palpate/"
strip "$root"/bin/{guest_client,uhid_polhem,usbip_polhem} "$root"/lib/palpate/*.so
# Each library that these need, by its name, where the loader looks for it.
ldd "$root"/bin/{guest_client,uhid_polhem,usbip_polhem} "$root"/lib/palpate/*.so | awk '/=> \//{print $3}' | sort -u |
  while read -r library; do cp -L "$library" "$root/lib/"; done
mkdir -p "$root/lib64"
cp -L /lib64/ld-linux-x86-64.so.2 "$root/lib64/"
# hidapi's libusb back end turns the device's names into UTF-8 with these.
gconv=/usr/lib/x86_64-linux-gnu/gconv
mkdir -p "$root$gconv"
cp "$gconv"/UTF-16.so "$root$gconv/"
printf 'alias UTF16// UTF-16//\nmodule UTF-16// INTERNAL UTF-16 1\nmodule INTERNAL UTF-16// UTF-16 1\n' >"$root$gconv/gconv-modules"
chmod +x "$root/init"
(cd "$root" && find . | cpio --quiet -o -H newc >"$work/initrd.cpio")

timeout 300 qemu-system-x86_64 -accel tcg -cpu qemu64 -smp 1 -icount shift=1,sleep=off -rtc base=2026-01-01,clock=vm -m 512 -nodefaults -nic none \
  -display none -serial stdio -monitor none -no-reboot -kernel "$cache/vmlinux" -initrd "$work/initrd.cpio" \
  -append "console=ttyS0 panic=-1 quiet nokaslr" </dev/null | tee "$work/out"
grep -q '^HID-RESULT 0' <(tr -d '\r' <"$work/out")
