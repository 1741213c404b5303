#!/usr/bin/env python3
"""POV-Ray as a contender: its function trace() from each point to the light, against a mesh of all that blocks.

Needs `povray` (3.7, Debian's package) in PATH, or where $POVRAY says, and numpy (python3-numpy). No picture is
rendered: a loop in POV-Ray's scene language reads points from a file and writes answers to another.

Traps:
- trace() cannot leave out the point's own triangle: rays start `offset` along the normal. Below 1e-8 surfaces
  shadow themselves, from 1e-4 on shadows move.
- Vertices of a mesh are floats, tolerances are absolute (about 1e-6), and nothing is hit beyond 1e7: the scene is
  scaled by a power of two, which rounds nothing, to a diagonal of about 1000; it is not moved.
- /etc/povray/3.7/povray.conf lets it read and write in its working folder and in /tmp alone: it runs in the folder of
  the files.
- Each question starts POV-Ray anew and parses the mesh again; its time has both.
"""
import os
import re
import subprocess

import numpy as np
from protocol import serve

POVRAY = os.environ.get('POVRAY', 'povray')
HELLO = {'name': 'POV-Ray', 'measure': 'area', 'takes': 'points', 'seed': 'seed',
         'lights': ['directional', 'point', 'spot', 'rectangle', 'disk'],
         'summary': 'trace() of its scene language, from each point to the light; stratified samples of area lights.',
         'parameters': [
             {'name': 'offset', 'type': 'real', 'default': 1e-6, 'min': 0, 'max': 1, 'phase': 'visibility',
              'sweep': '1e-8|1e-6|1e-4', 'doc': 'where rays start along the normal, of the diagonal of the scene'},
             {'name': 'samples', 'type': 'integer', 'default': 4, 'min': 1, 'max': 64, 'phase': 'visibility',
              'sweep': '2|4|8', 'doc': 'samples along each side of an area light: 4 are 16 rays'},
             {'name': 'seed', 'type': 'integer', 'default': 1, 'min': 0, 'max': 1000000, 'phase': 'visibility',
              'doc': 'of the place of each sample in its stratum'}]}
HARD = 'directional', 'point', 'spot'
PROGRAM = '''#version 3.7;
global_settings { assumed_gamma 1 }
camera { location 0 }
#include "blockers.inc"
#declare Any = seed(%(seed)d);
#fopen Points "points.txt" read
#fopen Answers "answers.txt" write
#for (K, 1, %(count)d)
  #read (Points, P, N)
  #declare Start = P + %(offset).17g * N;
  #declare Seen = 0;
  #for (I, 0, %(side)d - 1)
    #for (J, 0, %(side)d - 1)
      %(aim)s
      #if (vdot(N, D) > 0)
        #declare Normal = <0, 0, 0>;
        #if (Blockers > 0)
          #declare Hit = trace(Mesh, Start, D, Normal);
        #end
        #if (vlength(Normal) = 0)
          #declare Seen = Seen + 1;
        #elseif (Last & vlength(Hit - Start) >= vlength(D) - %(offset).17g)
          #declare Seen = Seen + 1;
        #end
      #end
    #end
  #end
  #write (Answers, Seen, "\\n")
#end
#fclose Points
#fclose Answers
'''


def vector(v):
    return '<%.17g,%.17g,%.17g>' % tuple(v)


class Contender:
    def hello(self, message):
        self.folder = message['folder']
        said = subprocess.run([POVRAY, '--version'], capture_output=True, text=True)
        found = re.search(r'(?:version|POV-Ray) +(\d+\.\S+)', said.stdout + said.stderr, re.I)
        return {**HELLO, 'version': found.group(1) if found else 'unknown'}

    def path(self, file):
        return os.path.join(self.folder, file)

    def load(self, file):
        return np.load(self.path(file))

    def scene(self, message):
        self.corners, self.blocks = self.load(message['triangles']), self.load(message['blocks']) != 0
        return {}

    def build(self, message):
        all_corners = self.corners.reshape(-1, 3).astype(float)
        diagonal = np.linalg.norm(np.ptp(all_corners, axis=0)) if len(all_corners) else 0
        self.scale = 2.0 ** np.round(np.log2(1024 / diagonal)) if diagonal > 0 else 1
        self.diagonal = diagonal * self.scale
        kept = self.corners[self.blocks].reshape(-1, 3).astype(float) * self.scale
        with open(self.path('blockers.inc'), 'w') as file:
            print(f'#declare Blockers = {len(kept) // 3};', file=file)
            if len(kept):
                print(f'#declare Mesh = mesh2 {{ vertex_vectors {{ {len(kept)},', file=file)
                np.savetxt(file, kept, '<%.9g,%.9g,%.9g>')
                print(f'}} face_indices {{ {len(kept) // 3},', file=file)
                np.savetxt(file, np.arange(len(kept)).reshape(-1, 3), '<%d,%d,%d>')
                print('} }', file=file)
        return {}

    def points(self, message):
        self.p = self.load(message['points'])
        return {}

    def aim(self, message):
        self.light = light = message['description']
        kind = light['type']
        at = vector(self.scale * np.array(light.get('position', [0, 0, 0]), float))
        if kind == 'directional':
            self.towards = f'#declare Last = 0; #declare D = -{vector(light["direction"])};'
            return {}
        self.towards = '#declare Last = 1; #declare D = %s - Start;' % at
        if kind in HARD:
            return {}
        sample = '#declare X = (I + rand(Any)) / %(side)d; #declare Y = (J + rand(Any)) / %(side)d;'
        if kind == 'rectangle':
            u, v = (self.scale * np.array(light[k], float) for k in ('edge_u', 'edge_v'))
            place = f'(X - 0.5) * {vector(u)} + (Y - 0.5) * {vector(v)}'
        else:
            axis = np.array(light['direction'], float)
            u = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
            v = np.cross(axis, u)
            u, v = (self.scale * light['radius'] / np.linalg.norm(w) * w for w in (u, v))
            place = f'sqrt(X) * (cos(2 * pi * Y) * {vector(u)} + sin(2 * pi * Y) * {vector(v)})'
        self.towards = f'{sample} #declare Last = 1; #declare D = {at} + {place} - Start;'
        return {}

    def visibility(self, message):
        settings = message['settings']
        side = 1 if self.light['type'] in HARD else settings.get('samples', 4)
        asked = np.flatnonzero(self.load(message['asked']))
        s = np.full(len(self.p), np.nan)
        if len(asked):
            p = self.p[asked]
            rows = np.hstack([p['position'] * self.scale, p['normal']])
            np.savetxt(self.path('points.txt'), rows, '<%.17g,%.17g,%.17g>,<%.9g,%.9g,%.9g>,')
            fills = {'side': side, 'seed': settings.get('seed', 1), 'count': len(asked),
                     'offset': settings.get('offset', 1e-6) * self.diagonal}
            with open(self.path('ask.pov'), 'w') as file:
                aim = self.towards.replace('%(side)d', str(side))
                file.write(PROGRAM % {**fills, 'aim': aim})
            ran = subprocess.run([POVRAY, '+Iask.pov', '+W1', '+H1', '-F', '-D', '-V', '-GA'], cwd=self.folder,
                                 capture_output=True, text=True, stdin=subprocess.DEVNULL)
            if ran.returncode != 0:
                raise RuntimeError(f'povray ended with {ran.returncode}: {ran.stderr[-400:]}')
            s[asked] = np.loadtxt(self.path('answers.txt'), ndmin=1) / side ** 2
        np.save(self.path(message['answers']), s)
        return {}


serve(Contender())
