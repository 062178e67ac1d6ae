#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""unpack_kernel.py VMLINUZ VMLINUX: the kernel inside a compressed image, which QEMU starts at once (PVH)."""
import lzma
import sys

image = open(sys.argv[1], "rb").read()
at = image.find(b"\xfd7zXZ\x00")
while at >= 0:
    try:
        kernel = lzma.LZMADecompressor().decompress(image[at:])
        if kernel[:4] == b"\x7fELF":
            open(sys.argv[2], "wb").write(kernel)
            sys.exit(0)
    except lzma.LZMAError:
        pass
    at = image.find(b"\xfd7zXZ\x00", at + 1)
sys.exit(f"{sys.argv[1]}: no kernel packed with XZ is in it")
