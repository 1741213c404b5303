#!/usr/bin/env python3
"""Recomputes the figures of reports: records from the planes beside them, pages from records, by code of its own.

    tests/recompute/recompute.py [--need-all] DIR ...

DIR is what compare, sweep, motion, energy, growth, a study or report wrote. Prints how many figures of each kind are right; exit code 1 where
one is not, or, with --need-all, where there is none of a kind.
"""
import argparse
import csv
import html
import json
import math
import os
import re
import sys
from collections import Counter

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from pages import NONE, headed, number, shows, tables  # noqa: E402
from pictures import read_exr  # noqa: E402
from planes import REACH, Geometry, light_errors, picture_figures, telling_points  # noqa: E402
from growths import grown, growth_page  # noqa: E402
from renderers import of_report  # noqa: E402
from statistics_anew import interval, median, ratio, student_bound, upper_share  # noqa: E402
import values as script  # noqa: E402
from studies import biased, exchanged, judged_alike, lectures, shaded, traced  # noqa: E402


KINDS = ('errors', 'coverage', 'pictures', 'times', 'labels', 'scene pages', 'ratios of pages', 'index',
        'sweep metrics',
         'sweep worst views', 'sweep bounds', 'sweep cells', 'sweep costs', 'sweep fronts', 'trade pages',
         'trade findings', 'trade at fixed errors', 'motion', 'motion winners', 'motion break-even', 'motion pages',
         'energy', 'recommendations', 'ladders', 'ladder pages', 'growth', 'growth pages', 'bias', 'bias as compare',
         'shading', 'whitted', 'radiosity', 'lectures', 'values', 'renderers')


class Tally:
    def __init__(self):
        self.figures, self.faults, self.notes = Counter(), [], Counter()

    def fault(self, where, what):
        self.faults.append(f'{where}: {what}')

    def same(self, kind, where, written, anew, tolerance=1e-9):
        """Compares objects member by member; a figure is a number, or a null where there is none."""
        if isinstance(anew, dict) and isinstance(written, dict):
            for key in sorted(set(anew) | set(written)):
                if key not in anew or key not in written:
                    self.fault(where, f'"{key}" is {"not" if key in anew else "unexpectedly"} there')
                else:
                    self.same(kind, f'{where}.{key}', written[key], anew[key], tolerance)
        elif isinstance(anew, (list, tuple)) and isinstance(written, list):
            if len(anew) != len(written):
                self.fault(where, f'{len(written)} values in place of {len(anew)}')
            for i, (w, a) in enumerate(zip(written, anew)):
                self.same(kind, f'{where}[{i}]', w, a, tolerance)
        else:
            self.figures[kind] += 1
            number_like = (int, float)
            if isinstance(anew, number_like) and isinstance(written, number_like) and not isinstance(written, bool):
                right = written == anew or abs(written - anew) <= tolerance * max(abs(written), abs(anew)) + 1e-15
            else:
                right = written == anew
            if not right:
                self.fault(where, f'{written} is written, {anew} is right')

    def shown(self, kind, where, text, value, unit='score', at_least=False):
        self.figures[kind] += 1
        if not shows(text, value, unit, at_least):
            self.fault(where, f'"{text}" is shown, the record says {"at least " if at_least else ""}{value}')

    def text(self, kind, where, text, right):
        self.figures[kind] += 1
        if text != right:
            self.fault(where, f'"{text}" is shown in place of "{right}"')


def load(path):
    with open(path, encoding='utf-8') as f:
        return json.load(f)


def ran(method):
    return method['serves']['how'] not in ('not', 'not_at_all') and not method.get('failed')


def sampled(times, name, where, tally):
    t = times[name]
    if t.get('samples') is not None:
        s = t['samples']
        tally.same('times', f'{where}.{name}', {k: t[k] for k in ('median', 'min', 'max', 'runs')},
                   {'median': median(s), 'min': min(s), 'max': max(s), 'runs': len(s)})


PHASES = ('build_ms', 'aim_ms', 'look_ms', 'visibility_ms')


# Records.

def tone_of(source):
    """(tone map, exposure) of a native scene file that is still there."""
    if not source.endswith('.json') or not os.path.isfile(source):
        return None
    scene = load(source)
    return scene.get('tone', 'clamp'), scene.get('exposure', 1.0)


def compared(folder, record, tally):
    """results.json of compare, from reference.exr and the methods' planes."""
    reference, geometry, columns = None, None, []
    names = [l['name'] for l in record['lights']]
    if len({m['text'] for m in record['methods']}) != len(record['methods']):
        tally.fault(folder, 'two methods have one text')
    for method in record['methods']:
        where = f'{folder}: {method["text"]}'
        settings = method['text'].partition(':')[2]
        for setting in filter(None, settings.split(',')):
            key, _, value = setting.partition('=')
            known = method['parameters'].get(key)
            written = str(known).lower() if isinstance(known, bool) else str(known)
            tally.figures['labels'] += 1
            if written != value and not (number(value) and isinstance(known, (int, float))
                    and float(value) == float(known)):
                tally.fault(where, f'the parameter {key} is {known}')
        if not ran(method):
            continue
        for name in PHASES:
            sampled(method['times'], name, where, tally)
        errors = method['errors']
        if [e['light'] for e in errors] != names:
            tally.fault(where, f'errors of {[e["light"] for e in errors]}, lights are {names}')
            continue
        if [t['light'] for t in method['light_times']] != names:
            tally.fault(where, f'times of {[t["light"] for t in method["light_times"]]}, lights are {names}')
        path = os.path.join(folder, (method.get('files') or {}).get('exr') or '')
        of_reference = os.path.join(folder, 'reference.exr')
        if not os.path.isfile(path) or not os.path.isfile(of_reference):
            tally.notes['methods without planes'] += 1
            continue
        if method['compared_with'] != record['reference']['text']:
            tally.notes['methods whose reference has no planes'] += 1
            continue
        if reference is None:
            reference = read_exr(of_reference)
            geometry = Geometry(reference)
        picture = read_exr(path)
        told = picture.attributes.get('umbra:parameters', method['text'])
        tally.text('labels', f'{where}: {os.path.basename(path)}', told, method['text'])
        if (picture.width, picture.height) != (record['size']['width'], record['size']['height']):
            tally.fault(where, 'the planes are of another size')
            continue
        title = method['title'] or method['name'].replace('_', ' ')
        columns.append((f'{title} ({settings})' if settings else title, picture))
        asked = given = 0
        for light, error in zip(record['lights'], errors):
            faults = []
            anew, (a, g) = light_errors(geometry, reference, picture, light['name'], light['kind'], faults)
            asked, given = asked + a, given + g
            for fault in faults:
                tally.fault(where, fault)
            tally.same('errors', f'{where}, {light["name"]}', {k: v for k, v in error.items() if k not in ('light',
                    'noise', 'explained')}, anew)
            told = [{'class': x['class'], 'pixel': x['pixel'], 'method': x['method'].get('visibility'),
                     'truth': x['truth'].get('visibility')} for x in error.get('explained', [])]
            tally.same('explained points', f'{where}, {light["name"]}.explained', told,
                       telling_points(reference, picture, light['name']))
        tally.same('coverage', f'{where}.coverage', method['coverage'], given / asked if asked else None)
        fine = '--pixel-samples' in record['command']
        if method.get('image') and not fine:
                tone = tone_of(record['scene'].get('source', ''))
                anew = picture_figures(reference, picture, names, *(tone or ('clamp', 1.0)))
                if not tone:
                    tally.notes['pictures whose scene file is not there: RMSE alone'] += 1
                tally.same('pictures', f'{where}.image', {k: method['image'][k] for k in (anew if tone else ('rmse',))},
                           {k: anew[k] for k in (anew if tone else ('rmse',))}, 2e-5)
    path = os.path.join(folder, record.get('values') or '')
    if reference is None or not os.path.isfile(path):
        return
    values, where = script.planes(path), f'{folder}: values.js'
    if values is None:
        tally.fault(where, 'is no call with JSON alone')
        return
    classes = [text.split(' ', 1)[1] for text in columns[0][1].attributes['umbra:class'].split(', ')]
    script.surfaces('values', where, values, reference, record['facts']['objects'], tally)
    for who, picture in [('Reference', reference), *columns]:
        script.column('values', where, values, who, picture, names, classes, tally)


SHARES = {'interior': ('false_shadow.interior', 'false_light.interior'), 'edge': ('false_shadow.edge',
        'false_light.edge'),
          'penumbra_error': ('penumbra_error.false_shadow', 'penumbra_error.false_light'),
          'noise_error': ('noise_error.false_shadow', 'noise_error.false_light'),
          'terminator.wrong': ('terminator.wrong',)}
for _group, _members in (('false_shadow', ('interior', 'edge', 'acne')), ('false_light', ('interior', 'edge',
        'detachment', 'leak'))):
    for _member in _members:
        SHARES[f'{_group}.{_member}'] = (f'{_group}.{_member}',)


def at(node, path):
    for key in path.split('.'):
        node = None if node is None else node.get(key)
    return node


def whole_edge(edges, name):
    """(value, at least) of mean, p95 or max with what lies beyond the reach counted as the reach."""
    lost, pieces = edges['unmatched'], edges['pieces']
    if not lost:
        return None if edges[name] is None else (edges[name], False)
    if name == 'mean':
        return ((edges['mean'] or 0) * (pieces - lost) + REACH * lost) / pieces, True
    if name == 'p95' and edges['max'] is not None and (pieces - 1) * 95 // 100 < pieces - lost:
        return edges['max'], False
    return REACH, True


def pooled(view, name):
    """(value, at least, wrong, of) of a metric over the lights of a view; None where a light has no answer."""
    errors = view['errors']
    if any(e['points'] == 0 and e['undefined'] + e['not_judged'] > 0 for e in errors):
        return None
    errors = [e for e in errors if e['points'] > 0]
    if not errors:
        return None
    n = sum(e['points'] for e in errors)
    if name in SHARES:
        counts = [at(e, path) for e in errors for path in SHARES[name]]
        return None if None in counts else (sum(counts) / n, False, sum(counts), n)
    if name.startswith('edge_displacement_px.'):
        found = [whole_edge(e['edge_displacement_px'], name.split('.')[1]) for e in errors if e['edge_displacement_px']]
        if not found or None in found:
            return None
        return max(v for v, _ in found), any(l for _, l in found), None, n
    values = [(e[name], e['points']) for e in errors]
    if any(v is None for v, _ in values):
        return None
    if name == 'rmse':
        return math.sqrt(sum(v * v * k for v, k in values) / n), False, None, n
    if name == 'mae':
        return sum(v * k for v, k in values) / n, False, None, n
    return max(v for v, _ in values), False, None, n


OF_S = ('rmse', 'mae', 'max')
ENTRIES = ('image_rmse', 'flip', 'flip_hdr', 'undefined', 'memory_mb')


def possible(p, view, exactly, name, unit):
    """What a view leaves possible, p being what it measured."""
    if exactly:
        return p[0]
    if p[2] is not None:
        return upper_share(p[2], p[3])
    if p[0] == 0 and not unit:
        missed = upper_share(0, sum(e['points'] for e in view['errors']))
        return math.sqrt(missed) if name == 'rmse' else 1 if name == 'max' else missed
    return p[0]


def least_bound(setting, name, unit):
    """What a bound is no less than by the views that are there."""
    least = 0.0
    for view in setting['views']:
        p = (view['metrics'][name], False, None, None) if name in ENTRIES else pooled(view, name)
        if p is None or p[0] is None or p[1]:
            return None
        exact = setting['serves']['how'] == 'exactly' and (p[0] == 0 or name in OF_S)
        width = max((e['bracket']['max_half_width'] for e in view['errors'] if e['bracket']),
                    default=0) if name in OF_S else 0
        least = max(least, possible(p, view, exact, name, unit) + width)
    return least


def metric_bound(setting, name, unit):
    exactly, values, widths = True, [], []
    for view in setting['views']:
        p = (view['metrics'][name], False, None, None) if name in ENTRIES else pooled(view, name)
        if p is None or p[0] is None or p[1]:
            return None
        exact = setting['serves']['how'] == 'exactly' and (p[0] == 0 or name in OF_S)
        exactly = exactly and exact
        width = max((e['bracket']['max_half_width'] for e in view['errors'] if e['bracket']),
                default=0) if name in OF_S else 0
        values.append((p, view))
        widths.append(width)
    if not values or (not exactly and len(values) < 2):
        return None
    found = [possible(p, view, exactly, name, unit) + width for (p, view), width in zip(values, widths)]
    largest = max(found)
    if exactly:
        return largest
    bound = max(student_bound(found), largest)
    return min(bound, max(1.0, largest)) if name in SHARES or name in OF_S else bound


def cost(load):
    rate = {k: v for k, v in load.items()}
    most = max(rate.values())
    share = lambda *who: max(rate[w] for w in who) / most
    return lambda b, a, l, v: share('object') * b + share('light', 'object') * a + share('camera', 'object') * l + v


def costs(setting, load):
    t, of = setting['times'], cost(load)
    return of(*(t[p]['median'] for p in PHASES)), [of(*row) for row in zip(*(t[p]['samples'] for p in PHASES))]


def front(settings, name):
    points = [(s['cost_ms'], s['values'][name], i, s['text']) for i, s in enumerate(settings)
              if s['excluded'] is None and s['cost_ms'] is not None and s['values'][name] is not None]
    return [t for c, e, i, t in sorted(points)
            if not any((c2 <= c and e2 <= e and (c2 < c or e2 < e)) for c2, e2, _, _ in points)]


def swept(folder, record, tally):
    """results.json of a scene's sweep: metrics from errors, worst views, bounds, costs, fronts; cells are the views."""
    sweep, names = record['sweep'], [l['name'] for l in record['lights']]
    units = {m['name']: m['unit'] for m in sweep['metrics']}
    cells = os.path.join(folder, 'cells')
    if not os.path.isdir(cells):
        cells = os.path.join(os.path.dirname(folder), 'cells')
    stored = {}
    if os.path.isdir(cells):
        for name in os.listdir(cells):
            cell = load(os.path.join(cells, name)) if name.endswith('.json') else {}
            if 'errors' in cell:
                stored.setdefault((cell['text'], cell['view']), []).append(cell)
    for s in sweep['settings']:
        where = f'{folder}: sweep of {s["text"]}'
        if not s.get('views') or any('errors' not in v for v in s['views']):
            continue
        for v in s['views']:
            here = f'{where}, view {v["view"]}'
            if [e['light'] for e in v['errors']] != names:
                tally.fault(here, f'errors of {[e["light"] for e in v["errors"]]}, lights are {names}')
            for name, written in v['metrics'].items():
                if name not in ENTRIES:
                    p = pooled(v, name)
                    tally.same('sweep metrics', f'{here}.{name}', written, p and p[0])
            image = v['image']
            tally.same('sweep metrics', here, {k: v['metrics'][k] for k in ('image_rmse', 'flip', 'flip_hdr')},
                       {'image_rmse': image['rmse'], 'flip': image['flip'], 'flip_hdr': image['flip_hdr']})
            of_cells = stored.get((s['text'], v['view']), [])
            if of_cells:
                tally.figures['sweep cells'] += 1
                if not any(c['errors'] == v['errors'] and c['image'] == image for c in of_cells):
                    tally.fault(here, 'no cell of this setting and view holds these errors')
        memory = s['memory_bytes'] / 1e6
        tally.same('sweep metrics', f'{where}.memory_mb', s['views'][0]['metrics']['memory_mb'], memory)
        for name in units:
            found = [v['metrics'][name] for v in s['views']]
            tally.same('sweep worst views', f'{where}.values.{name}', s['values'][name], None if None in found
                    else max(found))
            tally.same('sweep bounds', f'{where}.bounds.{name}', s['bounds'][name], metric_bound(s, name, units[name]),
                    1e-6)
        if s.get('times'):
            for name in PHASES:
                sampled(s['times'], name, where, tally)
            tally.same('sweep costs', f'{where}.cost_ms', s['cost_ms'], costs(s, sweep['workload'])[0])
    for name in units:
        tally.same('sweep fronts', f'{folder}: front of {name}', sweep['fronts'][name], front(sweep['settings'], name))


MOST_NOISE = 0.3  # above this noise bar nothing is ranked by times
SMALL_PICTURE = 60000  # points; of more recommend looks at fewer than the picture has


def entries_of_cell(cell):
    """A kept cell as a view of a sweep's record. A brief one has no memory."""
    image, memory = cell['image'], cell.get('memory_bytes')
    return {'view': cell['view'], 'errors': cell['errors'], 'metrics': {
        'image_rmse': image['rmse'], 'flip': image['flip'], 'flip_hdr': image['flip_hdr'],
        'undefined': cell['undefined'], 'memory_mb': memory / 1e6 if memory is not None else None}}


def metric_of(view, name):
    """(value, at least), or None where it is not known."""
    if name in ENTRIES:
        return view['metrics'][name], False
    p = pooled(view, name)
    return p and p[:2]


def recommended(folder, r, tally):
    """What recommend --json prints, from the cells and times that it keeps."""
    kind = 'recommendations'
    cells = os.path.join(folder, 'cells')
    cells = cells if os.path.isdir(cells) else r['kept_in'] or cells
    views, how, kept, runs = {}, {}, [], []
    points_in = {}  # of pictures of several sizes those of the size that is named, or the next smaller one
    most = r['size']['width'] * r['size']['height']
    for name in sorted(os.listdir(cells)) if os.path.isdir(cells) else ():
        cell = load(os.path.join(cells, name)) if name.endswith('.json') else {}
        if 'errors' in cell:
            points = sum(e['points'] for e in cell['errors'])
            if any(e['points'] > most for e in cell['errors']) or points < points_in.get((cell['text'], cell['view']), 0):
                continue
            points_in[cell['text'], cell['view']] = points
            views.setdefault(cell['text'], {})[cell['view']] = entries_of_cell(cell)
            how[cell['text']] = cell['serves']
        elif cell.get('times'):
            kept.append(cell)
        elif cell.get('price'):
            runs.append(cell['price'])
    load_of = {k: float(v) for k, v in (x.split('=') for x in r['workload'].split(','))}
    timed = [(costs({'times': c['times']}, load_of), c['turns']['noise_bar']) for c in kept]
    bar = math.inf if r['noise_bar'] is None else r['noise_bar']
    if timed and r['noise_bar'] not in [b for _, b in timed]:
        tally.fault(folder, f'a noise bar of {r["noise_bar"]}, times have {[b for _, b in timed]}')
    limits, bounds, rounds_of, factor = {}, {}, {}, {}
    unit = lambda name: {'edge_displacement_px': 'pixels', 'memory_mb': 'MB', 'undefined': 'share of points'}.get(
        name.split('.')[0], 'share of points' if name in SHARES else '')
    for c in r['candidates']:
        where, text = f'{folder}: {c["method"]}', c['method']
        chosen_on = [views.get(text, {}).get(v) for v in range(c['views'])]
        if None in chosen_on:
            tally.fault(where, 'a view that it was chosen on has no cell')
            continue
        tally.same(kind, f'{where}.undefined', c['undefined'], max(v['metrics']['undefined'] for v in chosen_on))
        worst = 0.0
        for name, e in c['errors'].items():
            found = [metric_of(v, name) for v in chosen_on]
            found_of = {'views': chosen_on, 'serves': how[text]}
            whole = c['views'] == r['views'] or c['beyond'] is None  # of the reference one view is enough
            bound = metric_bound(found_of, name, unit(name)) if whole else None
            least = bound if whole else least_bound(found_of, name, unit(name))
            tally.same(kind, f'{where}.{name}.largest', e['largest'],
                       None if None in found else max(v for v, _ in found))
            tally.same(kind, f'{where}.{name}.bound', e['bound'], bound, 1e-6)
            limits[name], bounds[text, name] = e['limit'], bound
            worst = max(worst, math.inf if least is None else 0 if least == 0 else
                        least / e['limit'] if e['limit'] else math.inf)
            if c['beyond'] and c['beyond']['metric'] == name:
                v = views[text][c['beyond']['view']]
                tally.same(kind, f'{where}: beyond', c['beyond']['error'],
                           least_bound({'views': [v], 'serves': how[text]}, name, unit(name)), 1e-6)
                if c['beyond']['error'] is not None and c['beyond']['error'] <= e['limit']:
                    tally.fault(where, f'beyond {e["limit"]} with {c["beyond"]["error"]}')
        factor[text] = worst
        if c['cost'] is not None:
            of = [rows for (ms, rows), _ in timed if abs(ms - c['cost']) <= 1e-9 * ms]
            tally.figures[kind] += 1
            if of:
                rounds_of[text] = of[0]
            elif timed and len(timed) >= sum(x['cost'] is not None for x in r['candidates']):
                tally.fault(where, f'a cost of {c["cost"]} ms, kept times make {[ms for (ms, _), _ in timed]}')
    cost_of = {c['method']: c['cost'] for c in r['candidates'] if c['cost'] is not None}
    first = next(iter(limits), None)

    # The staircase: a step is cheaper than all with a smaller bound by more than noise; of others the least bound.
    steps, cheapest = [], 0.0
    for text in sorted(cost_of, key=cost_of.get):
        error = bounds.get((text, first))
        if error is None or (steps and error >= steps[-1]['error']):
            continue
        if steps and cost_of[text] <= cheapest * (1 + (bar if math.isfinite(bar) else 0)):
            steps.pop()
        else:
            cheapest = cost_of[text]
        steps.append({'error': error, 'method': text, 'cost': cost_of[text]})
    tally.same(kind, f'{folder}: staircase', r['staircase'], steps, 1e-6)

    dropped = [d['method'] for d in r['dropped']]
    for d in r['dropped']:
        v = views.get(d['method'], {}).get(d['beyond']['view'])
        name = d['beyond']['metric']
        value = v and metric_of(v, name)
        tally.figures[kind] += 1
        if not v or d['beyond']['view'] < r['views'] or (d['beyond']['error'] is not None and (
                d['beyond']['error'] <= limits[name] or (value and value[0] > d['beyond']['error'] * (1 + 1e-9)))):
            tally.fault(f'{folder}: {d["method"]}', f'dropped for {d["beyond"]}, the cell has {value}')
    within = [t for t in factor if factor[t] <= 1 and t in cost_of and t not in dropped]
    within.sort(key=lambda t: (t not in rounds_of, cost_of[t]))
    tried = len(dropped) + 1
    if r['recommendation']:
        c = r['recommendation']
        tally.text(kind, f'{folder}: the answer', c['method'], within[0] if within else None)
        held, where = c['held_out'], f'{folder}: {c["method"]}, views that it was not chosen on'
        further = [v for n, v in sorted(views.get(c['method'], {}).items()) if n >= r['views']][:held['views']]
        for name in limits:
            found = [metric_of(v, name) for v in further]
            tally.same(kind, f'{where}.{name}.largest', held['largest'][name],
                       None if None in found or not found else max(v for v, _ in found))
            if bounds.get((c['method'], name)) is not None:
                tally.same(kind, f'{where}.{name}.holds', held['holds'][name],
                           sum(f is not None and not f[1] and f[0] <= bounds[c['method'], name] for f in found))
            if any(f is None or f[0] > limits[name] for f in found):
                tally.fault(where, f'{name} is {found}, its limit {limits[name]}')
        tally.same(kind, where, {k: held[k] for k in ('views', 'tried', 'beyond', 'share_beyond')}, {
            'views': len(further), 'tried': tried, 'beyond': 0,
            'share_beyond': 1 - (0.05 / tried) ** (1 / len(further)) if further else 1.0})
    elif r['nearest'] and factor:
        among = [t for t in factor if t in cost_of]
        tally.same(kind, f'{folder}: nearest', r['nearest']['factor'], min(map(factor.get, among), default=None), 1e-6)
    elif r['undecided']:
        tally.figures[kind] += 1
        if not bar > MOST_NOISE or [u['method'] for u in r['undecided']][:1] != within[:1]:
            tally.fault(folder, f'{[u["method"] for u in r["undecided"]]} are not decided at a noise bar of {bar}')
    base = r['recommendation'] and r['recommendation']['method']
    price_of = cost(load_of)
    for which, rivals in (('tied', r['tied']), ('runner_up', [r['runner_up']]), ('cheapest', [r['cheapest']]),
                          ('exact', [r['exact']])):
        for rival in filter(None, rivals):
            where, q = f'{folder}: {which}, {rival["method"]}', rival['cost_ratio']
            if rival['method'] in rounds_of and base in rounds_of:
                value, (low, high, coverage) = ratio(rounds_of[rival['method']], rounds_of[base])
                tally.same(kind, where, {k: q[k] for k in ('median', 'low', 'high', 'coverage')}, {
                    'median': value, 'low': low, 'high': high, 'coverage': coverage})
                if low is not None:
                    differs = (low > 1 or high < 1) and max(value, 1 / value) - 1 > bar
                    tally.same(kind, where, q['differs'], differs)
                    if which == 'tied' and differs or which == 'runner_up' and not differs:
                        tally.fault(where, f'the ratio is {value} ({low} to {high}), the noise bar {bar}')
            elif runs and most <= SMALL_PICTURE:  # it took no turns: a run of each, of as many points as the picture has
                tally.figures[kind] += 1
                of = [rival['cost'] / price_of(p['build_ms'], sum(p['aim_ms']), p['look_ms'], sum(p['visibility_ms']))
                      for p in runs]
                if q['low'] is not None or not any(math.isclose(q['median'], x, rel_tol=1e-9) for x in of):
                    tally.fault(where, f'a ratio of {q}, by single runs it is one of {of}')
    if r['cheapest']:
        tally.text(kind, f'{folder}: cheapest', r['cheapest']['method'], min(cost_of, key=cost_of.get))
    for m in r['methods']:
        if m['best'] and m['unfit'] is None and m['best']['method'] in factor:
            f = factor[m['best']['method']]
            tally.same(kind, f'{folder}: {m["method"]}, factor', m['factor'], None if math.isinf(f) else f, 1e-6)
            of = [t for t in cost_of if t.partition(':')[0] == m['method'] and t in factor]
            good = [t for t in of if factor[t] <= 1]
            right = min(good, key=cost_of.get) if good else min(of, key=lambda t: (factor[t], cost_of[t]), default=None)
            if right:
                tally.text(kind, f'{folder}: best of {m["method"]}', m['best']['method'], right)


def climbed(folder, record, tally):
    """results.json of ladders: where a method breaks, from the counts of its rungs."""
    kind, limit = 'ladders', record['breaking_share']
    for ladder in record['ladders']:
        judged = [rung['value'] for rung in ladder['rungs'] if 'unjudged' not in rung]
        for m in ladder['methods']:
            where = f'{folder}: {ladder["name"]}, {m["text"]}'
            if len(m['rungs']) != len(judged):
                tally.fault(where, f'{len(m["rungs"])} rungs, {len(judged)} are judged')
                continue
            breaks = None
            for value, o in zip(judged, m['rungs']):
                broken = 'stopped' in o
                if 'points' in o and m['name'] != 'sum':
                    wrong = o['false_shadow']['interior'] + o['false_light']['interior']
                    share = wrong / o['points'] if o['points'] else 0.0
                    most = 0 if o['serves']['how'] in ('exactly', 'to_rounding') else limit
                    broken = broken or share > most
                    tally.same(kind, f'{where}, rung {value:g}', {k: o[k] for k in ('interior_share', 'broken')},
                               {'interior_share': share, 'broken': broken and 'stopped' not in o})
                elif 'broken' in o:
                    broken = broken or o['broken']
                if broken and breaks is None:
                    breaks = value, 'stopped' if 'stopped' in o else o['kind']
            value, why = breaks or (None, None)
            tally.same(kind, f'{where}.breaks_at', m['breaks_at'], value)
            if m['name'] != 'sum':
                tally.same(kind, f'{where}.kind', m['kind'], why)


MOVEMENTS = ('camera', 'light', 'object')


def frame_ms(frame):
    return frame['build_ms'] + sum(frame['aim_ms']) + frame['look_ms'] + sum(frame['visibility_ms'])


def moved(folder, scene, limit, tally):
    lights = len(scene['lights'])
    frames = {}
    for m in scene['methods']:
        if not m.get('movements'):
            continue
        where = f'{folder}: motion of {scene["scene"]}, {m["text"]}'
        for phase in PHASES:
            sampled(m['at_rest'], phase, where, tally)
        for movement, of in m['movements'].items():
            if not of or not of.get('frames'):
                continue
            here, all_ = f'{where}, {movement}', [frame_ms(f) for f in of['frames']]
            frames[m['text'], movement] = all_
            for f in of['frames']:
                if len(f['aim_ms']) != lights or len(f['visibility_ms']) != lights:
                    tally.fault(here, f'times of {len(f["visibility_ms"])} lights, the scene has {lights}')
            rmse = [f['rmse'] for f in of['frames'] if f['points'] > 0]
            anew = {'sum_ms': sum(all_), 'mean_ms': sum(all_) / len(all_), 'median_ms': median(all_),
                    'undefined': sum(f['undefined'] for f in of['frames']),
                    'mean_rmse': sum(rmse) / len(rmse) if rmse else None, 'worst_rmse': max(rmse, default=None)}
            if all(f['interior'] is not None for f in of['frames']):
                anew['interior'] = sum(f['interior'] for f in of['frames'])
            rest = {p: m['at_rest'][p]['median'] for p in PHASES}
            if movement == 'camera':
                anew['model_ms'] = (rest['look_ms'] + rest['visibility_ms']) * len(all_)
            if movement == 'object':
                anew['model_ms'] = sum(rest.values()) * len(all_)
            model = of['model_ms'] / len(all_)
            if model:
                anew['measured_over_model'] = anew['mean_ms'] / model
                low, high, coverage = interval([v / model for v in all_])
                anew['frame_over_model'] = {'median': median([v / model for v in all_]), 'interval': [low, high],
                                            'pairs': len(all_), 'coverage': coverage}
            tally.same('motion', here, {k: of[k] for k in anew}, anew)
    complete = [m['text'] for m in scene['methods'] if all(
        (m['text'], k) in frames and all(f['undefined'] == 0 for f in m['movements'][k]['frames']) for k in MOVEMENTS)]
    within = [m['text'] for m in scene['methods'] if m['text'] in complete and all(
        f['rmse'] <= limit for k in MOVEMENTS for f in m['movements'][k]['frames'])]
    if any('cannot' in m for m in scene['movements']):
        return
    for winner in scene['winners']:
        for kind, who in (('complete', complete), ('within', within)):
            here, won = f'{folder}: {scene["scene"]}, {winner["mix"]}, {kind}', winner[kind]
            order = sorted((sum(share * median(frames[t, k]) for k, share in winner['share'].items() if share), i, t)
                           for i, t in enumerate(who))
            if not order or won is None:
                tally.same('motion winners', here, won, None if not order else order[0][2])
                continue
            mixed = lambda t: [sum(x) for x in zip(*([share * v for v in frames[t, k]]
                                                     for k, share in winner['share'].items() if share))]
            anew = {'method': order[0][2], 'ms': order[0][0], 'runner_up': order[1][2] if len(order) > 1 else None,
                    'ties': []}
            for _, _, t in order[1:]:
                value, (low, high, _) = ratio(mixed(t), mixed(order[0][2]))
                differs = low is not None and (low > 1 or high < 1) and max(value, 1 / value) - 1 > (
                    math.inf if scene['noise_bar'] is None else scene['noise_bar'])
                if value < 1 or not differs:
                    anew['ties'].append(t)
            tally.same('motion winners', here, {k: won[k] for k in anew}, anew)
    rest = {m['text']: m['at_rest'] for m in scene['methods'] if m['text'] in complete}
    ms = lambda text, *phases: sum(rest[text][p]['median'] for p in phases)
    noise, pairs = 1 + (math.inf if scene['noise_bar'] is None else scene['noise_bar']), []
    for slow in complete if noise <= 1 + MOST_NOISE else ():
        for fast in complete:
            start, frame = [tuple(ms(t, *phases) for t in (slow, fast)) for phases in (PHASES[:2], PHASES[2:])]
            if start[0] > start[1] * noise and frame[1] > frame[0] * noise:
                setup, saves = start[0] - start[1], frame[1] - frame[0]
                each = [math.ceil(setup / saves)]
                a, b = ([rest[t][p]['samples'] for p in PHASES] for t in (slow, fast))
                for (b1, a1, l1, v1), (b2, a2, l2, v2) in zip(zip(*a), zip(*b)):
                    shorter = l2 + v2 - l1 - v1
                    each.append(max(0, math.ceil((b1 + a1 - b2 - a2) / shorter)) if shorter > 0 else math.inf)
                pairs.append({'method': slow, 'over': fast, 'setup_ms': setup, 'saves_ms': saves, 'frames': each[0],
                              'rounds': [None if math.isinf(n) else n for n in (min(each), max(each))]})
    tally.same('motion break-even', f'{folder}: {scene["scene"]}, pairs', len(scene['break_even']), len(pairs))
    tally.same('motion break-even', f'{folder}: {scene["scene"]}', scene['break_even'], pairs, 1e-6)


def summed(folder, record, tally):
    """results.json of energy: faces.csv holds what its objects are sums of."""
    faces, path = {}, os.path.join(folder, 'faces.csv')
    if os.path.isfile(path):
        with open(path, newline='', encoding='utf-8') as f:
            for row in csv.DictReader(f):
                faces.setdefault((row['scene'], row['object']), []).append(row)
    for frame in record['frames']:
        for o in frame['objects']:
            where = f'{folder}: energy of {frame["scene"]}, {o["name"]}'
            for side in filter(None, (o, o.get('back'))):
                tally.same('energy', f'{where}.fraction', side['fraction'], side['irradiance'] / side['unshadowed']
                        if side['unshadowed'] else None)
            rows = [r for r in faces.get((frame['scene'], o['name']), ()) if r['irradiance']]
            total = sum(float(r['area']) for r in rows)
            if rows and o['coverage'] == 1 and 'irradiance_r' in rows[0]:
                tally.same('energy', f'{where}.irradiance_rgb', o['irradiance_rgb'], [
                    sum(float(r['area']) * float(r[f'irradiance_{c}']) for r in rows) / total for c in 'rgb'], 2e-5)
            if rows and o['coverage'] == 1:
                tally.same('energy', where, {k: o[k] for k in ('irradiance', 'unshadowed')}, {
                    k: sum(float(r['area']) * float(r[k]) for r in rows) / total for k in ('irradiance',
                            'unshadowed')}, 2e-5)
                tally.same('energy', f'{where}.area', o['area'], total, 2e-5)
    if len(record['frames']) == 1:
        tally.same('energy', f'{folder}: energy, mean', record['mean'], record['frames'][0]['objects'])


# Pages.

def labels(methods):
    """What pages call the settings: the title, with the settings that are not the defaults."""
    texts = Counter(m['text'] for m in methods)
    found = {}
    for m in methods:
        title, settings = m['title'] or m['name'].replace('_', ' '), m['text'].partition(':')[2]
        if texts[m['text']] == 1:
            found[f'{title} ({settings})' if settings else title] = m
    return found


def medians(key):
    return lambda m, e: [('ms', m['times'][key]['median'])] + (
        [('ms', m['times'][key]['min']), ('ms', m['times'][key]['max'])]
                if m['times'][key]['min'] != m['times'][key]['max'] else [])


def total_of(*phases):
    return lambda m, e: [('ms', sum(m['times'][p]['median'] for p in phases))]


def of_error(path, unit):
    return lambda m, e: [(unit, at(e, path))]


def edge(name):
    def found(m, e):
        whole = e['edge_displacement_px'] and whole_edge(e['edge_displacement_px'], name)
        return [('score', None)] if not whole else [('score', whole[0], whole[1])]
    return found


def image(name, unit='score'):
    def found(m, e):
        value = (m.get('image') or {}).get(name)
        return [(unit, math.inf if value is None and name == 'psnr' else value)]
    return found


COVERAGE = lambda m, e: [('percent', m['coverage'])]
MEMORY = lambda m, e: [('score', m['memory_bytes'] / 2**20 if m.get('memory_bytes') is not None else None)]
COLUMNS = {
    'False shadow / Interior': of_error('false_shadow.interior', 'count'),
            'False shadow / Edge band': of_error('false_shadow.edge', 'count'),
    'False shadow / Acne': of_error('false_shadow.acne', 'count'),
    'False light / Interior': of_error('false_light.interior', 'count'),
    'False light / Edge band': of_error('false_light.edge', 'count'),
    'False light / Detachment': of_error('false_light.detachment', 'count'),
    'False light / Leak': of_error('false_light.leak', 'count'), 'MAE': of_error('mae', 'score'),
    'RMSE': of_error('rmse', 'score'),
    'Max': of_error('max', 'score'), 'Bias': of_error('bias', 'score'), 'Points': of_error('points', 'count'),
    'Coverage of all lights, %': COVERAGE,
    'Wrong in the interior, points / Lit': of_error('interior.lit', 'count'),
    'Wrong in the interior, points / Penumbra': of_error('interior.penumbra', 'count'),
    'Wrong in the interior, points / Umbra': of_error('interior.umbra', 'count'),
    'At the terminator, points / Triangle away': of_error('terminator.facet_away', 'count'),
    'At the terminator, points / Normal away': of_error('terminator.normal_away', 'count'),
    'At the terminator, points / Wrong': of_error('terminator.wrong', 'count'),
    'Edge displacement, pixels / Mean': edge('mean'),
    'Edge displacement, pixels / 95 %': edge('p95'), 'Edge displacement, pixels / Max': edge('max'),
    'Edge displacement, pixels / Unmatched': of_error('edge_displacement_px.unmatched', 'count'),
    'Penumbra width, pixels / Method': of_error('penumbra_width_px.method', 'score'),
    'Penumbra width, pixels / Reference': of_error('penumbra_width_px.reference', 'score'),
    'Sampling, RMSE of S / Noise': of_error('noise.noise_rmse', 'score'),
    'Sampling, RMSE of S / Bias': of_error('noise.bias_rmse', 'score'),
    'Reference, ± S': of_error('bracket.max_half_width', 'score'), 'Lit': of_error('lit', 'count'),
    'Umbra': of_error('umbra', 'count'),
    'Penumbra': of_error('penumbra', 'count'), 'Undefined': of_error('undefined', 'count'),
    'On the boundary': of_error('on_boundary', 'count'), 'Not in the sample': of_error('not_judged', 'count'),
    'Facing away': of_error('away', 'count'), 'Unshadowed': lambda m, e: [('count',
    e.get('unshadowed', 0))]}
OF_METHODS = {
    'Phase, ms / Build': medians('build_ms'), 'Phase, ms / Aim': medians('aim_ms'),
            'Phase, ms / Look': medians('look_ms'),
    'Phase, ms / Visibility': medians('visibility_ms'), 'What moved, ms / Object': total_of(*PHASES),
    'What moved, ms / Light': total_of('aim_ms', 'visibility_ms'), 'What moved, ms / Camera': total_of('look_ms',
    'visibility_ms'),
    'Memory, MiB': MEMORY, 'Coverage, %': COVERAGE, 'RMSE': image('rmse'), 'PSNR, dB': image('psnr', 'db'),
    'SSIM': image('ssim', 'fixed'),
    'FLIP, mean': image('flip')}


def cell(kind, where, text, figures, tally):
    """A cell of one figure, or of a median with its range."""
    texts = text.replace('< 0.001', '<0.001').replace('≥ ', '≥').replace('< 0.1', '<0.1').replace('> 99.9', '>99.9')
    parts = [p for piece in texts.split(' ') for p in (piece.split('–') if piece != NONE else [piece])] or ['']
    parts = [p.replace('<', '< ').replace('≥', '≥ ').replace('>', '> ') for p in parts]
    if len(parts) != len(figures):
        tally.fault(where, f'"{text}" holds {len(parts)} figures, the record {len(figures)}')
        return
    for part, figure in zip(parts, figures):
        unit, value, at_least = (*figure, False)[:3]
        if unit in ('db', 'fixed') and value is not None and not math.isinf(value):
            read = number(part)
            tally.figures[kind] += 1
            if not read or abs(read[0] - value) > read[1] * (1 + 1e-9):
                tally.fault(where, f'"{part}" is shown, the record says {value}')
        else:
            tally.shown(kind, where, part, value, unit, at_least)


def fixed_rows(kind, page, rows, expected, tally):
    """Rows of a table must be these, in this order."""
    if rows != expected:
        tally.fault(page, f'a table has the rows {rows}, the record {expected}')
    tally.figures[kind] += len(expected)


def scene_page(page, record, tally):
    kind, known = 'scene pages', labels(record['methods'])
    label_of = {id(m): l for l, m in known.items()}
    reference = record['reference']['text']
    judged = [m for m in record['methods'] if m.get('errors') and m['text'] != reference]
    lights = [l['name'] for l in record['lights']]
    by_light = [(l, label_of.get(id(m))) for l in lights for m in judged]
    found = Counter()
    for heads, rows in tables(page):
        of_lights = all(h in COLUMNS for h in heads[1:])
        if heads[:1] == ['Method'] and of_lights and any(len(r) == 1 for r in rows):
            light, got = None, []
            found['errors'] += 1
            for row in rows:
                if len(row) == 1:
                    light = row[0][0]
                    continue
                label = row[0][0]
                got.append((light, label))
                method = known.get(label)
                error = method and next((e for e in method.get('errors', ()) if e['light'] == light), None)
                if not error:
                    tally.fault(page, f'a row of "{label}" under {light}, which the record does not have')
                    continue
                if len(row) != len(heads):
                    tally.fault(page, f'{len(row)} cells of {label} under {len(heads)} heads')
                for head, (text, _) in zip(heads[1:], row[1:]):
                    cell(kind, f'{page}: {light}, {label}, {head}', text, COLUMNS[head](method, error), tally)
            fixed_rows(kind, page, got, by_light, tally)
        elif heads[:1] == ['Method'] and len(heads) > 4 and all(h in OF_METHODS for h in heads[1:]):
            times = 'Memory, MiB' in heads
            found['times' if times else 'pictures'] += 1
            got = []
            for row in rows:
                method = known.get(row[0][0])
                got.append(row[0][0])
                if not method:
                    tally.fault(page, f'a row of "{row[0][0]}", which the record does not have')
                    continue
                for head, (text, _) in zip(heads[1:], row[1:]):
                    cell(kind, f'{page}: {row[0][0]}, {head}', text, OF_METHODS[head](method, None), tally)
            who = [m for m in record['methods'] if ran(m)] if times else [m for m in judged if m.get('image')]
            fixed_rows(kind, page, got, [label_of.get(id(m)) for m in who], tally)
        elif heads == ['Method', 'S', 'Difference', 'Class']:
            if rows:  # a script fills it, from values.js
                tally.fault(page, 'values under the cursor that nobody asked for')
        elif heads == ['Method', 'Object', 'Light', 'Camera']:
            found['ratios'] += 1
            ratios(page, record, known, rows, tally)
        elif heads == ['Method', 'Light', 'Aim', 'Visibility']:
            found['times of lights'] += 1
            got = []
            for row in rows:
                method = known.get(row[0][0])
                t = method and next((t for t in method['light_times'] if t['light'] == row[1][0]), None)
                got.append((row[0][0], row[1][0]))
                if t:
                    for key, (text, _) in zip(('aim_ms', 'visibility_ms'), row[2:]):
                        cell(kind, f'{page}: {row[0][0]}, {row[1][0]}, {key}', text, medians(key)({'times': t}, None),
                                tally)
            fixed_rows(kind, page, got, [(label_of.get(id(m)), l) for m in record['methods'] if ran(m)
                    for l in lights], tally)
        elif heads[:4] == ['Method', 'Serves', 'Why', 'Parameters']:
            for row in rows:
                method = known.get(row[0][0])
                if not method:
                    tally.fault(page, f'a row of "{row[0][0]}", which the record does not have')
                    continue
                tally.text(kind, f'{page}: {row[0][0]}, serves', row[1][0].replace(' ', '_'),
                           {'not': 'not_served'}.get(method['serves']['how'], method['serves']['how']))
                written = dict(p.partition('=')[::2] for p in row[3][0].split() if '=' in p)
                for key, value in method['parameters'].items():
                    shown_value = str(value).lower() if isinstance(value, bool) else str(value)
                    tally.figures[kind] += 1
                    if written.get(key) != shown_value and not (number(written.get(key, '')) and isinstance(value,
                            (int, float))
                                                                and float(written[key]) == value):
                        tally.fault(f'{page}: {row[0][0]}',
                                f'{key} is shown as {written.get(key)}, the record says {value}')
        elif heads[:1] == ['Object']:
            objects = {o['name']: o for o in record['facts']['objects']}
            for row in rows:
                o, of = objects.get(row[0][0]), dict(zip(heads, (t for t, _ in row)))
                if not o:
                    tally.fault(page, f'an object "{row[0][0]}", which the record does not have')
                    continue
                for head, unit, value in (('Triangles', 'count', o['triangles']), ('Vertices', 'count', o['vertices']),
                                          ('Parts', 'count', o['components']), ('Area, units²', 'score', o['area']),
                                          ('Volume, units³', 'score', o['volume'] if o['closed'] else None)):
                    cell(kind, f'{page}: {row[0][0]}, {head}', of.get(head, ''), [(unit, value)], tally)
        else:
            tally.fault(page, f'a table whose heads are not known: {heads}')
    if judged and found['errors'] < 3:
        tally.fault(page, f'{found["errors"]} tables of errors in place of 3')
    if any(ran(m) for m in record['methods']) and not found['times']:
        tally.fault(page, 'no table of times')


def rounds(method):
    t = method['times']
    each = list(zip(*(t[p]['samples'] for p in PHASES))) if t['visibility_ms'].get('samples') else []
    return {'Object': [b + a + l + v for b, a, l, v in each], 'Light': [a + v for _, a, _, v in each],
            'Camera': [l + v for _, _, l, v in each]}


def ratios(page, record, known, rows, tally):
    kind = 'ratios of pages'
    who = {l: rounds(m) for l, m in known.items() if ran(m)}
    control, same = record['turns'].get('control'), {}
    if control:
        of = next(m for m in record['methods'] if m['text'] == control['text'])
        same = {k: ratio(rounds({'times': control['again']})[k], rounds(of)[k]) for k in ('Object', 'Light', 'Camera')}
    for k, movement in enumerate(('Object', 'Light', 'Camera')):
        times = {l: w[movement] for l, w in who.items() if w[movement]}
        if not times:
            continue
        fastest = min(times, key=lambda l: median(times[l]))
        _, (low, high, _) = same.get(movement, (1, (None, None, 0)))
        bar = None if low is None else max(0.0, high - 1, 1 / low - 1)
        for row in rows:
            label, text = row[0][0], row[1 + k][0]
            if label not in times:
                continue
            tally.figures[kind] += 1
            where = f'{page}: {label}, {movement}'
            if (text == 'fastest') != (label == fastest):
                tally.fault(where, f'"{text}", the fastest is {fastest}')
            elif text.startswith('×'):
                value, (low, high, coverage) = ratio(times[label], times[fastest])
                if text.endswith('one run'):
                    value = median(times[label]) / median(times[fastest])
                given = re.findall(r'[\d.]+', text)
                right = [value] + ([low, high] if '(' in text else [])
                for g, r in zip(given, right):
                    tally.figures[kind] += 1
                    if not shows(g, r):
                        tally.fault(where, f'"{text}": {g} is shown, {r} is right')
                if '%' in text and abs(float(given[-1]) - 100 * coverage) > 0.0500001:
                    tally.fault(where, f'"{text}": the interval holds the median in {100 * coverage} %')
                if '(' in text and not ((low > 1 or high < 1) and bar is not None and max(value, 1 / value) - 1 > bar):
                    tally.fault(where, f'"{text}": the interval does not exclude 1, or the noise bar of {bar} is above')
            elif text == 'no difference':
                value, (low, high, _) = ratio(times[label], times[fastest])
                if low is not None and bar is not None and (low > 1 or high < 1) and max(value, 1 / value) - 1 > bar:
                    tally.fault(where, f'"{text}", the ratio is {value} ({low} to {high}), the noise bar {bar}')
            elif text != 'fastest':
                tally.fault(where, f'"{text}" is no ratio')


def star_of_index(page, records, tally):
    """What the finder of the cheapest methods reads of a row: the noise of its times, and whether it ranks nothing."""
    with open(page, encoding='utf-8') as f:
        rows = re.findall(r'<tr data-noise="([^"]*)"( data-loud)?><th[^>]*><a[^>]*>([^<]*)</a>', f.read())
    of = {html.unescape(title): (noise, bool(loud)) for noise, loud, title in rows}
    for r in records:
        turns = r.get('turns')
        bar = turns and (math.inf if turns['noise_bar'] is None else turns['noise_bar'])
        noise, loud = of.get(r['scene']['title'], (None, None))
        tally.same('index', f'{page}: {r["scene"]["title"]}, noise', [float(noise) if noise else noise, loud],
                   [bar if turns else '', bool(turns) and bar > MOST_NOISE])


def index_page(page, records, tally):
    kind = 'index'
    star_of_index(page, records, tally)
    for heads, rows in tables(page):
        if heads[:1] != ['Scene'] or not all(' / ' in h for h in heads[1:]):
            continue
        every = {}
        for r in records:
            for m in r['methods']:
                every.setdefault((m['name'], m['text'], json.dumps(m['parameters'], sort_keys=True)), m)
        known = labels(list(every.values()))
        shown = [h.rsplit(' / ', 1)[0] for h in heads[1:]]
        if set(shown) != set(known):
            tally.fault(page, f'columns of {sorted(set(shown))}, the records have {sorted(known)}')
        titles = {r['scene']['title']: r for r in records}
        if sorted(row[0][0] for row in rows) != sorted(titles):
            tally.fault(page, f'rows of {[row[0][0] for row in rows]}, the records are of {sorted(titles)}')
        for row in rows:
            record = titles.get(row[0][0])
            if not record:
                continue
            if len(row) != len(heads):
                tally.fault(page, f'{len(row)} cells of {row[0][0]} under {len(heads)} heads')
                continue
            for head, (text, a) in zip(heads[1:], row[1:]):
                label, column = head.rsplit(' / ', 1)
                text_of = known.get(label, {}).get('text')
                method = next((m for m in record['methods'] if m['text'] == text_of), None)
                where = f'{page}: {row[0][0]}, {head}'
                if method is None or not ran(method):
                    tally.figures[kind] += 1
                    if any(ch.isdigit() for ch in text) and method is None:
                        tally.fault(where, f'"{text}" of a setting that was not run')
                    continue
                e = method['errors']
                if method['text'] == record['reference']['text'] and not number(text.split(' ')[0]):
                    continue
                n = sum(x['points'] for x in e)
                sums = lambda member: sum((x[g][member] or 0) for x in e for g in ('false_shadow', 'false_light'))
                mae = sum((x['mae'] or 0) * x['points'] for x in e) / n if n else None
                ms = sum(method['times'][p]['median'] for p in PHASES)
                if column == 'Interior, points':
                    part = text.partition(' on ')
                    tally.shown(kind, where, part[0], sums('interior'), 'count') if n else tally.text(kind, where,
                            part[0], 'not judged')
                    tally.shown(kind, f'{where}: coverage', part[2].rstrip(' %') if part[1] else '100',
                            method['coverage'], 'percent')
                elif column == 'Edge, points':
                    tally.shown(kind, where, text, sums('edge') if n else None, 'count')
                elif column == 'MAE of S':
                    tally.shown(kind, where, text, mae)
                elif column == 'Time, ms':
                    tally.shown(kind, where, text, ms, 'ms')
                    for key, value in (('data-mae', mae), ('data-ms', ms), ('data-cover', method['coverage']),
                                       ('data-interior', sums('interior') if n else None)):
                        if key in a:
                            tally.same(kind, f'{where}, {key}', float(a[key]) if a[key] else None, value)
                else:
                    tally.fault(where, 'a head that is not known')


def score(value):
    """As pages write a figure: three digits."""
    if value == 0:
        return '0'
    exponent = math.floor(math.log10(abs(value)))
    if -4 <= exponent < 6:
        return f'{value:.{max(0, 2 - exponent)}f}'
    factor, power = f'{value:.1e}'.split('e')
    return f'{factor}·10{str(int(power)).translate(str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻"))}'


def noise_of(record):
    turns = record['sweep']['turns']
    if not turns:
        return 0.0
    return math.inf if turns['noise_bar'] is None else turns['noise_bar']


def in_trade(record, name):
    """Settings that take part, those of errors that may be larger among them: [(setting, cost, error, at least)]."""
    return [(s, s['cost_ms'], max(v['metrics'][name] for v in s['views']),
             any(name in v.get('at_least', ()) for v in s['views'])) for s in record['sweep']['settings']
            if s['excluded'] is None and s['cost_ms'] is not None and s['views']
            and None not in [v['metrics'][name] for v in s['views']]]


def staircase(record, name):
    """The sentence of a scene."""
    noise, of = noise_of(record), in_trade(record, name)
    if noise > MOST_NOISE:
        return ('Not ranked: times vary by more than 30 %, or are of fewer than six rounds: too much to say which setting is '
                'the cheapest.')
    steps = sorted((x for x in of if not any(c <= x[1] and e <= x[2] and (c < x[1] or e < x[2]) for _, c, e, _ in of)),
                   key=lambda x: x[1])
    if not steps:
        return 'No setting was both timed and compared.'
    same = lambda x: [s['title'] for s, c, e, _ in of if s['name'] != x[0]['name'] and e <= x[2]
                      and c <= x[1] * (1 + noise)]
    others = lambda titles: f' (as cheap, as far as noise tells: {", ".join(dict.fromkeys(titles))})' if titles else ''
    flights, before, exact = [], None, None
    for x in steps:
        if x[2] == 0:
            exact = exact or x
        elif not before or x[2] != before[2]:
            if not flights or flights[-1][0] != x[0]['title']:
                flights.append([x[0]['title'], x, []])
            flights[-1][1], before = x, x
            flights[-1][2] += same(x)
    if not before:
        label = exact[0]['text'].partition(':')[2] or 'defaults'
        return f'{exact[0]["title"]} ({label}){others(same(exact))} is the cheapest and its error is exactly 0.'
    words = '; below that down to '.join(f'{"at least " if x[3] else ""}{score(x[2])}: {title}{others(cheap)}'
                                         for title, x, cheap in flights)
    words = 'Cheapest down to an error of ' + words
    if not exact:
        return words + '; no setting has a smaller error.'
    apart = exact[1] > before[1] * (1 + noise)
    return f'{words}; exactly 0: {exact[0]["title"]}{others(same(exact))}, at ' + (
        f'{score(exact[1] / before[1])} times the cost of the step before.' if apart else
        'a cost that noise does not tell from that of the step before.')


def findings(page, records, name, tally):
    kind = 'trade findings'
    with open(page, encoding='utf-8') as f:
        text = f.read()
    plain = lambda t: html.unescape(re.sub(r'<[^>]*>', '', t)).strip()
    for which, found in (
            ('finding', [plain(t) for t in re.findall(r'<p class="finding">(.*?)</p>', text, re.S)]),
            ('list', [plain(t) for block in re.findall(r'<dl class="facts findings">(.*?)</dl>', text, re.S)
                      for t in re.findall(r'<dd>(.*?)</dd>', block, re.S)])):
        right = [staircase(r, name) for r in records]
        tally.figures[kind] += len(right)
        shown = [t.partition(': ')[2] if t.startswith('RMSE of S: ') else t for t in found]
        for a in shown:
            if a not in right:
                tally.fault(f'{page}: {which}', f'"{a}" is shown, the records say {right}')
        if len(shown) != len(right):
            tally.fault(f'{page}: {which}', f'{len(shown)} sentences, {len(right)} scenes')


def fixed_errors(page, records, name, tally):
    kind, most = 'trade at fixed errors', ['0.1', '0.03', '0.01', '0.003', '0.001', 'exactly 0']
    found = [t for t in headed(page) if t[1][:1] == ['Error at most']]
    quiet = {r['scene']['title']: r for r in records if noise_of(r) <= MOST_NOISE and in_trade(r, name)}
    solved = any(x[2] <= 0.1 for r in quiet.values() for x in in_trade(r, name))
    if len(found) != (1 if solved else 0):
        tally.fault(page, f'{len(found)} tables of fixed errors')
        return
    ratios, group = {}, None
    for _, heads, rows in found:
        for row in rows:
            if len(row) == 1:
                group = row[0][0]
                if group != 'Geometric mean over scenes' and group not in quiet:
                    tally.fault(page, f'a group "{group}", scenes that are ranked are {sorted(quiet)}')
                continue
            if row[0][0] not in most or (group not in quiet and group != 'Geometric mean over scenes'):
                tally.fault(page, f'a row "{row[0][0]}" of "{group}"')
                continue
            limit = 0.0 if row[0][0] == 'exactly 0' else float(row[0][0])
            for title, (text, a) in zip(heads[1:], row[1:]):
                where = f'{page}: {group}, at most {row[0][0]}, {title}'
                if group in quiet:
                    of = [x for x in in_trade(quiet[group], name) if x[2] <= limit]
                    mine = [x for x in of if x[0]['title'] == title]
                    if not mine:
                        left = [s['coverage'] for s in quiet[group]['sweep']['settings'] if s['title'] == title
                                and s['excluded'] and (s.get('coverage') or 1) < 1
                                and all(v['metrics'][name] is not None and v['metrics'][name] <= limit
                                        for v in s['views'] if 'errors' in v) and s['views']]
                        part = text.removeprefix(NONE).strip().removeprefix('covers ').removesuffix(' %')
                        tally.shown(kind, where, part, max(left, default=None), 'percent')
                        continue
                    best, least = min(mine, key=lambda x: x[1]), min(x[1] for x in of)
                    label = best[0]['text'].partition(':')[2] or 'defaults'
                    first, _, rest = text.partition(' ')
                    tally.shown(kind, where, first, best[1] / least)
                    tally.text(kind, where, rest.rpartition(' ms')[0].rpartition(' ')[0].removesuffix(' <'), label)
                    tally.shown(kind, where, rest.removeprefix(label).removesuffix(' ms').strip(), best[1], 'ms')
                    marked = 'cheapest' in a.get('class', '').split()
                    if marked != (best[1] <= least * (1 + noise_of(quiet[group]))):
                        tally.fault(where, f'{"" if marked else "not "}marked as the cheapest')
                    ratios.setdefault((limit, title), []).append(best[1] / least)
                else:
                    of = ratios.get((limit, title), [])
                    scenes = sum(any(x[2] <= limit for x in in_trade(r, name)) for r in quiet.values())
                    first, _, rest = text.partition(' ')
                    tally.shown(kind, where, first, math.exp(sum(map(math.log, of)) / len(of)) if of else None)
                    tally.text(kind, where, rest,
                               f'{len(of)} of {scenes} scene{"" if scenes == 1 else "s"}' if of else '')


def trade_page(page, records, tally):
    kind = 'trade pages'
    titles = {'RMSE of S': 'rmse', 'MAE of S': 'mae', 'Wrong interior points, fraction': 'interior',
              'Edge displacement (95 %), pixels': 'edge_displacement_px.p95', 'FLIP of the picture, mean': 'flip'}
    found = [t for t in headed(page) if t[1][:1] == ['Setting']]
    by_title = {r['scene']['title']: r for r in records}
    if len(found) != len(records):
        tally.fault(page, f'{len(found)} tables of settings, {len(records)} scenes')
    for heading, heads, rows in found:
        record = by_title.get(max((t for t in by_title if (heading + ' ').startswith(t + ' ')), key=len, default=None))
        if record is None:
            tally.fault(page, f'a section "{heading}", the scenes are {sorted(by_title)}')
            continue
        settings = {s['text']: s for s in record['sweep']['settings']}
        got = set()
        for row in rows:
            text = row[0][0].split(' ')[0]
            s = settings.get(text)
            got.add(text)
            if not s or not s.get('times'):
                if not s:
                    tally.fault(page, f'a setting "{text}", which the record does not have')
                continue
            for head, (shown, _) in zip(heads[1:], row[1:]):
                where, (title, _, column) = f'{page}: {text}, {head}', head.partition(' / ')
                if head == 'Cost, ms':
                    tally.figures[kind] += 1
                    first = shown.split(' ')[0] if not shown.startswith('<') else '< 0.001'
                    if not shows(first, s['cost_ms'], 'ms') and not shows(first, median(costs(s,
                            record['sweep']['workload'])[1]), 'ms'):
                        tally.fault(where, f'"{shown}" is shown, the record says {s["cost_ms"]}')
                elif head == 'Memory, MiB':
                    cell(kind, where, shown, [('score', s['memory_bytes'] / 2**20)], tally)
                elif head == 'Coverage, %':
                    cell(kind, where, shown, [('percent', s['coverage'])], tally)
                elif title in titles:
                    name = titles[title]
                    least = any((pooled(v, name) or (0, False))[1] for v in s['views']
                            if 'errors' in v) if name not in ENTRIES else False
                    if column == 'Worst view':
                        cell(kind, where, shown, [('score', s['values'][name], least)], tally)
                    elif column == 'Bound':
                        cell(kind, where, shown, [('score', s['bounds'][name])], tally)
                    elif column == 'Front':
                        tally.figures[kind] += 1
                        on = front(record['sweep']['settings'], name) if noise_of(record) <= MOST_NOISE else []
                        if shown != (str(on.index(text) + 1) if text in on else ''):
                            tally.fault(where, f'"{shown}" is shown, the front is {on}')
                    else:
                        tally.fault(where, 'a head that is not known')
                else:
                    tally.fault(where, 'a head that is not known')
        if got != set(settings):
            tally.fault(page, f'settings {sorted(got)}, the record has {sorted(settings)}')
    findings(page, records, 'rmse', tally)
    fixed_errors(page, records, 'rmse', tally)


def motion_page(page, record, tally):
    kind = 'motion pages'
    of_methods = [t for t in headed(page) if t[1][:1] == ['Method'] and len(t[1]) == 14]
    of_winners = [t for t in headed(page) if t[1][:1] == ['What moves']]
    for found in (of_methods, of_winners):
        if [heading for heading, _, _ in found] != [scene['title'] for scene in record['motion']]:
            tally.fault(page, f'tables of {[heading for heading, _, _ in found]}')
    of_pairs = [t for t in headed(page) if t[1][:2] == ['Method', 'over']]
    with_pairs = [scene for scene in record['motion'] if scene['break_even']]
    if [heading for heading, _, _ in of_pairs] != [scene['title'] for scene in with_pairs]:
        tally.fault(page, f'tables of break-even of {[heading for heading, _, _ in of_pairs]}')
    for (_, _, rows), scene in zip(of_pairs, with_pairs):
        fixed_rows('motion break-even', page, [(r[0][0], r[1][0]) for r in rows],
                   [(p['method'], p['over']) for p in scene['break_even']], tally)
        for row, p in zip(rows, scene['break_even']):
            where, texts = f'{page}: {p["method"]} over {p["over"]}', [t for t, _ in row[2:]]
            for text, value, unit in ((texts[0], p['setup_ms'], 'ms'), (texts[1], p['saves_ms'], 'ms'),
                                      (texts[2], p['frames'], 'count')):
                tally.shown('motion break-even', where, text, value, unit)
            least, most = ('never' if n is None else f'{n:.0f}' for n in p['rounds'])
            tally.text('motion break-even', f'{where}, rounds', texts[3].replace('\u202f', ''),
                       '' if least == most else f'{least} to {most}')
    if len(of_methods) != len(record['motion']) or len(of_winners) != len(record['motion']):
        tally.fault(page, f'{len(of_methods)} and {len(of_winners)} tables of {len(record["motion"])} scenes')
    for (_, heads, rows), (_, _, won), scene in zip(of_methods, of_winners, record['motion']):
        known, got = {m['text']: m for m in scene['methods']}, set()
        for row in rows:
            m = known.get(row[0][0].split(' ')[0])
            got.add(row[0][0].split(' ')[0])
            if not m:
                tally.fault(page, f'a method "{row[0][0]}", which the record does not have')
                continue
            if not m.get('movements'):
                continue
            for head, (text, _) in zip(heads[1:], row[1:]):
                where, (group, _, column) = f'{page}: {m["text"]}, {head}', head.partition(' / ')
                column = column.split(',')[0]
                if group.startswith('at rest'):
                    cell(kind, where, text, [('ms', m['at_rest'][column + '_ms']['median'])], tally)
                    continue
                of, first = m['movements'][group.split(' ')[0]], re.match(r'[^ a-z(]*', text)[0]
                if not of:
                    continue
                if column == 'ms':
                    tally.shown(kind, where, first, of['median_ms'], 'ms')
                elif column.endswith('model'):
                    tally.shown(kind, where, first, of['frame_over_model']['median'])
                elif column.startswith('RMSE'):
                    tally.shown(kind, where, first, of['worst_rmse'])
                    answered = sum(f['points'] for f in of['frames'])
                    asked = answered + sum(f['undefined'] for f in of['frames'])
                    part = re.search(r'of (.*) % of the points', text)
                    tally.shown(f'{kind}', f'{where}: coverage', part[1] if part else '100',
                                answered / asked if asked else 1.0, 'percent')
                else:
                    tally.fault(where, 'a head that is not known')
        fixed_rows(kind, page, sorted(got), sorted(known), tally)
        mixes = {w['mix']: w for w in scene['winners']}
        for row in won:
            w, x = mixes.get(row[0][0]), 1
            if not w:
                tally.fault(page, f'a mix "{row[0][0]}", which the record does not have')
                continue
            for which in ('complete', 'within'):
                where, of = f'{page}: {row[0][0]}, {which}', w[which]
                texts = [t for t, _ in row[x:x + 4]]
                x += 4
                if of is None or scene['noise_bar'] is None or scene['noise_bar'] > MOST_NOISE:
                    tally.text(kind, where, texts[0], 'none' if of is None else 'not ranked')
                    continue
                tally.text(kind, where, texts[0], of['method'])
                tally.shown(kind, where, texts[1], of['ms'], 'ms')
                tally.text(kind, where, ' '.join(texts[2].replace(',', ' ').split()), ' '.join(of['ties']))
                if of['runner_up'] and of['runner_up'] not in texts[3] and of['runner_up'] not in of['ties']:
                    tally.fault(where, f'"{texts[3]}" is shown as the next, {of["runner_up"]} is')


def rung_text(value):
    if value == 0 or 0.999e-3 <= value < 1e4:
        return f'{value:g}'
    factor, power = f'{value:.2e}'.split('e')
    factor = '' if float(factor) == 1 else f'{float(factor):g}·'
    return f'{factor}10{str(int(power)).translate(str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻"))}'


def fared(ladder, m):
    """What a cell says of a method: the rung, the kind, and what it leaves out."""
    notes, first = [], ladder['rungs'][0]['value']
    for key, words in (('not_served_from', 'not served'), ('silent_from', 'mostly undefined'),
                       ('not_judged_from', 'not judged')):
        if m[key] is not None:
            notes.append(words if m[key] == first else f'{words} from {rung_text(m[key])}')
    if m['breaks_at'] is not None:
        return ' '.join([rung_text(m['breaks_at']), m['kind'], ', '.join(notes)]).strip()
    holds, rungs = not notes, len(ladder['rungs']) + ladder['not_climbed']
    if 'judged_rungs' in m and holds and m['judged_rungs'] < rungs:
        notes.append(f'judged on {m["judged_rungs"]} of {rungs} rungs')
    if m.get('judged_rungs') and m['least_coverage'] < 1:
        tenths = round(1000 * m['least_coverage']) / 10
        shown = '< 0.1' if tenths == 0 < m['least_coverage'] else '> 99.9' if tenths == 100 else f'{tenths:g}'
        notes.append(f'answers {shown} % of the points' + (' or more' if m['judged_rungs'] > 1 else ''))
    return ' '.join(filter(None, ['holds' if holds else '', ', '.join(notes)]))


def ladder_page(page, record, tally):
    kind = 'ladder pages'
    by_title = {l['title']: l for l in record['ladders']}
    label = lambda m: (m['title'] if m['text'] == m['name'] else f'{m["title"]}, {m["preset"]}' if m['preset']
                       else m['text'])
    overview = 0
    for heading, heads, rows in headed(page):
        if heads[:2] == ['Ladder', 'Rungs']:
            overview += 1
            fixed_rows(kind, page, [r[0][0] for r in rows], [l['title'] for l in record['ladders']], tally)
            for row in rows:
                ladder = by_title.get(row[0][0])
                if not ladder:
                    continue
                judged = [r['value'] for r in ladder['rungs'] if 'unjudged' not in r]
                tally.text(kind, f'{page}: {row[0][0]}, rungs', row[1][0].removesuffix(ladder['unit']).strip(),
                           f'{rung_text(judged[0])} to {rung_text(judged[-1])}' if judged else 'not judged')
                of = {label(m): m for m in ladder['methods']}
                for head, (text, _) in zip(heads[2:], row[2:]):
                    m = of.get(head)
                    tally.text(kind, f'{page}: {row[0][0]}, {head}', text, fared(ladder, m) if m else 'not run')
        elif heads[:3] == ['Rung', 'lit', 'in shadow']:
            ladder = next((l for l in record['ladders'] if heading == f'{l["title"]} {l["name"]}'), None)
            if not ladder:
                tally.fault(page, f'a section "{heading}", which the record does not have')
                continue
            fixed_rows(kind, page, [r[0][0] for r in rows], [rung_text(r['value']) for r in ladder['rungs']], tally)
            for row, rung in zip(rows, ladder['rungs']):
                where = f'{page}: {ladder["name"]}, {row[0][0]}'
                tally.shown(kind, where, row[1][0], rung['interior_lit'], 'count')
                tally.shown(kind, where, row[2][0], rung['interior_shadow'], 'count')
                tally.text(kind, where, row[3][0], rung.get('unjudged', ''))
        elif heads[:2] == ['Method', 'Textbook form']:
            for row in rows:
                pairs = [(t, m) for l in record['ladders'] for t in l['methods'] for m in l['methods']
                         if t['preset'] == 'textbook' and m['text'] == t['name'] and m['title'] == row[0][0]]
                tally.text(kind, f'{page}: {row[0][0]}', row[1][0], pairs[0][0]['text'].partition(':')[2]
                           if pairs else None)
                tally.shown(kind, f'{page}: {row[0][0]}, ladders', row[2][0], len(pairs), 'count')
                times = [ratio(m['first_rung_ms'], t['first_rung_ms'])[0] for t, m in pairs
                         if m.get('first_rung_ms') and t.get('first_rung_ms')]
                tally.shown(kind, f'{page}: {row[0][0]}, time', row[6][0].split(' ')[0],
                            median(times) if times else None)
        elif heads[:1] != ['Ladder']:
            tally.fault(page, f'a table whose heads are not known: {heads}')
    if overview != 1:
        tally.fault(page, f'{overview} tables of all ladders')


# What only one kind of record has: the command, and who reads it.
STUDIES = {'models': ('shading', shaded), 'depths': ('whitted', traced), 'unshot': ('radiosity', exchanged)}


def check(folder, tally):
    records, sweeps, studies, biases = [], [], {}, []
    for place, folders, files in os.walk(folder):
        folders.sort()
        if 'recommendation.json' in files:
            recommended(place, load(os.path.join(place, 'recommendation.json')), tally)
        if 'results.json' not in files or os.path.basename(place) == 'cells':
            continue
        record = load(os.path.join(place, 'results.json'))
        page = os.path.join(place, 'index.html')
        if 'motion' in record:
            for scene in record['motion']:
                moved(place, scene, record['max_rmse'], tally)
            if os.path.isfile(page):
                motion_page(page, record, tally)
        elif 'sweep' in record:
            if any(r['scene'] == record['scene'] and r['command'] == record['command'] for r in sweeps):
                continue  # the only scene's record, once more
            swept(place, record, tally)
            sweeps.append(record)
        elif 'ladders' in record:
            climbed(place, record, tally)
            if os.path.isfile(page):
                ladder_page(page, record, tally)
        elif 'frames' in record and 'mean' in record:
            summed(place, record, tally)
        elif 'growth' in record:
            grown(place, record, tally)
            growth_page(page, record, tally)
        elif 'bias' in record:
            biased(place, record, tally)
            biases.append((place, record))
        elif any(of in record for of in STUDIES):
            command = next(of for of in STUDIES if of in record)
            name, study = STUDIES[command]
            study(place, record, tally)
            studies[name, record['scene']['name']] = record
        elif 'methods' in record and 'reference' in record and 'scene' in record:
            if not os.path.isfile(os.path.join(place, record['reference'].get('files', {}).get('exr',
                    ' '))) and place == folder:
                continue  # the only scene's record, once more, beside the folder of its planes
            compared(place, record, tally)
            records.append(record)
            if os.path.isfile(page):
                scene_page(page, record, tally)
    studies.update({('', r['scene']['name']): r for r in records})
    for place, record in biases:
        judged_alike(place, record, records, tally)
    page = os.path.join(folder, 'lectures.html')
    if os.path.isfile(page) and records:
        with open(page, encoding='utf-8') as f:
            lectures(page, re.search('<html lang="(..)"', f.read())[1], studies, tally)
    page = os.path.join(folder, 'index.html')
    if os.path.isfile(page):
        if records:
            index_page(page, records, tally)
            of_report(folder, records, labels, tally)
        if sweeps and not records:
            trade_page(page, sweeps, tally)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--need-all', action='store_true', help='each kind must have figures')
    parser.add_argument('folders', nargs='+', metavar='DIR')
    options = parser.parse_args()
    tally = Tally()
    for folder in options.folders:
        check(os.path.normpath(folder), tally)
    for kind, n in sorted(tally.figures.items()):
        print(f'{n:8} {kind}')
    print(f'{sum(tally.figures.values()):8} figures in all')
    for note, n in sorted(tally.notes.items()):
        print(f'{n:8} {note}')
    for kind in KINDS if options.need_all else ():
        if not tally.figures[kind]:
            tally.fault(kind, 'no figure of this kind was found')
    if not tally.figures:
        tally.fault(' '.join(options.folders), 'nothing to recompute was found')
    for fault in tally.faults[:40]:
        print(fault, file=sys.stderr)
    if len(tally.faults) > 40:
        print(f'... and {len(tally.faults) - 40} more', file=sys.stderr)
    return 1 if tally.faults else 0


if __name__ == '__main__':
    sys.exit(main())
