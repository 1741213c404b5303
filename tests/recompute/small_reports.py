#!/usr/bin/env python3
"""Writes the small reports that the standing check reads.

    tests/recompute/small_reports.py PROGRAM PLANTED_CONTENDER FOLDER
"""
import json
import os
import shutil
import subprocess
import sys

program, planted, folder = sys.argv[1:]
top = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
scenes = [os.path.join(top, 'scenes', f'{name}.json') for name in ('three_reasons', 'light_sizes', 'spot_stage')]
maps = ['shadow_zbuffer:resolution=64', 'shadow_zbuffer:resolution=256', 'planar_projection']
shutil.rmtree(folder, ignore_errors=True)
os.makedirs(folder)


def run(name, *arguments, out=subprocess.DEVNULL):
    subprocess.run([program, *arguments, '--quiet', '-o', os.path.join(folder, name)], check=True, stdout=out, cwd=folder)


def contender(name, fault):
    """A program that passes the gate, and from then on has a fault."""
    subprocess.run([program, 'contender', 'check', '--save', name, '--', planted, 'none'], check=True, cwd=folder,
                   stdout=subprocess.DEVNULL)
    path = os.path.join(folder, 'contenders', f'{name}.json')
    with open(path, encoding='utf-8') as f:
        written = json.load(f)
    written['command'][1] = fault
    with open(path, 'w', encoding='utf-8') as f:
        json.dump(written, f)


def quieten(name):
    """Gives the kept times a small noise bar: what is ranked by it does not depend on what else the machine does."""
    cells = os.path.join(folder, name, 'cells')
    for cell in os.listdir(cells):
        path = os.path.join(cells, cell)
        if cell.endswith('.json'):
            with open(path, encoding='utf-8') as f:
                kept = json.load(f)
            if kept.get('times'):
                kept['turns']['noise_bar'] = 0.05
                with open(path, 'w', encoding='utf-8') as f:
                    json.dump(kept, f)


small = ['--size', '48x27']
run('compared', 'compare', *scenes, '--methods', *maps, 'ray_traced:samples=4', '--size', '64x36')
run('planted', 'compare', *scenes[:2], '--methods', *maps, *small)
contender('right', 'none')
contender('wrong', 'exchanged')
run('outside', 'compare', *scenes, os.path.join(top, 'scenes', 'six_lights.json'), '--methods', 'right', 'wrong', 'ray_traced', *small)
run('moved', 'motion', scenes[0], '--methods', *maps, 'ray_traced', '--frames', '6', *small)
run('summed', 'energy', scenes[0], '--method', 'shadow_volumes', '--points', '8000')
run('laddered', 'ladder', 'needles', 'growing_light', '--methods', 'shadow_zbuffer:resolution=256', 'shadow_zbuffer',
    'shadow_zbuffer@textbook')
two_maps = ['--methods', 'shadow_zbuffer:resolution=64|256', 'planar_projection', *small]
sweep = ['sweep', scenes[0], *two_maps, '--views', '2']
run('swept', *sweep)
quieten('swept')
run('swept', *sweep)
# One setting alone is within the limit, so that it is the answer whatever the times are; one is beyond it in the first view.
choice = ['recommend', scenes[0], '--methods', 'shadow_zbuffer:resolution=16|64|256', 'planar_projection', *small, '--views', '3', '--held-out', '3', '--max', 'rmse=0.1', '--json']
run('recommended', *choice)
quieten('recommended')
with open(os.path.join(folder, 'recommended', 'recommendation.json'), 'w', encoding='utf-8') as f:
    run('recommended', *choice, out=f)

run('grown', 'growth', '--over', 'triangles', '--max', '20000', '--methods', 'shadow_zbuffer', 'ray_traced',
    'shadow_volumes')
# The same settings by two commands, which have to count the same: curved bodies have points at the terminator.
curved = os.path.join(top, 'scenes', 'self_shadow.json')
tiny = ['--size', '48x27']
run('biased/bias', 'bias', curved, scenes[0], *tiny)
run('biased/compared', 'compare', curved, scenes[0], *tiny, '--methods', 'shadow_zbuffer',
    'shadow_zbuffer:bias=receiver_plane', 'shadow_zbuffer:bias=manual,constant=0,slope=0,normal_offset=0',
    'shadow_zbuffer:bias=manual,constant=2,slope=0.5,normal_offset=1')
studies = {'compare': ['self_shadow', '--methods', 'shadow_zbuffer', *tiny], 'shading': ['self_shadow', *tiny],
           'whitted': ['mirror_and_glass', *tiny], 'radiosity': ['closed_room', '--patch', '0.25']}
for command, (scene, *options) in studies.items():
    run(f'studied/{command}', command, os.path.join(top, 'scenes', f'{scene}.json'), *options)
run('lectured', 'report', *(os.path.join(folder, 'studied', command) for command in studies), '--lang', 'de')
