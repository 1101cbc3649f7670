#!/usr/bin/env python3
"""Draws our side of the paper's figures 4 to 7 into docs/images, off-screen, from synthetic phantoms only.

  xvfb-run -a /usr/bin/python3 scripts/paper_figures.py [PERIOST]

PERIOST is the built program (default: the release build). Needs Debian's python3-vtk9 and xvfb.
"""
import json
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import zlib

import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  chooses the renderer
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkFiltersCore import vtkPolyDataNormals
from vtkmodules.vtkImagingColor import vtkImageQuantizeRGBToIndex
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
from vtkmodules.vtkRenderingCore import (vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow,
                                         vtkWindowToImageFilter)

ROOT = pathlib.Path(__file__).resolve().parent.parent
BONE = (0.87, 0.80, 0.70)
PIECES = [(214, 120, 90), (92, 148, 188), (130, 170, 96), (206, 172, 84)]

CHAIN = """periost: 1
name: figure
chain:
  - stage: phantom
    shape: {shape}
  - stage: threshold
    lower: {lower}
  - stage: marching_cubes
  - stage: decimate
    method: {method}
{options}  - stage: triangulate
"""


def run(periost, folder, shape, lower, method="paper", **options):
    """Runs one chain and returns its folder, with isosurface.vtp, simplex_mesh.vtp and surface.vtp in it."""
    folder = folder / "-".join([shape, method] + [f"{k}{v}".replace(" ", "") for k, v in options.items()])
    folder.mkdir()
    config = folder / "figure.yaml"
    lines = "".join(f"    {key}: {value}\n" for key, value in options.items())
    config.write_text(CHAIN.format(shape=shape, lower=lower, method=method, options=lines))
    out = folder / "out"
    subprocess.run([periost, "run", config, "--out", out, "--save", "isosurface,simplex_mesh", "--quiet"], check=True)
    return out


def read(path):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def actor_of(data, edges=True, color=BONE, line_width=1.0):
    normals = vtkPolyDataNormals()  # flat: every triangle shows
    normals.SetInputData(data)
    normals.ComputePointNormalsOff()
    normals.ComputeCellNormalsOn()
    normals.SplittingOff()
    normals.ConsistencyOff()
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(normals.GetOutputPort())
    actor = vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetInterpolationToFlat()
    look.SetColor(*color)
    look.SetAmbient(0.18)
    look.SetDiffuse(0.85)
    if edges:
        look.EdgeVisibilityOn()
        look.SetEdgeColor(0.16, 0.18, 0.22)
        look.SetLineWidth(line_width)
    return actor


def panel(actor, view, up, zoom, focus=None):
    """view: towards the camera; zoom 1 fills the panel; focus: a share of the bounding box, or its middle."""
    renderer = vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(actor)
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    bounds = actor.GetBounds()
    share = focus or (0.5, 0.5, 0.5)
    point = [bounds[2 * a] + share[a] * (bounds[2 * a + 1] - bounds[2 * a]) for a in range(3)]
    camera.SetFocalPoint(*point)
    camera.SetPosition(*[point[a] + view[a] for a in range(3)])
    camera.SetViewUp(*up)
    renderer.ResetCamera()
    camera.SetFocalPoint(*point)
    camera.SetPosition(*[point[a] + 500 * view[a] for a in range(3)])
    camera.Zoom(zoom)
    renderer.ResetCameraClippingRange()
    return renderer


def write_png(path, image, colours=64):
    """An RGB image as a PNG with a palette: a third of the size that VTK's own writer needs."""
    indexed = vtkImageQuantizeRGBToIndex()
    indexed.SetInputData(image)
    indexed.SetNumberOfColors(colours)
    indexed.Update()
    width, height, _ = indexed.GetOutput().GetDimensions()
    scalars, table = indexed.GetOutput().GetPointData().GetScalars(), indexed.GetLookupTable()
    values = bytes(int(scalars.GetValue(i)) for i in range(width * height))
    rows = b"".join(b"\0" + values[y * width:(y + 1) * width] for y in reversed(range(height)))
    palette = b"".join(bytes(round(255 * c) for c in table.GetTableValue(i)[:3])
                       for i in range(table.GetNumberOfTableValues()))

    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0))
                     + chunk(b"PLTE", palette) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def draw(name, panels, columns, width, height):
    """Panels of equal size, row by row from the top."""
    rows = -(-len(panels) // columns)
    window = vtkRenderWindow()
    window.OffScreenRenderingOn()
    window.SetMultiSamples(8)
    window.SetSize(columns * width, rows * height)
    for i, renderer in enumerate(panels):
        column, row = i % columns, rows - 1 - i // columns
        renderer.SetViewport(column / columns, row / rows, (column + 1) / columns, (row + 1) / rows)
        window.AddRenderer(renderer)
    window.Render()
    image = vtkWindowToImageFilter()
    image.SetInput(window)
    image.ReadFrontBufferOff()
    image.Update()
    path = ROOT / "docs" / "images" / name
    path.parent.mkdir(parents=True, exist_ok=True)
    write_png(path, image.GetOutput())
    print(path, path.stat().st_size, "bytes")


def pieces_coloured(folder, spacing):
    """The sewn simplex mesh, its faces coloured by the piece that they lie in."""
    events = [json.loads(line) for line in (folder / "events.ndjson").read_text().splitlines()]
    text = next(event["text"] for event in events if event.get("code") == "decimate.pieces")
    axis = "ijk".index(re.search(r"axis (\w)", text).group(1))
    planes = [int(word) * spacing[axis] for word in re.search(r"voxels (.*)", text).group(1).split(", ")]
    data = read(folder / "simplex_mesh.vtp")
    colours = vtkUnsignedCharArray()
    colours.SetNumberOfComponents(3)
    for i in range(data.GetNumberOfCells()):
        bounds = data.GetCell(i).GetBounds()
        middle = 0.5 * (bounds[2 * axis] + bounds[2 * axis + 1])
        colours.InsertNextTuple3(*PIECES[sum(middle > plane for plane in planes)])
    data.GetCellData().SetScalars(colours)
    return data


def main():
    periost = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "build/release/bin/periost")
    with tempfile.TemporaryDirectory() as work:
        work = pathlib.Path(work)
        cube = run(periost, work, "cube", 0.5, distance="0.4 voxel", rigidity=3, stiffness=0.15)
        ventricle = run(periost, work, "ventricle", 0.5, distance="0.4 voxel")
        four = run(periost, work, "vessel", 190, distance="0.2 voxel", pieces=4)
        vessel = {(m, d): run(periost, work, "vessel", 190, m, distance=f"{d} voxel")
                  for m in ("paper", "certified") for d in (0.2, 0.3)}

        tree = dict(view=(-1, 0.15, 0.1), up=(0, 0, 1))  # the cuts stand upright
        draw("figure4a.png", [panel(actor_of(pieces_coloured(four, (0.33, 0.33, 1.0)), line_width=0.6),
                                    zoom=1.35, **tree)], 1, 620, 640)
        look = dict(view=(0.9, -1.4, 0.8), up=(0, 0, 1), zoom=1.45)
        draw("figure4bc.png", [panel(actor_of(read(cube / "isosurface.vtp"), edges=False), **look),
                               panel(actor_of(read(cube / "surface.vtp"), edges=False), **look),
                               panel(actor_of(read(cube / "surface.vtp")), **look)], 3, 380, 380)
        side = dict(view=(1, -0.9, 0.45), up=(0, 0, 1))
        draw("figure5.png", [panel(actor_of(read(ventricle / "surface.vtp")), zoom=1.4, **side),
                             panel(actor_of(read(ventricle / "simplex_mesh.vtp")), zoom=1.4, **side)], 2, 480, 420)
        draw("figure6.png", [panel(actor_of(read(vessel["paper", 0.2] / "surface.vtp"), line_width=0.6),
                                   zoom=1.35, **tree)], 1, 620, 640)
        detail = dict(zoom=6, focus=(0.5, 0.4, 0.45), view=(0.25, -1, 0.1), up=(0, 0, 1))
        draw("figure7.png", [panel(actor_of(read(vessel[m, d] / "surface.vtp")), **detail)
                             for m in ("paper", "certified") for d in (0.2, 0.3)], 2, 420, 340)


main()
