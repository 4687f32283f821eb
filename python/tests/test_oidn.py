"""The networks of Open Image Denoise are imported; without it, what is refused."""

import json
import math
import struct

import numpy
import pytest
from frames import ROOT, noise

import xrds


def test_no_library(tmp_path):
    library = tmp_path / "library.so"
    library.write_bytes(b"x" * 5000)
    with pytest.raises(xrds.Error, match="is no library of Open Image Denoise"):
        xrds.import_oidn(library, tmp_path / "networks")
    with pytest.raises(xrds.Error):
        xrds.import_oidn(tmp_path / "missing.so", tmp_path)


def test_the_folder_is_that_of_the_environment(tmp_path, monkeypatch):
    monkeypatch.setenv("XRDS_DENOISERS", str(tmp_path))
    assert xrds.denoiser_folder() == tmp_path


def archive():
    """The network rt_hdr_small as Open Image Denoise stores it, with weights of small numbers: those of a golden test, wider."""
    golden = (ROOT / "tests/golden/unet/hdr_small.model.safetensors").read_bytes()
    head = json.loads(golden[8:8 + int.from_bytes(golden[:8], "little")])
    data, table = b"", struct.pack("<I", len(head) - 1)
    for name, tensor in head.items():
        if name == "__metadata__":
            continue
        shape = [{3: 3, 7: 35}.get(side, 8 * side) for side in tensor["shape"]]
        table += struct.pack("<H", len(name)) + name.encode() + struct.pack(f"<B{len(shape)}I", len(shape), *shape)
        table += (b"oihw" if len(shape) == 4 else b"x") + b"h" + struct.pack("<Q", 12 + len(data))
        data += numpy.full(math.prod(shape), 0.01, numpy.float16).tobytes()
    return struct.pack("<HBBQ", 0x41D7, 2, 0, 12 + len(data)) + data + table


def test_a_network_is_imported_and_runs(tmp_path):
    (tmp_path / "rt_hdr_small.tza").write_bytes(archive())
    files = xrds.import_oidn(tmp_path / "rt_hdr_small.tza", tmp_path / "networks")
    assert files == [tmp_path / "networks" / "rt_hdr_small.safetensors"]
    model = xrds.Model(files[0])
    assert (model.scale, model.inputs, model.metadata("size")) == (1, (), "small")
    picture = xrds.upscale(noise(32, 48), model=model)
    assert picture.shape == (32, 48, 3) and numpy.isfinite(picture).all()
