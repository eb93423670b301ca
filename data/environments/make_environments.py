# SPDX-License-Identifier: Apache-2.0
"""Writes sky.exr and studio.exr beside this file: lat-long maps, scene-linear Rec.709, half float.

    blender -b -P make_environments.py

World z is up. The map is Blender's: u = 0.5 - atan2(y, x) / 2 pi, v = acos(z) / pi from the top,
so that +X is the middle column and +Y a quarter from the left.
"""
from pathlib import Path

import bpy
import numpy as np

WIDTH, HEIGHT = 256, 128
SUBSAMPLES = 8  # per pixel and axis: a sun two pixels wide needs a clean edge

# Irradiance of the sun over that of the sky, both on level ground: dark shadows, never black ones.
SUN_TO_SKY = 3.0
SUN_RADIUS_DEG = 1.4  # two pixels across; the real sun, 0.27, would fall between the pixels
SUN_COLOR = np.array([1.0, 0.90, 0.74])


def direction(azimuth_deg, elevation_deg):
    """Unit vector; azimuth counter-clockwise from +X seen from above."""
    a, e = np.radians([azimuth_deg, elevation_deg])
    return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])


def pixel_directions(subsamples=1):
    """World directions of the (sub)pixel centres, rows from the top, [rows, columns, 3]."""
    u = (np.arange(WIDTH * subsamples) + 0.5) / (WIDTH * subsamples)
    v = (np.arange(HEIGHT * subsamples) + 0.5) / (HEIGHT * subsamples)
    azimuth, polar = np.meshgrid((0.5 - u) * 2 * np.pi, v * np.pi)
    return np.stack([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth),
                     np.cos(polar)], axis=-1)


def pixel_mean(fine):
    """Box filter from subpixels to pixels; weights by solid angle are constant enough here."""
    n = SUBSAMPLES
    return fine.reshape(HEIGHT, n, WIDTH, n, -1).mean(axis=(1, 3))


def smoothstep(low, high, x):
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def mix(a, b, t):
    return np.asarray(a) * (1.0 - t) + np.asarray(b) * t


def irradiance_on_level_ground(radiance):
    """E = integral of L cos(theta) over the upper hemisphere, per colour channel."""
    z = pixel_directions()[..., 2:]
    solid_angle = (2 * np.pi / WIDTH) * (np.pi / HEIGHT) * np.sqrt(1.0 - z * z)
    return np.sum(radiance * np.maximum(z, 0.0) * solid_angle, axis=(0, 1))


def sky():
    """Clear sky, bright at the horizon and around the sun; darker, warm ground below."""
    w = pixel_directions(SUBSAMPLES)
    z = w[..., 2:]
    sun = direction(215.0, 38.0)
    cos_sun = w @ sun[:, None]

    up = np.clip(z, 0.0, 1.0)
    dome = mix([0.50, 0.66, 0.84], [0.12, 0.25, 0.55], 1.0 - (1.0 - up) ** 3)
    dome = dome + np.array([0.55, 0.40, 0.20]) * np.exp(-up / 0.06)
    dome = dome + np.array([0.70, 0.55, 0.35]) * np.clip(cos_sun, 0.0, 1.0) ** 24
    ground = mix([0.26, 0.21, 0.16], [0.12, 0.09, 0.065], np.clip(-z / 0.5, 0.0, 1.0))
    background = pixel_mean(mix(ground, dome, smoothstep(-0.03, 0.0, z)))

    edge = np.cos(np.radians([SUN_RADIUS_DEG * 1.15, SUN_RADIUS_DEG * 0.85]))
    disc = pixel_mean(smoothstep(*edge, cos_sun)) * SUN_COLOR
    wanted = SUN_TO_SKY * irradiance_on_level_ground(background).mean()
    return background + disc * wanted / irradiance_on_level_ground(disc).mean()


def soft_box(w, center, width_deg, height_deg, edge_deg):
    """1 inside a rectangle of angles around `center`, falling smoothly to 0 across `edge_deg`."""
    right = np.cross([0.0, 0.0, 1.0], center)
    right /= np.linalg.norm(right)
    up = np.cross(center, right)
    forward = w @ center[:, None]
    x = np.degrees(np.arctan2(np.abs(w @ right[:, None]), forward))
    y = np.degrees(np.arctan2(np.abs(w @ up[:, None]), forward))
    inside = 1.0 - smoothstep(-edge_deg / 2, edge_deg / 2, x - width_deg / 2)
    return inside * (1.0 - smoothstep(-edge_deg / 2, edge_deg / 2, y - height_deg / 2))


def studio():
    """Dim warm-grey room with a large warm key, a cool fill and a narrow rim light."""
    w = pixel_directions(SUBSAMPLES)
    z = w[..., 2:]
    room = mix([0.10, 0.085, 0.07], [0.26, 0.245, 0.225], smoothstep(-0.9, 0.9, z))
    key = soft_box(w, direction(278.0, 44.0), 64.0, 44.0, 14.0) * np.array([4.2, 3.9, 3.4])
    fill = soft_box(w, direction(350.0, 28.0), 50.0, 50.0, 24.0) * np.array([0.70, 0.88, 1.15])
    rim = soft_box(w, direction(100.0, 48.0), 14.0, 70.0, 8.0) * np.array([2.6, 2.6, 2.7])
    return pixel_mean(room + key + fill + rim)


def write_exr(path, radiance):
    """Saves [rows from the top, columns, RGB] as half float, ZIP."""
    assert radiance.min() >= 0.0 and radiance.max() < 0.25 * 65504.0  # far from the end of half
    image = bpy.data.images.new(path.stem, WIDTH, HEIGHT, float_buffer=True)
    rgba = np.ones((HEIGHT, WIDTH, 4), dtype=np.float32)
    rgba[..., :3] = radiance[::-1]  # Blender counts rows from the bottom
    image.pixels.foreach_set(rgba.ravel())
    settings = bpy.context.scene.render.image_settings
    settings.file_format, settings.color_mode = "OPEN_EXR", "RGB"
    settings.color_depth, settings.exr_codec = "16", "ZIP"
    image.save_render(str(path), scene=bpy.context.scene)


for environment in (sky, studio):
    radiance = environment()
    # Exposure: open level ground of albedo a comes out as a.
    radiance *= np.pi / irradiance_on_level_ground(radiance).mean()
    write_exr(Path(__file__).resolve().parent / f"{environment.__name__}.exr", radiance)
