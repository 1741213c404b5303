"""What the adapters that drive Blender share: its start, the scene, the lights, a render read back.

Importing this with any Python starts Blender (`blender` in PATH, or where $BLENDER says; Debian's 3.4.1 was tried) with
the importing script as its own; inside Blender the import returns. `Contender` has what does not depend on the engine.

Traps, each silent:
- Persistent data keeps the shadows of the render before: the ratio is 1 wherever the light shines. It stays off.
- Area lights shine to one side. Where points lie at both, two renders serve them.
- A spot shines in its cone alone, which does not matter for S_j: a spot is a point light, turned as the spot is.
- Blender writes to stdout: the protocol has descriptors of its own.
"""
import json
import os
import shutil
import sys
import time
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
                        os.path.abspath(sys.modules['__main__'].__file__), '--', str(ends[0]), str(ends[1])])

import bpy
import numpy as np
from mathutils import Matrix, Vector
from protocol import serve


def configure(scene):
    scene.world = None
    scene.view_settings.view_transform = 'Raw'
    scene.render.resolution_percentage = 100
    scene.render.use_persistent_data = scene.render.use_compositing = scene.render.use_sequencer = False
    scene.render.image_settings.file_format = 'OPEN_EXR'
    scene.render.image_settings.color_depth = '32'
    scene.render.image_settings.exr_codec = 'NONE'


def white_material(name):
    """A white diffuse surface; the node of its BSDF is returned, too."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.remove(nodes['Principled BSDF'])
    diffuse = nodes.new('ShaderNodeBsdfDiffuse')
    diffuse.inputs['Color'].default_value = 1, 1, 1, 1
    material.node_tree.links.new(diffuse.outputs[0], nodes['Material Output'].inputs[0])
    return material, diffuse


def mesh_object(name, corners, material):
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
    mesh.materials.append(material)
    made = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(made)
    return made


def axes(x, y, z, at):
    return Matrix([[*row] for row in zip(x, y, z, at)] + [[0, 0, 0, 1]])


def along(direction, at):
    """A pose that looks along `direction`, as lights do along their -z."""
    return Matrix.Translation(at) @ Vector(direction).to_track_quat('-Z', 'Y').to_matrix().to_4x4()


class Contender:
    """The engine sets `said`, the answer to hello, and has the methods that raise NotImplementedError here."""
    lamps = []
    ms = 0  # spent in renders

    def prepare(self, scene):
        """Settings that never change, materials."""
        raise NotImplementedError

    def add(self, corners, blocks, seen):
        """An object of the triangles that take light or not, that the camera sees or not."""
        raise NotImplementedError

    def clip(self, camera, settings):
        """Near and far distance of the camera, before the points are known (self.positions is None) or after."""
        raise NotImplementedError

    def set_light(self, data):
        """What else the engine wants of a light, whose type and size are set."""

    def set_render(self, scene, data, shadow, settings):
        """Settings of one render."""
        raise NotImplementedError

    def hello(self, message):
        self.folder = message['folder']
        for item in list(bpy.data.objects):
            bpy.data.objects.remove(item)
        configure(bpy.context.scene)
        self.prepare(bpy.context.scene)
        return self.said

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
        self.lamps, self.positions = [], None
        for blocks, seen in (True, True), (True, False), (False, True):
            which = (self.blocks == blocks) & (self.seen == seen)
            if which.any():
                self.add(self.corners[which], blocks, seen)
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
        camera = bpy.data.objects.new('camera', data)
        bpy.context.scene.collection.objects.link(camera)
        camera.matrix_world = axes(right, right.cross(forward), -forward, eye)
        bpy.context.scene.camera = camera
        data.clip_start, data.clip_end = self.clip(camera, {})

    def points(self, message):
        self.size = message['raster']
        if not self.size:  # of no use before `visibility`
            return {}
        p = self.load(message['points'])
        self.positions, self.surface = p['position'], p['triangle'] != 0xffffffff
        bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = self.size
        camera = bpy.context.scene.camera
        camera.data.clip_start, camera.data.clip_end = self.clip(camera, message['settings'])
        return {}

    def aim(self, message):
        of = {lamp.data for lamp in self.lamps}  # two lamps may share one
        for lamp in self.lamps:
            bpy.data.objects.remove(lamp)
        for data in of:
            bpy.data.lights.remove(data)
        self.lamps, light = [], message['description']
        kind = light['type']
        self.hard = kind in ('directional', 'point', 'spot')
        at, direction = Vector(light.get('position', [0, 0, 0])), Vector(light.get('direction', [0, -1, 0]))
        data = bpy.data.lights.new('light', {'directional': 'SUN', 'rectangle': 'AREA', 'disk': 'AREA'}.get(kind, 'POINT'))
        data.energy = 1000
        if kind == 'directional':
            data.angle = 0
        elif data.type == 'POINT':
            data.shadow_soft_size = light.get('radius', 0)
        poses = [along(direction, at)]
        if kind == 'disk':
            data.shape, data.size = 'DISK', 2 * light['radius']
            poses.append(along(-direction, at))
        if kind == 'rectangle':
            u, v = Vector(light['edge_u']), Vector(light['edge_v'])
            data.shape, data.size, data.size_y = 'RECTANGLE', u.length, v.length
            u, v = u.normalized(), v.normalized()
            poses = [axes(x, v, x.cross(v), at) for x in (-u, u)]  # lights along -z
        self.set_light(data)
        for pose in poses:
            lamp = bpy.data.objects.new('light', data)
            lamp.matrix_world = pose
            bpy.context.scene.collection.objects.link(lamp)
            lamp.hide_render = True
            self.lamps.append(lamp)
        return {}

    def render(self):
        file = os.path.join(self.folder, 'blender.exr')
        bpy.context.scene.render.filepath = file
        begin = time.perf_counter()
        bpy.ops.render.render(write_still=True)
        self.ms += 1000 * (time.perf_counter() - begin)
        image = bpy.data.images.load(file)
        image.colorspace_settings.name = 'Raw'
        pixels = np.empty(4 * self.size[0] * self.size[1], np.float32)
        image.pixels.foreach_get(pixels)
        bpy.data.images.remove(image)
        os.remove(file)
        return pixels.reshape(self.size[1], self.size[0], 4)[::-1, :, :3].astype(float)

    def visibility(self, message):
        if not self.size:
            raise ValueError('only whole pictures are rendered, not points without a raster')
        asked = self.load(message['asked']).reshape(self.size[1], self.size[0]) != 0
        s = np.full(asked.shape, np.nan)
        self.ms = 0
        for lamp in self.lamps:
            here = asked
            if len(self.lamps) == 2:  # in front of this side
                at, back = (np.array(lamp.matrix_world.col[k][:3]) for k in (3, 2))
                here = asked & ((self.positions - at) @ back < 0).reshape(asked.shape)
            if not here.any():
                continue
            lamp.hide_render = False
            pictures = []
            for shadow in False, True:
                self.set_render(bpy.context.scene, lamp.data, shadow, message['settings'])
                pictures.append(self.render().mean(2))
            lamp.hide_render = True
            open_, shadowed = pictures
            with np.errstate(invalid='ignore', divide='ignore'):
                s[here] = np.where(open_ > 0, np.clip(shadowed / open_, 0, 1), np.nan)[here]
        np.save(os.path.join(self.folder, message['answers']), s)
        return {'ms': self.ms}


def run(contender):
    """Serves until the end, and then ends Blender."""
    first, second = (int(end) for end in sys.argv[sys.argv.index('--') + 1:][:2])
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # thousands of lines of progress; what fails is said on stderr
    try:
        serve(contender, open(first, encoding='utf-8'), open(second, 'w', encoding='utf-8'))
    except BaseException:
        traceback.print_exc()
        os._exit(1)
    os._exit(0)  # not through Blender's own end
