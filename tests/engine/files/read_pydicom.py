#!/usr/bin/env python3
"""Densities of DICOM folders, read by pydicom: what tests/engine/files/pydicom_test.cpp compares with.

read_pydicom.py LIST reads a text file of lines FOLDER FILES INSTEAD and writes, for each FOLDER, FOLDER.f32: the densities of
its slices (s0.dcm to the number FILES of them) as float32, in the order of their places along their normal. Padding becomes INSTEAD.

pydicom 2.3 gives the words of an image as they lie in the file. The bits of a stored value are cut out of them here,
by arithmetic instead of by masks: PS3.5, 8.1.1.
"""
import sys
import warnings

import numpy
import pydicom
from pydicom.pixel_data_handlers.util import apply_modality_lut

warnings.simplefilter("ignore")


def stored_values(words, data):
    values = words.astype(numpy.int64) % 2**data.BitsAllocated
    values = values // 2 ** (data.HighBit + 1 - data.BitsStored) % 2**data.BitsStored
    if data.PixelRepresentation == 1:
        values = numpy.where(values >= 2 ** (data.BitsStored - 1), values - 2**data.BitsStored, values)
    return values


def padding(values, data):
    if "PixelPaddingValue" not in data:
        return numpy.zeros(values.shape, bool)
    ends = [data.PixelPaddingValue, data.get("PixelPaddingRangeLimit", data.PixelPaddingValue)]
    return (values >= min(ends)) & (values <= max(ends))


def group(data, frame, name):
    """The functional group of a frame: its own, else the shared one, else the file itself."""
    for groups in (data.get("PerFrameFunctionalGroupsSequence", []), data.get("SharedFunctionalGroupsSequence", [])):
        if len(groups) > 1:
            groups = [groups[frame]]
        if len(groups) == 1 and name in groups[0]:
            return groups[0][name][0]
    return data


def slices_of(path):
    data = pydicom.dcmread(path)
    words = data.pixel_array
    frames = int(data.get("NumberOfFrames", 1))
    words = words.reshape((frames, data.Rows, data.Columns))
    for n in range(frames):
        values = stored_values(words[n], data)
        place = group(data, n, "PlanePositionSequence").ImagePositionPatient
        axes = group(data, n, "PlaneOrientationSequence").ImageOrientationPatient
        normal = numpy.cross([float(a) for a in axes[:3]], [float(a) for a in axes[3:]])
        densities = apply_modality_lut(values, group(data, n, "PixelValueTransformationSequence"))
        yield float(numpy.dot([float(p) for p in place], normal)), densities, padding(values, data)


def main():
    with open(sys.argv[1], encoding="utf-8") as lines:
        jobs = [line.split() for line in lines]
    for folder, count, instead in jobs:
        slices = []
        for n in range(int(count)):
            slices += slices_of(f"{folder}/s{n}.dcm")
        slices.sort(key=lambda one: one[0])
        with open(folder + ".f32", "wb") as out:
            for _, densities, padded in slices:
                rounded = numpy.asarray(densities, numpy.float64).astype(numpy.float32)
                rounded[padded] = numpy.float32(instead)
                out.write(rounded.astype("<f4").tobytes())


main()
