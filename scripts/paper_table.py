#!/usr/bin/env python3
"""Runs the paper's examples with both methods and writes the table of docs/paper.md between its markers.

  scripts/paper_table.py PERIOST DOCUMENT WORK_FOLDER

PERIOST is the built program. The real ventricles are run when PERIOST_TEST_DATA names the folder that holds them.
"""
import json
import os
import pathlib
import subprocess
import sys

PHANTOM = "  - stage: phantom\n    shape: {shape}\n{more}  - stage: threshold\n    lower: {lower}\n"
REAL = "  - stage: read_image\n    path: {path}\n  - stage: threshold\n    lower: 0.5\n"
TAIL = "  - stage: marching_cubes\n  - stage: decimate\n    method: {method}\n{options}" \
       "  - stage: triangulate\n  - stage: verify\n    preset: lenient\n"

CUBE = PHANTOM.format(shape="cube", more="", lower=0.5)
VENTRICLE = PHANTOM.format(shape="ventricle", more="", lower=0.5)
NOISY = PHANTOM.format(shape="ventricle", more="    noise: 1\n", lower=0.5)
VESSEL = PHANTOM.format(shape="vessel", more="", lower=190)
BOTH = ("paper", "certified")


def cases(data):
    """Example, the paper's rate, image, options of decimate, methods."""
    yield "cube, 0.4, s 3, β 0.15", "90 %", CUBE, {"distance": "0.4 voxel", "rigidity": 3, "stiffness": 0.15}, BOTH
    yield "cube, 0.4, s 0, β 0.15", "–", CUBE, {"distance": "0.4 voxel", "rigidity": 0, "stiffness": 0.15}, BOTH
    yield "ventricle phantom, 0.4", "65 %", VENTRICLE, {"distance": "0.4 voxel"}, BOTH
    yield "the same, noise 1", "65 %", NOISY, {"distance": "0.4 voxel"}, BOTH
    if data:
        real = REAL.format(path=os.path.join(data, "lateral_ventricles_1mm.nii.gz"))
        yield "real ventricles, 0.4", "65 %", real, {"distance": "0.4 voxel"}, BOTH
    yield "vessel, 0.2", "81 %", VESSEL, {"distance": "0.2 voxel"}, BOTH
    yield "vessel, 0.2, two pieces", "81 %", VESSEL, {"distance": "0.2 voxel", "pieces": 2}, ("paper",)
    yield "vessel, 0.2, four pieces", "81 %", VESSEL, {"distance": "0.2 voxel", "pieces": 4}, ("paper",)
    yield "vessel, 0.3", "92 %", VESSEL, {"distance": "0.3 voxel"}, BOTH


def run(periost, folder, image, options, method):
    """Runs one chain; returns its quality.json and the seconds that decimate took."""
    lines = "".join(f"    {key}: {value}\n" for key, value in options.items())
    config = folder / "config.yaml"
    config.write_text("periost: 1\nname: paper\nchain:\n" + image + TAIL.format(method=method, options=lines))
    out = folder / "out"
    done = subprocess.run([periost, "run", config, "--out", out, "--force", "--quiet", "--threads", "2"],
                          capture_output=True, text=True)
    if done.returncode not in (0, 3):  # 3: a gate of the preset failed, which the table shows
        sys.exit(f"{config}: exit code {done.returncode}\n{done.stderr}")
    manifest = json.loads((out / "run.json").read_text())
    seconds = next(stage["wall_s"] for stage in manifest["stages"] if stage["kind"] == "decimate")
    return json.loads((out / "quality.json").read_text()), seconds


def row(name, published, method, quality, seconds):
    """One line of the table; distances in thresholds."""
    decimation, surface = quality["decimation"], quality["surface"]
    distance, angle, smooth = surface["distance"], surface["min_angle_deg"], surface["smoothness"]
    asked = distance["requested"]
    cells = [
        name, published, f"`{method}`",
        f"{decimation['triangles_before']:,} → {decimation['triangles_after']:,}",
        f"{100 * decimation['rate']:.1f} %",
        f"{distance['surface_to_isosurface']['max'] / asked:.2f} / {distance['isosurface_to_surface']['max'] / asked:.2f}",
        f"{100 * surface['volume_change']:+.1f} %",
        f"{angle['min']:.1f}° / {angle['p01']:.1f}°",
        f"{smooth['simplex_angle_rms_deg']:.1f}° / {smooth['normal_deviation_rms_deg']:.1f}°",
        str(surface["self_intersections"]), f"{seconds:.1f} s",
    ]
    return "| " + " | ".join(cells) + " |"


def main():
    periost, document, work = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    rows = ["| example | the paper | method | triangles | rate | distance, there / back | volume | angles, worst / p01 "
            "| smoothness, φ / normals | crossings | decimate |", "|---" * 11 + "|"]
    for name, published, image, options, methods in cases(os.environ.get("PERIOST_TEST_DATA")):
        for method in methods:
            folder = work / f"{len(rows)}-{method}"
            folder.mkdir(parents=True, exist_ok=True)
            rows.append(row(name, published, method, *run(periost, folder, image, options, method)))
            print(rows[-1], flush=True)
    text = document.read_text()
    begin, end = "<!-- table: scripts/paper-table.sh -->\n", "<!-- end of table -->"
    head, rest = text.split(begin)
    document.write_text(head + begin + "\n".join(rows) + "\n" + end + rest.split(end)[1])


main()
