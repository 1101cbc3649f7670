#!/usr/bin/env python3
"""Makes the table of docs/suitability.md: what the decimated surface costs a stress analysis.

  scripts/suitability.py BUILD FOLDER [CASE...]

BUILD is a build folder with PERIOST_BENCHMARKS=ON, FOLDER where meshes and results are kept (what is there is not made
again), CASE of cube, femur, femur_ct and skull. femur_ct needs PERIOST_TEST_DATA, skull PERIOST_CRANIUM. For each case
the undecimated isosurface, the decimated ones at 0.2, 0.3 and 0.4 voxel, and vtkQuadricDecimation's at the same numbers
of triangles are filled by TetGen and stretched (pipeline/mechanics/stretch.h). The table goes to standard output.

The skull's isosurface is too large for second order. Its meshes are stretched at first order, where only elements of equal
size compare: MAX_VOLUME makes the decimated ones' as small as the isosurface's, and lets TetGen split their triangles.
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
# mm^3, for the cases that are stretched at first order.
MAX_VOLUME = {"skull": 0.85}
LIMITS = "time_limit: 7200, memory_limit: 7GiB"


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
    """Triangles of the surface that the chain filled: the decimated one, else the isosurface."""
    stages = json.loads((folder / "run.json").read_text())["stages"]
    counts = {}
    for output in (o for s in stages for o in s["outputs"]):
        counts.setdefault(output["kind"], output["facts"].get("triangles"))
    return int(counts.get("surface", counts["isosurface"]))


def made_meshes(build, case, root):
    """The volumes of a case as (name, triangles, file or sentence), the undecimated one first."""
    base = CASES[case] + "  - {stage: marching_cubes, keep: largest}\n"
    sizes = f", max_volume: {MAX_VOLUME[case]}, preserve_surface: false" if case in MAX_VOLUME else ""
    fill = f"  - {{stage: tetgen, {LIMITS}{sizes}}}\n  - {{stage: improve}}\n"
    fine = root / case / "fine"
    error = run(build, fine, base + f"  - {{stage: tetgen, {LIMITS}, from: {{surface: marching_cubes}}}}\n", ["isosurface"])
    if error:
        sys.exit(f"{case}: {error}")
    rows = [("isosurface", triangles(fine), fine / "volume.vtu")]
    for distance in DISTANCES:
        ours = root / case / f"periost-{distance.replace('.', '_')}"
        error = run(build, ours, base + f"  - {{stage: decimate, distance: {distance} voxel, small_components: drop}}\n"
                    "  - {stage: triangulate}\n" + fill)
        rows.append((f"{distance} voxel", triangles(ours), error or ours / "volume.vtu"))
        theirs = root / case / f"vtk-{distance.replace('.', '_')}"
        surface = theirs.with_suffix(".vtp")
        if not surface.exists():
            subprocess.run([build / "bin/bench_suitability", "--quadric", fine / "isosurface.vtp",
                            str(triangles(ours)), surface], check=True)
        error = run(build, theirs, f"  - {{stage: read_surface, path: {surface.resolve()}, require: any}}\n" + fill)
        if error and "guarantee" in error or not (theirs / "run.json").exists():
            error = "refused"
        rows.append((f"VTK at {triangles(ours):,}", triangles(ours), error or theirs / "volume.vtu"))
    return rows


def answers(build, rows, folder, order):
    """What bench_suitability says of each file; each is kept in a file as soon as it is there."""
    kept = folder / "answers.json"
    said = {line["file"]: line for line in map(json.loads, kept.read_text().splitlines())} if kept.exists() else {}
    files = [str(file) for _, _, file in rows if isinstance(file, pathlib.Path)]
    for file in files:
        if file in said:
            continue
        done = subprocess.run([build / "bin/bench_suitability", "--threads", str(len(os.sched_getaffinity(0))), "--order",
                               str(order), "--frame", files[0], file], capture_output=True, text=True, check=True)
        with kept.open("a") as out:
            out.write(done.stdout)
        said[file] = json.loads(done.stdout)
    return said


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
        said = answers(build, rows, root / case, 1 if case in MAX_VOLUME else 2)
        fine = said[str(rows[0][2])]
        for row in rows:
            print(line(case, row, said.get(str(row[2]), {}), fine), flush=True)


if __name__ == "__main__":
    main()
