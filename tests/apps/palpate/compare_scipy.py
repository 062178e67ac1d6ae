# SPDX-License-Identifier: Apache-2.0
# compare_scipy.py FOLDER: each filter that `palpate filter` wrote there against scipy.ndimage. For every line of
# FOLDER/cases.txt, "NAME CHAIN" with NAME.nrrd the result of CHAIN on in.nrrd, or "NAME gradient/OPERATOR" with NAME.raw
# its gradients, prints "NAME D C L": the largest difference D of the two; C, how much the filter changed a voxel at most;
# L, the largest density of in.nrrd, without its sign. In double; numpy and scipy alone.
import math
import os
import sys

import numpy as np
from scipy import ndimage


def volume(path):
    """Densities [k, j, i] and spacing [mm] in the same order, of an NRRD file as Palpate writes it: raw floats."""
    with open(path, "rb") as file:
        header, data = file.read().split(b"\n\n", 1)
    fields = dict(line.split(": ", 1) for line in header.decode().split("\n") if ": " in line)
    assert fields["type"] == "float" and fields["encoding"] == "raw", fields
    size = [int(n) for n in fields["sizes"].split()]
    if "spacings" in fields:
        spacing = [float(n) for n in fields["spacings"].split()]
    else:
        vectors = fields["space directions"].replace("(", " ").replace(")", " ").replace(",", " ").split()
        spacing = [float(np.linalg.norm([float(n) for n in vectors[3 * a:3 * a + 3]])) for a in range(3)]
    values = np.frombuffer(data, "<f4", count=size[0] * size[1] * size[2])
    return values.reshape(size[::-1]).astype(np.float64), spacing[::-1]


def words(chain):
    """Kind, size, unit and keys of one filter."""
    parts = chain.split(":")
    number = parts[1].removesuffix("mm")
    return parts[0], float(number), parts[1].endswith("mm"), dict(p.split("=") for p in parts[2:])


def offsets(size, in_mm, spacing, ball):
    """Which voxels a window holds: those whose centres are at most `size` away, along each axis or straight."""
    h = spacing if in_mm else [1, 1, 1]
    reach = [int(math.floor(size / step + 1e-9)) for step in h]
    grid = np.meshgrid(*[np.arange(-r, r + 1) * step for r, step in zip(reach, h)], indexing="ij")
    if not ball:
        return np.ones(grid[0].shape, bool)
    return sum(g * g for g in grid) <= size * size * (1 + 1e-9)


def diffused(f, spacing, steps, keys):
    """Perona and Malik, explicit: what flows through each of the six faces; none through the border."""
    kappa = float(keys["kappa"])
    dt = float(keys["dt"]) if "dt" in keys else 1 / (4 * sum(1 / h**2 for h in spacing))
    for _ in range(int(steps)):
        inflow = np.zeros_like(f)
        for axis, h in enumerate(spacing):
            d = np.diff(f, axis=axis)
            flow = d / (1 + (d / (kappa * h)) ** 2) / h**2
            before, after = [[slice(None)] * 3 for _ in range(2)]
            before[axis], after[axis] = slice(None, -1), slice(1, None)
            inflow[tuple(before)] += flow
            inflow[tuple(after)] -= flow
        f = f + dt * inflow
    return f


def signed_distance(f, spacing, band):
    """In metres, to the centre of the nearest voxel on the other side of isovalue 0, cut off at the band."""
    to_background, to_object = [ndimage.distance_transform_edt(m, sampling=spacing) for m in (f > 0, f <= 0)]
    return np.clip(to_background - to_object, -band * min(spacing), band * min(spacing)) * 1e-3


def expected(f, spacing, chain):
    kind, size, in_mm, keys = words(chain)
    if kind == "diffuse":
        return diffused(f, spacing, size, keys)
    if kind == "distance":
        return signed_distance(f, spacing, size)
    mode = {"nearest": "nearest", "mirror": "reflect"}[keys.get("border", "nearest")]  # SciPy: reflect = d c b | b c d
    if kind == "gaussian":
        sigma = [size / h if in_mm else size for h in spacing]
        truncate = float(keys.get("truncate", 3))
        for axis, s in enumerate(sigma):
            reach = math.ceil(truncate * s - 1e-9)
            f = ndimage.gaussian_filter1d(f, s, axis=axis, mode=mode, truncate=(reach + 0.25) / s)  # int(truncate s + 0.5)
        return f
    window = offsets(size, in_mm, spacing, keys.get("shape") == "ball")
    if kind == "median":
        return ndimage.median_filter(f, footprint=window, mode=mode)
    dilate = lambda g: ndimage.grey_dilation(g, footprint=window, mode=mode)
    erode = lambda g: ndimage.grey_erosion(g, footprint=window, mode=mode)
    return {"dilate": dilate, "erode": erode, "open": lambda g: dilate(erode(g)),
            "close": lambda g: erode(dilate(g))}[kind](f)


def gradients(f, spacing, operator):
    """[axis, k, j, i] with axis 0 along i, per metre; each stencil as a correlation along each axis."""
    if operator.startswith("gaussian"):  # central differences of the smoothed field
        return gradients(expected(f, spacing, operator), spacing, "central")
    along = {"central": [-0.5, 0, 0.5], "sobel": [-0.5, 0, 0.5], "central4": [1 / 12, -8 / 12, 0, 8 / 12, -1 / 12]}
    results = []
    for axis in (2, 1, 0):
        g = ndimage.correlate1d(f, along[operator], axis=axis, mode="nearest")
        if operator == "sobel":
            assert np.allclose(ndimage.sobel(f, axis=axis, mode="nearest"),
                               32 * smoothed(g, axis, [0.25, 0.5, 0.25]))  # SciPy's own, unscaled
            g = smoothed(g, axis, [0.25, 0.5, 0.25])
        results.append(g / (spacing[axis] * 1e-3))
    return np.array(results)


def smoothed(g, but, weights):
    for axis in range(3):
        if axis != but:
            g = ndimage.correlate1d(g, weights, axis=axis, mode="nearest")
    return g


def inside(f, reach):
    return f[..., reach:-reach, reach:-reach, reach:-reach]


def main(folder):
    f, spacing = volume(os.path.join(folder, "in.nrrd"))
    for line in open(os.path.join(folder, "cases.txt")):
        name, chain = line.split()
        if chain.startswith("gradient/"):  # doubles: three components a voxel, i fastest of the voxels
            ours = np.fromfile(os.path.join(folder, name + ".raw"), "<f8").reshape(f.shape + (3,)).transpose(3, 0, 1, 2)
            ours, theirs = inside(ours, 2), inside(gradients(f, spacing, chain.removeprefix("gradient/")), 2)
            change = np.abs(theirs).max()
        else:
            ours, _ = volume(os.path.join(folder, name + ".nrrd"))
            theirs = expected(f, spacing, chain)
            change = np.abs(theirs - f).max()
        print(name, *[repr(float(n)) for n in (np.abs(ours - theirs).max(), change, np.abs(f).max())])


main(sys.argv[1])
