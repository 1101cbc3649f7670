#!/usr/bin/env python3
"""Makes the table of docs/suitability.md: what the decimated surface costs a stress analysis.

  scripts/suitability.py BUILD FOLDER [CASE...]

BUILD is a build folder with PERIOST_BENCHMARKS=ON, FOLDER where meshes and results are kept (what is there is not made
again), CASE of cube, femur, femur_ct and skull. femur_ct needs PERIOST_TEST_DATA, skull PERIOST_CRANIUM. For each case
the undecimated isosurface, the decimated ones at 0.2, 0.3 and 0.4 voxel, and vtkQuadricDecimation's at the same numbers
of triangles are filled by TetGen and stretched (pipeline/mechanics/stretch.h). The table goes to standard output.
"""
import json
import os
import pathlib
import re
import subprocess
import sys

DISTANCES = ("0.2", "0.3", "0.4")
IMAGE = "  - {{stage: read_image, path: {}}}\n  - {{stage: threshold, lower: 226, keep: largest, fill_holes: all}}\n"
CASES = {
    "cube": "  - {stage: phantom, shape: cube}\n  - {stage: threshold, lower: 0.5}\n",
    "femur": "  - {stage: phantom, shape: femur}\n"
             "  - {stage: threshold, lower: 226, keep: largest, fill_holes: all}\n",
    "femur_ct": IMAGE.format(os.environ.get("PERIOST_TEST_DATA", ".") + "/femur_leg_ct.nii.gz"),
    "skull": IMAGE.format(os.environ.get("PERIOST_CRANIUM", "Cranium.inv3")),
}


def run(build, folder, chain, save=()):
    """Runs a chain into a folder, unless that was done; the text of its error, or None."""
    if not (folder / "run.json").exists():
        folder.mkdir(parents=True, exist_ok=True)
        config = folder.with_suffix(".yaml")
        config.write_text("periost: 1\nname: suitability\nchain:\n" + chain)
        subprocess.run([build / "bin/periost", "run", config, "--out", folder, "--force", "--progress", "none",
                        *(["--save", ",".join(save)] if save else [])], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                       check=False)
    return (json.loads((folder / "run.json").read_text()).get("error") or {}).get("text")


def triangles(folder):
    """Triangles of the surface that the chain left."""
    stages = json.loads((folder / "run.json").read_text())["stages"]
    return int([o for s in stages for o in s["outputs"] if o["kind"] in ("surface", "isosurface")][-1]["facts"]["triangles"])


def made_meshes(build, case, root):
    """The volumes of a case as (name, triangles, file or sentence), the undecimated one first."""
    base = CASES[case] + "  - {stage: marching_cubes, keep: largest}\n"
    fine = root / case / "fine"
    error = run(build, fine, base + "  - {stage: tetgen, from: {surface: marching_cubes}}\n", ["isosurface"])
    if error:
        sys.exit(f"{case}: {error}")
    rows = [("isosurface", triangles(fine), fine / "volume.vtu")]
    for distance in DISTANCES:
        ours = root / case / f"periost-{distance.replace('.', '_')}"
        error = run(build, ours, base + f"  - {{stage: decimate, distance: {distance} voxel, small_components: drop}}\n"
                    "  - {stage: triangulate}\n  - {stage: tetgen}\n  - {stage: improve}\n")
        rows.append((f"{distance} voxel", triangles(ours), error or ours / "volume.vtu"))
        theirs = root / case / f"vtk-{distance.replace('.', '_')}"
        surface = theirs.with_suffix(".vtp")
        if not surface.exists():
            subprocess.run([build / "bin/bench_suitability", "--quadric", fine / "isosurface.vtp",
                            str(triangles(ours)), surface], check=True)
        error = run(build, theirs, f"  - {{stage: read_surface, path: {surface.resolve()}, require: any}}\n"
                    "  - {stage: tetgen}\n  - {stage: improve}\n")
        if error and "guarantee" in error or not (theirs / "run.json").exists():
            error = "refused"
        rows.append((f"VTK at {triangles(ours):,}", triangles(ours), error or theirs / "volume.vtu"))
    return rows


def answers(build, rows, folder):
    """What bench_suitability says of each file; kept in a file."""
    kept = folder / "answers.json"
    if not kept.exists():
        files = [str(file) for _, _, file in rows if isinstance(file, pathlib.Path)]
        done = subprocess.run([build / "bin/bench_suitability", "--threads", str(os.cpu_count()), *files],
                              capture_output=True, text=True, check=True)
        kept.write_text(done.stdout)
    return {said["file"]: said for said in map(json.loads, kept.read_text().splitlines())}


def line(case, row, said, fine):
    """One line of the table."""
    name, count, file = row
    if not isinstance(file, pathlib.Path):
        return f"| {case} | {name} | {count:,} | – | no tetrahedra: {re.sub(r'[|]', '/', file)} | | | | |"
    if "stiffness" not in said:
        return f"| {case} | {name} | {count:,} | {said['tets']:,} | not stretched | | | | |"
    change = [f"{100 * (said[key] / fine[key] - 1):+.2f} %" for key in ("stiffness", "energy", "p95_von_mises")]
    if said is fine:
        change = [f"{said['stiffness']:,.0f} N/mm", f"{said['energy']:,.1f} N mm", f"{said['p95_von_mises']:.2f} MPa"]
    return "| " + " | ".join([case, name, f"{count:,}", f"{said['tets']:,}", *change, str(said["iterations"]),
                              f"{said['seconds']:.1f}"]) + " |"


def main():
    build, root = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    print("| case | surface | triangles | tets | stiffness | energy | p95 stress | iterations | seconds |")
    print("|---|---|---|---|---|---|---|---|---|")
    for case in sys.argv[3:] or CASES:
        rows = made_meshes(build, case, root)
        said = answers(build, rows, root / case)
        fine = said[str(rows[0][2])]
        for row in rows:
            print(line(case, row, said.get(str(row[2]), {}), fine), flush=True)


if __name__ == "__main__":
    main()
