#!/usr/bin/env python3
"""Plants one fault at a time in copies of small reports: recompute.py has to find each.

    tests/recompute/planted_faults.py COMPARED SWEPT MOVED SUMMED RECOMMENDED LADDERED GROWN BIASED LECTURED OUTSIDE

The folders are what compare (of a scene with several lights, with two settings of one method), sweep,
motion, energy, recommend, ladder, growth, bias (beside a comparison of its settings), report (of studies, with the
lectures in German) and compare (with contenders from outside) wrote; small_reports.py writes such folders.
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

RECOMPUTE = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'recompute.py')


def runs(folder):
    return subprocess.run([sys.executable, '-B', RECOMPUTE, folder], capture_output=True, text=True)


def scene_folder(folder):
    """The first folder of a scene below one that compare wrote."""
    for place, folders, files in os.walk(folder):
        folders.sort()
        if 'reference.exr' in files:
            return place
    raise SystemExit(f'{folder}: no folder of a scene')


def in_json(change, of_scene=False, name='results.json'):
    def plant(folder):
        path = os.path.join(scene_folder(folder) if of_scene else folder, name)
        with open(path, encoding='utf-8') as f:
            record = json.load(f)
        change(record)
        with open(path, 'w', encoding='utf-8') as f:
            json.dump(record, f)
    return plant


def in_page(change, of_scene=False, name='index.html'):
    def plant(folder):
        path = os.path.join(scene_folder(folder) if of_scene else folder, name)
        with open(path, encoding='utf-8') as f:
            page = f.read()
        changed = change(page)
        if changed == page:
            raise SystemExit(f'{path}: nothing to plant the fault in')
        with open(path, 'w', encoding='utf-8') as f:
            f.write(changed)
    return plant


def wrong_method(record):
    """A method with an error above 0 under some light: (method, error)."""
    return next((m, e) for m in record['methods'] for e in m.get('errors', ()) if e['bias'])


def halved(record):
    wrong_method(record)[1]['rmse'] /= 2


def other_sign(record):
    e = wrong_method(record)[1]
    e['bias'] = -e['bias']


def in_explained(change):
    """In the first point that a record of compare explains."""
    def plant(folder):
        for place, folders, files in os.walk(folder):
            folders.sort()
            if 'reference.exr' not in files:
                continue
            path = os.path.join(place, 'results.json')
            with open(path, encoding='utf-8') as f:
                record = json.load(f)
            points = [x for m in record['methods'] for e in m.get('errors', ()) for x in e.get('explained', ())]
            if points:
                change(points[0])
                with open(path, 'w', encoding='utf-8') as f:
                    json.dump(record, f)
                return
        raise SystemExit(f'{folder}: no point is explained')
    return plant


def neighbour(point):
    point['pixel'][0] += 1


def sides_exchanged(point):
    point['method']['visibility'], point['truth']['visibility'] = (point['truth']['visibility'],
            point['method']['visibility'])


def one_light_less(record):
    for m in record['methods']:
        del m['errors'][-1]


def exchanged(node, a, b):
    node[a], node[b] = node[b], node[a]


def cause_exchanged(record):
    for m in record['methods']:
        for e in m.get('errors', ()):
            if e['false_shadow'] != e['false_light']:
                exchanged(e['false_shadow'], 'interior', 'edge')
                exchanged(e['false_light'], 'interior', 'edge')


def edges_without_lost(record):
    e = next(e for m in record['methods'] for e in m.get('errors', ()) if e['edge_displacement_px'])
    e['edge_displacement_px']['pieces'] += 1


def heads_exchanged(a, b):
    return lambda page: page.replace(f'>{a}<', '>\0<', 1).replace(f'>{b}<', f'>{a}<', 1).replace('>\0<', f'>{b}<', 1)


def labels_exchanged(page):
    """The heads of the summary's first two settings."""
    heads = re.findall(r'<a href="#method-\d+">([^<]+)</a></th>', page)
    a, b = heads[0], heads[1]
    return page.replace(f'>{a}</a></th>', '>\0</a></th>', 1).replace(f'>{b}</a></th>', f'>{a}</a></th>',
            1).replace('\0', b, 1)


def light_renamed(page):
    """The name of the last light stands above the first one's rows, in each table."""
    names = re.findall(r'<th[^>]*colspan[^>]*>\s*(?:<[^>]*>)*([a-z_]+)\s*<', page)
    return page.replace(f'>{names[0]}<', f'>{names[-1]}<')


def coverage_rounded(page):
    return re.sub(r'<td>(\d+)\.(\d)</td></tr>', lambda m: f'<td>{int(m[1]) + (m[2] >= "5")}</td></tr>', page)


def last_digit(page):
    """The last figure of three digits that a cell of the summary shows, one more in its last digit."""
    found = list(re.finditer(r'<td>(0\.\d*[1-8])</td>', page))[-1]
    text = found[1][:-1] + str(int(found[1][-1]) + 1)
    return page[:found.start(1)] + text + page[found.end(1):]


def row_gone(page):
    """A table's second row of a method, gone."""
    rows = list(re.finditer(r'<tr><th scope="row">.*?</tr>', page, re.S))
    return page[:rows[1].start()] + page[rows[1].end():]


def some_setting(record):
    return next(s for s in record['sweep']['settings'] if s['values']['rmse'])


def front_turned(record):
    name = next(n for n, texts in record['sweep']['fronts'].items() if len(texts) > 1)
    record['sweep']['fronts'][name].reverse()


def best_view(record):
    s = some_setting(record)
    s['values']['rmse'] = min(v['metrics']['rmse'] for v in s['views'])


def bound_is_value(record):
    s = some_setting(record)
    s['bounds']['rmse'] = s['values']['rmse']


def phases_exchanged(record):
    s = some_setting(record)
    exchanged(s['times'], 'aim_ms', 'visibility_ms')


def of_motion(change):
    return lambda record: change(next(m for m in record['motion'][0]['methods']
            if m.get('movements'))['movements']['light'])


def mean_as_median(movement):
    movement['median_ms'] = movement['mean_ms'] * 1.01


def last_as_worst(movement):
    movement['worst_rmse'] = movement['worst_rmse'] / 2 + 1e-3


def light_of_frame_gone(movement):
    del movement['frames'][0]['visibility_ms'][-1]


def other_winner(record):
    for w in record['motion'][0]['winners']:
        if w['complete']:
            w['complete']['method'] = record['motion'][0]['methods'][-1]['text'] + ':other=1'
            return


def pair_too_many(record):
    a, b = record['motion'][0]['methods'][:2]
    record['motion'][0]['break_even'].append({'method': a['text'], 'over': b['text'], 'setup_ms': 3.0, 'saves_ms': 1.0,
                                              'frames': 3, 'rounds': [3, 3]})


def pair_on_page(page):
    """A table of break-even that the record does not have, or one more frame in the one that it has."""
    row = re.search(r'<caption id="[^"]*-pairs">.*?<tbody>\s*<tr>.*?</td><td>[^<]*</td><td>[^<]*</td><td>(\d+)</td>',
                    page, re.S)
    if row:
        return page[:row.start(1)] + str(int(row[1]) + 1) + page[row.end(1):]
    return page.replace('</section>\n</main>', '<table><thead><tr><th>Method</th><th>over</th></tr></thead><tbody><tr>'
                        '<th>a</th><td>b</td></tr></tbody></table></section>\n</main>')


def fewer_points(page):
    """The RMSE of a method that leaves points without an answer, as if of all points."""
    return re.sub(r'<small>of [^<]* % of the points</small>', '', page, count=1)


def figure_raised(before):
    """The first figure behind `before`, one more in its last digit."""
    def change(page):
        m = re.search(before + r'(\d*\.?\d*[0-8])(?!\d)', page)
        return page[:m.start(1)] + m[1][:-1] + str(int(m[1][-1]) + 1) + page[m.end(1):] if m else page
    return change


def half_beyond(record):
    beyond = next(c['beyond'] for c in record['candidates'] if c['beyond'])
    beyond['error'] /= 2


def of_recommendation(change):
    return in_json(change, name='recommendation.json')


def cost_of_other(record):
    a, b = [c for c in record['candidates'] if c['cost'] is not None][:2]
    a['cost'], b['cost'] = b['cost'] * 1.5, a['cost'] * 1.5


def answer_of_other(record):
    record['recommendation']['method'] = record['cheapest']['method']


def ratio_turned(record):
    q = record['cheapest']['cost_ratio']
    q['median'] = 1 / q['median']


def views_chosen_on(record):
    """What the views that were chosen on have stands for what the further ones have."""
    r = record['recommendation']
    r['held_out']['largest']['rmse'] = r['errors']['rmse']['largest']


def of_first_ladder(change):
    return in_json(lambda record: change(record['ladders'][0]['methods'][0], record['ladders'][0]))


def breaks_late(method, ladder):
    rungs = [r['value'] for r in ladder['rungs']]
    method['breaks_at'] = rungs[rungs.index(method['breaks_at']) + 1]


def light_as_shadow(method, ladder):
    o = next(o for o in method['rungs'] if o['broken'])
    o['false_light']['interior'] += 1


def columns_of_energy(record):
    o = next(o for o in record['frames'][0]['objects'] if o['irradiance'] != o['unshadowed'])
    exchanged(o, 'irradiance', 'unshadowed')


def a_fit(record):
    """A fitted exponent of a method, and the method."""
    return next((f, m) for m in record['growth'][0]['methods'] for f in m['fits'] if f.get('verdict'))


def median_as_least(record):
    """Medians for the least times: fits take those, so that they are no longer of these samples."""
    _, m = a_fit(record)
    for p in m['points']:
        for phase in p['times'].values():
            if isinstance(phase, dict) and 'samples' in phase:
                phase['samples'] = [phase['median'] * (1.1 if i % 2 else 0.9) for i in range(len(phase['samples']))]


def other_verdict(record):
    fit, _ = a_fit(record)
    fit['verdict'] = 'agrees' if fit['verdict'] != 'agrees' else 'above'


def wider(record):
    fit, _ = a_fit(record)
    fit['interval'] = [fit['exponent'] - 1.1 * (fit['exponent'] - fit['interval'][0]), fit['interval'][1]]


def terminator_counted(record):
    """As if what is wrong at the terminator were a false shadow."""
    for study in record['bias']:
        if study['scene'] in ('all', 'self_shadow'):
            study['receiver_plane']['false_shadow']['interior'] += 1


def in_bias(change):
    return in_json(change, name='bias/results.json')


def in_study(command, change):
    scenes = {'shading': 'self_shadow', 'whitted': 'mirror_and_glass', 'radiosity': 'closed_room'}
    return in_json(change, name=f'{command}-{scenes[command]}/results.json')


def times_of_other(record):
    a, b = record['models'][:2]
    exchanged_between(a, b, 'times_ms')


def exchanged_between(a, b, key):
    a[key], b[key] = b[key], a[key]


FAULTS = {
    'compared': [
        ('a figure is half of what the planes say', in_json(halved, True)),
        ('a bias has the other sign', in_json(other_sign, True)),
        ('a light is missing from the errors', in_json(one_light_less, True)),
        ('interior and edge band are exchanged', in_json(cause_exchanged, True)),
        ('another point than the most telling is explained', in_explained(neighbour)),
        ('an explained point has the S of the truth for that of the method', in_explained(sides_exchanged)),
        ('a piece of an edge too many', in_json(edges_without_lost, True)),
        ('two methods have one another\'s text', in_json(lambda r: exchanged_text(r), True)),
        ('coverage counts as whole', in_json(lambda r: [m.update(coverage=0.5) for m in r['methods'][:1]], True)),
        ('what a page shows under the cursor is in the row of another method',
         in_page(lambda script: script.replace('"Planar projection"', '"\0"', 1).replace(
             '"Shadow z-buffer (resolution=64)"', '"Planar projection"', 1).replace(
             '\0', 'Shadow z-buffer (resolution=64)'), True, 'values.js')),
        ('heads of two columns of a scene page are exchanged', in_page(heads_exchanged('MAE', 'RMSE'), True)),
        ('a scene page names the last light above the rows of the first', in_page(light_renamed, True)),
        ('a scene page shows percentages without their tenths', in_page(coverage_rounded, True)),
        ('a scene page lacks a row', in_page(row_gone, True)),
        ('the summary has two settings\' figures in one another\'s columns', in_page(labels_exchanged)),
        ('the summary shows a figure that is one off in its last digit', in_page(last_digit)),
        ('the summary marks the cheapest as if times had another noise',
         in_page(lambda page: re.sub('data-noise="[^"]*"', 'data-noise="0.01"', page, count=1))),
    ],
    'swept': [
        ('a front is in the wrong order', in_json(front_turned)),
        ('the best view stands for the worst', in_json(best_view)),
        ('a bound is the measured value', in_json(bound_is_value)),
        ('the times of two phases are exchanged', in_json(phases_exchanged)),
        ('heads of two columns of a trade page are exchanged', in_page(heads_exchanged('Worst view', 'Bound'))),
        ('the sentence of a scene names another error', in_page(figure_raised('class="finding">[^<]*error of '))),
        ('the list of findings names another error', in_page(figure_raised('<dd>[^<]*error of '))),
        ('a ratio at a fixed error is another one',
         in_page(figure_raised(r'Error at most(?:.|\n)*?<td class="first[^"]*">'))),
        ('a dearer method is marked as the cheapest, or the cheapest is not',
         in_page(lambda page: page.replace('<td class="first cheapest">1.00 <', '<td class="first">1.00 <', 1))),
        ('a scene is ranked whose times vary by 40 %',
         in_json(lambda r: r['sweep']['turns'].update(noise_bar=0.4))),
    ],
    'moved': [
        ('another figure stands for the median of frames', in_json(of_motion(mean_as_median))),
        ('another frame stands for the worst', in_json(of_motion(last_as_worst))),
        ('a frame lacks a light', in_json(of_motion(light_of_frame_gone))),
        ('another method won', in_json(other_winner)),
        ('a pair pays off that does not', in_json(pair_too_many)),
        ('a page has another break-even', in_page(pair_on_page)),
        ('an error of a part of the points is shown as one of all', in_page(fewer_points)),
    ],
    'summed': [('irradiance with and without shadows are exchanged', in_json(columns_of_energy))],
    'recommended': [
        ('the largest error stands for the bound', of_recommendation(
            lambda r: [c['errors']['rmse'].update(bound=c['errors']['rmse']['largest']) for c in r['candidates']])),
        ('costs are of other settings', of_recommendation(cost_of_other)),
        ('the answer is the cheapest, whatever its errors', of_recommendation(answer_of_other)),
        ('a ratio of costs is turned over', of_recommendation(ratio_turned)),
        ('views that were chosen on stand for further ones', of_recommendation(views_chosen_on)),
        ('too small a share of views is said to be beyond',
         of_recommendation(lambda r: r['recommendation']['held_out'].update(share_beyond=0.05))),
        ('a method misses the limit by another factor',
         of_recommendation(lambda r: r['methods'][0].update(factor=2 * r['methods'][0]['factor']))),
        ('a setting is beyond a limit by half as much', of_recommendation(half_beyond)),
        ('the staircase has another step', of_recommendation(lambda r: r['staircase'].pop())),
    ],
    'laddered': [
        ('a method breaks a rung later', of_first_ladder(breaks_late)),
        ('a wrong point more than the share says', of_first_ladder(light_as_shadow)),
        ('a page names another class of errors', in_page(lambda page: page.replace('<small>leak</small>',
                                                                                   '<small>acne</small>', 1))),
        ('heads of two columns of a ladder page are exchanged', in_page(heads_exchanged('lit', 'in shadow'))),
    ],
    'grown': [
        ('an exponent is of other times', in_json(median_as_least)),
        ('an exponent meets another verdict', in_json(other_verdict)),
        ('an interval is a tenth wider', in_json(wider)),
        ('heads of two columns of exponents are exchanged', in_page(heads_exchanged('exponent', '95 %'))),
        ('a page shows another exponent', in_page(figure_raised(r'<td class="text">camera frame</td><td>'))),
    ],
    'biased': [
        ('what is wrong at the terminator counts as false shadow', in_bias(terminator_counted)),
        ('another setting is called the best', in_bias(lambda r: r['bias'][1]['best_manual'].update(constant=4.0))),
        ('the sum leaves out a scene', in_bias(lambda r: r['bias'][0].update(points=r['bias'][1]['points']))),
        ('false shadow and false light are exchanged in the head of the page',
         in_page(lambda page: page.replace('>shadow<', '>\0<', 1).replace('>light<', '>shadow<', 1).replace('\0', 'light'),
                 name='bias/index.html')),
        ('a file has another number of wrong points', in_page(figure_raised(r'self_shadow,[^,]*,\d+,'),
                                                              name='bias/bias.csv')),
    ],
    'lectured': [
        ('the times of two shading models are exchanged', in_study('shading', times_of_other)),
        ('the errors of two shading models are exchanged',
         in_study('shading', lambda r: exchanged_between(r['models'][0], r['models'][2], 'rmse'))),
        ('the first ray leaves and is not counted', in_study('whitted', lambda r: r['depths'][1].update(
            left=r['depths'][1]['left'] - 1))),
        ('a phase has the part of another', in_study('whitted', lambda r: exchanged_between(*r['phases'][:2],
                                                                                         'fraction'))),
        ('a step of radiosity is missing', in_study('radiosity', lambda r: r['unshot'].pop(3))),
        ('the lectures show another figure', in_page(figure_raised(r'<span lang="de">[^<]*?: 0,'),
                                                     name='lectures.html')),
        ('the lectures write a decimal point in German',
         in_page(lambda page: re.sub(r'(<span lang="de">[^<]*? 0),', r'\1.', page, count=1), name='lectures.html')),
    ],
    'outside': [
        ('heads of false shadow and false light are exchanged',
         in_page(heads_exchanged('False shadow', 'False light'), name='renderers.html')),
        ('a contender has other points', in_page(figure_raised(r'<td>2 of 4</td><td>'), name='renderers.html')),
        ('a contender answers on one scene less',
         in_page(lambda page: page.replace('<td>2 of 4<', '<td>1 of 4<', 1), name='renderers.html')),
        ('the page shows another own time', in_page(lambda page: page.replace('<td>20.0</td></tr>', '<td>25.0</td></tr>', 1),
                                                    name='renderers.html')),
        ('a record has another own time',
         in_json(lambda r: outsider(r)['own_times'].update(look_ms=outsider(r)['own_times']['look_ms'] + 1),
                 name='three_reasons/results.json')),
        ('a contender is called one of ours',
         in_json(lambda r: outsider(r).update(outside=''), name='three_reasons/results.json')),
    ],
}


def outsider(record):
    return next(m for m in record['methods'] if m.get('outside'))


def exchanged_text(record):
    a, b = [m for m in record['methods'] if m['name'] == 'shadow_zbuffer'][:2]
    a['text'], b['text'] = b['text'], a['text']


def main():
    if len(sys.argv) != 1 + len(FAULTS):
        raise SystemExit(__doc__)
    missed = found = 0
    for kind, folder in zip(FAULTS, sys.argv[1:]):
        with tempfile.TemporaryDirectory() as above:
            copy = os.path.join(above, 'copy')
            shutil.copytree(folder, copy)
            clean = runs(copy)
            if clean.returncode != 0:
                print(f'{folder}: faults before one was planted:\n{clean.stderr}', file=sys.stderr)
                missed += 1
            for what, plant in FAULTS[kind]:
                shutil.rmtree(copy)
                shutil.copytree(folder, copy)
                plant(copy)
                ran = runs(copy)
                if ran.returncode == 1 and 'Traceback' not in ran.stderr:
                    found += 1
                    print(f'found: {what}: {ran.stderr.splitlines()[0].removeprefix(above)}')
                else:
                    missed += 1
                    print(f'MISSED: {what}\n{ran.stderr}', file=sys.stderr)
    print(f'{found} planted faults were found, {missed} were not')
    return 1 if missed else 0


if __name__ == '__main__':
    sys.exit(main())
