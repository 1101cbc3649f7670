#!/usr/bin/env python3
"""Runs bench_decimate over cases and methods and writes the tables of docs/benchmarks.md between its markers.

  scripts/bench_decimate.py BENCH_DECIMATE DOCUMENT [CASE...]
"""
import json
import pathlib
import platform
import subprocess
import sys

CASES = ("cranium", "ventricle", "vessel", "femur")
METHODS = ("periost", "vtkQuadricDecimation", "vtkDecimatePro", "cgal_collapse", "cgal_quadric", "cgal_remesh")
BASE = "vtkQuadricDecimation"
TIMED = ("periost", BASE)  # the methods whose times are compared
MORE_ROUNDS = 4


def measured(program, case, method, triangles, *options):
    """What the program says of one run, or None where the method failed."""
    done = subprocess.run([program, case, method, triangles, *options], capture_output=True, text=True)
    if done.returncode != 0:
        print(f"{case} {method}: {done.stderr.strip()}", file=sys.stderr)
        return None
    return json.loads(done.stdout)


def timed_in_turns(program, case, said, triangles):
    """Runs methods again in turns, so that what else the machine does slows all alike; keeps the least times of each."""
    for _ in range(MORE_ROUNDS):
        for method in TIMED:
            again = measured(program, case, method, triangles[method], "--time-only")
            if again and again["seconds"] < said[method]["seconds"]:
                said[method].update({key: again[key] for key in ("seconds", "processor_seconds")})


def row(name, said, base):
    """One line of a table; times as ratios to the base's first."""
    ratio = f"{said['seconds'] / base['seconds']:.2f}" if base else "–"
    volume = f"{100 * said['volume_change']:+.2f} %" if "volume_change" in said else "–"
    tets = said["tetgen"]
    cells = [name, ratio, f"{said['seconds']:.1f} ({said['processor_seconds']:.1f})",
             f"{said['peak_bytes'] / said['before']:.0f}",
             f"{said['triangles']:,}, {100 * said['triangles'] / said['before']:.1f} %",
             f"{said['min_angle']:.1f}° / {said['p01_angle']:.1f}°", f"{100 * said['below_20']:.2f} %",
             f"{said['outward']:.2f} / {said['back']:.2f}", volume,
             f"{said['self_intersections']:,} / {said['non_manifold']:,}",
             f"{tets:,} tets" if isinstance(tets, int) else f"no: `{tets}`"]
    return "| " + " | ".join(cells) + " |"


HEAD = ("| | time | s (processor) | bytes per triangle | triangles | angles, worst / p01 | under 20° | voxels off, there / back "
        "| volume | crossings / non-manifold | TetGen |\n" + "|---" * 11 + "|")


def table(program, case):
    """The lines of one case."""
    said = {method: measured(program, case, method, "10%") for method in METHODS}
    timed_in_turns(program, case, said, dict.fromkeys(TIMED, "10%"))
    base = said[BASE]
    lines = [f"## {case}: {base['before']:,} triangles", "", HEAD]
    lines += [row(f"{method}, 10 %", one, base) for method, one in said.items() if one]
    end = measured(program, case, "periost", "end")
    count = str(end["triangles"])
    said = {"periost": end, BASE: measured(program, case, BASE, count)}
    timed_in_turns(program, case, said, {"periost": "end", BASE: count})
    same = said[BASE]
    lines += [row("periost, to the end", end, same), row(f"{BASE}, as many", same, same)]
    return lines + [""]


def machine():
    """The processor's name and the number of cores."""
    text = pathlib.Path("/proc/cpuinfo").read_text()
    names = [line.split(":")[1].strip() for line in text.splitlines() if line.startswith("model name")]
    return f"{names[0] if names else platform.machine()}, {len(names)} cores"


def main():
    program, document = sys.argv[1], pathlib.Path(sys.argv[2])
    lines = [f"Machine: {machine()}, Debian 12, GCC 12 -O2; two threads for periost, one for the others, which have no more.", ""]
    for case in sys.argv[3:] or CASES:
        lines += table(program, case)
        print("\n".join(lines[-20:]), flush=True)
    text = document.read_text()
    begin, end = "<!-- tables: scripts/bench-decimate.sh -->\n", "<!-- end of tables -->"
    head, rest = text.split(begin)
    document.write_text(head + begin + "\n".join(lines) + end + rest.split(end)[1])


main()
