"""Growth, anew: least times, exponents and their intervals, verdicts, crossings, and the page that shows them."""
import math

from pages import NONE, headed
from statistics_anew import median, ratio, student_t

FRAMES = {'camera_frame': ('look_ms', 'visibility_ms'), 'light_frame': ('aim_ms', 'visibility_ms'),
          'object_frame': ('build_ms', 'aim_ms', 'look_ms', 'visibility_ms')}
PHASES = {'build': ('build_ms',), 'aim': ('aim_ms',), **FRAMES}
SHORTEST_MS, DECISIVE = 0.05, 0.5


def rounds(point, quantity):
    return [sum(r) for r in zip(*(point['times'][p]['samples'] for p in PHASES[quantity]))]


def straight(points, quantity):
    """The power law through the least times, or the memory: what a record says of it; None of fewer than 3 points."""
    largest, of = points[-1]['x'] if points else 0, []
    for p in points:
        y = p['memory_bytes'] if quantity == 'memory' else min(rounds(p, quantity))
        if p['x'] >= largest / 100 * (1 - 1e-9) and y > 0 and (quantity == 'memory' or y >= SHORTEST_MS):
            of.append((math.log(p['x']), math.log(y)))
    n = len(of)
    if n < 3:
        return None
    u, v = sum(a for a, _ in of) / n, sum(b for _, b in of) / n
    uu, vv = sum((a - u) ** 2 for a, _ in of), sum((b - v) ** 2 for _, b in of)
    slope = sum((a - u) * (b - v) for a, b in of) / uu
    rest = sum((b - v - slope * (a - u)) ** 2 for a, b in of)
    half = student_t(n - 2) * math.sqrt(rest / (n - 2) / uu)
    return {'exponent': slope, 'interval': [slope - half, slope + half], 'factor': math.exp(v - slope * u),
            'r_squared': 1.0 if vv == 0 else min(1.0, max(0.0, 1 - rest / vv)), 'points': n,
            'range': [math.exp(of[0][0]), math.exp(of[-1][0])]}


def verdict(fit, theory):
    (low, high), (least, most) = fit['interval'], theory
    return ('below' if high < least else 'above' if low > most
            else 'undecided' if high - low > DECISIVE else 'agrees')


def changes(a, b, quantity):
    """Where the faster of two methods changes: [(x, between, the first is faster below)]."""
    found, before = [], None
    for p in a['points']:
        for q in b['points']:
            if p['x'] != q['x']:
                continue
            both = [(x, y) for x, y in zip(rounds(p, quantity), rounds(q, quantity)) if x > 0 and y > 0]
            if not both:
                continue
            middle, (low, high, coverage) = ratio(*zip(*both))
            bar = math.inf if p['noise_bar'] is None else p['noise_bar']
            if not coverage or low <= 1 <= high or max(middle, 1 / middle) <= 1 + bar:
                continue
            now = p['x'], math.log(middle)
            if before and (before[1] < 0) != (now[1] < 0):
                t = before[1] / (before[1] - now[1])
                found.append((before[0] * (now[0] / before[0]) ** t, [before[0], now[0]], before[1] < 0))
            before = now
    return found


def grown(folder, record, tally):
    for family in record['growth']:
        for method in family['methods']:
            where = f'{folder}: {family["name"]}, {method["text"]}'
            for p in method['points']:
                for phase in PHASES['object_frame']:
                    t = p['times'][phase]
                    s = t['samples']
                    tally.same('growth', f'{where} at {p["x"]}: {phase}', {k: t[k] for k in ('median', 'min', 'max')},
                               {'median': median(s), 'min': min(s), 'max': max(s)})
                if p['x'] not in family['sizes']:
                    tally.fault(where, f'a point at {p["x"]}, sizes are {family["sizes"]}')
            for fit in method['fits']:
                at, anew = f'{where}: {fit["quantity"]}', straight(method['points'], fit['quantity'])
                written = {k: fit[k] for k in ('exponent', 'interval', 'factor', 'r_squared', 'points', 'range')
                        if k in fit}
                tally.same('growth', at, written, anew or {}, 1e-6)
                if fit.get('theory') and anew:
                    tally.text('growth', f'{at}, verdict', fit['verdict'], verdict(anew, fit['theory']['interval']))
        pairs = [(a, b) for i, a in enumerate(family['methods']) for b in family['methods'][i + 1:]]
        right = [(q, a['text'] if below else b['text'], b['text'] if below else a['text'], x, between)
                for a, b in pairs for q in FRAMES for x, between, below in changes(a, b, q)]
        tally.same('growth', f'{folder}: {family["name"]}, crossings',
                   [[c['quantity'], c['below'], c['above'], c['x'], c['between']] for c in family['crossings']],
                   [list(c) for c in right], 1e-6)


def of_pair(text):
    low, _, high = text.partition(' to ')
    return [low, high or low]


def growth_page(page, record, tally):
    kind = 'growth pages'
    fits = [t for t in headed(page) if t[1][2:3] == ['exponent']]
    tally.same(kind, f'{page}: sections', [heading for heading, _, _ in fits], [f['title'] for f in record['growth']])
    for (_, heads, rows), family in zip(fits, record['growth']):
        of = [(m, f) for m in family['methods'] for f in m['fits']]
        if len(rows) != len(of):
            tally.fault(page, f'{len(rows)} exponents of {family["title"]}, the record has {len(of)}')
        for row, (m, f) in zip(rows, of):
            texts = dict(zip(heads, (t for t, _ in row)))
            where, theory = f'{page}: {m["text"]}, {f["quantity"]}', f.get('theory')
            over = f'fitted over, {family["unit"]}'
            tally.text(kind, where, texts['Method'], m['text'])
            tally.text(kind, where, texts['of'], f['quantity'].replace('_', ' '))
            tally.text(kind, where, texts['verdict'], f.get('verdict') or '')
            tally.text(kind, where, texts['because'], theory['why'] if theory else '')
            for head, values, unit in (('95 %', f.get('interval'), 'score'), (over, f.get('range'), 'count'),
                                       ('theory', theory and theory['interval'], 'score')):
                if values is None:
                    tally.text(kind, f'{where}, {head}', texts[head], NONE if head == 'theory' else '')
                    continue
                for text, value in zip(of_pair(texts[head]), values):
                    tally.shown(kind, f'{where}, {head}', text, round(value) if unit == 'count' else value, unit)
            if 'exponent' in f:
                tally.shown(kind, f'{where}, exponent', texts['exponent'], f['exponent'])
            else:
                tally.text(kind, f'{where}, exponent', texts['exponent'], 'too short to fit')
    crossings = [t for t in headed(page) if t[1][:1] == ['Faster below']]
    crossed = [f for f in record['growth'] if f['crossings']]
    tally.same(kind, f'{page}: crossings', [heading for heading, _, _ in crossings], [f['title'] for f in crossed])
    for (_, _, rows), family in zip(crossings, crossed):
        for row, c in zip(rows, family['crossings']):
            texts, where = [t for t, _ in row], f'{page}: {c["below"]} and {c["above"]}'
            tally.same(kind, where, texts[:3], [c['below'], c['above'], c['quantity'].replace('_', ' ')])
            tally.shown(kind, f'{where}, near', texts[3], round(c['x']), 'count')
            for text, value in zip(of_pair(texts[4]), c['between']):
                tally.shown(kind, f'{where}, between', text, round(value), 'count')
