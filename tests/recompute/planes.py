"""Errors of results.json anew from the planes of the EXR files beside it."""
import math
import struct

AREA = ('rectangle', 'disk', 'sphere')
NAMES = ('no_surface away terminator_away not_judged undefined on_boundary right terminator terminator_wrong '
         'false_shadow_edge false_shadow acne false_light_edge false_light detachment leak penumbra noise '
         'unshadowed').split()
NOT_COMPARED = set(NAMES[:6]) | {'unshadowed'}
DARK, BRIGHT = ('false_shadow', 'acne'), ('false_light', 'detachment', 'leak')
REACH = 8.0


def _single(x):
    return struct.unpack('f', struct.pack('f', x))[0]


def _level(s):
    return 'lit' if s > 1 - 1 / 1024 else 'umbra' if s < 1 / 1024 else 'penumbra'


class Geometry:
    """The surface points of a view, and which neighbours lie on one surface."""

    def __init__(self, reference):
        self.width, self.height = reference.width, reference.height
        c = reference.channels
        self.p = list(zip(c['P.x'], c['P.y'], c['P.z']))
        self.n = list(zip(c['N.x'], c['N.y'], c['N.z']))
        m = struct.unpack('<16f', reference.raw['worldToNDC'])
        column = lambda k: [m[4 * row + k] for row in range(3)]
        perspective = any(abs(v) > 1e-12 for v in column(3))
        spans = []
        for k, pixels in ((0, self.width), (1, self.height)):
            # Half of the picture lies half_width to the side: the column is the axis over 2 half_width, plus w / 2.
            axis = [v - 0.5 * w for v, w in zip(column(k), column(3))] if perspective else column(k)
            spans.append(1 / math.sqrt(sum(v * v for v in axis)) / pixels)
        self.span = [max(spans) * (z if perspective else 1) for z in c['Z']]

    def one_surface(self, i, j):
        way = [b - a for a, b in zip(self.p[i], self.p[j])]
        off = max(abs(sum(w * n for w, n in zip(way, self.n[k]))) for k in (i, j))
        return off <= max(self.span[i], self.span[j])


def _pairs(width, height, drawn):
    for y in range(height):
        for x in range(width):
            i = y * width + x
            if drawn[i]:
                if x + 1 < width and drawn[i + 1]:
                    yield i, i + 1, x, y, False
                if y + 1 < height and drawn[i + width]:
                    yield i, i + width, x, y, True


def _band(geometry, drawn, s, tolerance):
    band = [False] * len(drawn)
    for i, j, x, y, below in _pairs(geometry.width, geometry.height, drawn):
        if abs(_single(s[i] - s[j])) > _single(tolerance / 1.5):
            mx, my = (x, y + 0.5) if below else (x + 0.5, y)
            for py in range(max(0, y - 2), min(geometry.height, y + 3)):
                for px in range(max(0, x - 2), min(geometry.width, x + 3)):
                    if math.hypot(px - mx, py - my) <= 1.5:
                        band[py * geometry.width + px] = True
    return band


def _boundary(geometry, drawn, s):
    pieces = []
    for i, j, x, y, below in _pairs(geometry.width, geometry.height, drawn):
        a, b = s[i], s[j]
        if (a < 0.5) == (b < 0.5) or not geometry.one_surface(i, j):
            continue
        t, up = (0.5 - a) / (b - a), 1 if b > a else -1
        pieces.append((x, y + t, 0, up) if below else (x + t, y, up, 0))
    return pieces


def _displacement(geometry, drawn, s, truth):
    of_truth, found = _boundary(geometry, drawn, truth), _boundary(geometry, drawn, s)
    if not of_truth:
        return None
    by_row = {}
    for piece in found:
        by_row.setdefault(int(piece[1]), []).append(piece)
    off = []
    for x, y, tx, ty in of_truth:
        near = [math.hypot(px - x, py - y) for row in range(int(y) - 9, int(y) + 10) for px, py, ux,
                uy in by_row.get(row, ())
                if ux * tx + uy * ty >= 0 and abs(px - x) <= 9]
        near = [d for d in near if d <= REACH]
        if near:
            off.append(min(near))
    off.sort()
    known = bool(off)
    return {'mean': sum(off) / len(off) if known else None, 'p95': off[(len(off) - 1) * 95 // 100] if known else None,
            'max': off[-1] if known else None, 'pieces': len(of_truth), 'unmatched': len(of_truth) - len(off),
            'reach': REACH}


def _penumbra_width(geometry, drawn, s, truth):
    w, length, corners = geometry.width, 0.0, ((0, 0), (1, 0), (1, 1), (0, 1))
    for y in range(geometry.height - 1):
        for x in range(w - 1):
            i = y * w + x
            square, at = (i, i + 1, i + w + 1, i + w), []
            for k in range(4):
                a, b = truth[square[k]], truth[square[(k + 1) % 4]]
                if (a < 0.5) != (b < 0.5):
                    t, c, d = (0.5 - a) / (b - a), corners[k], corners[(k + 1) % 4]
                    at.append((c[0] + (d[0] - c[0]) * t, c[1] + (d[1] - c[1]) * t))
            if at and all(drawn[c] for c in square) and geometry.one_surface(square[0], square[2]) and \
                    geometry.one_surface(square[1], square[3]):
                length += sum(math.dist(at[k], at[k + 1]) for k in range(0, len(at), 2))
    if length < 1:
        return None
    area = lambda plane: sum(plane[i] * (1 - plane[i]) for i in range(len(plane)) if drawn[i])
    return {'method': 6 * area(s) / length, 'reference': 6 * area(truth) / length}


def light_errors(geometry, reference, method, light, kind, faults):
    """The entry of `errors` of one light; what the classes say against S goes to `faults`."""
    plane = lambda picture, what: picture.channels[f'{what}.{light}']
    s, truth, answer, of_truth = plane(method, 'S'), plane(reference, 'S'), plane(method, 'answer'), plane(reference,
            'answer')
    facing, judged, half = plane(reference, 'facing'), plane(reference, 'judged'), plane(reference, 'half_width')
    classes = [NAMES[c] for c in plane(method, 'class')]
    tolerance = _single(0.1 if kind in AREA else 0.5)
    asked = [facing[i] >= 2 and classes[i] != 'unshadowed' for i in range(len(s))]
    band = _band(geometry, [asked[i] and of_truth[i] != 0 for i in range(len(s))], truth, tolerance)
    e = {k: 0 for k in ('points', 'undefined', 'away', 'on_boundary', 'not_judged', 'lit', 'umbra', 'penumbra')}
    e['false_shadow'] = {'interior': 0, 'edge': 0, 'acne': 0}
    e['false_light'] = {'interior': 0, 'edge': 0, 'detachment': 0, 'leak': 0}
    e['interior'] = {'lit': 0, 'umbra': 0, 'penumbra': 0}
    e['penumbra_error'], e['noise_error'] = {'false_shadow': 0, 'false_light': 0}, {'false_shadow': 0, 'false_light': 0}
    e['terminator'] = {'facet_away': 0, 'normal_away': 0, 'wrong': 0}
    absolute = squared = signed = largest = widest = unshadowed = unnamed = 0
    odd = 0
    for i, c in enumerate(classes):
        # What the planes say of the point, whatever the file of classes says.
        if facing[i] == 0:
            means = {'no_surface'}
        elif facing[i] == 1:
            means = {'away', 'terminator_away'}
        elif c == 'unshadowed':
            means = {c} if s[i] == 1 and truth[i] == 1 else set()
        elif answer[i] != 0 and not judged[i]:
            means = {'not_judged'}
        elif of_truth[i] == 2:
            means = {'on_boundary'}
        elif answer[i] == 0 or of_truth[i] == 0:
            means = {'undefined'}
        else:
            d = s[i] - truth[i]
            if abs(d) <= tolerance + half[i]:
                means = {'right', 'terminator'}
            elif band[i]:
                means = {'false_shadow_edge' if d < 0 else 'false_light_edge', 'terminator_wrong'}
            elif kind in AREA and _level(truth[i]) == 'penumbra':
                means = {'penumbra', 'noise', 'terminator_wrong'}
            else:
                means = set(DARK if d < 0 else BRIGHT) | {'noise', 'terminator_wrong'}
        if c not in means:
            odd += 1
        for name in ('away', 'not_judged', 'undefined', 'on_boundary'):
            e[name] += name in means
        e['terminator']['facet_away'] += c == 'terminator_away'
        unshadowed += c == 'unshadowed'
        if means & NOT_COMPARED or not means:
            continue
        e['points'] += 1
        level = _level(truth[i])
        e[level] += 1
        side = e['false_shadow' if d < 0 else 'false_light']
        e['terminator']['normal_away'] += c in ('terminator', 'terminator_wrong')
        e['terminator']['wrong'] += c == 'terminator_wrong'
        if abs(d) > tolerance + half[i] and c != 'terminator_wrong':
            if band[i]:
                side['edge'] += 1
            else:
                side['interior'] += 1
                e['interior'][level] += 1
                if c in side:
                    side[c] += 1
                if c in ('penumbra', 'noise'):
                    e[c + '_error']['false_shadow' if d < 0 else 'false_light'] += 1
                unnamed += c == 'false_light'
        absolute, squared, signed = absolute + abs(d), squared + d * d, signed + d
        largest, widest = max(largest, abs(d)), max(widest, half[i])
    if odd:
        faults.append(f'{odd} classes of {light} are not what S, answers, facing and the edge band say')
    n = e['points']
    e['mae'], e['rmse'], e['max'], e['bias'] = (absolute / n, math.sqrt(squared / n), largest,
            signed / n) if n else [None] * 4
    e['bracket'] = {'max_half_width': widest} if widest > 0 else None
    if not n:
        for kind_of in ('false_shadow', 'false_light'):
            e[kind_of] = {k: None for k in e[kind_of]}
    if unnamed:
        e['false_light']['detachment'] = e['false_light']['leak'] = None
    if unshadowed:
        e['unshadowed'] = unshadowed
    drawn = [c not in NOT_COMPARED or c == 'not_judged' for c in classes]
    e['edge_displacement_px'] = _displacement(geometry, drawn, s, truth)
    e['penumbra_width_px'] = _penumbra_width(geometry, drawn, s, truth) if kind in AREA else None
    return e, (sum(asked), sum(a and b != 0 for a, b in zip(asked, answer)))


def telling_points(reference, method, light):
    """The point of each interior class of wrong points with the largest error, and of those with most of its class near."""
    plane = lambda picture, what: picture.channels[f'{what}.{light}']
    s, truth, classes = plane(method, 'S'), plane(reference, 'S'), plane(method, 'class')
    width, height = reference.width, reference.height
    found = []
    for name in ('acne', 'false_shadow', 'detachment', 'leak', 'false_light', 'penumbra', 'noise'):
        members = {i for i, c in enumerate(classes) if NAMES[c] == name}
        if not members:
            continue
        error = {i: abs(_single(s[i] - truth[i])) for i in members}
        most = max(error.values())
        near = lambda i: sum(y * width + x in members for y in range(max(0, i // width - 3), min(height, i // width + 4))
                             for x in range(max(0, i % width - 3), min(width, i % width + 4)))
        i = max((k for k in sorted(members) if error[k] == most), key=near)
        found.append({'class': name, 'pixel': [i % width, i // width], 'method': s[i], 'truth': truth[i]})
    return found


def _shown(picture, tone, exposure):
    """The displayed picture, rows of (r, g, b): exposed, tone-mapped, clamped, sRGB."""
    rgb = [[max(0.0, _single(exposure * v)) for v in pixel] for pixel in zip(*(picture.channels[c] for c in 'RGB'))]
    largest = max(1.0, max(v for pixel in rgb for v in pixel))
    for pixel in rgb:
        peak, factor = max(pixel), 1.0
        if tone == 'divide':
            factor = 1 / largest
        elif tone == 'hue' and peak > 0.8:
            t = (peak - 0.8) / 0.2
            factor = (0.8 + 0.2 * t / (1 + t)) / peak
        for c in range(3):
            v = min(pixel[c] * factor, 1.0)
            pixel[c] = 12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055
    return rgb


def _smoothed(values, width, height):
    """Gaussian of sigma 1.5 over 11 x 11 pixels, where it lies within the picture."""
    def weights(side):
        n = min(side, 11)
        w = [math.exp(-(i - 0.5 * (n - 1)) ** 2 / 4.5) for i in range(n)]
        return [v / sum(w) for v in w]
    across, down = weights(width), weights(height)
    rows = [[sum(w * values[y * width + x + k] for k, w in enumerate(across)) for x in range(width - len(across) + 1)]
            for y in range(height)]
    return [sum(w * rows[y + k][x] for k, w in enumerate(down)) for y in range(height - len(down) + 1)
            for x in range(len(rows[0]))]


def _similarity(a, b, width, height):
    """SSIM of luminances [Wang et al., Image Quality Assessment, 2004]."""
    ya, yb = ([0.2126 * r + 0.7152 * g + 0.0722 * b for r, g, b in rows] for rows in (a, b))
    of = lambda u, v: _smoothed([p * q for p, q in zip(u, v)], width, height)
    one, c1, c2 = [1.0] * len(ya), 1e-4, 9e-4
    found = [(2 * ma * mb + c1) * (2 * (ab - ma * mb) + c2) /
             ((ma * ma + mb * mb + c1) * (aa - ma * ma + bb - mb * mb + c2))
             for ma, mb, aa, bb, ab in zip(of(ya, one), of(yb, one), of(ya, ya), of(yb, yb), of(ya, yb))]
    return sum(found) / len(found)


def picture_figures(reference, method, lights, tone, exposure):
    """RMSE of the linear pictures, PSNR and SSIM of the shown ones; pixels without an answer are the reference's."""
    n = reference.width * reference.height
    whole = [all(method.channels[f'answer.{l}'][i] != 0 for l in lights) for i in range(n)]
    squares = 0
    for c in 'RGB':
        a, b = reference.channels[c], method.channels[c]
        squares += sum((b[i] - a[i]) ** 2 for i in range(n) if whole[i])
    of_reference, of_method = _shown(reference, tone, exposure), _shown(method, tone, exposure)
    of_method = [m if w else r for m, r, w in zip(of_method, of_reference, whole)]
    off = sum((x - y) ** 2 for a, b in zip(of_reference, of_method) for x, y in zip(a, b)) / (3 * n)
    return {'rmse': math.sqrt(squares / (3 * n)), 'psnr': -10 * math.log10(off) if off > 0 else None,
            'ssim': _similarity(of_method, of_reference, reference.width, reference.height)}
