#!/usr/bin/env python3
"""Blender's EEVEE as a contender: its shadow maps, as the ratio of a render with shadow over one without.

Needs `blender` (Debian's 3.4.1) in PATH, or where $BLENDER says, and OpenGL through EGL (libegl1, and libgl1-mesa-dri
where no graphics card is: Mesa then draws on the processor). No display and no X server: EGL without a surface does.

EEVEE draws each light a depth map of cube faces, a sun one of cascades, once for each of `samples` pictures of which it
takes the mean; with soft shadows the map is turned by up to a texel and moved over the light from one to the next.
One light a render. A scene's unit is a metre, on which EEVEE's near planes, biases and smallest lights depend.

What is its own, and shows in the answers:
- A light has at least a radius of 1 mm, a sun the angle of 1 mm at 1 m; they have no hard edges with soft shadows.
- The picture with shadow is the light's analytic irradiance times the share of samples that the point sees, which are
  spread evenly over a rectangle or disk: the ratio is a share of area, but for lights partly below the horizon of the
  point, where the part below counts as not there (S too large); round bodies show it beside their terminators.
- A light with a radius is a ball with samples in it: the penumbra of a sphere has another profile.
- Blockers nearer to a lamp than `clip_start` cast no shadow.

Traps, each silent, besides those of blender_scene.py:
- EEVEE moves pictures over the pixel by the width of its filter; 0 keeps the points at the pixel's centre.
- Above 0, light_threshold cuts far lights off, at a distance that depends on their power. It is 0.
- EEVEE ignores an object's visibility for cameras and shadows; materials say it.
- The camera's depth has 24 bits, and the cascades of a sun follow its near plane and end with its far plane: both are
  Blender's defaults, 0.1 and 100, and are moved only where something seen lies beyond, unless `fit` is on.
- Without EGL Blender aborts in the first render; `hello` looks first.
"""
import ctypes
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))  # Blender does not
for name in 'DISPLAY', 'WAYLAND_DISPLAY':  # a dead one is worse than none
    os.environ.pop(name, None)
import blender_scene as shared  # first: starts Blender
import bpy
import gpu
import numpy as np

SIZES = '64|128|256|512|1024|2048|4096'


def parameter(name, kind, default, doc, **more):
    return {'name': name, 'type': kind, 'default': default, 'doc': doc, 'phase': 'visibility', **more}


def look_for_egl():
    try:
        egl = ctypes.CDLL('libEGL.so.1')
    except OSError:
        raise RuntimeError('no EGL, so no OpenGL without a display: install libegl1 and libgl1-mesa-dri')
    egl.eglGetProcAddress.restype = ctypes.c_void_p
    get = egl.eglGetProcAddress(b'eglGetPlatformDisplayEXT')
    get = get and ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_uint, ctypes.c_void_p, ctypes.c_void_p)(get)
    display = get and get(0x31DD, None, None)  # EGL_PLATFORM_SURFACELESS_MESA
    if not display or not egl.eglInitialize(ctypes.c_void_p(display), None, None):
        raise RuntimeError('EGL starts no OpenGL without a display: install libegl-mesa0 and libgl1-mesa-dri')


class Eevee(shared.Contender):
    said = {'name': 'EEVEE', 'version': bpy.app.version_string, 'measure': 'area', 'takes': 'raster',
            'lights': ['directional', 'point', 'spot', 'rectangle', 'disk', 'sphere'],
            'parameters': [
                parameter('cube_size', 'choice', '512', 'texels along a face of the map of a lamp', choices=SIZES,
                          sweep='256|512|1024|2048'),
                parameter('cascade_size', 'choice', '1024', 'texels along each of the four maps of a sun', choices=SIZES,
                          sweep='512|1024|2048|4096'),
                parameter('high_bitdepth', 'boolean', False, 'maps of 24 bits in place of 16'),
                parameter('soft_shadows', 'boolean', True, 'move and turn the map with each sample; else one map from the centre'),
                parameter('samples', 'integer', 64, 'pictures of which the mean is taken, each with maps of its own',
                          min=1, max=4096, sweep='1|16|64|256'),
                parameter('bias', 'real', 1.0, "times 5 cm towards a lamp, or 0.00002 of a sun's depth; polygons are offset besides",
                          min=0, max=100, sweep='0|1|10'),
                parameter('clip_start', 'real', 0.05, 'near plane of the map of a lamp', min=1e-6, max=1000),
                parameter('fit', 'boolean', False, "the camera's near and far planes, and so a sun's maps, end with what it sees",
                          phase='look'),
                parameter('contact_shadows', 'boolean', False, 'march 20 cm through the depth of the picture, too')]}

    def prepare(self, scene):
        look_for_egl()
        scene.render.engine = 'BLENDER_EEVEE'
        scene.render.filter_size = 0
        e = scene.eevee
        e.light_threshold = 0
        e.use_gtao = e.use_bloom = e.use_ssr = e.use_motion_blur = e.use_overscan = False
        self.materials = {(True, True): shared.white_material('white')[0]}
        for blocks, seen in (False, True), (True, False):
            material, diffuse = shared.white_material('white')
            if blocks:  # transparent to all but shadow rays
                nodes, link = material.node_tree.nodes, material.node_tree.links.new
                mix = nodes.new('ShaderNodeMixShader')
                link(nodes.new('ShaderNodeLightPath').outputs['Is Shadow Ray'], mix.inputs[0])
                link(nodes.new('ShaderNodeBsdfTransparent').outputs[0], mix.inputs[1])
                link(diffuse.outputs[0], mix.inputs[2])
                link(mix.outputs[0], nodes['Material Output'].inputs[0])
                material.blend_method = 'CLIP'
            material.shadow_method = 'CLIP' if blocks else 'NONE'
            self.materials[blocks, seen] = material
        self.warm_up(scene)
        self.said['summary'] = f"Blender's shadow maps: a render with shadow over one without. OpenGL: {gpu.platform.renderer_get()}."

    def warm_up(self, scene):
        """A render that compiles the shaders, which belongs to no question."""
        self.size, self.corners, self.positions, self.camera = (8, 8), np.eye(3)[None], None, {'eye': [3, 3, 3], 'target': [0, 0, 0]}
        for blocks, seen in self.materials:
            self.add(self.corners, blocks, seen)
        self.place_camera()
        self.aim({'description': {'type': 'point', 'position': [4, 2, 2]}})
        self.lamps[0].hide_render = False
        scene.eevee.taa_render_samples = 2
        scene.render.resolution_x, scene.render.resolution_y = self.size
        self.render()

    def add(self, corners, blocks, seen):
        shared.mesh_object('triangles', corners, self.materials[blocks, seen])

    def clip(self, camera, settings):
        near, far = 0.1, 100
        if self.positions is not None and self.surface.any():
            pose = np.array(camera.matrix_world)
            depth = (pose[:3, 3] - self.positions[self.surface]) @ pose[:3, 2]
            if settings.get('fit', False):
                near, far = depth.max(), 0
            near, far = max(1e-6, min(near, 0.9 * depth.min())), max(far, 1.1 * depth.max())
        self.far = far
        return near, far

    def set_render(self, scene, data, shadow, settings):
        e = scene.eevee
        e.shadow_cube_size, e.shadow_cascade_size = settings.get('cube_size', '512'), settings.get('cascade_size', '1024')
        e.use_shadow_high_bitdepth = settings.get('high_bitdepth', False)
        e.use_soft_shadows = settings.get('soft_shadows', True)
        e.taa_render_samples = settings.get('samples', 64) if shadow else 1  # without shadow they are all the same
        if data.type == 'SUN':
            data.shadow_cascade_max_distance = max(200, self.far)
        data.use_shadow, data.use_contact_shadow = shadow, settings.get('contact_shadows', False)
        data.shadow_buffer_bias, data.shadow_buffer_clip_start = settings.get('bias', 1.0), settings.get('clip_start', 0.05)


shared.run(Eevee())
