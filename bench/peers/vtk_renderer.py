"""VTK on an exported scene: the GPU mapper (here: Mesa's llvmpipe) and the fixed-point mapper of the CPU."""

import time

from vtkmodules.vtkCommonDataModel import vtkPiecewiseFunction
from vtkmodules.vtkIOImage import vtkMetaImageReader
from vtkmodules.vtkRenderingCore import (
    vtkColorTransferFunction,
    vtkRenderer,
    vtkRenderWindow,
    vtkVolume,
    vtkVolumeProperty,
    vtkWindowToImageFilter,
)
from vtkmodules.vtkRenderingVolume import vtkFixedPointVolumeRayCastMapper
from vtkmodules.vtkRenderingVolumeOpenGL2 import vtkOpenGLGPUVolumeRayCastMapper
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  registers the window's implementation

from pictures import from_image_data

MAPPERS = {
    "vtk_gpu": vtkOpenGLGPUVolumeRayCastMapper,
    "vtk_fixed_point": vtkFixedPointVolumeRayCastMapper,
}


class Vtk:
    """A window with one volume, drawn with one mapper."""

    def __init__(self, name, scene, folder, step, shaded):
        self.name = name
        reader = vtkMetaImageReader()
        reader.SetFileName(str(folder / scene["volume"]["path"]))
        reader.Update()
        image = reader.GetOutput()
        mapper = MAPPERS[name]()
        mapper.SetInputData(image)
        mapper.SetBlendModeToComposite()
        mapper.AutoAdjustSampleDistancesOff()
        mapper.SetSampleDistance(step * min(image.GetSpacing()))
        if name == "vtk_gpu":
            mapper.UseJitteringOff()
            mapper.LockSampleDistanceToInputSpacingOff()
            mapper.SetMaxMemoryInBytes(2 << 30)
        else:
            mapper.SetImageSampleDistance(1.0)
            mapper.IntermixIntersectingGeometryOff()
        volume = vtkVolume()
        volume.SetMapper(mapper)
        volume.SetProperty(properties(scene, shaded))
        renderer = vtkRenderer()
        renderer.SetBackground(*scene["image"]["background"])
        renderer.AddVolume(volume)
        self.window = vtkRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetSize(*scene["image"]["size"])
        self.window.AddRenderer(renderer)
        aim(renderer, scene["camera"])

    def frame(self):
        """Wall and processor time of one frame, ms, until the picture is there."""
        wall, cpu = time.perf_counter(), time.process_time()
        self.window.Render()
        self.window.WaitForCompletion()
        return 1e3 * (time.perf_counter() - wall), 1e3 * (time.process_time() - cpu)

    def picture(self):
        """Display colours, (height, width, 3), 0 to 255."""
        grab = vtkWindowToImageFilter()
        grab.SetInput(self.window)
        grab.ReadFrontBufferOff()
        grab.Update()
        return from_image_data(grab.GetOutput())

    def close(self):
        """Frees the window; what OpenGL says of itself."""
        said = self.window.ReportCapabilities()
        self.window.Finalize()
        wanted = ("OpenGL renderer string", "OpenGL version string")
        return [line.strip() for line in said.splitlines() if line.strip().startswith(wanted)]


def properties(scene, shaded):
    """Transfer function and shading of a scene."""
    function = scene["transfer_function"]
    color, opacity = vtkColorTransferFunction(), vtkPiecewiseFunction()
    for point in function["points"]:
        color.AddRGBPoint(point["value"], *point["color"])
        opacity.AddPoint(point["value"], point["opacity"])
    made = vtkVolumeProperty()
    made.SetColor(color)
    made.SetScalarOpacity(opacity)
    made.SetScalarOpacityUnitDistance(function["unit_distance"])
    made.SetInterpolationTypeToLinear()
    made.SetShade(shaded)
    made.SetAmbient(scene["lighting"]["ambient"])
    made.SetDiffuse(scene["lighting"]["diffuse"])
    made.SetSpecular(0.0)
    return made


def aim(renderer, camera):
    """Puts the camera of a scene into a renderer."""
    active = renderer.GetActiveCamera()
    active.SetPosition(*camera["eye"])
    active.SetFocalPoint(*camera["target"])
    active.SetViewUp(*camera["up"])
    active.SetViewAngle(camera["fov_y"])
    renderer.ResetCameraClippingRange()
