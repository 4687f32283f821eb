"""The networks of Open Image Denoise are imported; without it, what is refused."""

import json
import math
import struct

import numpy
import pytest
from frames import FULL_MODEL, MODEL, ROOT, frame, layers, noise, small_denoisers, write
from test_command import command, files, picture, same

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
    return small_denoisers(tmp_path / "denoisers")


@pytest.mark.parametrize("words, options", [
    ([], {}), (["--clean-guides"], {"clean_guides": True}), (["--precision", "fp16"], {"precision": "fp16"}), (["--exposure", "2"], {"exposure": 2.0}),
])
def test_images_are_denoised_first_as_by_the_command(networks, tmp_path, words, options):
    colour, images = frame()
    read = files(tmp_path, colour, **images)
    wanted = picture(tmp_path, *read, "--model", MODEL, "--denoise-first", "--denoisers", networks, *words)
    found = xrds.upscale(colour, model=MODEL, denoise_first=networks, **images, **options)
    same(found, wanted)
    assert not numpy.array_equal(found, xrds.upscale(colour, model=MODEL, **images))


def test_the_full_colour_is_brought_to_the_level_of_the_merged_one(networks, tmp_path):
    colour, images = frame()
    full = (numpy.repeat(numpy.repeat(colour, 4, 0), 4, 1) * (0.5 + noise(48, 64, seed=4))).astype(numpy.float32)
    wanted = picture(tmp_path, *files(tmp_path, colour, beauty=full, **images), "--samples", "16,1", "--model", FULL_MODEL, "--denoise-first", "--denoisers", networks)
    same(xrds.upscale(colour, full_colour=full, samples=(16, 1), model=FULL_MODEL, denoise_first=networks, **images), wanted)


@pytest.mark.parametrize("words, options", [
    (["--ensemble", "2"], {"ensemble": 2}), (["--ensemble", "4", "--clean-guides"], {"ensemble": 4, "clean_guides": True}), (["--ensemble", "8"], {"ensemble": 8}),
    (["--skip", "0.05"], {"skip": 0.05}), (["--wrap"], {"wrap": True}), (["--wrap", "--ensemble", "4", "--precision", "fp16"], {"wrap": True, "ensemble": 4, "precision": "fp16"}),
    (["--memory", "7000000", "--tiles", "exact"], {"memory": 7e6, "tiles": "exact"}),
])
def test_networks_one_after_the_other_are_those_of_the_command(networks, tmp_path, words, options):
    colour, images = frame()
    colour[3, 4], colour[3, 5], colour[0, 0, 2] = numpy.nan, -1, numpy.inf
    images["albedo"][5:7, 5:7], images["normal"][9, 9], images["albedo"][20, 20] = numpy.nan, numpy.inf, 1.5
    model = "xrds-x4-compact" if "memory" in options else "xrds-x4-mini"  # which is prepared in less time
    wanted = picture(tmp_path, *files(tmp_path, colour, **images), "--model", model, "--denoise-first", "--denoisers", networks, *words)
    alpha = noise(12, 16, 1, seed=4)
    with xrds.Upscaler(16, 12, model, denoise_first=networks, **options) as upscaler:
        for _ in range(2):
            same(upscaler(colour, **images), wanted)
        assert upscaler.repairs == (2, 5, 0) and upscaler.exposure > 0 and upscaler.device_bytes > 0
        with_alpha = upscaler(numpy.concatenate([colour, alpha], 2), **images)
        same(with_alpha[..., :3], wanted)
    bicubic = xrds.upscale(numpy.concatenate([colour, alpha], 2), wrap=options.get("wrap", False), **images)[..., 3]
    numpy.testing.assert_array_equal(with_alpha[..., 3], bicubic)


@pytest.mark.parametrize("passes", [2, 8])
def test_an_ensemble_has_a_share_of_the_images_with_their_noise(networks, tmp_path, passes):
    colour, images = frame()
    full = (numpy.repeat(numpy.repeat(colour, 4, 0), 4, 1) * (0.5 + noise(48, 64, seed=4))).astype(numpy.float32)
    full[7, 7], full[7, 8] = numpy.nan, -1
    words = ["--samples", "16,1", "--model", FULL_MODEL, "--denoise-first", "--denoisers", networks, "--ensemble", passes]
    wanted = picture(tmp_path, *files(tmp_path, colour, beauty=full, **images), *words)
    given = {"full_colour": full, "samples": (16, 1), "model": FULL_MODEL, "denoise_first": networks, "ensemble": passes, **images}
    same(xrds.upscale(colour, **given), wanted)
    half = xrds.upscale(colour, out=numpy.empty((48, 64, 3), numpy.float16), **given)
    numpy.testing.assert_array_equal(half, wanted.astype(numpy.float16))


@pytest.mark.parametrize("options", [{"ensemble": 2}, {"layers": {"Emit": noise(12, 16)}}])
def test_distances_stay_as_they_are(networks, options):
    model = ROOT / "tests/golden/s4_depth.model.safetensors"
    images = {name: image for name, image in {**frame()[1], "depth": noise(48, 64)[..., 0]}.items() if name in xrds.Model(model).inputs}
    assert "depth" in images
    found = xrds.upscale(noise(12, 16), model=model, denoise_first=networks, **images, **options)
    wanted = xrds.upscale(noise(12, 16), model=model, denoise_first=networks, **images)
    picture = found[0] if "layers" in options else found
    assert 0.5 < picture.mean() / wanted.mean() < 2


def test_denoised_windows_that_did_not_change_are_kept(networks):
    colour, images = frame()
    options = {"denoise_first": networks, "exposure": 1.0, "tiles": "exact"}
    with xrds.Upscaler(16, 12, MODEL, keep_unchanged=True, **options) as keeping, xrds.Upscaler(16, 12, MODEL, ensemble=1, skip=0, wrap=False, **options) as whole:
        first = keeping(colour, **images)
        same(keeping(colour, **images), first)
        numpy.testing.assert_allclose(first, whole(colour, **images), rtol=1e-3, atol=1e-3 * first.mean())


def test_of_a_denoised_colour_the_part_is_changed_that_the_model_states(networks):
    model = ROOT / "tests/golden/s1_restrained.model.safetensors"
    images = {"albedo": noise(12, 16, seed=2), "normal": noise(12, 16, seed=3)}
    clean = numpy.maximum(xrds.denoise(noise(12, 16), guides="clean", denoisers=networks, **images), 0)
    whole = xrds.upscale(clean, model=model, **images)
    wanted = clean + numpy.where(whole < clean, 0.75, 0.25) * (whole - clean)
    found = xrds.upscale(clean, model=model, denoised_colour=True, **images)
    numpy.testing.assert_allclose(found, wanted, rtol=1e-5, atol=1e-6)
    first = {"model": model, "denoise_first": networks, "clean_guides": True, **images}
    numpy.testing.assert_allclose(xrds.upscale(noise(12, 16), **first), wanted, rtol=1e-3, atol=1e-3 * wanted.mean())
    picture, layers = xrds.upscale(noise(12, 16), layers={"Emit": noise(12, 16)}, **first)
    numpy.testing.assert_allclose(picture, wanted, rtol=1e-3, atol=1e-3 * wanted.mean())
    numpy.testing.assert_allclose(layers["Emit"], picture, rtol=1e-5)


def test_networks_that_are_missing_are_named(networks, monkeypatch):
    colour, images = frame()
    assert xrds.can_denoise(networks)
    (networks / "rt_nrm.safetensors").unlink()
    monkeypatch.setenv("XRDS_DENOISERS", str(networks))
    assert not xrds.can_denoise()
    with pytest.raises(xrds.Error, match="no network rt_nrm"):
        xrds.upscale(colour, model=MODEL, denoise_first=True, **images)
    assert numpy.isfinite(xrds.upscale(colour, model=MODEL, denoise_first=True, clean_guides=True, **images)).all()
    with pytest.raises(xrds.ArgumentError, match="clean_guides .* give denoise_first"):
        xrds.upscale(colour, model=MODEL, clean_guides=True, **images)


def denoised(tmp_path, networks, colour, images, *words):
    """What `xrds denoise` makes."""
    write(tmp_path / "render.exr", colour=colour, **images)
    command("denoise", tmp_path / "render.exr", "-o", tmp_path / "out.exr", "--denoisers", networks, "--quiet", *words)
    return layers(tmp_path / "out.exr")["RGB"]


@pytest.mark.parametrize("words, options", [
    ([], {}), (["--guides", "clean"], {"guides": "clean"}), (["--precision", "fp16"], {"precision": "fp16"}), (["--exposure", "2"], {"exposure": 2.0}),
    (["--guides", "noisy", "--quality", "fast"], {"guides": "noisy", "quality": "fast"}),
])
def test_a_render_is_denoised_as_by_the_command(networks, tmp_path, words, options):
    (networks / "rt_hdr_alb_nrm_small.safetensors").write_bytes((networks / "rt_hdr_calb_cnrm_large.safetensors").read_bytes())
    colour = noise(12, 20)
    images = {"albedo": noise(12, 20, seed=2), "normal": noise(12, 20, seed=3)}
    for image in (colour, *images.values()):
        image[3, 4], image[3, 5], image[7, 7:9, 1], image[8, 8] = numpy.nan, -1, numpy.inf, 1.5
    wanted = denoised(tmp_path, networks, colour, images, *words)
    same(xrds.denoise(colour, denoisers=networks, **images, **options), wanted)
    with xrds.Denoiser(20, 12, denoisers=networks, **options) as denoiser:
        out = numpy.empty_like(colour)
        assert denoiser(colour, out=out, **images) is out
        same(out, wanted)
        assert denoiser.device_bytes > 0


def test_a_render_with_an_albedo_alone(networks, tmp_path):
    (networks / "rt_hdr_alb.safetensors").write_bytes((ROOT / "tests/golden/unet/hdr_albedo_base.model.safetensors").read_bytes())
    colour, albedo = noise(12, 20), noise(12, 20, seed=2)
    found = xrds.denoise(colour, albedo=albedo, denoisers=networks)
    same(found, denoised(tmp_path, networks, colour, {"albedo": albedo}))
    clean = xrds.upscale(albedo, model=networks / "rt_alb.safetensors")
    same(found, xrds.denoise(colour, albedo=clean, guides="clean", denoisers=networks))
    assert not numpy.array_equal(found, xrds.denoise(colour, albedo=albedo, guides="clean", denoisers=networks))


def test_a_render_without_guides(networks, tmp_path):
    (networks / "rt_hdr_small.safetensors").write_bytes((ROOT / "tests/golden/unet/hdr_small.model.safetensors").read_bytes())
    colour = noise(12, 20, channels=4)
    found = xrds.denoise(colour, quality="fast", denoisers=networks)
    same(found[..., :3], denoised(tmp_path, networks, colour[..., :3], {}, "--quality", "fast"))
    numpy.testing.assert_array_equal(found[..., 3], colour[..., 3])


def test_a_colour_from_0_to_1(networks, tmp_path):
    colour, images = noise(12, 20), {"albedo": noise(12, 20, seed=2), "normal": noise(12, 20, seed=3)}
    with pytest.raises(xrds.Error, match="no network rt_ldr_calb_cnrm of"):
        xrds.denoise(colour, ldr=True, denoisers=networks, **images)
    (networks / "rt_ldr_calb_cnrm.safetensors").write_bytes((ROOT / "tests/golden/unet/ldr_albedo_normal_small.model.safetensors").read_bytes())
    found = xrds.denoise(colour, ldr=True, denoisers=networks, **images)
    same(found, denoised(tmp_path, networks, colour, images, "--ldr"))


def test_tiles_have_the_bits_of_the_whole(networks):
    (networks / "rt_hdr_small.safetensors").write_bytes((ROOT / "tests/golden/unet/hdr_small.model.safetensors").read_bytes())
    colour = noise(128, 1024)
    options = {"inputs": (), "quality": "fast", "denoisers": networks, "exposure": 1.0}
    with xrds.Denoiser(1024, 128, **options) as whole, xrds.Denoiser(1024, 128, memory=whole.device_bytes * 3 // 4, **options) as tiled:
        assert tiled.device_bytes < whole.device_bytes
        same(tiled(colour), whole(colour))


def test_a_denoiser_refuses_what_cannot_be(networks):
    colour, albedo = noise(12, 20), noise(12, 20, seed=2)
    for options, sentence in (
        ({"normal": albedo}, "takes albedo and normal, albedo, or nothing"),
        ({"albedo": noise(24, 40), "normal": albedo}, "The albedo is 40 x 24 pixels, expected 20 x 12"),
        ({"guides": "wrong"}, "guides is 'wrong'"),
        ({"quality": "wrong"}, "quality is 'wrong'"),
        ({"ldr": True, "exposure": 2.0}, "exposure .* cannot go with ldr"),
    ):
        with pytest.raises(xrds.ArgumentError, match=sentence):
            xrds.denoise(colour, denoisers=networks, **options)
    with pytest.raises(xrds.Error, match="no network rt_hdr_alb of"):
        xrds.denoise(colour, albedo=albedo, denoisers=networks)
    with pytest.raises(TypeError, match="The albedo"):
        xrds.denoise(colour, albedo=3, normal=albedo, denoisers=networks)
    with pytest.raises(xrds.ArgumentError, match="This denoiser takes albedo and normal, and got albedo"):
        xrds.Denoiser(20, 12, denoisers=networks)(colour, albedo=albedo)


def test_progress_of_a_denoiser_rises_and_can_end_it(networks):
    images = {"albedo": noise(12, 20, seed=2), "normal": noise(12, 20, seed=3)}
    shares = []
    xrds.denoise(noise(12, 20), denoisers=networks, **images, progress=lambda stage, share: shares.append(share) if stage == "upscaling" else None)
    assert shares == sorted(shares) and shares[-1] == 1 and len(set(shares)) >= 3
    with pytest.raises(xrds.Cancelled):
        xrds.denoise(noise(12, 20), denoisers=networks, **images, progress=lambda stage, share: stage != "upscaling" or share < 0.5)


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
    picture = xrds.upscale(noise(12, 20), model=model)
    assert picture.shape == (12, 20, 3) and numpy.isfinite(picture).all()
