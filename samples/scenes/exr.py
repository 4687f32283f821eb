"""OpenEXR scan-line files as a dictionary from channel name to a 2-D array. Needs numpy only."""
import os
import struct
import zlib

import numpy as np

MAGIC = struct.pack("<ii", 20000630, 2)
HALF, FLOAT = 1, 2
ZIP = 3
LINES = {0: 1, 2: 1, 3: 16}  # scan lines in a block, by compression: none, ZIPS, ZIP


def _attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def _pack(raw):
    """Splits even from odd bytes, stores differences, deflates: OpenEXR's ZIP."""
    flat = np.frombuffer(raw, np.uint8)
    split = np.concatenate([flat[0::2], flat[1::2]]).astype(np.int16)
    split[1:] = split[1:] - split[:-1] + 128
    packed = zlib.compress(split.astype(np.uint8).tobytes(), 9)
    return packed if len(packed) < len(raw) else raw


def _unpack(packed, byte_size):
    if len(packed) == byte_size:
        return packed
    split = np.frombuffer(zlib.decompress(packed), np.uint8).astype(np.int64)
    split[1:] -= 128
    split = np.cumsum(split).astype(np.uint8)
    half = (byte_size + 1) // 2
    flat = np.empty(byte_size, np.uint8)
    flat[0::2], flat[1::2] = split[:half], split[half:]
    return flat.tobytes()


def on_grid(plane, step):
    """Rounds to multiples of `step`: fewer bits, a smaller file."""
    return np.round(np.asarray(plane, np.float64) / step) * step


def rounded(plane, bits):
    """Rounds to `bits` bits behind the leading one; half has ten."""
    share, exponent = np.frexp(np.asarray(plane, np.float64))
    return np.ldexp(on_grid(share, 0.5 ** (bits + 1)), exponent)


def write(path, channels):
    """Writes equally sized 2-D arrays as half floats, ZIP; the file appears whole or not at all."""
    names = sorted(channels)
    planes = [np.asarray(channels[name]).clip(-65504, 65504).astype("<f2") for name in names]
    height, width = planes[0].shape
    listed = b"".join(n.encode() + b"\0" + struct.pack("<iBxxxii", HALF, 0, 1, 1) for n in names) + b"\0"
    window = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    head = MAGIC + b"".join([
        _attribute("channels", "chlist", listed),
        _attribute("compression", "compression", bytes([ZIP])),
        _attribute("dataWindow", "box2i", window),
        _attribute("displayWindow", "box2i", window),
        _attribute("lineOrder", "lineOrder", b"\0"),
        _attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
        _attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)),
        _attribute("screenWindowWidth", "float", struct.pack("<f", 1)),
    ]) + b"\0"
    blocks = []
    for top in range(0, height, LINES[ZIP]):
        lines = range(top, min(top + LINES[ZIP], height))
        packed = _pack(b"".join(plane[y].tobytes() for y in lines for plane in planes))
        blocks.append(struct.pack("<ii", top, len(packed)) + packed)
    offsets = np.cumsum([len(head) + 8 * len(blocks)] + [len(block) for block in blocks[:-1]])
    part = f"{path}.part"
    with open(part, "wb") as file:
        file.write(head + offsets.astype("<u8").tobytes() + b"".join(blocks))
    os.replace(part, path)


def _header(content):
    """The attributes by name, and the position behind them."""
    attributes, at = {}, len(MAGIC)
    while content[at]:
        name, kind, _ = content[at:at + 600].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        (byte_size,) = struct.unpack_from("<i", content, at)
        attributes[name.decode()] = content[at + 4:at + 4 + byte_size]
        at += 4 + byte_size
    return attributes, at + 1


def read(path):
    """Reads a single-part file stored plain, ZIPS or ZIP; half and float channels come back as float32."""
    with open(path, "rb") as file:
        content = file.read()
    attributes, at = _header(content)
    listed, names, kinds = attributes["channels"], [], []
    while listed[0]:
        name, listed = listed.split(b"\0", 1)
        names.append(name.decode())
        kinds.append({HALF: "<f2", FLOAT: "<f4"}[struct.unpack_from("<i", listed)[0]])
        listed = listed[16:]
    left, top, right, bottom = struct.unpack("<iiii", attributes["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    step = LINES[attributes["compression"][0]]
    line_size = sum(width * np.dtype(kind).itemsize for kind in kinds)
    image = {name: np.empty((height, width), np.float32) for name in names}
    count = -(-height // step)
    for offset in np.frombuffer(content, "<u8", count, at):
        y, packed_size = struct.unpack_from("<ii", content, int(offset))
        lines = range(y - top, min(y - top + step, height))
        raw = _unpack(content[int(offset) + 8:int(offset) + 8 + packed_size], line_size * len(lines))
        begin = 0
        for line in lines:
            for name, kind in zip(names, kinds):
                image[name][line] = np.frombuffer(raw, kind, width, begin)
                begin += width * np.dtype(kind).itemsize
    return image
