"""The networks of Open Image Denoise are imported; without it, what is refused."""

import json
import math
import struct

import numpy
import pytest
from frames import MODEL, ROOT, frame, noise
from test_command import files, picture, same

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


@pytest.fixture
def networks(tmp_path):
    """Small ones of random weights under the names of Open Image Denoise's."""
    folder = tmp_path / "denoisers"
    folder.mkdir()
    for name, golden in {"rt_hdr_calb_cnrm_large": "hdr_albedo_normal_large", "rt_alb": "albedo_small", "rt_nrm": "normal_small"}.items():
        (folder / f"{name}.safetensors").write_bytes((ROOT / f"tests/golden/unet/{golden}.model.safetensors").read_bytes())
    return folder


@pytest.mark.parametrize("words, options", [
    ([], {}), (["--clean-guides"], {"clean_guides": True}), (["--precision", "fp16"], {"precision": "fp16"}), (["--exposure", "2"], {"exposure": 2.0}),
])
def test_images_are_denoised_first_as_by_the_command(networks, tmp_path, words, options):
    colour, images = frame(12, 16)
    read = files(tmp_path, colour, **images)
    wanted = picture(tmp_path, *read, "--model", MODEL, "--denoise-first", "--denoisers", networks, *words)
    found = xrds.upscale(colour, model=MODEL, denoise_first=networks, **images, **options)
    same(found, wanted)
    assert not numpy.array_equal(found, xrds.upscale(colour, model=MODEL, **images))


def test_the_full_colour_is_brought_to_the_level_of_the_merged_one(networks, tmp_path):
    colour, images = frame(12, 16)
    full = (numpy.repeat(numpy.repeat(colour, 4, 0), 4, 1) * (0.5 + noise(48, 64, seed=4))).astype(numpy.float32)
    wanted = picture(tmp_path, *files(tmp_path, colour, beauty=full, **images), "--samples", "16,1", "--model", "xrds-x4-full", "--denoise-first", "--denoisers", networks)
    same(xrds.upscale(colour, full_colour=full, samples=(16, 1), model="xrds-x4-full", denoise_first=networks, **images), wanted)


def test_networks_that_are_missing_are_named(networks, monkeypatch):
    colour, images = frame(12, 16)
    assert xrds.can_denoise(networks)
    (networks / "rt_nrm.safetensors").unlink()
    monkeypatch.setenv("XRDS_DENOISERS", str(networks))
    assert not xrds.can_denoise()
    with pytest.raises(xrds.Error, match="no network rt_nrm"):
        xrds.upscale(colour, model=MODEL, denoise_first=True, **images)
    assert numpy.isfinite(xrds.upscale(colour, model=MODEL, denoise_first=True, clean_guides=True, **images)).all()
    with pytest.raises(xrds.ArgumentError, match="ensemble"):
        xrds.upscale(colour, model=MODEL, denoise_first=True, clean_guides=True, ensemble=2, **images)


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
