"""What the scripts share about tetrahedral meshes: gmsh files, small geometry."""

import math
from pathlib import Path
from typing import NamedTuple

TRIANGLE, TETRAHEDRON = 2, 4  # gmsh element types
TETRAHEDRON_FACES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))  # outward


class Mesh(NamedTuple):
    points: dict        # node tag -> (x, y, z)
    triangles: list     # three node tags each
    surfaces: list      # tag of the geometric surface each triangle lies on
    tetrahedra: list    # four node tags each


def read_msh(path):
    """Read an ASCII MSH 4.1 file."""
    sections, name = {}, None
    for line in Path(path).read_text().splitlines():
        if line.startswith("$End"):
            name = None
        elif line.startswith("$"):
            name = line[1:]
            sections[name] = []
        elif name:
            sections[name].append(line)
    if not sections.get("MeshFormat", [""])[0].startswith("4.1 0 "):
        raise ValueError(f"{path}: not an ASCII MSH 4.1 file")
    if not sections.keys() >= {"Nodes", "Elements"}:
        raise ValueError(f"{path}: no nodes or no elements")

    points, rows = {}, iter(sections["Nodes"])
    block_count = int(next(rows).split()[0])
    for _ in range(block_count):
        count = int(next(rows).split()[3])
        tags = [int(next(rows)) for _ in range(count)]
        points.update((tag, tuple(map(float, next(rows).split()))) for tag in tags)

    cells, surfaces, rows = {TRIANGLE: [], TETRAHEDRON: []}, [], iter(sections["Elements"])
    block_count = int(next(rows).split()[0])
    for _ in range(block_count):
        _, entity, kind, count = map(int, next(rows).split())
        block = [tuple(map(int, next(rows).split()[1:])) for _ in range(count)]
        if kind in cells:
            cells[kind] += block
        if kind == TRIANGLE:
            surfaces += [entity] * count
    return Mesh(points, cells[TRIANGLE], surfaces, cells[TETRAHEDRON])


def write_msh(path, points, tetrahedra):
    """Write an ASCII MSH 4.1 file of one body; nodes count from 1, m."""
    box = " ".join(f"{bound(axis):.9g}" for bound in (min, max) for axis in zip(*points))
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat",
             "$Entities", "0 0 0 1", f"1 {box} 0 0", "$EndEntities",
             "$Nodes", f"1 {len(points)} 1 {len(points)}", f"3 1 0 {len(points)}"]
    lines += map(str, range(1, len(points) + 1))
    lines += (f"{x:.9g} {y:.9g} {z:.9g}" for x, y, z in points)
    lines += ["$EndNodes", "$Elements", f"1 {len(tetrahedra)} 1 {len(tetrahedra)}",
              f"3 1 {TETRAHEDRON} {len(tetrahedra)}"]
    lines += (f"{tag} {a} {b} {c} {d}" for tag, (a, b, c, d) in enumerate(tetrahedra, 1))
    lines.append("$EndElements")
    Path(path).write_text("\n".join(lines) + "\n", encoding="ascii")


def skin_of(tetrahedra):
    """The faces that belong to one tetrahedron only, turned outward."""
    faces = {}
    for cell in tetrahedra:
        for corners in TETRAHEDRON_FACES:
            face = tuple(cell[i] for i in corners)
            key = frozenset(face)
            if faces.pop(key, None) is None:
                faces[key] = face
    return list(faces.values())


def plus(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def minus(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def times(factor, a):
    return (factor * a[0], factor * a[1], factor * a[2])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(dot(a, a))
    return times(1 / length, a) if length else a


def normal_of(a, b, c):
    return unit(cross(minus(b, a), minus(c, a)))


def nearest_on(triangle, p):
    """The point of the triangle nearest to p (Ericson, Real-Time Collision Detection)."""
    a, b, c = triangle
    ab, ac, ap, bp, cp = minus(b, a), minus(c, a), minus(p, a), minus(p, b), minus(p, c)
    d1, d2, d3, d4, d5, d6 = (dot(ab, ap), dot(ac, ap), dot(ab, bp), dot(ac, bp),
                              dot(ab, cp), dot(ac, cp))
    if d1 <= 0 and d2 <= 0:
        return a
    if d3 >= 0 and d4 <= d3:
        return b
    if d6 >= 0 and d5 <= d6:
        return c
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    if vc <= 0 <= d1 and d3 <= 0:
        return plus(a, times(d1 / (d1 - d3), ab))
    if vb <= 0 <= d2 and d6 <= 0:
        return plus(a, times(d2 / (d2 - d6), ac))
    if va <= 0 and d4 >= d3 and d5 >= d6:
        return plus(b, times((d4 - d3) / ((d4 - d3) + (d5 - d6)), minus(c, b)))
    return plus(a, plus(times(vb / (va + vb + vc), ab), times(vc / (va + vb + vc), ac)))
