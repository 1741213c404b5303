"""EXR and PNG files as Umbra writes them (scan lines, PIZ, ZIP or none; 8 bits), read with Python's own modules."""
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


def _huffman(data, count):
    """The values of a Huffman block: lengths of codes by value, then codes; the last value repeats the one before."""
    first, last, _, bits, _ = struct.unpack_from('<5I', data)
    at, held, have = 20, 0, 0

    def take(n):
        nonlocal at, held, have
        while have < n:
            held, have, at = held << 8 | data[at], have + 8, at + 1
        have -= n
        value = held >> have
        held &= (1 << have) - 1
        return value

    lengths, value = {}, first
    while value <= last:
        length = take(6)
        if length == 63:
            value += take(8) + 6
        elif length >= 59:
            value += length - 57
        else:
            if length:
                lengths[value] = length
            value += 1
    counts = [0] * 59
    for length in lengths.values():
        counts[length] += 1
    code = 0
    for length in range(58, 0, -1):
        counts[length], code = code, (code + counts[length]) >> 1
    values = {}
    for value in sorted(lengths):
        length = lengths[value]
        values[length, counts[length]] = value
        counts[length] += 1
    text = bin(int.from_bytes(b'\1' + data[at:at + (bits + 7) // 8], 'big'))[3:]
    by_text = {format(code, f'0{length}b'): value for (length, code), value in values.items()}
    least, out, i = min(lengths.values(), default=1), [], 0
    while i < bits and len(out) < count:
        n = least
        while text[i:i + n] not in by_text:
            n += 1
            if n > 58:
                raise ValueError('a Huffman code that is in no table')
        value, i = by_text[text[i:i + n]], i + n
        if value == last:
            out += [out[-1]] * int(text[i:i + 8], 2)
            i += 8
        else:
            out.append(value)
    return out


def _wavelet(a, start, nx, ox, ny, oy, largest):
    small = largest < 1 << 14

    def two(l, h):
        if small:
            l, h = l - 65536 if l > 32767 else l, h - 65536 if h > 32767 else h
            sum_ = l + (h & 1) + (h >> 1)
            return sum_ & 65535, (sum_ - h) & 65535
        b = (l - (h >> 1)) & 65535
        return (h + b - 32768) & 65535, b

    p2 = 1
    while p2 * 2 <= min(nx, ny):
        p2 *= 2
    p = p2 >> 1
    while p >= 1:
        ys, xs = range(0, ny - p2 + 1, p2), range(0, nx - p2 + 1, p2)
        for y in ys:
            for x in xs:
                i = start + y * oy + x * ox
                j, k = i + ox * p, i + oy * p
                m = k + ox * p
                a00, a10 = two(a[i], a[k])
                a01, a11 = two(a[j], a[m])
                a[i], a[j] = two(a00, a01)
                a[k], a[m] = two(a10, a11)
            if nx & p:
                i = start + y * oy + len(xs) * p2 * ox
                a[i], a[i + oy * p] = two(a[i], a[i + oy * p])
        if ny & p:
            for x in xs:
                i = start + len(ys) * p2 * oy + x * ox
                a[i], a[i + ox * p] = two(a[i], a[i + ox * p])
        p2, p = p, p >> 1


def _unpiz(block, size, rows, width, words):
    if len(block) >= size:
        return block
    low, high = struct.unpack_from('<HH', block)
    at, bitmap = 4, bytearray(8192)
    if low <= high:
        bitmap[low:high + 1] = block[at:at + high - low + 1]
        at += high - low + 1
    table = [i for i in range(65536) if i == 0 or bitmap[i >> 3] >> (i & 7) & 1]
    length, = struct.unpack_from('<i', block, at)
    values = _huffman(block[at + 4:at + 4 + length], size // 2)
    start, planes = 0, []
    for n in words:
        for j in range(n):
            _wavelet(values, start + j, width, n, rows, width * n, len(table) - 1)
        planes.append((start, n))
        start += n * width * rows
    out = []
    for y in range(rows):
        for begin, n in planes:
            out += [table[v] for v in values[begin + y * width * n:begin + (y + 1) * width * n]]
    return struct.pack(f'<{len(out)}H', *out)


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
    lines = {0: 1, 2: 1, 3: 16, 4: 32}.get(compression)
    if lines is None:
        raise ValueError(f'{path}: compression {compression} is not read, only none, ZIPS, ZIP and PIZ')
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
        if compression == 4:
            block = _unpiz(block, rows * line_bytes, rows, width, [codes[k][1] // 2 for _, k in kinds])
        elif compression:
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
