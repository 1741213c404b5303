"""Tables of pages, each cell under its full head, and whether a text is the rounding of a figure."""
import math
import re
from html.parser import HTMLParser

NONE = '–'


class _Tables(HTMLParser):
    def __init__(self):
        super().__init__()
        self.tables, self.cell, self.where = [], None, None
        self.heading, self.in_heading = '', False

    def handle_starttag(self, tag, attributes):
        a = dict(attributes)
        if tag == 'table':
            self.tables.append({'head': [], 'body': [], 'heading': self.heading})
            self.where = 'body'
        if tag in ('h2', 'h3'):
            self.heading, self.in_heading = '', True
        if not self.tables:
            return
        if tag in ('thead', 'tbody'):
            self.where = 'head' if tag == 'thead' else 'body'
        if tag == 'tr':
            self.tables[-1][self.where].append([])
        if tag in ('td', 'th') and self.tables[-1][self.where]:
            self.cell = {'tag': tag, 'text': '', 'columns': int(a.get('colspan', 1)), 'rows': int(a.get('rowspan', 1)),
                    'a': a}
            self.tables[-1][self.where][-1].append(self.cell)
        if tag in ('br', 'small', 'span') and self.cell is not None:
            self.cell['text'] += ' '

    def handle_endtag(self, tag):
        if tag in ('h2', 'h3'):
            self.in_heading = False
        if tag in ('td', 'th', 'table'):
            self.cell = None

    def handle_data(self, data):
        if self.in_heading:
            self.heading += data
        if self.cell is not None:
            self.cell['text'] += data


def _clean(text):
    return re.sub(r'[ \t\n\r\xa0]+', ' ', text.replace('\xad', '')).strip()


def _heads(rows):
    """The head of each column, those above it joined by " / "."""
    grid = {}
    for y, row in enumerate(rows):
        x = 0
        for cell in row:
            while (y, x) in grid:
                x += 1
            for dy in range(cell['rows']):
                for dx in range(cell['columns']):
                    grid[y + dy, x + dx] = (_clean(cell['text']), cell)
            x += cell['columns']
    width = max((x for _, x in grid), default=-1) + 1
    heads = []
    for x in range(width):
        cells = []
        for y in range(len(rows)):
            if (y, x) in grid and (not cells or grid[y, x][1] is not cells[-1][1]):
                cells.append(grid[y, x])
        heads.append(' / '.join(text for text, _ in cells))
    return heads


def tables(path):
    """[(heads, rows)], as `headed` without headings."""
    return [(heads, rows) for _, heads, rows in headed(path)]


def headed(path):
    """[(heading of its section, heads, rows)].

    A row is [(text, attributes)], one a column; a row of one cell across the table is a group's name.
    """
    parser = _Tables()
    parser.feed(open(path, encoding='utf-8').read())
    found = []
    for t in parser.tables:
        rows = []
        for row in t['body']:
            cells = []
            for cell in row:
                cells += [(_clean(cell['text']), cell['a'])] * (cell['columns'] if len(row) > 1 else 1)
            rows.append(cells)
        found.append((_clean(t['heading']), _heads(t['head']), rows))
    return found


_RAISED = str.maketrans('⁰¹²³⁴⁵⁶⁷⁸⁹⁻', '0123456789-')


def number(text):
    """(value, half a unit of its last digit), or None."""
    text = text.replace('\u202f', '').replace('−', '-')
    m = re.fullmatch(r'(-?\d+(?:\.(\d+))?)(?:·10([⁰¹²³⁴⁵⁶⁷⁸⁹⁻]+))?', text)
    if not m:
        return None
    power = 10.0 ** int(m[3].translate(_RAISED)) if m[3] else 1.0
    return float(m[1]) * power, 0.5 * 10.0 ** -len(m[2] or '') * power


def shows(text, value, unit='score', at_least=False):
    """Whether `text` is what a page may write of `value`: three digits, a count, a percentage in tenths."""
    if at_least != text.startswith('≥ '):
        return False
    text = text.removeprefix('≥ ')
    if value is None:
        return text in (NONE, '')
    if unit == 'db' and math.isinf(value):
        return text == '∞'
    if unit == 'percent':
        value *= 100
        if text.startswith(('<', '>')):
            return 0 < value < 0.0500001 if text == '< 0.1' else text == '> 99.9' and 99.9499999 < value < 100
    if text == '< 0.001':
        return unit == 'ms' and 0 < value < 0.001
    read = number(text)
    if read is None:
        return False
    shown, half = read
    if unit == 'count':
        return shown == value
    if unit == 'percent':
        half = 0.05
        return abs(shown - value) <= half * (1 + 1e-9) and (shown > 0) == (value > 0) and (shown < 100) == (value < 100)
    if (shown == 0) != (value == 0) or abs(shown - value) > half * (1 + 1e-9):
        return False
    digits = 2 if '·' in text else 3
    return value == 0 or half <= abs(value) * 10.0 ** (1 - digits) * 0.5001 or half == 0.5
