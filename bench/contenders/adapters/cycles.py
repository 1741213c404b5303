#!/usr/bin/env python3
"""Blender's Cycles as a contender: S_j is a render with shadow over the same render without, one light at a time.

Needs `blender` (Debian's 3.4.1) in PATH, or where $BLENDER says; no display. Run with any Python 3: it starts Blender
with itself as the script. Cycles' float positions and its pixels' centres are those of the program's raster.

Traps, each silent:
- Persistent data keeps the shadows of the render before: the ratio is 1 wherever the light shines. It stays off.
- The filter BOX ignores its width and spreads samples over the pixel; BLACKMAN_HARRIS 0.01 keeps them at the centre.
- Of several lights Cycles samples one a sample, and its light threshold drops samples of weak light at random: one
  light a render, threshold 0.
- Its area lights shine to one side. Where points lie at both, two renders serve them.
- A light with a radius is a disk through its centre that faces the point, not what the point sees of a sphere: the
  penumbra is too narrow by (radius / distance)^2 / 2.
- Blender writes to stdout: the protocol has descriptors of its own.
Outside the cone of a spot light, and where no sample of a light is in front of the point, 0 / 0 is undefined.
"""
import json
import os
import shutil
import sys
import traceback

if 'bpy' not in sys.modules:
    ends = os.dup(0), os.dup(1)
    for end in ends:
        os.set_inheritable(end, True)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)
    blender = os.environ.get('BLENDER') or shutil.which('blender')
    if not blender:
        sys.exit('blender: not in PATH')
    os.environ['PATH'] = '/usr/bin:' + os.environ['PATH']  # Debian's Blender takes the numpy of the first Python there
    os.execvp(blender, [blender, '--background', '--factory-startup', '--python-exit-code', '1', '--python',
                        os.path.abspath(__file__), '--', str(ends[0]), str(ends[1])])

import bpy
import numpy as np
from mathutils import Matrix, Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))  # Blender does not
from protocol import serve

HELLO = {'name': 'Cycles', 'version': bpy.app.version_string, 'measure': 'irradiance', 'takes': 'raster',
         'seed': 'seed', 'lights': ['directional', 'point', 'spot', 'rectangle', 'disk', 'sphere'],
         'summary': "Blender's path tracer without bounces: a render with shadow over one without.",
         'parameters': [
             {'name': 'samples', 'type': 'integer', 'default': 16, 'min': 1, 'max': 4096, 'phase': 'visibility',
              'sweep': '4|16|64', 'doc': 'samples a pixel of area lights; other lights have 1'},
             {'name': 'seed', 'type': 'integer', 'default': 1, 'min': 0, 'max': 1000000, 'phase': 'visibility',
              'doc': 'of its samples'}]}


def configure(scene):
    scene.render.engine = 'CYCLES'
    scene.world = None
    scene.view_settings.view_transform = 'Raw'
    scene.render.resolution_percentage = 100
    scene.render.use_persistent_data = scene.render.use_compositing = scene.render.use_sequencer = False
    scene.render.image_settings.file_format = 'OPEN_EXR'
    scene.render.image_settings.color_depth = '32'
    scene.render.image_settings.exr_codec = 'NONE'
    c = scene.cycles
    c.device = 'CPU'
    c.pixel_filter_type, c.filter_width = 'BLACKMAN_HARRIS', 0.01
    c.max_bounces = c.diffuse_bounces = c.glossy_bounces = c.transmission_bounces = c.transparent_max_bounces = 0
    c.sample_clamp_direct = c.sample_clamp_indirect = c.light_sampling_threshold = 0
    c.use_adaptive_sampling = c.use_denoising = False


def mesh_object(name, corners):
    n = len(corners)
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(3 * n)
    mesh.vertices.foreach_set('co', corners.astype(np.float32).ravel())
    mesh.loops.add(3 * n)
    mesh.loops.foreach_set('vertex_index', np.arange(3 * n, dtype=np.int32))
    mesh.polygons.add(n)
    mesh.polygons.foreach_set('loop_start', np.arange(0, 3 * n, 3, dtype=np.int32))
    mesh.polygons.foreach_set('loop_total', np.full(n, 3, np.int32))
    mesh.update(calc_edges=True)
    mesh.materials.append(bpy.data.materials['white'])
    made = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(made)
    made.cycles.shadow_terminator_offset = made.cycles.shadow_terminator_geometry_offset = 0
    return made


def axes(x, y, z, at):
    return Matrix([[*row] for row in zip(x, y, z, at)] + [[0, 0, 0, 1]])


def along(direction, at):
    """A pose that looks along `direction`, as lights do along their -z."""
    return Matrix.Translation(at) @ Vector(direction).to_track_quat('-Z', 'Y').to_matrix().to_4x4()


class Contender:
    lamps = []

    def hello(self, message):
        self.folder = message['folder']
        for item in list(bpy.data.objects):
            bpy.data.objects.remove(item)
        white = bpy.data.materials.new('white')
        white.use_nodes = True
        nodes = white.node_tree.nodes
        nodes.remove(nodes['Principled BSDF'])
        diffuse = nodes.new('ShaderNodeBsdfDiffuse')
        diffuse.inputs['Color'].default_value = 1, 1, 1, 1
        white.node_tree.links.new(diffuse.outputs[0], nodes['Material Output'].inputs[0])
        configure(bpy.context.scene)
        return HELLO

    def load(self, file):
        return np.load(os.path.join(self.folder, file))

    def scene(self, message):
        with open(os.path.join(self.folder, message['scene']), encoding='utf-8') as file:
            native = json.load(file)
        self.camera = native['camera']
        self.corners, self.blocks = self.load(message['triangles']), self.load(message['blocks']) != 0
        seen = np.array([o.get('seen_by_camera', True) for o in native['objects']], bool)
        self.seen = seen[self.load(message['objects'])] if len(seen) else np.zeros(0, bool)
        return {}

    def build(self, message):
        for item in list(bpy.data.objects):
            bpy.data.objects.remove(item)
        for mesh in list(bpy.data.meshes):
            bpy.data.meshes.remove(mesh)
        self.lamps = []
        for blocks, seen in (True, True), (True, False), (False, True):
            which = (self.blocks == blocks) & (self.seen == seen)
            if which.any():
                made = mesh_object('triangles', self.corners[which])
                made.visible_shadow, made.visible_camera = blocks, seen
        self.place_camera()
        return {}

    def place_camera(self):
        """As the native format describes it; the frame is that of the program."""
        eye, target, up = (Vector(self.camera.get(k, [0, 1, 0])) for k in ('eye', 'target', 'up'))
        forward = (target - eye).normalized()
        right = forward.cross(up)
        if right.length_squared < 1e-20 * up.length_squared:
            right = forward.cross(Vector((0, 0, 1) if abs(forward.z) < 0.9 else (1, 0, 0)))
        right.normalize()
        data = bpy.data.cameras.new('camera')
        data.sensor_fit = 'VERTICAL'
        if 'height' in self.camera:
            data.type, data.ortho_scale = 'ORTHO', self.camera['height']
        else:
            full = 2 * np.tan(np.radians(self.camera.get('fov', 45)) / 2)
            data.lens = max(1, 1 / full)  # neither may be below 1
            data.sensor_height = full * data.lens
        far = np.abs(self.corners - np.array(eye)).max() if len(self.corners) else 1
        data.clip_start, data.clip_end = max(1e-6, 1e-6 * far), 4 * far
        camera = bpy.data.objects.new('camera', data)
        bpy.context.scene.collection.objects.link(camera)
        camera.matrix_world = axes(right, right.cross(forward), -forward, eye)
        bpy.context.scene.camera = camera

    def points(self, message):
        self.size = message['raster']
        if not self.size:
            raise ValueError('only whole pictures are rendered, not points without a raster')
        self.positions = self.load(message['points'])['position']
        bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = self.size
        return {}

    def aim(self, message):
        of = {lamp.data for lamp in self.lamps}  # two lamps may share one
        for lamp in self.lamps:
            bpy.data.objects.remove(lamp)
        for data in of:
            bpy.data.lights.remove(data)
        self.lamps, light = [], message['description']
        if light.get('fixed_to') == 'camera':
            raise ValueError('the light is fixed to the camera')
        kind = light['type']
        self.hard = kind in ('directional', 'point', 'spot')
        at, direction = Vector(light.get('position', [0, 0, 0])), Vector(light.get('direction', [0, -1, 0]))
        data = bpy.data.lights.new('light', {'directional': 'SUN', 'point': 'POINT', 'spot': 'SPOT',
                                             'sphere': 'POINT'}.get(kind, 'AREA'))
        data.energy = 1000
        data.cycles.use_multiple_importance_sampling = False
        if kind == 'directional':
            data.angle = 0
        elif kind in ('point', 'spot', 'sphere'):
            data.shadow_soft_size = light.get('radius', 0)
        if kind == 'spot':
            data.spot_size, data.spot_blend = 2 * np.radians(light.get('cutoff', 45)), 0
        poses = [along(direction, at)]
        if kind == 'disk':
            data.shape, data.size = 'DISK', 2 * light['radius']
            poses.append(along(-direction, at))
        if kind == 'rectangle':
            u, v = Vector(light['edge_u']), Vector(light['edge_v'])
            data.shape, data.size, data.size_y = 'RECTANGLE', u.length, v.length
            u, v = u.normalized(), v.normalized()
            poses = [axes(x, v, x.cross(v), at) for x in (-u, u)]  # lights along -z
        for pose in poses:
            lamp = bpy.data.objects.new('light', data)
            lamp.matrix_world = pose
            bpy.context.scene.collection.objects.link(lamp)
            lamp.hide_render = True
            self.lamps.append(lamp)
        return {}

    def render(self, shadow):
        self.lamps[0].data.cycles.cast_shadow = shadow
        file = os.path.join(self.folder, 'cycles.exr')
        bpy.context.scene.render.filepath = file
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(file)
        image.colorspace_settings.name = 'Raw'
        pixels = np.empty(4 * self.size[0] * self.size[1], np.float32)
        image.pixels.foreach_get(pixels)
        bpy.data.images.remove(image)
        os.remove(file)
        return pixels.reshape(self.size[1], self.size[0], 4)[::-1, :, :3].mean(2, dtype=float)

    def visibility(self, message):
        settings = message['settings']
        bpy.context.scene.cycles.samples = 1 if self.hard else settings.get('samples', 16)
        bpy.context.scene.cycles.seed = settings.get('seed', 1)
        asked = self.load(message['asked']).reshape(self.size[1], self.size[0]) != 0
        s = np.full(asked.shape, np.nan)
        for lamp in self.lamps:
            here = asked
            if len(self.lamps) == 2:  # in front of this side
                at, back = (np.array(lamp.matrix_world.col[k][:3]) for k in (3, 2))
                here = asked & ((self.positions - at) @ back < 0).reshape(asked.shape)
            if not here.any():
                continue
            lamp.hide_render = False
            open_, shadowed = self.render(False), self.render(True)
            lamp.hide_render = True
            with np.errstate(invalid='ignore', divide='ignore'):
                s[here] = np.where(open_ > 0, np.clip(shadowed / open_, 0, 1), np.nan)[here]
        np.save(os.path.join(self.folder, message['answers']), s)
        return {}


first, second = (int(end) for end in sys.argv[sys.argv.index('--') + 1:][:2])
os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # thousands of lines of progress; what fails is said on stderr
try:
    serve(Contender(), open(first, encoding='utf-8'), open(second, 'w', encoding='utf-8'))
except BaseException:
    traceback.print_exc()
    os._exit(1)
os._exit(0)  # not through Blender's own end
