"""values.js, anew: what a page shows under the cursor, from the planes of the EXR files."""
import base64
import json

from pictures import png_of

CALL, END = 'umbraValues(', ');\n'
NO_TRIANGLE, UNDEFINED = 0xffffffff, 0


def pixels(url):
    return png_of(base64.b64decode(url.removeprefix('data:image/png;base64,'))).channels


def planes(path):
    with open(path, encoding='utf-8') as f:
        text = f.read()
    return json.loads(text[len(CALL):-len(END)]) if text.startswith(CALL) and text.endswith(END) else None


def column(kind, where, values, who, picture, lights, classes, tally):
    """The column `who` has the planes of a picture: S in steps of 1/255, classes, answers."""
    found = [c for c in values['columns'] if c['who'] == who]
    if len(found) != 1 or len(found[0]['planes']) != len(lights):
        tally.fault(where, f'{len(found)} columns of "{who}"')
        return
    for light, url in zip(lights, found[0]['planes']):
        s, answers = picture.channels[f'S.{light}'], picture.channels[f'answer.{light}']
        named = picture.channels.get(f'class.{light}') or [None] * len(s)
        wrong = sum(
            b != (0 if answer == UNDEFINED else 255) or (answer != UNDEFINED and abs(r / 255 - min(max(v, 0), 1)) > 0.501 / 255)
            or (c is not None and values['classes'][g] != classes[int(c)])
            for (r, g, b), v, answer, c in zip(pixels(url), s, answers, named, strict=True))
        tally.figures[kind] += len(s)
        if wrong:
            tally.fault(f'{where}, {who}, {light}', f'{wrong} of {len(s)} values are not those of the planes')


def surfaces(kind, where, values, picture, objects, tally):
    """Triangles and objects, and the size."""
    tally.same(kind, where, [values['width'], values['height'], values['objects']],
               [picture.width, picture.height, [[o['name'], o['triangles']] for o in objects]])
    faces = [(r << 16 | g << 8 | b) - 1 for r, g, b in pixels(values['faces'])]
    wrong = sum(a != (-1 if b == NO_TRIANGLE else b) for a, b in zip(faces, picture.channels['id.face'], strict=True))
    tally.figures[kind] += len(faces)
    if wrong:
        tally.fault(where, f'{wrong} pixels name another triangle')
