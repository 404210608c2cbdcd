#!/usr/bin/python3
"""Run sim_server study over scenes that ship, and measure what larger meshes cost.

Called by scripts/study, which builds the program first. Each scene gets a folder with its
rows.csv, timing.csv, along.csv, reference.csv and summary.json. Blocks of 3 to 300 thousand
tetrahedra (made here, gone afterwards) are explained by model: cost.json, time a step in contact,
set-up, bytes. With --million also one of a million, condensed on two ranks of MPI, which takes 12 GB;
that needs scripts/setup --mpi. Timed runs go one at a time. Interrupted, it goes on where it was.

Writes into --out: the folders, block_coarse.msh (a mesh that advice may name), cost.json and
summary.json (the rows of all scenes).

Exit status: 0 done, 1 a program failed, 2 wrong use.
"""

import argparse
import csv
import hashlib
import json
import math
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SERVER = ROOT / "build" / "release" / "bin" / "sim_server"
SCENES = ("liver", "liver_implicit", "liver_tensor_mass", "liver_reduced", "block", "block_friction")
QUICK = ("liver_reduced",)
# Of blocks also a mesh with edges (mm) about twice as long under the tool; finer ones would take too long.
BLOCK_EDGE = 4
# The block without friction is near a closed form: a sphere of this radius (m) on a bonded layer of this height (m), E
# (Pa) and nu, while it presses by less than this share of the radius. The layer is endless, the sides of the block are
# free, which makes it a few percent softer.
BALL, LAYER, MODULUS, POISSON, SHALLOW = 0.006, 0.040, 48e3, 0.45, 0.2
# Cells along x and z of a block, half as many along y: 3 to 292 thousand tetrahedra.
SIZES = (10, 15, 22, 32, 46)
MODELS = ("tensor_mass", "hybrid", "quasi_static", "reduced", "implicit")
MILLION, MPI_BUILD = 70, ROOT / "build" / "mpi" / "bin" / "sim_server"  # 1 029 000 tetrahedra
SCENE = """title = "A block of {n} x {m} x {n} cells"
rate_hz = 30
[mesh]
file = "{mesh}"
[[fixed]]
box = [[-1, -1, -1], [1, -0.0299, 1]]
[material]
law = "linear"
young_modulus = 10e3
poisson_ratio = 0.45
[deformation]
model = "{model}"
[[tool]]
radius = 0.003
reach = [[-0.0025, -0.0025, -0.0025], [0.0025, 0.0025, 0.0025]]
"""
CUTTING = """cut_buttons = 1
[cutting]
box = [[-0.005, -0.005, -0.005], [0.005, 0.005, 0.005]]
"""
KUHN = ((1, 2, 4), (1, 4, 2), (2, 1, 4), (2, 4, 1), (4, 1, 2), (4, 2, 1))  # ways from a corner: bits x, y, z


def write_block(file, n):
    """60 x 30 x 60 mm, its top y = 0: n x n/2 x n cubes of six tetrahedra."""
    m = n // 2
    step = 0.06 / n
    number = {}
    for i in range(n + 1):
        for j in range(m + 1):
            for k in range(n + 1):
                number[i, j, k] = len(number) + 1
    cells = [(i, j, k) for i in range(n) for j in range(m) for k in range(n)]
    with open(file, "w", encoding="utf-8") as out:
        print(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{len(number)}", file=out)
        for (i, j, k), v in number.items():
            print(v, i * step - 0.03, (j - m) * 0.03 / m, k * step - 0.03, file=out)
        print(f"$EndNodes\n$Elements\n{6 * len(cells)}", file=out)
        e = 0
        for i, j, k in cells:
            for way in KUHN:
                corner, corners = 0, [number[i, j, k]]
                for bit in way:
                    corner |= bit
                    corners.append(number[i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2 & 1)])
                if way in ((1, 4, 2), (2, 1, 4), (4, 2, 1)):  # an odd permutation: inside out
                    corners[2], corners[3] = corners[3], corners[2]
                e += 1
                print(e, "4 2 0 0", *corners, file=out)
        print("$EndElements", file=out)


def say(text):
    print(f"study deformation: {text}", file=sys.stderr, flush=True)


def run(*arguments):
    """Its progress is shown; its table goes to stdout."""
    ended = subprocess.run([SERVER, *map(str, arguments)], check=False)
    if ended.returncode != 0:
        raise SystemExit(f"study deformation: sim_server {' '.join(map(str, arguments))} ended with {ended.returncode}")


def tetrahedra_of(n):
    return 6 * n * n * (n // 2)


def write_scene(folder, model, n):
    """Of a block that is written beside it. Returns both files."""
    mesh, scene = folder / f"block_{n}.msh", folder / f"block_{n}_{model}.toml"
    write_block(mesh, n)
    text = SCENE.format(n=n, m=n // 2, mesh=mesh, model=model) + (CUTTING if model == "hybrid" else "")
    scene.write_text(text, encoding="utf-8")
    return mesh, scene


def cost_of(folder, model, n):
    """Measured by this program before, or now."""
    found = folder / f"{model}_{n}.json"
    if not found.exists():
        mesh, scene = write_scene(folder, model, n)
        subprocess.run([SERVER, "explain", scene, "--no-cache", "--json", found, "--steps", "20"], check=True,
                       stdout=subprocess.DEVNULL)
        mesh.unlink()
    told = json.loads(found.read_text(encoding="utf-8"))
    return {"model": model, "tetrahedra": tetrahedra_of(n), "step_ms_p50": told["contact"]["step_ms"]["p50"],
            "setup_ms": told["setup_ms"], "bytes": told["bytes"]}


def cost_of_condensed(folder, n):
    """The same of a quasi-static body that two ranks condense; its set-up is what they take."""
    made, found = folder / f"condensed_{n}_made.json", folder / f"condensed_{n}.json"
    if not found.exists():
        mesh, scene = write_scene(folder, "quasi_static", n)
        kept = folder / f"condensed_{n}"
        if not made.exists():
            ranks = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "2"]
            subprocess.run([*ranks, MPI_BUILD, "condense", scene, "--out", kept, "--report", made],
                           check=True, stdout=subprocess.DEVNULL)
        subprocess.run([SERVER, "explain", scene, "--condensed", kept, "--json", found, "--steps", "20"], check=True,
                       stdout=subprocess.DEVNULL)
        mesh.unlink()
    told = json.loads(found.read_text(encoding="utf-8"))
    stages = json.loads(made.read_text(encoding="utf-8"))["stages_ms"]
    return {"model": "condensed", "tetrahedra": tetrahedra_of(n), "step_ms_p50": told["contact"]["step_ms"]["p50"],
            "setup_ms": sum(stages.values()), "bytes": told["bytes"]}


def sphere_on_layer(depth):
    """Force (N) that presses a ball by depth (m) into the layer: Sneddon (1965) for the half-space, times what
    Dimitriadis et al. (2002, Biophys. J. 82:2798) found for a bonded layer."""
    low, high = 0.0, BALL * (1 - 1e-12)
    for _ in range(200):  # depth = a / 2 ln((R + a) / (R - a)) grows with the radius a of the contact
        a = (low + high) / 2
        low, high = (a, high) if a / 2 * math.log((BALL + a) / (BALL - a)) < depth else (low, a)
    half_space = MODULUS / (1 - POISSON**2) * ((a * a + BALL * BALL) / 2 * math.log((BALL + a) / (BALL - a)) - a * BALL)
    alpha = -(1.2876 - 1.4678 * POISSON + 1.3442 * POISSON**2) / (1 - POISSON)
    beta = (0.6387 - 1.0277 * POISSON + 1.5164 * POISSON**2) / (1 - POISSON)
    chi, pi = math.sqrt(BALL * depth) / LAYER, math.pi
    return half_space * (1 - 2 * alpha / pi * chi + 4 * alpha**2 / pi**2 * chi**2
                         - 8 / pi**3 * (alpha**3 + 4 * pi**2 / 15 * beta) * chi**3
                         + 16 * alpha / pi**4 * (alpha**3 + 3 * pi**2 / 5 * beta) * chi**4)


def against_closed_form(folder):
    """By how much (%) the reference's force on the block is above (below: negative) the closed form, on average over
    the steps in which it is pressed by 0.1 to 0.2 radii."""
    off = []
    with open(folder / "reference.csv", encoding="utf-8", newline="") as lines:
        for row in csv.DictReader(lines):
            depth = BALL - float(row["y_m"])  # the top is y = 0
            if 0.1 * BALL <= depth <= SHALLOW * BALL:
                force = sphere_on_layer(depth)
                off.append(100 * (float(row["fy_n"]) - force) / force)
    return sum(off) / len(off) if off else None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, help="folder; made if it is not there")
    parser.add_argument("--quick", action="store_true", help="one scene, coarse reference, meshes to 10 thousand")
    parser.add_argument("--million", action="store_true", help="a condensed block of a million tetrahedra besides")
    options = parser.parse_args()
    rows = []
    options.out.mkdir(parents=True, exist_ok=True)
    coarse = options.out / "block_coarse.msh"
    if not options.quick:
        subprocess.run([ROOT / "scripts/meshes/make_block", "--fine", str(BLOCK_EDGE), "-o", coarse], check=True)
    for name in QUICK if options.quick else SCENES:
        say(name)
        folder = options.out / name
        run("study", ROOT / "configs" / "scenes" / f"{name}.toml", "--out", folder, "--budget-ms", 33,
            *(["--quick"] if options.quick else []), *(["--mesh", coarse] if name.startswith("block") else []))
        if name == "block":
            found = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
            found["reference"]["closed_form_percent"] = against_closed_form(folder)
            (folder / "summary.json").write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
        rows += json.loads((folder / "summary.json").read_text(encoding="utf-8"))["rows"]
    costs = options.out / "cost" / hashlib.sha256(SERVER.read_bytes() + (SCENE + CUTTING).encode()).hexdigest()[:16]
    costs.mkdir(parents=True, exist_ok=True)
    found = []
    for model, n in [(model, n) for model in MODELS for n in (SIZES[:2] if options.quick else SIZES)]:
        say(f"{model} of {tetrahedra_of(n)} tetrahedra")
        found.append(cost_of(costs, model, n))
    if options.million:
        say(f"a condensed body of {tetrahedra_of(MILLION)} tetrahedra, 6 minutes")
        found.append(cost_of_condensed(costs, MILLION))
    (options.out / "cost.json").write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    (options.out / "scenes.json").write_text(json.dumps(QUICK if options.quick else SCENES) + "\n", encoding="utf-8")
    (options.out / "summary.json").write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    return 0


sys.exit(main())
