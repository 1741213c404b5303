"""Studies, anew: sums and choices of their records, errors from their pictures, tables and files, and the lectures."""
import csv
import html
import json
import math
import os
import re

from pages import NONE, headed, shows
from pictures import read_png
from statistics_anew import median

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SIDES = [(side, place) for side in ('false_shadow', 'false_light') for place in ('interior', 'edge')]
STEP = 2.3 / 255  # of an intensity near white from one value of 8 bits to the next


def listed(path):
    with open(path, encoding='utf-8', newline='') as f:
        return list(csv.DictReader(f))


def files(kind, folder, name, rows, tally):
    """A file NAME.csv has these rows: lists of texts and numbers, in its columns."""
    found = listed(os.path.join(folder, name + '.csv'))
    if len(found) != len(rows):
        tally.fault(f'{folder}: {name}.csv', f'{len(found)} rows in place of {len(rows)}')
    for read, row in zip(found, rows):
        for (column, text), value in zip(read.items(), row, strict=True):
            is_number = isinstance(value, (int, float))
            tally.same(kind, f'{folder}: {name}.csv, {column}', float(text) if is_number else text,
                       float(value) if is_number else value or '', 1e-6)


def shown(kind, where, texts, values, tally):
    """Texts of neighbouring cells: a text, (value, decimals), or a count."""
    for text, value in zip(texts, values, strict=True):
        if isinstance(value, tuple):
            figure, decimals = value
            tally.figures[kind] += 1
            if text != (NONE if figure is None else f'{figure:.{decimals}f}'):
                tally.fault(where, f'"{text}" is shown, the record says {figure}')
        elif isinstance(value, int):
            tally.shown(kind, where, text, value, 'count')
        else:
            tally.text(kind, where, text, value)


# The bias of the shadow z-buffer.

def errors_of(cell):
    return [cell[side][place] for side, place in SIDES]


def biased(folder, record, tally):
    kind, studies = 'bias', record['bias']
    *_, last = studies
    grid = [(c, s, n) for n in record['normal_offsets'] for s in record['slopes'] for c in record['constants']]

    def cells(study):
        return [errors_of(c) for part in study['slices'] for row in part['rows'] for c in row]

    if len(studies) > 1:
        total, parts = studies[0], studies[1:]
        tally.text(kind, f'{folder}: first', total['scene'], 'all')
        for what, of in (('points', lambda s: [s['points']]), ('automatic', lambda s: errors_of(s['automatic'])),
                         ('receiver_plane', lambda s: errors_of(s['receiver_plane'])),
                         ('cells', lambda s: [v for c in cells(s) for v in c])):
            tally.same(kind, f'{folder}: all, {what}', of(total), [sum(v) for v in zip(*map(of, parts))])
    for study in studies:
        where, mine = f'{folder}: {study["scene"]}', cells(study)
        tally.same(kind, f'{where}, normal offsets', [p['normal_offset'] for p in study['slices']],
                   record['normal_offsets'])
        tally.same(kind, f'{where}, settings', [study['settings'], len(mine)], [len(grid), len(grid)])
        inner, outer = (lambda c: c[0] + c[2]), (lambda c: c[1] + c[3])
        least = min(range(len(grid)), key=lambda i: (inner(mine[i]), outer(mine[i]), sum(grid[i])))
        best = study['best_manual']
        tally.same(kind, f'{where}, best', errors_of(best) + [best[k] for k in ('constant', 'slope', 'normal_offset')],
                   mine[least] + list(grid[least]))
        automatic = inner(errors_of(study['automatic']))
        tally.same(kind, f'{where}, better', study['settings_better_than_automatic'],
                   sum(inner(c) < automatic for c in mine))
    inside = lambda cell: [cell['false_shadow']['interior'], cell['false_light']['interior']]
    setting = lambda cell: [cell[k] for k in ('constant', 'slope', 'normal_offset')]
    better = lambda s: f'{s["settings_better_than_automatic"]} of {s["settings"]}'
    row_of = lambda s: inside(s['automatic']) + inside(s['best_manual']) + setting(s['best_manual']) + inside(
            s['receiver_plane'])
    files(kind, folder, 'bias', [[s['scene'], s['title'], s['points'], *row_of(s), better(s)] for s in studies], tally)

    page = os.path.join(folder, 'index.html')
    (_, heads, rows), *rest = headed(page)
    tally.same(kind, f'{page}: heads', heads, [' / scene', ' / points', *(f'{g} / {h}' for g, h in (
        ('auto', 'shadow'), ('auto', 'light'), ('best manual', 'shadow'), ('best manual', 'light'),
        ('best manual', 'constant'), ('best manual', 'slope'), ('best manual', 'normal offset'),
        ('receiver plane', 'shadow'), ('receiver plane', 'light'))), ' / settings better than auto'])
    tally.same(kind, f'{page}: rows', len(rows), len(studies))
    for row, s in zip(rows, studies):
        values = [v if isinstance(v, int) else f'{v:g}' for v in row_of(s)]
        shown(kind, f'{page}: {s["title"]}', [t for t, _ in row], [s['title'], s['points'], *values, better(s)], tally)
    tally.same(kind, f'{page}: sections', [t[0] for t in rest], [s['title'] for s in studies])
    for (_, _, rows), s in zip(rest, studies):
        best = 'constant={constant:g}, slope={slope:g}, normal_offset={normal_offset:g}'.format(**s['best_manual'])
        for row, (name, how, of) in zip(rows, (('auto', 'the default', 'automatic'), ('best manual', best,
                'best_manual'), ('receiver_plane', 'no bias beyond a rounding margin', 'receiver_plane')), strict=True):
            shown(kind, f'{page}: {s["title"]}, {name}', [t for t, _ in row], [name, how, *errors_of(s[of])], tally)


def judged_alike(folder, record, compared, tally):
    """A study of the bias counts what compare counts of the same settings."""
    for study in record['bias']:
        for r in compared:
            if r['scene']['name'] != study['scene'] or r['size'] != record['size']:
                continue
            if any(light['kind'] in ('rectangle', 'disk', 'sphere') for light in r['lights']):
                continue  # a study takes their centres
            for m in r['methods']:
                p = m['parameters']
                if m['name'] != 'shadow_zbuffer' or not m.get('errors'):
                    continue
                if p['bias'] == 'manual':
                    at = [p[k] for k in ('constant', 'slope', 'normal_offset')]
                    cell = next((c for part in study['slices'] if part['normal_offset'] == at[2]
                                 for s, row in zip(record['slopes'], part['rows']) if s == at[1]
                                 for c0, c in zip(record['constants'], row) if c0 == at[0]), None)
                else:
                    cell = study['automatic' if p['bias'] == 'auto' else 'receiver_plane']
                if cell is not None:
                    tally.same('bias as compare', f'{folder}: {study["scene"]}, {m["text"]}',
                               [study['points'], *errors_of(cell)],
                               [sum(e['points'] for e in m['errors']), *(sum(e[side][place] for e in m['errors'])
                                                                        for side, place in SIDES)])


# Shading, rays after Whitted, radiosity.

def intensities(folder, picture, exposure):
    """Of a picture that was clamped, not compressed: the values that were shown, and whether all were below white."""
    seen = [v / 255 for pixel in read_png(os.path.join(folder, picture)).channels for v in pixel]
    return [(v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4) / exposure for v in seen], max(seen) < 1


def from_pictures(kind, where, written, folder, record, picture, whole, tally):
    """An RMSE of intensities, from the pictures: within what 8 bits leave open; where some are white, at least that."""
    with open(record['scene']['source'], encoding='utf-8') as f:
        scene = json.load(f)
    if scene.get('tone', 'clamp') != 'clamp':
        tally.notes['pictures that are compressed'] += 1
        return
    exposure = scene.get('exposure', 1.0)
    (a, a_whole), (b, b_whole) = (intensities(folder, name, exposure) for name in (picture, whole))
    anew = math.sqrt(sum((x - y) ** 2 for x, y in zip(a, b, strict=True)) / len(a))
    tally.figures[kind] += 1
    if written < anew - STEP / exposure or (a_whole and b_whole and written > anew + STEP / exposure):
        tally.fault(where, f'an RMSE of {written} is written, the pictures say {anew:.5f}')


def shaded(folder, record, tally):
    kind, models = 'shading', record['models']
    loud = record['noise_bar'] is None or record['noise_bar'] > 0.3
    for m in models:
        where = f'{folder}: {m["name"]}'
        tally.same(kind, f'{where}, ms', m['ms'], median(m['times_ms']))
        from_pictures(kind, where, m['rmse'], folder, record, m['picture'], 'phong.png', tally)
        tally.same(kind, f'{where}: worst', [m['worst'][k] >= m[k] for k in ('rmse', 'flip', 'perceived')], [True] * 3)
    cost = {m['name']: (median(m['times_ms']), m['worst']['rmse']) for m in models}
    front = [] if loud else sorted((n for n, (t, e) in cost.items() if not any(
        a <= t and b <= e and (a < t or b < e) for a, b in cost.values())), key=lambda n: cost[n])
    tally.same(kind, f'{folder}: front', record['front'], front)
    columns = ('name', 'evaluations', 'asked', 'ms', 'rmse', 'flip', 'perceived', 'highlight', 'kink')
    files(kind, folder, 'models', [[m[c] for c in columns] for m in models], tally)
    page = os.path.join(folder, 'index.html')
    (_, heads, rows), = headed(page)
    tally.same(kind, f'{page}: heads', heads, ['model', 'sums', 'Sj asked', 'time, ms', 'RMSE', 'FLIP', 'perceived',
                                               'highlight', 'kinks'])
    for row, m in zip(rows, models, strict=True):
        shown(kind, f'{page}: {m["name"]}', [t for t, _ in row], [m['name'], m['evaluations'], m['asked'], (m['ms'], 2),
              (m['rmse'], 5), (m['flip'], 5), (m['perceived'], 5), (m['highlight'], 3), (m['kink'], 2)], tally)
    with open(page, encoding='utf-8') as f:
        text = f.read()
    right = ('Not ranked by time' if loud else
             f'No other model is both faster and closer to phong (RMSE) than: {", ".join(front)}.')
    tally.same(kind, f'{page}: the sentence "{right}"', right in text, True)


def traced(folder, record, tally):
    kind, depths = 'whitted', record['depths']
    for d in depths:
        where = f'{folder}: depth {d["depth"]}'
        tally.same(kind, where, d['met'] + d['left'], d['eye'] + d['reflected'] + d['refracted'])
        from_pictures(kind, where, d['rmse'], folder, record, d['picture'], depths[-1]['picture'], tally)
    rays = sum(d['eye'] + d['reflected'] + d['refracted'] for d in depths)
    tally.same(kind, f'{folder}: rays', record['ways'][0]['rays'], rays)
    for phase in record['phases']:
        tally.same(kind, f'{folder}: {phase["name"]}', phase['fraction'], phase['ms'] / record['total_ms'])
    if (s := record['search']):
        tally.same(kind, f'{folder}: search', [s['ratio'], s['all_by_search_ms']],
                   [s['search_us'] / s['tree_us'], s['search_us'] * s['of'] / 1000])
    if (single := record['single']):
        from_pictures(kind, f'{folder}: single', single['rmse'], folder, record, single['picture'], record['picture'], tally)
    columns = ('depth', 'eye', 'reflected', 'refracted', 'met', 'left', 'shadow', 'total_reflections', 'too_light',
               'too_deep', 'rmse', 'flip')
    files(kind, folder, 'depths', [[d[c] for c in columns] for d in depths], tally)
    page = os.path.join(folder, 'index.html')
    found = headed(page)
    by = {heads[0]: (heads, rows) for _, heads, rows in found}
    tally.same(kind, f'{page}: heads', by['depth'][0], ['depth', 'reflected', 'refracted', 'met a surface', 'left',
               'shadow rays', 'total reflections', 'too light', 'too deep', 'RMSE', 'FLIP'])
    for row, d in zip(by['depth'][1], depths, strict=True):
        counts = [d[c] for c in columns if c not in ('eye', 'rmse', 'flip')]
        shown(kind, f'{page}: depth {d["depth"]}', [t for t, _ in row], [*counts, (d['rmse'], 5), (d['flip'], 4)],
              tally)
    for row, p in zip(by['phase'][1], record['phases'], strict=True):
        shown(kind, f'{page}: {p["name"]}', [t for t, _ in row[1:]], [(p['ms'], 1), (100 * p['fraction'], 1)], tally)
    for row, w in zip(by['rays'][1], record['ways'], strict=True):
        shown(kind, f'{page}: {w["name"]}', [t for t, _ in row[1:4]], [w['rays'], (w['ms'], 1), w['different_pixels']],
              tally)


def exchanged(folder, record, tally):
    kind, unshot = 'radiosity', record['unshot']
    tally.same(kind, f'{folder}: steps', record['steps'], len(unshot) - 1)
    tally.same(kind, f'{folder}: the first power', unshot[0], 1.0)
    tally.same(kind, f'{folder}: falls', all(a >= b for a, b in zip(unshot, unshot[1:])), True)
    files(kind, folder, 'unshot', [[i, v] for i, v in enumerate(unshot)], tally)
    page = os.path.join(folder, 'index.html')
    with open(page, encoding='utf-8') as f:
        text = html.unescape(re.sub(r'<[^>]*>', '', f.read())).replace('\u202f', '')
    right = f'{record["patches"]} patches, {record["steps"]} steps, {100 * unshot[-1]:.3g} % of the power unshot'
    tally.same(kind, f'{page}: the sentence "{right}"', right in text, True)
    tally.same(kind, f'{page}: {100 * record["arrived"]:.1f} % arrived', f'{100 * record["arrived"]:.1f} %' in text,
               True)


# The lectures, in pictures.

def member(node, path):
    for name in path.split('.'):
        if isinstance(node, list):
            node = (node[int(name)] if name.isdigit() and int(name) < len(node) else
                    next((n for n in node if n.get('name') == name), None))
        else:
            node = (node or {}).get(name)
        if node is None:
            return None
    return node


def lectures(page, language, records, tally):
    """`records`: {(command, scene): results.json}; compare's command is ''."""
    kind = 'lectures'
    with open(os.path.join(TOP, 'bench/report/lectures/topics.json'), encoding='utf-8') as f:
        topics = json.load(f)['topics']
    with open(os.path.join(TOP, 'bench/report/lectures', language, 'texts.json'), encoding='utf-8') as f:
        words = json.load(f)
    with open(page, encoding='utf-8') as f:
        text = f.read()
    articles = dict(re.findall(r'<article class="topic" id="([^"]+)">(.*?)</article>', text, re.S))
    tally.same(kind, f'{page}: topics', sorted(articles), sorted(t['id'] for t in topics))
    for topic in topics:
        record = records.get((topic.get('study', ''), topic.get('scene')))
        measured = re.search(rf'<p class="small">{words["phrases"]["measured"]} .*?</p>',
                             articles.get(topic['id'], ''), re.S)
        spans = [html.unescape(re.sub(r'<[^>]*>', '', s)) for s in re.findall(
            rf'<span lang="{language}">(.*?)</span>', measured[0] if measured else '', re.S)]
        figures = topic.get('figures', []) if record else []
        where = f'{page}: {topic["id"]}'
        wanted = [f for f in figures if any(member(record, v['path']) is not None for v in f['values'])]
        if topic.get('study') and len(spans) != len(wanted):
            tally.fault(where, f'{len(spans)} sentences of figures in place of {len(wanted)}')
        for said, figure in zip(spans, wanted):
            name = lambda english: words.get('names', {}).get(english, english)
            values = [(name(v['name']) if v.get('name') else '', member(record, v['path'])) for v in figure['values']]
            values = [(n, v) for n, v in values if v is not None]
            # "What – first: 0.12; second: 0.34." or "What: 0.12."
            what, _, rest = said.removesuffix('.').partition(' – ' if figure['values'][0].get('name') else ': ')
            tally.text(kind, where, what, name(figure['what']))
            parts = rest.split(words['phrases']['separator'])
            if len(parts) != len(values):
                tally.fault(where, f'"{said}" has {len(parts)} figures in place of {len(values)}')
            for part, (of, value) in zip(parts, values):
                shown_name, _, shown_figure = part.rpartition(': ')
                tally.text(kind, where, shown_name, of)
                point = shown_figure.replace(',', '.') if words['decimal_comma'] else shown_figure
                tally.figures[kind] += 1
                other = '.' if words['decimal_comma'] else ','
                if other in shown_figure or not shows(point, value, figure['kind']):
                    tally.fault(where, f'"{shown_figure}" is shown of {of or what}, the record says {value}')
