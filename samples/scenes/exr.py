"""OpenEXR files of scan lines in one part, as arrays. Needs numpy only."""
import contextlib
import os
import struct
import zlib
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np

MAGIC = struct.pack("<ii", 20000630, 2)
LONG_NAMES = struct.pack("<ii", 20000630, 2 | 0x400)  # of attributes and channels: longer than 31 bytes
KINDS = ("<u4", "<f2", "<f4")  # by the number that a channel list has for them
HALF = 1
NONE, ZIP = 0, 3
LINES = {NONE: 1, 2: 1, ZIP: 16}  # scan lines in a block, by compression: none, ZIPS, ZIP


class Picture(NamedTuple):
    """attributes: {name: (type, bytes)} as they are stored, of everything that the channels do not say.
    channels: {name: array [height, width]} of uint32, float16 or float32."""
    attributes: dict
    channels: dict


def _attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def _pack(raw, level):
    """Splits even from odd bytes, stores differences, deflates: OpenEXR's ZIP."""
    flat = np.frombuffer(raw, np.uint8)
    split = np.concatenate([flat[0::2], flat[1::2]])
    split[1:] = split[1:] - split[:-1] + np.uint8(128)  # modulo 256
    packed = zlib.compress(split.tobytes(), level)
    return packed if len(packed) < len(raw) else raw


def _unpack(packed, byte_size):
    if len(packed) == byte_size:
        return packed
    split = np.frombuffer(zlib.decompress(packed), np.uint8).copy()
    split[1:] -= np.uint8(128)
    split = np.cumsum(split, dtype=np.uint8)
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


def _encoding(names, planes):
    """The attributes that the channels decide."""
    height, width = planes[0].shape
    listed = b"".join(name.encode() + b"\0" + struct.pack("<iBxxxii", KINDS.index(plane.dtype.str), 0, 1, 1) for name, plane in zip(names, planes)) + b"\0"
    window = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    return {
        "channels": ("chlist", listed),
        "compression": ("compression", bytes([ZIP])),
        "dataWindow": ("box2i", window),
        "displayWindow": ("box2i", window),
        "lineOrder": ("lineOrder", b"\0"),
    }


@contextlib.contextmanager
def naming(path):
    """Within it, errors of writing name the file, as those of opening do."""
    try:
        yield
    except OSError as error:
        error.filename = error.filename or path
        raise


def save(path, picture, level=9):
    """Writes a Picture as ZIP, deflated at `level`; the file appears whole or not at all."""
    names = sorted(picture.channels, key=str.encode)
    planes = [np.ascontiguousarray(picture.channels[name]) for name in names]
    height = planes[0].shape[0]
    usual = {
        "pixelAspectRatio": ("float", struct.pack("<f", 1)),
        "screenWindowCenter": ("v2f", struct.pack("<ff", 0, 0)),
        "screenWindowWidth": ("float", struct.pack("<f", 1)),
    }
    attributes = {**usual, **picture.attributes, **_encoding(names, planes)}
    long = max(map(len, map(str.encode, [*names, *attributes]))) > 31
    head = (LONG_NAMES if long else MAGIC) + b"".join(_attribute(name, *attributes[name]) for name in sorted(attributes)) + b"\0"

    def block(top):
        lines = range(top, min(top + LINES[ZIP], height))
        packed = _pack(b"".join(plane[y].tobytes() for y in lines for plane in planes), level)
        return struct.pack("<ii", top, len(packed)) + packed

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        blocks = list(pool.map(block, range(0, height, LINES[ZIP])))
    offsets = np.cumsum([len(head) + 8 * len(blocks)] + [len(block) for block in blocks[:-1]])
    part = f"{path}.part"
    try:
        with naming(part), open(part, "wb") as file:
            file.write(head + offsets.astype("<u8").tobytes())
            file.writelines(blocks)
        os.replace(part, path)
    except BaseException:
        if os.path.isfile(part):
            os.remove(part)
        raise


def write(path, channels, samples=0):
    """Writes equally sized 2-D arrays as half floats, ZIP; the file appears whole or not at all. samples: of a pixel, noted
    as Cycles does; 0: not noted."""
    noted = {"cycles.ViewLayer.samples": ("string", str(samples).encode())} if samples else {}
    save(path, Picture(noted, {name: np.asarray(plane).clip(-65504, 65504).astype(KINDS[HALF]) for name, plane in channels.items()}))


def _header(content):
    """The attributes by name, (type, bytes), and the position behind them."""
    if content[:8] not in (MAGIC, LONG_NAMES):
        raise ValueError("is no OpenEXR file of scan lines in one part")
    attributes, at = {}, len(MAGIC)
    while content[at]:
        name, kind, _ = content[at:at + 600].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        (byte_size,) = struct.unpack_from("<i", content, at)
        attributes[name.decode()] = kind.decode(), content[at + 4:at + 4 + byte_size]
        at += 4 + byte_size
    return attributes, at + 1


def load(path):
    """Reads a single-part file stored plain, ZIPS or ZIP as a Picture. Raises ValueError for any other."""
    with open(path, "rb") as file:
        content = file.read()
    attributes, at = _header(content)
    listed, kinds = attributes["channels"][1], {}
    while listed[0]:
        name, listed = listed.split(b"\0", 1)
        kinds[name.decode()] = np.dtype(KINDS[struct.unpack_from("<i", listed)[0]])
        listed = listed[16:]
    left, top, right, bottom = struct.unpack("<iiii", attributes["dataWindow"][1])
    width, height = right - left + 1, bottom - top + 1
    compression = attributes["compression"][1][0]
    if compression not in LINES:
        raise ValueError(f"is compressed by method {compression}, expected none, ZIPS or ZIP")
    step = LINES[compression]
    line_size = sum(width * kind.itemsize for kind in kinds.values())
    channels = {name: np.empty((height, width), kind) for name, kind in kinds.items()}
    for offset in np.frombuffer(content, "<u8", -(-height // step), at):
        y, packed_size = struct.unpack_from("<ii", content, int(offset))
        lines = min(step, height - (y - top))
        raw = _unpack(content[int(offset) + 8:int(offset) + 8 + packed_size], line_size * lines)
        block, begin = np.frombuffer(raw, np.uint8).reshape(lines, line_size), 0
        for name, kind in kinds.items():
            end = begin + width * kind.itemsize
            channels[name][y - top:y - top + lines] = np.ascontiguousarray(block[:, begin:end]).view(kind)
            begin = end
    decided = _encoding(list(channels), list(channels.values())) if channels else {}
    return Picture({name: value for name, value in attributes.items() if name not in decided}, channels)


def read(path):
    """Reads a file as load() does; every channel comes back as float32."""
    return {name: plane.astype(np.float32, copy=False) for name, plane in load(path).channels.items()}
