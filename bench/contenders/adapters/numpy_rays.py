#!/usr/bin/env python3
"""A contender in Python: segments from each point to samples of the light against all triangles, in NumPy.

Needs numpy (Debian: python3-numpy). There is no hierarchy: the time is points x samples x triangles, 30 to 60 ns each.
The test is that of Moeller and Trumbore (Fast, Minimum Storage Ray/Triangle Intersection, 1997), its triple products
taken apart so that all points meet all triangles in three products of matrices.

Traps: the point's own triangle and what the segment meets at its two ends do not occlude it; edges belong to the
triangles at both sides, or light leaks between them; a sphere light is the disk that the point sees of it; the part of
a light behind the point's plane is not seen, though the share is of the whole light.
"""
import os

import numpy as np
from protocol import serve

HELLO = {'name': 'NumPy', 'version': np.__version__, 'measure': 'area', 'takes': 'points', 'seed': 'seed',
         'lights': ['directional', 'point', 'spot', 'rectangle', 'disk', 'sphere'],
         'summary': 'Segments against all triangles, in double precision; stratified samples of area lights.',
         'parameters': [
             {'name': 'samples', 'type': 'integer', 'default': 4, 'min': 1, 'max': 64, 'phase': 'visibility',
              'sweep': '2|4|8', 'doc': 'samples along each side of an area light: 4 are 16 segments'},
             {'name': 'seed', 'type': 'integer', 'default': 1, 'min': 0, 'max': 1000000, 'phase': 'visibility',
              'doc': 'of the place of each sample in its stratum'}]}
END, EDGE, TESTS = 1e-9, 1e-12, 1 << 20  # of a segment; of a triangle; at once (8 MiB an array)
HARD = 'directional', 'point', 'spot'


class Contender:
    def hello(self, message):
        self.folder = message['folder']
        return HELLO

    def load(self, file):
        return np.load(os.path.join(self.folder, file))

    def scene(self, message):
        self.corners = self.load(message['triangles']).astype(float)
        self.blocks = self.load(message['blocks']) != 0
        return {}

    def build(self, message):
        kept = self.corners[self.blocks]
        self.centre = kept.reshape(-1, 3).mean(0) if len(kept) else np.zeros(3)  # numbers around 0 round least
        self.reach = np.ptp(self.corners, axis=(0, 1)).max() if len(self.corners) else 1
        a, b, c = (kept - self.centre).transpose(1, 0, 2)
        e, f = b - a, c - a
        normal = np.cross(e, f)
        self.det = normal.T                                # times d: the determinant
        self.u = np.hstack([f, -np.cross(a, f)]).T         # times (d x o, d): u times the determinant
        self.v = np.hstack([-e, np.cross(a, e)]).T
        self.t = np.hstack([-normal, np.sum(a * normal, 1, keepdims=True)]).T  # times (o, 1)
        self.own = np.append(np.where(self.blocks, np.cumsum(self.blocks) - 1, -1), -1)  # by triangle of the scene
        return {}

    def points(self, message):
        p = self.load(message['points'])
        self.p, self.n = p['position'] - self.centre, p['normal'].astype(float)
        self.own_of = self.own[np.minimum(p['triangle'], len(self.own) - 1)]
        return {}

    def aim(self, message):
        self.light = light = message['description']
        self.at = np.array(light.get('position', [0, 0, 0]), float) - self.centre
        return {}

    def targets(self, p, sample):
        """Where the segments from p end, for samples of the unit square."""
        kind, light, (x, y) = self.light['type'], self.light, sample
        if kind == 'directional':
            d = np.array(light['direction'], float)
            return p - d * (self.reach / np.linalg.norm(d))
        if kind in HARD:
            return np.broadcast_to(self.at, p.shape)
        if kind == 'rectangle':
            return self.at + (x - 0.5) * np.array(light['edge_u'], float) + (y - 0.5) * np.array(light['edge_v'], float)
        at, radius = self.at, light['radius']
        axis = np.array(light['direction'] if kind == 'disk' else [0, 0, 0], float) + np.zeros_like(p)
        if kind == 'sphere':  # its disk is where the cone of tangents touches it
            axis = at - p
            d = np.linalg.norm(axis, axis=1, keepdims=True)
            with np.errstate(invalid='ignore', divide='ignore'):  # NaN inside of the sphere: undefined
                at, radius = at - axis * (radius / d) ** 2, radius * np.sqrt(1 - (radius / d) ** 2)
        axis = axis / np.linalg.norm(axis, axis=1, keepdims=True)
        s = np.cross(axis, np.where(np.abs(axis[:, :1]) < 0.6, [[1, 0, 0]], [[0, 1, 0]]))
        s /= np.linalg.norm(s, axis=1, keepdims=True)
        t = np.cross(axis, s)
        r, angle = radius * np.sqrt(x), 2 * np.pi * y
        return at + r * (np.cos(angle) * s + np.sin(angle) * t)

    def hit(self, p, target, own):
        d, last = target - p, np.inf if self.light['type'] == 'directional' else 1 - END
        line = np.hstack([np.cross(d, p), d])
        with np.errstate(all='ignore'):  # edge-on: infinite or NaN, which is no hit
            scale = 1 / (d @ self.det)
            u, v, t = (line @ self.u) * scale, (line @ self.v) * scale, (np.insert(p, 3, 1, 1) @ self.t) * scale
            hit = (u >= -EDGE) & (v >= -EDGE) & (u + v <= 1 + EDGE) & (t > END) & (t < last)
        there = np.flatnonzero(own >= 0)
        hit[there, own[there]] = False
        return hit.any(1)

    def visibility(self, message):
        side = 1 if self.light['type'] in HARD else message['settings'].get('samples', 4)
        random = np.random.default_rng(message['settings'].get('seed', 1))
        asked = np.flatnonzero(self.load(message['asked']))
        s = np.full(len(self.p), np.nan)
        rows = max(1, TESTS // max(1, self.det.shape[1]))
        for i in (asked[k:k + rows] for k in range(0, len(asked), rows)):
            p, seen = self.p[i], np.zeros(len(i))
            for stratum in np.ndindex(side, side):
                sample = (random.random((2, len(i), 1)) + np.reshape(stratum, (2, 1, 1))) / side
                target = self.targets(p, sample)
                ahead = np.sum((target - p) * self.n[i], 1)
                seen += np.where(np.isnan(ahead), np.nan, (ahead > 0) & ~self.hit(p, target, self.own_of[i]))
            s[i] = seen / side ** 2
        np.save(os.path.join(self.folder, message['answers']), s)
        return {}


serve(Contender())
