#!/usr/bin/env python3
"""Writes the visual meshes of longarm_one as binary STL [m].  Needs nothing but Python 3.

Run in this folder:  python3 make_meshes.py
Every body is closed, counter-clockwise from outside, and stands in the frame of its link.
"""

import math
import os
import struct

from make_robot import FOREARM, MAST_X, ROLL_AT, SHOULDER, UPPER

ROUND = 24  # Sides of what is round.


def rotated(triangles, turn):
    """Triangles with each point p replaced by turn(p); turn must keep orientation."""
    return [tuple(turn(p) for p in t) for t in triangles]


def moved(triangles, dx=0.0, dy=0.0, dz=0.0):
    return rotated(triangles, lambda p: (p[0] + dx, p[1] + dy, p[2] + dz))


def z_to_y(p):
    return (p[1], p[2], p[0])


def z_to_x(p):
    return (p[2], p[0], p[1])


def quad(a, b, c, d):
    return [(a, b, c), (a, c, d)]


def loft(loops, closed_ends=True):
    """Skin between loops of equally many points, each counter-clockwise seen from the next one's side."""
    out = []
    for lower, upper in zip(loops, loops[1:]):
        n = len(lower)
        for i in range(n):
            j = (i + 1) % n
            out += quad(lower[i], lower[j], upper[j], upper[i])
    if closed_ends:
        first, last = loops[0], loops[-1]
        out += [(first[0], first[i + 1], first[i]) for i in range(1, len(first) - 1)]
        out += [(last[0], last[i], last[i + 1]) for i in range(1, len(last) - 1)]
    return out


def lathe(profile, sides=ROUND, phase=0.0):
    """Body of revolution about z; profile: (radius, z) from bottom to top, radius > 0."""
    angles = [phase + 2 * math.pi * i / sides for i in range(sides)]
    return loft([[(r * math.cos(a), r * math.sin(a), z) for a in angles] for r, z in profile])


def prism(outline, half, chamfer=0.0):
    """Convex outline (x, y), counter-clockwise, from z = -half to half, its edges cut by `chamfer`."""
    cx = sum(p[0] for p in outline) / len(outline)
    cy = sum(p[1] for p in outline) / len(outline)
    size = max(math.hypot(p[0] - cx, p[1] - cy) for p in outline)
    k = 1 - chamfer / size
    small = [(cx + k * (x - cx), cy + k * (y - cy)) for x, y in outline]
    at = lambda loop, z: [(x, y, z) for x, y in loop]
    if chamfer == 0:
        return loft([at(outline, -half), at(outline, half)])
    return loft([at(small, -half), at(outline, chamfer - half), at(outline, half - chamfer), at(small, half)])


def rectangle(x, y, corner):
    """Rectangle of full size x, y with its corners cut."""
    a, b, c = x / 2, y / 2, corner
    return [(a, c - b), (a, b - c), (a - c, b), (c - a, b), (-a, b - c), (-a, c - b), (c - a, -b), (a - c, -b)]


def xz_prism(outline, half, chamfer=0.0):
    """Convex outline in (x, z), extruded along y."""
    return rotated(prism(outline, half, chamfer),
                   lambda p: (p[0], -p[2], p[1]))


def barrel(radius, half, chamfer=0.006):
    """Cylinder along y."""
    profile = [(radius - chamfer, -half), (radius, chamfer - half), (radius, half - chamfer), (radius - chamfer, half)]
    return rotated(lathe(profile), z_to_y)


def hull():
    side = [(-0.31, 0.1), (-0.26, 0.055), (0.2, 0.055), (0.31, 0.14), (0.31, 0.22), (-0.31, 0.22)]
    return xz_prism(side, 0.148, 0.01)


def deck():
    plate = moved(prism(rectangle(0.62, 0.5, 0.05), 0.015, 0.005), dz=0.235)
    box = moved(prism(rectangle(0.13, 0.2, 0.02), 0.045, 0.01), dx=MAST_X + 0.005, dz=0.295)
    return plate + box


def stadium(radius, half_length, steps):
    """Points and outward normals around two half circles joined by straights, in (x, z)."""
    points = []
    for centre, start in ((half_length, -0.5), (-half_length, 0.5)):
        for i in range(steps + 1):
            a = math.pi * (start + i / steps)
            points.append((centre + radius * math.cos(a), radius * math.sin(a), math.cos(a), math.sin(a)))
        straight = 10
        sign = 1 if start < 0 else -1
        for i in range(1, straight):
            x = sign * half_length * (1 - 2 * i / straight)
            points.append((x, sign * radius, 0, sign))
    return points


def track():
    """A belt with cleats around the wheels; centre height 0.1, ends at +-0.36."""
    half, belt, cleat = 0.048, 0.014, 0.007
    outer, inner = [], []
    for i, (x, z, nx, nz) in enumerate(stadium(0.093, 0.26, 8)):
        bump = cleat if i % 2 == 0 else 0.0
        outer.append((x + nx * bump, z + nz * bump))
        inner.append((x - nx * belt, z - nz * belt))
    out = []
    n = len(outer)
    for i in range(n):
        j = (i + 1) % n
        a, b, c, d = outer[i], outer[j], inner[j], inner[i]
        at = lambda p, y: (p[0], y, p[1] + 0.1)
        out += quad(at(a, half), at(b, half), at(b, -half), at(a, -half))
        out += quad(at(d, -half), at(c, -half), at(c, half), at(d, half))
        out += quad(at(a, -half), at(b, -half), at(c, -half), at(d, -half))
        out += quad(at(b, half), at(a, half), at(d, half), at(c, half))
    return out


def track_wheels():
    out = []
    for x, r in ((-0.26, 0.075), (0.26, 0.075), (-0.13, 0.05), (0.0, 0.05), (0.13, 0.05)):
        z = 0.1 if r > 0.06 else 0.07
        out += moved(rotated(lathe([(r - 0.01, -0.044), (r, -0.036), (r, 0.036), (r - 0.01, 0.044)], 16), z_to_y),
                     dx=x, dz=z)
    return out


def mast():
    column = lathe([(0.05, 0.25), (0.05, 0.92), (0.044, 0.95)], 8, math.pi / 8)
    foot = lathe([(0.075, 0.25), (0.075, 0.345), (0.055, 0.37)], 8, math.pi / 8)
    return column + foot


def turret():
    body = lathe([(0.074, 0.0), (0.074, 0.035), (0.066, 0.06), (0.05, SHOULDER)])
    return body + moved(barrel(0.062, 0.074), dz=SHOULDER)


def upper_arm():
    tube = lathe([(0.035, -0.02), (0.054, 0.03), (0.057, 0.09), (0.047, 0.2), (0.045, UPPER - 0.16),
                  (0.054, UPPER - 0.06), (0.05, UPPER - 0.02), (0.035, UPPER + 0.01)])
    return tube + moved(barrel(0.056, 0.07), dz=UPPER)


def elbow():
    return lathe([(0.036, -0.02), (0.05, 0.03), (0.05, 0.12), (0.044, 0.2), (0.044, 0.24)])


def forearm():
    wrist_at = FOREARM - ROLL_AT
    tube = lathe([(0.044, 0.0), (0.044, 0.03), (0.037, 0.12), (0.034, wrist_at - 0.05), (0.026, wrist_at - 0.01)])
    return tube + moved(barrel(0.043, 0.047), dz=wrist_at)


def wrist():
    return lathe([(0.028, -0.03), (0.036, 0.0), (0.039, 0.04), (0.039, 0.07)])


def palm():
    body = moved(prism(rectangle(0.066, 0.146, 0.012), 0.027, 0.006), dz=0.061)
    rail = moved(prism(rectangle(0.03, 0.15, 0.004), 0.004), dz=0.0865)
    return body + rail


def camera_pod():
    return prism(rectangle(0.036, 0.056, 0.008), 0.021, 0.004)


def finger():
    side = [(0.004, 0.0), (0.016, 0.0), (0.016, 0.028), (0.011, 0.0775), (0.004, 0.0775)]  # (y, z)
    return rotated(prism(side, 0.0135, 0.001), z_to_x)


def head():
    body = rotated(prism(rectangle(0.35, 0.085, 0.025), 0.05, 0.01), z_to_x)
    hoods = []
    for y in (0.127, -0.127):
        hoods += moved(rotated(lathe([(0.034, 0.0), (0.036, 0.02), (0.032, 0.024)], 20), z_to_x), dx=0.045, dy=y, dz=0.02)
    return moved(body, dx=0.005, dz=0.02) + hoods


def ptz():
    profile = [(0.034, -0.06), (0.042, -0.05), (0.042, 0.05), (0.036, 0.066), (0.036, 0.074)]
    return rotated(lathe(profile), z_to_x)


def write_stl(path, triangles):
    with open(path, "wb") as file:
        file.write(b"longarm_one visual mesh, metres".ljust(80, b" "))
        file.write(struct.pack("<I", len(triangles)))
        for a, b, c in triangles:
            u = [b[i] - a[i] for i in range(3)]
            v = [c[i] - a[i] for i in range(3)]
            n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
            size = math.sqrt(sum(x * x for x in n)) or 1.0
            file.write(struct.pack("<12fH", *(x / size for x in n), *a, *b, *c, 0))


def volume(triangles):
    """Positive when the faces look outward."""
    return sum(a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]) for a, b, c in triangles) / 6


def main():
    os.makedirs("meshes", exist_ok=True)
    total = 0
    for make in (hull, deck, track, track_wheels, mast, turret, upper_arm, elbow, forearm, wrist, palm, camera_pod,
                 finger, head, ptz):
        triangles = make()
        if volume(triangles) < 0:
            raise SystemExit(make.__name__ + " is inside out")
        write_stl(os.path.join("meshes", make.__name__ + ".stl"), triangles)
        total += len(triangles)
        print(f"{make.__name__:14s} {len(triangles):5d} triangles, {1e6 * volume(triangles):10.1f} cm3")
    print(total)


if __name__ == "__main__":
    main()
