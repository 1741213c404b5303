"""EXR and PNG files as Umbra writes them (scan lines, ZIP or none; 8 bits), read with Python's own modules."""
import struct
import zlib


class Picture:
    def __init__(self, width, height, channels, attributes):
        self.width, self.height, self.channels, self.attributes = width, height, channels, attributes


def _text(data, at):
    end = data.index(b'\0', at)
    return data[at:end].decode('utf-8'), end + 1


def _unzipped(block, size):
    if len(block) == size:
        return block
    raw = bytearray(zlib.decompress(block))
    for i in range(1, len(raw)):
        raw[i] = (raw[i - 1] + raw[i] - 128) & 255
    half = (len(raw) + 1) // 2
    out = bytearray(len(raw))
    out[0::2], out[1::2] = raw[:half], raw[half:]
    return bytes(out)


def read_exr(path):
    data = open(path, 'rb').read()
    magic, version = struct.unpack_from('<II', data)
    if magic != 20000630 or version & 0x1A00:
        raise ValueError(f'{path}: not an EXR of one part and of scan lines')
    at, attributes = 8, {}
    while data[at]:
        name, at = _text(data, at)
        kind, at = _text(data, at)
        size, = struct.unpack_from('<I', data, at)
        attributes[name] = (kind, data[at + 4:at + 4 + size])
        at += 4 + size
    at += 1
    x0, y0, x1, y1 = struct.unpack('<4i', attributes['dataWindow'][1])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    compression = attributes['compression'][1][0]
    lines = {0: 1, 2: 1, 3: 16}.get(compression)
    if lines is None:
        raise ValueError(f'{path}: compression {compression} is not read, only none, ZIPS and ZIP')
    kinds, c, listed = [], 0, attributes['channels'][1]
    while listed[c]:
        name, c = _text(listed, c)
        kinds.append((name, struct.unpack_from('<i', listed, c)[0]))
        c += 16
    codes = {0: ('I', 4), 1: ('e', 2), 2: ('f', 4)}
    line_bytes = sum(codes[k][1] for _, k in kinds) * width
    planes = {name: [] for name, _ in kinds}
    blocks = -(-height // lines)
    for offset in struct.unpack_from(f'<{blocks}Q', data, at):
        y, size = struct.unpack_from('<iI', data, offset)
        rows = min(lines, y1 + 1 - y)
        block = data[offset + 8:offset + 8 + size]
        if compression:
            block = _unzipped(block, rows * line_bytes)
        b = 0
        for _ in range(rows):
            for name, kind in kinds:
                code, bytes_each = codes[kind]
                planes[name].extend(struct.unpack_from(f'<{width}{code}', block, b))
                b += bytes_each * width
    texts = {k: v.decode('utf-8', 'replace') for k, (kind, v) in attributes.items() if kind == 'string'}
    picture = Picture(width, height, planes, texts)
    picture.raw = {k: v for k, (_, v) in attributes.items()}
    return picture


def read_png(path):
    """Rows of (r, g, b)."""
    return png_of(open(path, 'rb').read(), path)


def png_of(data, path='a PNG'):
    at, packed = 8, b''
    while at < len(data):
        size, kind = struct.unpack_from('>I4s', data, at)
        body = data[at + 8:at + 8 + size]
        if kind == b'IHDR':
            width, height, depth, colour, _, _, interlaced = struct.unpack('>IIBBBBB', body)
        elif kind == b'IDAT':
            packed += body
        at += 12 + size
    if depth != 8 or interlaced or colour not in (0, 2, 4, 6):
        raise ValueError(f'{path}: not a PNG of 8 bits in one pass')
    n = {0: 1, 2: 3, 4: 2, 6: 4}[colour]
    raw, before, out = zlib.decompress(packed), bytes(width * n), []
    for y in range(height):
        start = y * (width * n + 1)
        how, line = raw[start], bytearray(raw[start + 1:start + 1 + width * n])
        for i in range(len(line)):
            a, b, c = (line[i - n] if i >= n else 0), before[i], (before[i - n] if i >= n else 0)
            if how == 1:
                line[i] = (line[i] + a) & 255
            elif how == 2:
                line[i] = (line[i] + b) & 255
            elif how == 3:
                line[i] = (line[i] + (a + b) // 2) & 255
            elif how == 4:
                p = a + b - c
                pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
                line[i] = (line[i] + (a if pa <= pb and pa <= pc else b if pb <= pc else c)) & 255
        before = line
        for x in range(width):
            px = line[x * n:x * n + n]
            out.append(tuple(px[:3]) if n >= 3 else (px[0],) * 3)
    return Picture(width, height, out, {})
