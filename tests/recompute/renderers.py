"""renderers.html, anew: contenders from outside over scenes, and on each."""
import math
import os
from collections import Counter

from pages import headed

KIND = 'renderers'
COLUMNS = ['Points', 'Undefined', 'False shadow', 'False light', 'Edge', 'RMSE of S', 'Bias of S']
PHASES = ('build_ms', 'aim_ms', 'look_ms', 'visibility_ms')


def sums(methods):
    """What the columns say of the errors of `methods`: [(unit, value)]."""
    errors = [e for m in methods for e in m['errors']]
    n = sum(e['points'] for e in errors)
    of = lambda way, where: sum(e[way][where] or 0 for e in errors) if n else None
    mean = lambda term: sum(term(e) * e['points'] for e in errors if e['points']) / n if n else None
    square = mean(lambda e: e['rmse'] ** 2)
    return [('count', n), ('count', sum(e['undefined'] for e in errors)), ('count', of('false_shadow', 'interior')),
            ('count', of('false_light', 'interior')),
            ('count', of('false_shadow', 'edge') + of('false_light', 'edge') if n else None),
            ('score', None if square is None else math.sqrt(square)), ('score', mean(lambda e: e['bias']))]


def renderers_page(page, records, known, tally):
    """`known`: what pages call the contenders."""
    label_of = {m['text']: label for label, m in known.items()}
    served = lambda m: m['serves']['how'] not in ('not', 'not_at_all') and not m.get('failed')
    outside = [(r, [m for m in r['methods'] if m.get('outside')]) for r in records]
    tables = [t for t in headed(page) if t[1]]
    over = [t for t in tables if t[1][:2] == ['Contender', 'Scenes']]
    of_scenes = {heading: (heads, rows) for heading, heads, rows in tables if heads[:2] == ['Contender', 'Points']}
    if len(over) != 1 or len(tables) != 1 + len(of_scenes) or over[0][1] != ['Contender', 'Scenes', *COLUMNS]:
        tally.fault(page, f'tables of {[heading for heading, _, _ in tables]}')
        return

    def compare(where, figures, cells):
        if len(figures) != len(cells):
            tally.fault(where, f'{len(cells)} cells in place of {len(figures)}')
        for column, (unit, value), (text, _) in zip(COLUMNS, figures, cells):
            tally.shown(KIND, f'{where}, {column}', text, value, unit)

    seen = Counter()
    for (label, _), (scenes, _), *cells in over[0][2]:
        ms = [m for _, methods in outside for m in methods if label_of.get(m['text']) == label]
        seen[label] += 1
        tally.text(KIND, f'{page}: {label}, scenes', scenes, f'{sum(map(served, ms))} of {len(ms)}')
        compare(f'{page}: {label}', sums(filter(served, ms)), cells)
    wanted = Counter({label_of[m['text']] for _, methods in outside for m in methods})
    if seen != wanted:
        tally.fault(page, f'rows of {sorted(seen.elements())}, the records have {sorted(wanted)}')
    for record, methods in outside:
        title = record['scene']['title']
        heads, rows = of_scenes.get(title, (None, ()))
        if heads != (['Contender', *COLUMNS, 'Time, ms', 'Own time, ms'] if methods else None):
            tally.fault(page, f'the table of {title} has the heads {heads}')
            continue
        if [row[0][0] for row in rows] != [label_of[m['text']] for m in methods]:
            tally.fault(page, f'{title} has the rows {[row[0][0] for row in rows]}')
            continue
        for row, m in zip(rows, methods):
            where = f'{page}: {title}, {row[0][0]}'
            if not served(m):
                tally.text(KIND, where, row[1][0],
                           'Failed: ' + m['failed']['message'] if m.get('failed') else m['serves']['why'])
                continue
            compare(where, sums([m]), row[1:-2])
            own = m.get('own_times')
            times = [sum(m['times'][p]['median'] for p in PHASES),
                     sum(own[p] or 0 for p in PHASES) if own else None]
            for head, value, (text, _) in zip(heads[-2:], times, row[-2:]):
                tally.shown(KIND, f'{where}, {head}', text, value, 'ms')


def of_report(folder, records, labels, tally):
    """The page is there where a record has a contender, and only then."""
    page, every = os.path.join(folder, 'renderers.html'), {}
    for r in records:
        for m in r['methods']:
            every.setdefault((m['name'], m['text'], str(m['parameters'])), m)
    known = {label: m for label, m in labels(list(every.values())).items() if m.get('outside')}
    if os.path.isfile(page) != bool(known):
        tally.fault(page, f'{len(known)} contenders in the records')
    elif known:
        renderers_page(page, records, known, tally)
