# SPDX-License-Identifier: Apache-2.0
"""VTK's and SciPy's filters and VTK's pictures, timed on request: what apps/rivals/python_rivals.cpp starts and talks with.

A line in, a line out, words parted by tabs:
  threads N                        first line in. Out: "rival LIBRARY JOB WAY" and "missing LIBRARY WHY [JOB]" lines, "ready"
  load FILE NX NY NZ HX HY HZ      raw floats, i fastest; spacing in mm. Out: "ok"
  see WIDTH HEIGHT ISOVALUE X Y Z FX FY FZ UX UY UZ FOV
                                   of pictures: where the camera is [mm], its directions forward and up, the angle between
                                   the upper and the lower edge [degree]. Out: "ok"
  run LIBRARY JOB WAY [FILE]       Out: "cost WALL_MS CPU_MS"; FILE gets the result as raw floats
"error WORDS" where something failed. Ends when its input does.
"""
import os
import resource
import signal
import sys
import time

signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to answer, which then closes the input


def say(*words):
    sys.stdout.write("\t".join(str(word).replace("\n", " ") for word in words) + "\n")
    sys.stdout.flush()


threads = int(sys.stdin.readline().split("\t")[1])
os.environ["OMP_NUM_THREADS"] = str(threads)
os.environ["VTK_SMP_MAX_THREADS"] = str(threads)
rivals = {}  # (library, job, way) -> function of the volume; its result is an array, i fastest
volume = None  # numpy array [k, j, i]
spacing = (1.0, 1.0, 1.0)
view = None  # numbers of "see"


def rival(library, job, way):
    def register(function):
        rivals[library, job, way] = function
        say("rival", library, job, way)
        return function

    return register


def offer_scipy():
    import numpy
    from scipy import ndimage

    one = "one thread"

    def simple(job, way, work):
        rival("SciPy", job, f"ndimage.{way}, {one}")(lambda: work(volume))

    simple("gaussian:1.5", "gaussian_filter, 11 taps",
           lambda v: ndimage.gaussian_filter(v, 1.5, truncate=3, mode="nearest"))
    simple("median:1", "median_filter", lambda v: ndimage.median_filter(v, size=3, mode="nearest"))
    simple("dilate:1", "grey_dilation", lambda v: ndimage.grey_dilation(v, size=(3, 3, 3), mode="nearest"))
    simple("erode:1", "grey_erosion", lambda v: ndimage.grey_erosion(v, size=(3, 3, 3), mode="nearest"))
    simple("open:1", "grey_opening", lambda v: ndimage.grey_opening(v, size=(3, 3, 3), mode="nearest"))
    simple("close:1", "grey_closing", lambda v: ndimage.grey_closing(v, size=(3, 3, 3), mode="nearest"))

    def components(along):
        def work(v):
            out = numpy.empty(v.shape + (3,), numpy.float32)
            for component, h in enumerate(spacing):
                out[..., component] = along(v, 2 - component) / h
            return out

        return work

    simple("gradient central", "correlate1d, three times",
           components(lambda v, axis: ndimage.correlate1d(v, [-0.5, 0, 0.5], axis=axis, mode="nearest")))
    simple("gradient sobel", "sobel, three times",
           components(lambda v, axis: ndimage.sobel(v, axis=axis, mode="nearest") / 32))
    simple("gradient gaussian:1.5", "gaussian_filter of order 1, three times",
           components(lambda v, axis: ndimage.gaussian_filter(
               v, 1.5, order=[int(axis == a) for a in range(3)], truncate=3, mode="nearest")))


def offer_vtk():
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkMultiThreader
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkImagingGeneral import (vtkImageAnisotropicDiffusion3D, vtkImageGaussianSmooth, vtkImageGradient,
                                              vtkImageMedian3D)
    from vtkmodules.vtkImagingMorphological import vtkImageContinuousDilate3D, vtkImageContinuousErode3D

    vtkMultiThreader.SetGlobalMaximumNumberOfThreads(threads)
    vtkMultiThreader.SetGlobalDefaultNumberOfThreads(threads)
    image = {}  # of the volume that was loaded last

    def input_image():
        if image.get("of") is not volume:
            made = vtkImageData()
            made.SetDimensions(*reversed(volume.shape))
            made.SetSpacing(*spacing)
            made.GetPointData().SetScalars(numpy_to_vtk(volume.reshape(-1)))  # in place
            image.update({"of": volume, "image": made})
        return image["image"]

    def filters(job, way, *setups):
        def work():
            at = None  # a filter keeps the one before it alive
            for make, setup in setups:
                one = make()
                setup(one)
                one.SetInputData(input_image()) if at is None else one.SetInputConnection(at.GetOutputPort())
                at = one
            at.Update()
            return at

        work.array = lambda at: vtk_to_numpy(at.GetOutput().GetPointData().GetScalars())
        rival("VTK", job, way)(work)

    kernel = lambda f: f.SetKernelSize(3, 3, 3)

    def smooth(f):
        f.SetDimensionality(3)
        f.SetStandardDeviation(1.5)
        f.SetRadiusFactor(3.4)  # which ends the kernel at five voxels

    def diffuse(f):
        f.SetNumberOfIterations(5)
        f.SetDiffusionThreshold(200)  # its own 5 leaves a scan's noise as it is

    ball = "its kernel of 3^3 is a ball"
    filters("gradient central", "vtkImageGradient, 64-bit result", (vtkImageGradient, lambda f: f.SetDimensionality(3)))
    filters("gaussian:1.5", "vtkImageGaussianSmooth, 11 taps", (vtkImageGaussianSmooth, smooth))
    filters("median:1", "vtkImageMedian3D", (vtkImageMedian3D, kernel))
    filters("dilate:1", f"vtkImageContinuousDilate3D, {ball}", (vtkImageContinuousDilate3D, kernel))
    filters("erode:1", f"vtkImageContinuousErode3D, {ball}", (vtkImageContinuousErode3D, kernel))
    filters("close:1", f"vtkImageContinuousDilate3D, Erode3D, {ball}", (vtkImageContinuousDilate3D, kernel),
            (vtkImageContinuousErode3D, kernel))
    filters("diffuse:5:kappa=200", "vtkImageAnisotropicDiffusion3D, 5 iterations, all neighbours",
            (vtkImageAnisotropicDiffusion3D, diffuse))
    offer_vtk_picture()


# Front to back through 16-bit values, opaque from the isovalue on. The window that VTK wants is never seen.
def offer_vtk_picture():
    if "DISPLAY" not in os.environ:
        say("missing", "VTK", "its ray caster wants a display: run the bench with xvfb-run -a", "picture")
        return
    import numpy
    import vtkmodules.vtkRenderingOpenGL2
    import vtkmodules.vtkRenderingVolumeOpenGL2
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPiecewiseFunction
    from vtkmodules.vtkRenderingCore import (vtkColorTransferFunction, vtkRenderer, vtkRenderWindow, vtkVolume,
                                             vtkVolumeProperty, vtkWindowToImageFilter)
    from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper

    made = {}

    def scene():
        if made.get("of") is volume:
            return made
        least, most = float(volume.min()), float(volume.max())
        made.clear()
        made.update({"least": least, "scale": 65535 / max(most - least, 1e-30)})
        made["words"] = numpy.round((volume - least) * made["scale"]).astype(numpy.uint16)
        image = vtkImageData()
        image.SetDimensions(*reversed(volume.shape))
        image.SetSpacing(*spacing)
        image.GetPointData().SetScalars(numpy_to_vtk(made["words"].reshape(-1)))
        caster = vtkFixedPointVolumeRayCastMapper()
        caster.SetInputData(image)
        caster.SetNumberOfThreads(threads)
        caster.AutoAdjustSampleDistancesOff()
        caster.SetImageSampleDistance(1)
        caster.SetSampleDistance(0.5 * min(spacing))
        white = vtkColorTransferFunction()
        white.AddRGBPoint(0, 1, 1, 1)
        look = vtkVolumeProperty()
        look.SetColor(white)
        look.ShadeOn()
        look.SetAmbient(0.2)
        look.SetInterpolationTypeToLinear()
        look.SetScalarOpacityUnitDistance(1e-3 * min(spacing))
        shown = vtkVolume()
        shown.SetMapper(caster)
        shown.SetProperty(look)
        renderer = vtkRenderer()
        renderer.AddVolume(shown)
        window = vtkRenderWindow()
        window.SetOffScreenRendering(1)
        window.AddRenderer(renderer)
        made.update({"of": volume, "caster": caster, "look": look, "renderer": renderer, "window": window})
        return made

    def work():
        now = scene()
        width, height, isovalue = int(view[0]), int(view[1]), view[2]
        at, forward, up = (numpy.array(view[n:n + 3]) for n in (3, 6, 9))
        word = (isovalue - now["least"]) * now["scale"]
        opaque = vtkPiecewiseFunction()
        opaque.AddPoint(word, 0)
        opaque.AddPoint(word + 1, 1)
        now["look"].SetScalarOpacity(opaque)
        camera = now["renderer"].GetActiveCamera()
        camera.SetPosition(*at)
        camera.SetFocalPoint(*(at + forward))
        camera.SetViewUp(*up)
        camera.SetViewAngle(view[12])
        now["renderer"].ResetCameraClippingRange()
        now["window"].SetSize(width, height)
        now["caster"].Modified()
        now["window"].Render()
        return now["window"]

    def covered(window):
        grab = vtkWindowToImageFilter()
        grab.SetInput(window)
        grab.Update()
        pixels = vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars())
        rows = (pixels.max(axis=1) > 0).reshape(int(view[1]), int(view[0]))
        return rows[::-1]  # VTK's first row is the lowest

    work.array = covered
    rival("VTK", "picture", "vtkFixedPointVolumeRayCastMapper, 16 bits, steps of half a voxel")(work)


def load(path, *numbers):
    import numpy

    global volume, spacing
    size = [int(n) for n in numbers[:3]]
    spacing = tuple(float(h) for h in numbers[3:])
    volume = numpy.fromfile(path, numpy.float32).reshape(size[::-1])
    say("ok")


def see(*numbers):
    global view
    view = [float(n) for n in numbers]
    say("ok")


def cpu_ms():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return 1e3 * (usage.ru_utime + usage.ru_stime)


def run(library, job, way, path=None):
    work = rivals[library, job, way]
    cpu, start = cpu_ms(), time.perf_counter()
    result = work()
    wall = 1e3 * (time.perf_counter() - start)
    cpu = cpu_ms() - cpu
    if path:
        array = work.array(result) if hasattr(work, "array") else result
        array.astype("float32").reshape(-1).tofile(path)
    say("cost", wall, cpu)


for library, offer, package in ("SciPy", offer_scipy, "python3-scipy"), ("VTK", offer_vtk, "python3-vtk9"):
    try:
        offer()
    except ImportError:
        say("missing", library, f"not installed: apt-get install {package}")
say("ready")
for line in sys.stdin:
    words = line.rstrip("\n").split("\t")
    try:
        {"load": load, "see": see, "run": run}[words[0]](*words[1:])
    except Exception as trouble:  # one rival's failure is not the others'
        say("error", repr(trouble))
