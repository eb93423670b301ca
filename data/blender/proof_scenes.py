# SPDX-License-Identifier: Apache-2.0
"""Twenty scenes of many kinds, on which the prior of data/prior is tested once it is trained.

Built from the primitives of scenes.py and independently of the generator in data/prior, which
never sees them. Deterministic. World z up, metres."""
import random
from math import cos, exp, inf, pi, sin

import bmesh

from scenes import (BLUE, CREAM, DARK_GREEN, GREEN, ORANGE, PURPLE, RED, SAND, SLATE, TEAL, WHITE,
                    YELLOW, Scene, box, cylinder, disc, icosphere, monkey, put, sphere, torus)

GREY, WOOD, BRICK = (0.4, 0.4, 0.4), (0.42, 0.28, 0.16), (0.45, 0.22, 0.16)
COLOURS = (CREAM, ORANGE, RED, BLUE, GREEN, YELLOW, TEAL, PURPLE, WHITE, GREY)


def ground(albedo=SAND):
    put("ground", disc(300), albedo, (0, 0), longest_edge=inf)


def block(low, high, albedo, turn=0.0):
    size = [b - a for a, b in zip(low, high)]
    middle = [(a + b) / 2 for a, b in zip(low, high)]
    put("block", box(), albedo, middle[:2], on=low[2], turn=(0, 0, turn), size=size,
        longest_edge=2.0)


def post(at, height, radius, albedo, on=0.0):
    return put("post", cylinder(segments=32), albedo, at, on=on,
               size=(2 * radius, 2 * radius, height), smooth=False, longest_edge=2.0)


def ball(at, diameter, albedo, on=0.0):
    return put("ball", sphere(), albedo, at, on=on, size=diameter, smooth=True, longest_edge=inf)


def walls(x, y, height, albedo, gap=None, thick=0.15):
    """Four walls around 0..x, 0..y; gap: (wall n, e, s or w, from, to, sill, lintel)"""
    for side in "nesw":
        length = x if side in "ns" else y
        spans = [(0, length, 0, height)]
        for wall, a, b, sill, lintel in gap or ():
            if wall == side:
                spans = [(0, a, 0, height), (b, length, 0, height), (a, b, 0, sill),
                         (a, b, lintel, height)]
        for a, b, low, high in spans:
            if b - a < 1e-3 or high - low < 1e-3:
                continue
            if side in "ns":
                at = y if side == "n" else -thick
                block((a, at, low), (b, at + thick, high), albedo)
            else:
                at = x if side == "e" else -thick
                block((at, a, low), (at + thick, b, high), albedo)


def slab(x, y, at, albedo, thick=0.15, over=0.15):
    block((-over, -over, at), (x + over, y + over, at + thick), albedo)


def table(at, size, height, albedo, on=0.0):
    (x, y), (w, d) = at, size
    block((x - w / 2, y - d / 2, on + height - 0.04), (x + w / 2, y + d / 2, on + height), albedo)
    for a in (-1, 1):
        for b in (-1, 1):
            post((x + a * (w / 2 - 0.05), y + b * (d / 2 - 0.05)), height - 0.04, 0.025, albedo, on)
    return on + height


def figure(at, albedo, height=1.75, on=0.0):
    x, y = at
    for side in (-0.1, 0.1):
        put("leg", cylinder(segments=24), SLATE, (x + side, y), on=on,
            size=(0.16, 0.16, 0.48 * height), longest_edge=inf)
    put("torso", icosphere(4), albedo, at, on=on + 0.42 * height,
        size=(0.46, 0.28, 0.46 * height), smooth=True, longest_edge=inf)
    for side in (-0.27, 0.27):
        put("arm", cylinder(segments=16), albedo, (x + side, y), on=on + 0.42 * height,
            turn=(0, -12 if side < 0 else 12, 0), size=(0.1, 0.1, 0.38 * height), longest_edge=inf)
    put("head", icosphere(4), CREAM, at, on=on + 0.86 * height, size=0.14 * height, smooth=True,
        longest_edge=inf)


def leaves(rng, count, where, size, albedo):
    """Flat leaves in random attitudes; where() -> centre"""
    mesh = bmesh.new()
    for _ in range(count):
        x, y, z = where()
        a, b, s = rng.uniform(0, 2 * pi), rng.uniform(-1.2, 1.2), size * rng.uniform(0.5, 1)
        along = (cos(a) * cos(b), sin(a) * cos(b), sin(b))
        side = (-sin(a) * 0.35, cos(a) * 0.35, 0)
        corners = [(-1, 0), (0, -1), (1, 0), (0, 1)]
        mesh.faces.new([mesh.verts.new((x + s * (u * along[0] + v * side[0]),
                                        y + s * (u * along[1] + v * side[1]),
                                        z + s * u * along[2])) for u, v in corners])
    lowest = min(v.co.z for v in mesh.verts)
    put("leaves", mesh, albedo, (0, 0), on=lowest, longest_edge=inf)


def tree(rng, at, height, albedo=DARK_GREEN):
    x, y = at
    post(at, 0.5 * height, 0.03 * height, WOOD)

    def where():
        d, f, t = rng.random() ** 0.33 * 0.28 * height, rng.uniform(0, 2 * pi), rng.uniform(-1, 1)
        q = (1 - t * t) ** 0.5
        return x + d * q * cos(f), y + d * q * sin(f), 0.68 * height + d * t
    leaves(rng, 500, where, 0.06 * height, albedo)


def land(z, half, cells, albedo):
    mesh = bmesh.new()
    at = [half * (2 * i / cells - 1) for i in range(cells + 1)]
    rows = [[mesh.verts.new((x, y, z(x, y))) for x in at] for y in at]
    for a, b in zip(rows, rows[1:]):
        for i in range(cells):
            mesh.faces.new((a[i], a[i + 1], b[i + 1], b[i]))
    put("land", mesh, albedo, (0, 0), on=min(v.co.z for r in rows for v in r), smooth=True,
        longest_edge=inf)


def bedroom():
    ground()
    slab(4.2, 3.6, -0.16, WOOD)
    walls(4.2, 3.6, 2.6, CREAM, [("w", 1.1, 2.5, 0.9, 2.2)])
    slab(4.2, 3.6, 2.6, WHITE)
    block((2.2, 1.6, 0), (4.15, 3.5, 0.45), BLUE)
    block((3.7, 1.7, 0.45), (4.1, 2.5, 0.6), WHITE)
    block((0.1, 3.0, 0), (1.5, 3.55, 2.1), WOOD)
    table((1.9, 3.2), (0.7, 0.5), 0.6, WOOD)
    ball((1.9, 3.2), 0.25, YELLOW, on=0.6)


def galley():
    ground()
    slab(2.2, 4.5, -0.16, GREY)
    walls(2.2, 4.5, 2.5, WHITE, [("n", 0.6, 1.6, 1.1, 2.1), ("s", 0.6, 1.5, 0, 2.05)])
    slab(2.2, 4.5, 2.5, WHITE)
    for x in (0, 1.6):
        block((x, 0.2, 0), (x + 0.6, 4.5, 0.9), TEAL)
        block((x + (0 if x == 0 else 0.25), 1, 1.5), (x + (0.35 if x == 0 else 0.6), 4.5, 2.2), TEAL)
    rng = random.Random(2)
    for i in range(9):
        post((0.3 + rng.uniform(-0.15, 0.15), 1 + 0.35 * i), rng.uniform(0.1, 0.35), 0.05,
             rng.choice(COLOURS), on=0.9)


def office():
    ground()
    slab(14, 9, -0.16, SLATE)
    walls(14, 9, 3, WHITE, [("n", 0.3, 13.7, 0.8, 2.7), ("w", 1, 8, 0.8, 2.7)])
    slab(14, 9, 3, WHITE)
    for x in (3.5, 7, 10.5):
        block((x - 0.2, 4.3, 0), (x + 0.2, 4.7, 3), WHITE)
        for y in (2.2, 6.8):
            top = table((x, y), (1.6, 0.8), 0.74, WOOD)
            block((x - 0.3, y - 0.05, top), (x + 0.3, y, top + 0.4), SLATE)
            block((x - 0.25, y - 1.1, 0), (x + 0.25, y - 0.6, 0.48), BLUE)


def passage():
    ground()
    slab(2, 12, -0.16, GREY)
    walls(2, 12, 2.8, CREAM, [("n", 0.3, 1.7, 0, 2.3), ("e", 5, 6.4, 0, 2.2)])
    slab(2, 12, 2.8, WHITE)
    for y in (2.5, 8):
        block((0, y, 0), (0.12, y + 0.9, 2.1), WOOD)
    block((1.5, 8.5, 0), (1.95, 9.6, 0.8), RED)


def alley():
    ground(GREY)
    block((-5, -6, 0), (-1.4, 30, 9), BRICK)
    block((1.5, -8, 0), (6, 12, 7), SAND)
    block((1.8, 13, 0), (7, 32, 11), CREAM)
    for y in range(0, 28, 4):
        block((-1.4, y, 2.5), (-1.25, y + 1.2, 4), SLATE)
    post((-1.3, 2), 8, 0.06, GREY)
    for i, (x, y) in enumerate(((1, 3), (0.9, 4.2), (-1, 6), (1.1, 8))):
        block((x - 0.4, y - 0.4, 0), (x + 0.4, y + 0.4, 0.7 + 0.2 * i), COLOURS[i])
    for i in range(5):
        block((-1.4, 9 + 0.3 * i, 0), (-0.5, 9.3 + 0.3 * i, 0.2 * (i + 1)), GREY)


def avenue():
    ground(SLATE)
    rng = random.Random(6)
    for side in (-1, 1):
        for k in range(7):
            h = rng.uniform(6, 16)
            x0, x1 = sorted((side * 12, side * 22))
            block((x0, 12 * k - 20, 0), (x1, 12 * k - 9, h), rng.choice((CREAM, BRICK, SAND, GREY)))
        for k in range(5):
            tree(rng, (side * 9, 9 * k - 4), 5.5)
    for x, y in ((-5, 4), (-5, 12), (5, 8)):
        block((x - 0.9, y - 2.1, 0.25), (x + 0.9, y + 2.1, 0.9), rng.choice(COLOURS))
        block((x - 0.75, y - 1.2, 0.9), (x + 0.75, y + 0.9, 1.45), SLATE)
    figure((2, 3), RED)


def flats():
    ground(GREY)
    block((-3, -2, 0), (3, 3, 0.1), WOOD)
    block((-3, 3, 0), (3, 3.08, 3), TEAL)
    block((-3.08, -0.5, 0), (-3, 3.08, 3), CREAM)
    block((-1.2, 1.8, 0.1), (1.2, 2.7, 0.55), RED)
    block((-1.2, 2.5, 0.55), (1.2, 2.75, 1), RED)
    top = table((0.1, 0.7), (1.1, 0.6), 0.45, WOOD, on=0.1)
    ball((0.2, 0.7), 0.22, WHITE, on=top)
    post((-2.3, 2.4), 1.6, 0.03, SLATE, on=0.1)
    put("shade", cylinder(top=0.3), WHITE, (-2.3, 2.4), on=1.55, size=(0.5, 0.5, 0.35))
    figure((1.9, 1.2), BLUE, on=0.1)


def puppets():
    ground()
    top = table((0, 0), (1.6, 1), 0.75, WOOD)
    block((-0.5, -0.3, top), (0.5, 0.3, top + 0.02), CREAM)
    block((-0.52, -0.3, top), (-0.5, 0.32, top + 0.7), RED)
    block((0.5, -0.3, top), (0.52, 0.32, top + 0.7), GREEN)
    block((-0.5, 0.3, top), (0.5, 0.32, top + 0.7), CREAM)
    block((-0.52, -0.3, top + 0.7), (0.52, 0.32, top + 0.72), CREAM)
    put("suzanne", monkey(), ORANGE, (-0.18, 0.05), on=top + 0.02, size=0.22, smooth=True)
    block((0.1, -0.02, top + 0.02), (0.3, 0.16, top + 0.4), WHITE, turn=20)
    ball((0.02, -0.17), 0.1, BLUE, on=top + 0.02)


def shop():
    ground(GREY)
    block((-4, 0.3, 0), (-1.4, 4, 4), BRICK)
    block((1.4, 0.3, 0), (4, 4, 4), BRICK)
    block((-1.4, 2, 0), (1.4, 4, 4), CREAM)
    block((-1.4, 0.3, 2.6), (1.4, 2, 4), BRICK)
    block((-1.4, 0.35, 0), (1.4, 2, 0.5), WOOD)
    rng = random.Random(9)
    for k, z in enumerate((0.5, 1.2)):
        if k:
            block((-1.35, 1.3, z - 0.04), (1.35, 2, z), WOOD)
        for i in range(6):
            x = -1.1 + 0.44 * i
            put("ware", rng.choice((sphere, box, cylinder))(), rng.choice(COLOURS),
                (x, 1.6 if k else rng.uniform(0.7, 1.2)), on=z,
                size=(0.3, 0.3, rng.uniform(0.2, 0.45)), longest_edge=inf)


def breakfast():
    ground(DARK_GREEN)
    top = table((0, 0), (1.3, 0.9), 0.74, WOOD)
    for x, y in ((-0.3, -0.15), (0.35, 0.1)):
        put("plate", cylinder(), WHITE, (x, y), on=top, size=(0.26, 0.26, 0.015))
        put("roll", icosphere(4), ORANGE, (x, y), on=top + 0.015, size=(0.13, 0.1, 0.07),
            smooth=True)
        put("cup", cylinder(top=0.4), BLUE, (x + 0.2, y + 0.08), on=top, turn=(180, 0, 0),
            size=(0.09, 0.09, 0.1))
    post((0, 0.2), 0.26, 0.05, CREAM, on=top)
    put("ring", torus(0.12), YELLOW, (0.02, -0.2), on=top, size=0.16, smooth=True)
    for i in range(4):
        ball((-0.05 + 0.07 * (i % 2), 0.02 + 0.07 * (i // 2)), 0.07, RED, on=top)
    block((-0.25, 0.7, 0), (0.25, 1.15, 0.45), WOOD)


def sweep():
    mesh = bmesh.new()
    line = [(-3, 0), (0.6, 0)] + [(0.6 + 0.6 * sin(a), 0.6 - 0.6 * cos(a))
                                  for a in (pi / 2 * i / 16 for i in range(1, 17))] + [(1.2, 2.4)]
    rows = [[mesh.verts.new((x, y, z)) for x in (-1.6, 1.6)] for y, z in line]
    for a, b in zip(rows, rows[1:]):
        mesh.faces.new((a[0], a[1], b[1], b[0]))
    put("sweep", mesh, WHITE, (0, 0), longest_edge=0.5)
    post((0, -0.2), 0.12, 0.35, CREAM)
    post((-0.08, -0.2), 0.3, 0.05, TEAL, on=0.12)
    post((-0.08, -0.2), 0.1, 0.02, SLATE, on=0.42)
    put("box", box(), ORANGE, (0.12, -0.14), on=0.12, turn=(0, 0, 30), size=(0.14, 0.1, 0.2))


def urn():
    ground(GREY)
    top = put("foot", cylinder(top=0.3), CREAM, (0, 0), size=(0.7, 0.7, 0.25))
    top = put("body", icosphere(5), CREAM, (0, 0), on=top - 0.03, size=(0.9, 0.9, 1), smooth=True)
    put("rim", torus(0.1), CREAM, (0, 0), on=top - 0.06, size=(0.5, 0.5, 0.4), smooth=True)


def chess():
    ground(WOOD)
    block((-1, -1, 0), (1, 1, 0.06), CREAM)
    rng = random.Random(13)
    for _ in range(16):
        at = (0.25 * rng.randint(-4, 3) + 0.125, 0.25 * rng.randint(-4, 3) + 0.125)
        colour, h = rng.choice((SLATE, WHITE)), rng.uniform(0.18, 0.36)
        put("foot", cylinder(top=0.25), colour, at, on=0.06, size=(0.19, 0.19, h))
        ball(at, 0.12, colour, on=0.04 + h)


def boulders():
    def z(x, y):
        return 1.2 * sin(0.31 * x + 1) * cos(0.23 * y) + 0.35 * sin(0.9 * x) * sin(1.1 * y + 2)
    land(z, 30, 200, SAND)
    rng = random.Random(14)
    for _ in range(60):
        x, y, s = rng.uniform(-14, 14), rng.uniform(-6, 22), 0.3 * exp(rng.uniform(0, 1.9))
        put("rock", icosphere(2), GREY, (x, y), on=z(x, y) - 0.35 * s,
            turn=[rng.uniform(0, 360) for _ in range(3)],
            size=(s, s * rng.uniform(0.6, 1), s * rng.uniform(0.5, 0.9)), longest_edge=inf)


def dunes():
    def z(x, y):
        return 2.5 * abs(sin(0.09 * x + 0.04 * y + 0.7 * sin(0.05 * y))) ** 1.6
    land(z, 90, 260, SAND)
    figure((3, 18), RED, on=z(3, 18))
    figure((4.2, 19), BLUE, on=z(4.2, 19))


def blades():
    ground(WOOD)
    rng = random.Random(16)
    mesh = bmesh.new()
    for _ in range(5000):
        x, y, a = rng.uniform(-1.6, 1.6), rng.uniform(-1.2, 2.4), rng.uniform(0, 2 * pi)
        h, w = rng.uniform(0.08, 0.3), 0.006
        dx, dy = h * 0.4 * cos(a), h * 0.4 * sin(a)
        mesh.faces.new([mesh.verts.new(p) for p in
                        ((x - w * sin(a), y + w * cos(a), 0), (x + w * sin(a), y - w * cos(a), 0),
                         (x + dx, y + dy, h))])
    put("grass", mesh, GREEN, (0, 0), longest_edge=inf)
    put("suzanne", monkey(), ORANGE, (0.1, 0.3), size=0.35, smooth=True)


def thicket():
    ground(DARK_GREEN)
    rng = random.Random(17)
    for x, y, h in ((-1.5, 2, 3.2), (0.3, 3.2, 4.4), (1.9, 2.2, 2.8), (3.4, 4, 5), (-3.3, 4, 4)):
        tree(rng, (x, y), h, GREEN)
    leaves(rng, 1500, lambda: (rng.gauss(0, 1.5), rng.gauss(1.8, 0.6), rng.uniform(0.03, 0.7)),
           0.08, DARK_GREEN)


def ruin():
    ground()
    for low, high in (((-4, 2, 0), (1, 2.5, 0.9)), ((2.2, 2, 0), (4, 2.5, 1.4)),
                      ((-4, -3, 0), (-3.5, 2, 0.5)), ((0, 5, 0), (5, 5.4, 0.6))):
        block(low, high, CREAM)
    for i, h in enumerate((2.6, 0.7, 1.3, 2.9)):
        post((-2.5 + 1.9 * i, 0.3), h, 0.22, CREAM)
    put("drum", cylinder(), CREAM, (-0.6, -1.2), turn=(90, 0, 35), size=(0.44, 0.44, 0.9),
        longest_edge=inf)
    block((1.2, -1.4, 0), (1.9, -0.9, 0.35), CREAM, turn=25)


def deck():
    ground(SLATE)
    slab(20, 14, 2.8, GREY, thick=0.3, over=1)
    for x in range(0, 21, 5):
        for y in (0, 7, 14):
            block((x - 0.2, y - 0.2, 0), (x + 0.2, y + 0.2, 2.8), GREY)
    block((0, 14.2, 0), (20, 14.4, 2.8), CREAM)
    for x, y, c in ((4, 10.5, RED), (8, 10.5, BLUE), (15, 10.5, WHITE)):
        block((x - 0.9, y - 2.1, 0.25), (x + 0.9, y + 2.1, 0.9), c)
        block((x - 0.75, y - 1.2, 0.9), (x + 0.75, y + 0.9, 1.45), SLATE)


def square():
    ground(GREY)
    rng = random.Random(20)
    for _ in range(14):
        figure((rng.uniform(-6, 6), rng.uniform(1, 14)), rng.choice(COLOURS),
               height=rng.uniform(1.55, 1.9))
    for i in range(3):
        put("step", cylinder(), CREAM, (0, 8), on=0.18 * i, size=(6 - 1.4 * i, 6 - 1.4 * i, 0.18),
            longest_edge=1.0)
    post((0, 8), 2, 0.6, CREAM, on=0.54)
    put("suzanne", monkey(), TEAL, (0, 8), on=2.54, size=0.9, smooth=True)
    block((-4.5, 3, 0), (-2.5, 3.5, 0.45), WOOD)




def scene(build, camera, target, hfov_deg, ao_radii, environment="sky.exr"):
    return Scene(build, 320, 180, camera, target, hfov_deg, environment, ao_radii)


PROOF_SCENES = {
    "bedroom": scene(bedroom, (0.4, 0.4, 1.6), (3.2, 2.8, 0.7), 68, (0.3, 1.5)),
    "galley": scene(galley, (1.1, 0.35, 1.6), (1.0, 4, 1.0), 70, (0.25, 1)),
    "office": scene(office, (13.2, 0.6, 1.7), (3, 6.5, 0.9), 65, (0.5, 3), "studio.exr"),
    "passage": scene(passage, (1.3, 0.6, 1.6), (0.9, 9, 1.2), 62, (0.4, 1.5)),
    "alley": scene(alley, (0.3, -1.5, 1.7), (-0.1, 9, 1.6), 60, (0.6, 4)),
    "avenue": scene(avenue, (1.2, -6, 1.7), (-1, 15, 2.4), 70, (1, 8)),
    "flats": scene(flats, (2.2, -3.4, 1.6), (-0.5, 1.8, 0.9), 52, (0.4, 2), "studio.exr"),
    "puppets": scene(puppets, (0.12, -1.5, 1.25), (0, 0, 1.05), 42, (0.1, 0.4), "studio.exr"),
    "shop": scene(shop, (-0.6, -2.6, 1.5), (0.1, 1, 1.2), 58, (0.3, 1.5)),
    "breakfast": scene(breakfast, (0.5, -1.1, 1.35), (0, 0.05, 0.75), 46, (0.06, 0.3)),
    "sweep": scene(sweep, (0.4, -2.1, 0.7), (0, -0.1, 0.25), 34, (0.1, 0.5), "studio.exr"),
    "urn": scene(urn, (1.8, -2.7, 1.1), (0, 0, 0.6), 40, (0.2, 1)),
    "chess": scene(chess, (0.9, -1.9, 1.1), (0, -0.1, 0.1), 45, (0.1, 0.5), "studio.exr"),
    "boulders": scene(boulders, (0, -9, 2.4), (0.5, 6, 0.2), 62, (0.5, 3)),
    "dunes": scene(dunes, (0, 2, 3.4), (4, 30, 0.6), 60, (1, 6)),
    "blades": scene(blades, (0.5, -1.6, 0.6), (0.05, 0.3, 0.12), 50, (0.06, 0.3)),
    "thicket": scene(thicket, (0.4, -2.6, 1.3), (0.2, 2.5, 1.2), 60, (0.2, 1), "studio.exr"),
    "ruin": scene(ruin, (-1.8, -5.2, 1.7), (0.3, 1, 0.5), 62, (0.4, 2)),
    "deck": scene(deck, (1.5, 1.2, 1.6), (13, 12, 1.2), 66, (0.6, 4), "studio.exr"),
    "square": scene(square, (2.5, -3.5, 1.65), (-0.6, 8, 1.1), 58, (0.4, 3)),
}
