#!/usr/bin/env python3
"""Draws the tools that come with haptolith, as OBJ files in millimetres.

    python3 tools/draw/draw_tools.py [FOLDER]      default: the folder above this file

z is up, x is where the hand pushes to, and what is to be held is at the origin. Each tool is a union of closed parts:
haptolith takes what lies in any of them as solid.
"""

import math
import pathlib
import sys


class Drawing:
    """Closed parts, each with points of its own; triangles counter-clockwise seen from outside."""

    def __init__(self, title):
        self.title = title
        self.points = []
        self.faces = []

    def part(self, points, faces):
        first = len(self.points) + 1
        self.points += points
        self.faces += [[first + i for i in face] for face in faces]

    def prism(self, outline, low, high):
        """An outline of (x, z), counter-clockwise seen from -y, drawn from y = low to y = high."""
        n = len(outline)
        front = [(x, low, z) for x, z in outline]
        back = [(x, high, z) for x, z in outline]
        sides = [[(i + 1) % n, i, n + i, n + (i + 1) % n] for i in range(n)]
        self.part(front + back, [list(range(n)), list(range(2 * n - 1, n - 1, -1))] + sides)

    def box(self, low, high):
        (x0, y0, z0), (x1, y1, z1) = low, high
        self.prism([(x0, z0), (x1, z0), (x1, z1), (x0, z1)], y0, y1)

    def upright(self, outline, low, high):
        """An outline of (x, y), counter-clockwise seen from above, drawn from z = low to z = high."""
        n = len(outline)
        bottom = [(x, y, low) for x, y in outline]
        top = [(x, y, high) for x, y in outline]
        sides = [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
        self.part(bottom + top, [list(range(n - 1, -1, -1)), list(range(n, 2 * n))] + sides)

    def turned(self, outline, segments):
        """What a closed outline of (radius, z) sweeps around z, counter-clockwise as drawn to the right of the axis."""
        n = len(outline)
        points = []
        for k in range(segments):
            angle = 2 * math.pi * k / segments
            points += [(r * math.cos(angle), r * math.sin(angle), z) for r, z in outline]
        faces = []
        for k in range(segments):
            a, b = k * n, (k + 1) % segments * n
            for i in range(n):
                j = (i + 1) % n
                corners = [a + i] + ([b + i] if outline[i][0] > 0 else [])
                corners += [b + j] + ([a + j] if outline[j][0] > 0 else [])
                faces += [corners] if len(corners) > 2 else []
        self.part(points, faces)

    def text(self):
        lines = [f"# {self.title}, in mm. Drawn by tools/draw/draw_tools.py."]
        lines += ["v " + " ".join(f"{x:.4f}".rstrip("0").rstrip(".") for x in point) for point in self.points]
        for face in self.faces:
            lines += [f"f {face[0]} {face[i]} {face[i + 1]}" for i in range(1, len(face) - 1)]
        return "\n".join(lines) + "\n"


def wall(points, thickness):
    """Quadrilaterals along a line of (x, z), `thickness` to its right; they meet in the corners."""
    normals = []
    for (x0, z0), (x1, z1) in zip(points, points[1:]):
        length = math.hypot(x1 - x0, z1 - z0)
        normals.append(((z1 - z0) / length, -(x1 - x0) / length))
    offset = []
    for i, (x, z) in enumerate(points):
        beside = normals[max(i - 1, 0):i + 1]
        nx, nz = (sum(n[k] for n in beside) / len(beside) for k in (0, 1))
        scale = thickness / (nx * nx + nz * nz)
        offset.append((x + nx * scale, z + nz * scale))
    return [[points[i], offset[i], offset[i + 1], points[i + 1]] for i in range(len(points) - 1)]


def scoop():
    """A flat scoop of sheet metal: 1.5 mm, open in front."""
    tool = Drawing("A scoop with sides, 60 x 45 x 22 mm")
    thick, half, width = 1.5, 30, 22.5
    floor = -11
    tool.box((-half, -width, floor), (half, width, floor + thick))
    tool.box((-half, -width, floor), (-half + thick, width, floor + 22))
    side = [(-half, floor), (half, floor), (half, floor + 5), (-half + 12, floor + 22), (-half, floor + 22)]
    tool.prism(side, -width, -width + thick)
    tool.prism(side, width - thick, width)
    return tool


def bucket():
    """An excavator's bucket: a bent plate of 2 mm between two sides, with four teeth."""
    tool = Drawing("A bucket with teeth, 60 x 50 x 46 mm")
    thick, width = 2, 25
    bend = [(30, -22), (4, -22)]
    for step in range(1, 7):  # a quarter of a circle of 22 mm, up to the back
        angle = math.pi / 2 * step / 6
        bend.append((4 - 22 * math.sin(angle), -22 * math.cos(angle)))
    bend.append((-18, 22))
    for quad in wall(bend, thick):
        tool.prism(quad if area(quad) > 0 else quad[::-1], -width, width)
    side = [(30, -22), (30, -14), (-6, 22), (-18, 22)] + bend[-2:0:-1]
    tool.prism(side, -width, -width + thick)
    tool.prism(side, width - thick, width)
    for middle in (-19.5, -6.5, 6.5, 19.5):
        tool.prism([(24, -22), (40, -22), (40, -21), (24, -18)], middle - 2.5, middle + 2.5)
    return tool


def area(outline):
    return sum(x0 * z1 - x1 * z0 for (x0, z0), (x1, z1) in zip(outline, outline[1:] + outline[:1])) / 2


def rake():
    """Five round-nosed tines under a bar."""
    tool = Drawing("A rake with five tines, 64 x 46 mm")
    tool.box((-4, -32, 8), (4, 32, 16))
    for middle in (-28, -14, 0, 14, 28):
        tool.prism([(-2.5, -26), (0, -30), (2.5, -26), (2.5, 10), (-2.5, 10)], middle - 2, middle + 2)
    return tool


def corer():
    """A tube with a sharpened edge below, open at both ends."""
    tool = Drawing("A corer, 40 mm across and 70 mm long")
    tool.turned([(18.5, -33), (18.7, -35), (19.2, -35), (20, -31), (20, 35), (18.5, 35)], 48)
    return tool


def auger():
    """A flight of 2 mm around a shaft, with a pitch of 24 mm: turned clockwise from above, it lifts soil."""
    tool = Drawing("An auger, 40 mm across and 80 mm long")
    tool.turned([(0, -44), (5, -38), (5, 40), (0, 40)], 24)
    steps, pitch, thick = 72, 24, 2
    points = []
    for k in range(steps + 1):
        z = -37 + 72 * k / steps
        angle = 2 * math.pi * (z + 37) / pitch  # a right-handed screw, as drills are
        for radius in (3, 20):
            for dz in (0, thick):
                points.append((radius * math.cos(angle), radius * math.sin(angle), z + dz))
    faces = [[0, 2, 3, 1]]
    for k in range(steps):
        a, b = 4 * k, 4 * k + 4
        for i, j in ((0, 2), (2, 3), (3, 1), (1, 0)):
            faces.append([a + i, b + i, b + j, a + j])
    end = 4 * steps
    faces.append([end, end + 1, end + 3, end + 2])
    tool.part(points, faces)
    return tool


def round_z(points, angle):
    """Points of (x, y), turned about the origin."""
    c, s = math.cos(angle), math.sin(angle)
    return [(c * x - s * y, s * x + c * y) for x, y in points]


def wheel():
    """A wheel with twelve grousers of 5 mm; its axle is z."""
    tool = Drawing("A wheel with 12 grousers, 80 mm across and 36 mm wide")
    tool.turned([(0, -18), (35, -18), (35, 18), (0, 18)], 72)
    for k in range(12):
        tool.upright(round_z([(33, -1.25), (40, -1.25), (40, 1.25), (33, 1.25)], math.pi * k / 6), -18, 18)
    return tool


def bucket_drum():
    """A drum with three mouths in its rim, each under a lip; its shaft is z. Turned counter-clockwise from above, it digs."""
    tool = Drawing("A bucket drum with three scoops, 80 mm across and 44 mm wide")
    outer, thick, half, steps = 34, 2, 22, 10
    tool.turned([(0, -half), (outer, -half), (outer, -half + thick), (0, -half + thick)], 60)
    tool.turned([(0, half - thick), (outer, half - thick), (outer, half), (0, half)], 60)
    tool.turned([(0, -half), (5, -half), (5, half), (0, half)], 24)
    arc = math.radians(90)  # rim between two mouths
    for k in range(3):
        begin = 2 * math.pi * k / 3
        for i in range(steps):
            a, b = begin + arc * i / steps, begin + arc * (i + 1) / steps
            tool.upright([((outer - thick) * math.cos(a), (outer - thick) * math.sin(a)),
                          (outer * math.cos(a), outer * math.sin(a)), (outer * math.cos(b), outer * math.sin(b)),
                          ((outer - thick) * math.cos(b), (outer - thick) * math.sin(b))], -half, half)
        lip = round_z([(outer - thick, 0), (outer, 0), (outer + 5, 10), (outer + 3, 10)], begin + arc)  # over the mouth
        tool.upright(lip, -half, half)
    return tool


def volume(drawing):
    """In mm3; parts that overlap count twice."""
    total = 0
    for face in drawing.faces:
        a = drawing.points[face[0] - 1]
        for i in range(1, len(face) - 1):
            b, c = drawing.points[face[i] - 1], drawing.points[face[i + 1] - 1]
            total += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2])
                      + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6
    return total


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent
    for name, draw in (("auger", auger), ("bucket", bucket), ("bucket-drum", bucket_drum), ("corer", corer),
                       ("rake", rake), ("scoop", scoop), ("wheel", wheel)):
        drawing = draw()
        (folder / f"{name}.obj").write_text(drawing.text())
        print(f"{name}: {len(drawing.points)} points, {volume(drawing):.0f} mm3")


if __name__ == "__main__":
    main()
