#!/usr/bin/env python3
"""Blender's Cycles as a contender: S_j is a render with shadow over the same render without, one light at a time.

Needs `blender` (Debian's 3.4.1) in PATH, or where $BLENDER says; no display. Run with any Python 3: blender_scene.py
starts Blender with this file as the script. Cycles' float positions and its pixels' centres are those of the program's
raster.

Traps, each silent, besides those of blender_scene.py:
- The filter BOX ignores its width and spreads samples over the pixel; BLACKMAN_HARRIS 0.01 keeps them at the centre.
- Of several lights Cycles samples one a sample, and its light threshold drops samples of weak light at random: one
  light a render, threshold 0.
- A light with a radius is a disk through its centre that faces the point, not what the point sees of a sphere: the
  penumbra is too narrow by (radius / distance)^2 / 2.
Where no sample of a light is in front of the point, 0 / 0 is undefined.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))  # Blender does not
import blender_scene as shared  # first: starts Blender
import bpy
import numpy as np


class Cycles(shared.Contender):
    said = {'name': 'Cycles', 'version': bpy.app.version_string, 'measure': 'irradiance', 'takes': 'raster',
            'seed': 'seed', 'lights': ['directional', 'point', 'spot', 'rectangle', 'disk', 'sphere'],
            'summary': "Blender's path tracer without bounces: a render with shadow over one without.",
            'parameters': [
                {'name': 'samples', 'type': 'integer', 'default': 16, 'min': 1, 'max': 4096, 'phase': 'visibility',
                 'sweep': '4|16|64', 'doc': 'samples a pixel of area lights; other lights have 1'},
                {'name': 'seed', 'type': 'integer', 'default': 1, 'min': 0, 'max': 1000000, 'phase': 'visibility',
                 'doc': 'of its samples'}]}

    def prepare(self, scene):
        scene.render.engine = 'CYCLES'
        c = scene.cycles
        c.device = 'CPU'
        c.pixel_filter_type, c.filter_width = 'BLACKMAN_HARRIS', 0.01
        c.max_bounces = c.diffuse_bounces = c.glossy_bounces = c.transmission_bounces = c.transparent_max_bounces = 0
        c.sample_clamp_direct = c.sample_clamp_indirect = c.light_sampling_threshold = 0
        c.use_adaptive_sampling = c.use_denoising = False
        self.white = shared.white_material('white')[0]

    def add(self, corners, blocks, seen):
        made = shared.mesh_object('triangles', corners, self.white)
        made.cycles.shadow_terminator_offset = made.cycles.shadow_terminator_geometry_offset = 0
        made.visible_shadow, made.visible_camera = blocks, seen

    def clip(self, camera, settings):
        far = np.abs(self.corners - np.array(camera.matrix_world.translation)).max() if len(self.corners) else 1
        return max(1e-6, 1e-6 * far), 4 * far

    def set_light(self, data):
        data.cycles.use_multiple_importance_sampling = False

    def set_render(self, scene, data, shadow, settings):
        data.cycles.cast_shadow = shadow
        scene.cycles.samples = 1 if self.hard else settings.get('samples', 16)
        scene.cycles.seed = settings.get('seed', 1)


shared.run(Cycles())
