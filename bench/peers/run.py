"""Umbravox and VTK in turn, frame by frame, on the same volumes, transfer functions, cameras and steps.

    cargo bench --bench gpu -- --set record --export /tmp/peers
    python bench/peers/run.py /tmp/peers --program target/release/umbravox --json peers.json

Every round draws one frame with each renderer. Pictures are compared before times are: ours must agree with one of VTK's
mappers to a PSNR of 35 dB unshaded, 25 dB shaded, or as well as these two agree with each other, less 1 dB. Where it does
not, the renderers do not draw the same, and nothing is written. See README.md beside this file.
"""

import argparse
import json
import os
import statistics
import sys
from pathlib import Path

import vtkmodules.all  # noqa: F401  factories of readers and mappers

from ours import Ours
from pictures import psnr_db
from vtk_renderer import MAPPERS, Vtk

THRESHOLD_DB = {False: 35.0, True: 25.0}
# How much worse than VTK's two mappers among themselves.
MARGIN_DB = 1.0


def measure(arguments, name, step, shaded):
    """One row: all renderers on one scene."""
    folder = arguments.folder
    scene_path = folder / f"{name}.json"
    scene = json.loads(scene_path.read_text())
    settings = {"march.step": step, "lighting.shading": "diffuse" if shaded else "none"}
    ours = Ours(arguments.program, scene_path, settings)
    renderers = [ours] + [Vtk(mapper, scene, folder, step, shaded) for mapper in MAPPERS]
    for renderer in renderers:
        renderer.frame()  # pipelines are built, normals computed
    times = {renderer.name: [] for renderer in renderers}
    for _ in range(arguments.rounds):
        for renderer in renderers:
            times[renderer.name].append(renderer.frame())
    pictures = {renderer.name: renderer.picture() for renderer in renderers}
    psnr = {
        "vtk_gpu": psnr_db(pictures["umbravox"], pictures["vtk_gpu"]),
        "vtk_fixed_point": psnr_db(pictures["umbravox"], pictures["vtk_fixed_point"]),
        "between_theirs": psnr_db(pictures["vtk_gpu"], pictures["vtk_fixed_point"]),
    }
    said = {renderer.name: renderer.close() for renderer in renderers}
    return {
        "scene": name,
        "image": scene["image"]["size"],
        "step": step,
        "shaded": shaded,
        "psnr_db": psnr,
        "samples": said["umbravox"]["samples"]["taken"],
        "times": {
            name: {
                "wall_ms": spread(wall for wall, _ in pairs),
                "cpu_ms": spread(cpu for _, cpu in pairs),
            }
            for name, pairs in times.items()
        },
        "devices": {"umbravox": said["umbravox"]["device"], "vtk_gpu": said["vtk_gpu"]},
    }


def spread(values):
    """Smallest, median and largest."""
    values = sorted(values)
    return {"min": values[0], "median": statistics.median(values), "max": values[-1]}


def disagreement(row):
    """What is wrong with the pictures of a row, or None."""
    least = THRESHOLD_DB[row["shaded"]]
    if row["psnr_db"]["between_theirs"] is not None:
        least = min(least, row["psnr_db"]["between_theirs"] - MARGIN_DB)
    best = [row["psnr_db"][mapper] for mapper in MAPPERS]
    if None in best or max(best) >= least:
        return None
    return f"{row['scene']}, step {row['step']}: {max(best):.1f} dB, below {least:.1f} dB"


def table(rows):
    """The figures as Markdown: processor time per frame over the cores, and how many times ours theirs is."""
    cores = os.cpu_count()
    lines = [
        "| scene | step | shaded | ours ms | VTK GPU ms | times ours | VTK FixedPoint ms | times ours | PSNR dB, GPU / FixedPoint / the two |",
        "| --- | --: | --- | --: | --: | --: | --: | --: | --: |",
    ]
    for row in rows:
        cpu = {name: time["cpu_ms"]["median"] / cores for name, time in row["times"].items()}
        db = ["equal" if db is None else f"{db:.1f}" for db in row["psnr_db"].values()]
        lines.append(
            f"| {row['scene']} | {row['step']} | {'yes' if row['shaded'] else 'no'} | {cpu['umbravox']:.0f} "
            f"| {cpu['vtk_gpu']:.0f} | {cpu['vtk_gpu'] / cpu['umbravox']:.2f} "
            f"| {cpu['vtk_fixed_point']:.0f} | {cpu['vtk_fixed_point'] / cpu['umbravox']:.2f} | {' / '.join(db)} |"
        )
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="what --export wrote")
    parser.add_argument("--program", default="target/release/umbravox", help="our program")
    parser.add_argument("--scenes", nargs="+", default=["fog", "sparse", "blobs", "aorta", "head"])
    parser.add_argument("--steps", nargs="+", type=float, default=[1.0, 0.5])
    parser.add_argument("--shading", nargs="+", choices=["off", "on"], default=["off", "on"])
    parser.add_argument("--rounds", type=int, default=3, help="frames of each renderer, after one that is not counted")
    parser.add_argument("--json", type=Path, help="write every figure here")
    arguments = parser.parse_args()
    if "DISPLAY" not in os.environ:
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    rows = []
    for name in arguments.scenes:
        if not (arguments.folder / f"{name}.json").exists():
            print(f"NOT MEASURED: {name}: {arguments.folder} has no such scene", file=sys.stderr)
            continue
        for shading in arguments.shading:
            for step in arguments.steps:
                rows.append(measure(arguments, name, step, shading == "on"))
                print(table(rows).splitlines()[-1], file=sys.stderr, flush=True)
    wrong = [text for text in map(disagreement, rows) if text]
    print(table(rows))
    if wrong:
        sys.exit("the pictures differ:\n  " + "\n  ".join(wrong))
    if arguments.json:
        report = {
            "cores": os.cpu_count(),
            "vtk": vtkmodules.vtkCommonCore.vtkVersion.GetVTKVersion(),
            "threshold_db": {"unshaded": THRESHOLD_DB[False], "shaded": THRESHOLD_DB[True]},
            "rounds": arguments.rounds,
            "rows": rows,
        }
        arguments.json.write_text(json.dumps(report, indent=2) + "\n")


if __name__ == "__main__":
    main()
