"""Layers of light: they add up to the picture."""

import numpy
import pytest
from frames import MODEL, frame, noise, small_denoisers, write
from frames import layers as layers_of
from test_command import command

import xrds

COLOUR, IMAGES = frame()
LIGHT = {"DiffDir": noise(12, 16, seed=5), "DiffInd": noise(12, 16, seed=6) / 4, "Emit": noise(12, 16, seed=7) / 4}
LOW, FULL = noise(12, 16, seed=8), noise(48, 64, seed=9)
LAYERS = {**LIGHT, "DiffCol": (LOW, FULL)}
SUM = (LIGHT["DiffDir"] + LIGHT["DiffInd"]) * LOW + LIGHT["Emit"]


def total(found, dot=""):
    return (found[dot + "DiffDir"] + found[dot + "DiffInd"]) * found[dot + "DiffCol"] + found[dot + "Emit"]


def test_add_up_to_the_picture():
    picture, found = xrds.upscale(SUM, model=MODEL, layers=LAYERS, **IMAGES)
    assert list(sorted(found)) == sorted(LAYERS)
    assert all(image.shape == (48, 64, 3) and image.dtype == numpy.float32 and image.min() >= 0 for image in found.values())
    numpy.testing.assert_allclose(total(found), picture, rtol=1e-5)
    assert (found["DiffCol"] == FULL).all()
    assert (picture == xrds.upscale(SUM, model=MODEL, **IMAGES)).all()


def test_with_view_layer_merged_and_halves():
    layers = {"ViewLayer." + name: array for name, array in LAYERS.items()}
    with xrds.Upscaler(16, 12, MODEL) as upscaler:
        full = noise(48, 64, seed=10)
        picture, found = upscaler(SUM, layers=layers, full_colour=full, samples=(64, 16), **IMAGES)
        numpy.testing.assert_allclose(total(found, "ViewLayer."), picture, rtol=1e-5)


def test_light_groups_add_up_by_themselves():
    groups = {"Combined_key": 0.25 * SUM, "Combined_fill": 0.75 * SUM}
    picture, found = xrds.upscale(SUM, model=MODEL, layers={**LAYERS, **groups}, **IMAGES)
    numpy.testing.assert_allclose(total(found), picture, rtol=1e-5)
    numpy.testing.assert_allclose(found["Combined_key"] + found["Combined_fill"], picture, rtol=1e-5)
    numpy.testing.assert_allclose(found["Combined_key"], 0.25 * picture, rtol=1e-4)


def test_too_much_light_is_told():
    with pytest.warns(UserWarning, match="200 %"):
        xrds.upscale(SUM, model=MODEL, layers={"a": SUM, "b": SUM}, **IMAGES)


@pytest.mark.parametrize(
    "layers, words",
    [
        ({}, "no light"),
        ({"DiffCol": (LOW, FULL)}, "no light"),
        ({"DiffDir": COLOUR, "DiffCol": LOW}, "expected .low, full."),
        ({"Emit": (LOW, FULL)}, "is a pair"),
        ({"Emit": noise(12, 15)}, "15 x 12"),
        ({"DiffDir": COLOUR, "DiffCol": (LOW, LOW)}, "full-resolution colour pass"),
    ],
)
def test_refusals(layers, words):
    with pytest.raises(xrds.ArgumentError, match=words):
        xrds.upscale(SUM, model=MODEL, layers=layers, **IMAGES)


def test_not_with_skipped_windows():
    with pytest.raises(xrds.ArgumentError, match="leaves out windows"):
        xrds.upscale(SUM, model=MODEL, layers=LAYERS, skip="safe", **IMAGES)


@pytest.fixture
def networks(tmp_path):
    return small_denoisers(tmp_path / "denoisers")


GROUPS = {"Combined_key": 0.25 * SUM, "Combined_fill": 0.75 * SUM}


def near(found, wanted):
    """The networks of random weights make much of a rounding."""
    numpy.testing.assert_allclose(found, wanted, rtol=1e-3, atol=1e-3 * wanted.mean())


@pytest.mark.parametrize("words, options", [([], {}), (["--clean-guides"], {"clean_guides": True})])
def test_denoised_first_they_are_those_of_the_command(networks, tmp_path, words, options):
    write(tmp_path / "low.exr", colour=SUM, **LIGHT, **GROUPS, DiffCol=LOW)
    write(tmp_path / "full.exr", DiffCol=FULL, **IMAGES)
    command("upscale", tmp_path / "low.exr", tmp_path / "full.exr", "-o", tmp_path / "out.exr", "--model", MODEL, "--denoise-first", "--denoisers", networks, "--layers", "all", *words)
    wanted = layers_of(tmp_path / "out.exr")
    with xrds.Upscaler(16, 12, MODEL, denoise_first=networks, **options) as upscaler:
        alone = upscaler(SUM, **IMAGES)
        picture, found = upscaler(SUM, layers={**LAYERS, **GROUPS}, **IMAGES)
        assert upscaler.exposure > 0 and upscaler.device_bytes > 0
    near(picture, alone)
    for name, image in {"Combined": picture, **found}.items():
        numpy.testing.assert_array_equal(image, wanted[name])
    numpy.testing.assert_allclose(total(found), picture, rtol=1e-5)
    numpy.testing.assert_allclose(found["Combined_key"] + found["Combined_fill"], picture, rtol=1e-5)
    with pytest.raises(xrds.Error):
        upscaler(SUM, layers=LAYERS, **IMAGES)  # closed


def test_layers_that_are_denoised_warn_where_they_add_up_to_more(networks):
    with pytest.warns(UserWarning, match="add up to 2"):
        xrds.upscale(SUM, model=MODEL, layers={"Emit": 2 * SUM}, denoise_first=networks, **IMAGES)


@pytest.mark.parametrize("words, options", [([], {}), (["--ensemble", "2", "--denoise-first"], {"ensemble": 2}), (["--denoise-first"], {})])
def test_broken_pixels_are_repaired_as_by_the_command(networks, tmp_path, words, options):
    given = {name: image.copy() for name, image in {"colour": SUM, **LIGHT, "low": LOW, "full": FULL, **IMAGES}.items()}
    for image in given.values():
        image[3, 4], image[3, 5], image[7, 7:9, 1] = numpy.nan, -1, numpy.inf
    lights = {name: given[name] for name in LIGHT}
    images = {name: given[name] for name in IMAGES}
    write(tmp_path / "low.exr", colour=given["colour"], DiffCol=given["low"], **lights)
    write(tmp_path / "full.exr", DiffCol=given["full"], **images)
    if words:
        words, options = [*words, "--denoisers", networks], {**options, "denoise_first": networks}
    command("upscale", tmp_path / "low.exr", tmp_path / "full.exr", "-o", tmp_path / "out.exr", "--model", MODEL, "--layers", "all", *words)
    wanted = layers_of(tmp_path / "out.exr")
    picture, found = xrds.upscale(given["colour"], model=MODEL, layers={**lights, "DiffCol": (given["low"], given["full"])}, **images, **options)
    for name, image in {"Combined": picture, **found}.items():
        numpy.testing.assert_array_equal(image, wanted[name])


@pytest.mark.parametrize("guides", ["prefilter", "clean"])
def test_of_a_denoised_render_they_are_those_of_the_command(networks, tmp_path, guides):
    images = {"albedo": noise(12, 16, seed=2), "normal": noise(12, 16, seed=3)}
    given = {**LIGHT, **GROUPS, "DiffCol": LOW}
    write(tmp_path / "render.exr", colour=SUM, **images, **given)
    command("denoise", tmp_path / "render.exr", "-o", tmp_path / "out.exr", "--denoisers", networks, "--guides", guides, "--layers", "all")
    wanted = layers_of(tmp_path / "out.exr")
    picture, found = xrds.denoise(SUM, layers=given, guides=guides, denoisers=networks, **images)
    assert (picture == xrds.denoise(SUM, guides=guides, denoisers=networks, **images)).all()
    for name, image in {"Combined": picture, **found}.items():
        numpy.testing.assert_array_equal(image, wanted[name])
    numpy.testing.assert_allclose(total(found), numpy.maximum(picture, 0), rtol=1e-5)
    assert (found["DiffCol"] == LOW).all() == (guides == "clean")


@pytest.mark.parametrize(
    "layers, words",
    [({}, "no light"), ({"DiffDir": COLOUR, "DiffCol": (LOW, LOW)}, "there is one render"), ({"Emit": noise(12, 15)}, "15 x 12 pixels, expected 16 x 12")],
)
def test_refusals_of_a_denoiser(networks, layers, words):
    with pytest.raises(xrds.ArgumentError, match=words):
        xrds.denoise(SUM, layers=layers, denoisers=networks, albedo=LOW, normal=LOW)


@pytest.mark.parametrize("layers", [{"Emit": SUM / 2}, {"Combined_key": SUM / 3}, {"DiffDir": LIGHT["DiffDir"], "DiffCol": LOW}])
def test_a_part_of_the_light_is_denoised_as_a_part(networks, layers):
    images = {"albedo": noise(12, 16, seed=2), "normal": noise(12, 16, seed=3)}
    picture, found = xrds.denoise(SUM, layers=layers, denoisers=networks, **images)
    radiance = found.get("Emit", found.get("Combined_key")) if "DiffDir" not in found else found["DiffDir"] * found["DiffCol"]
    assert 0.05 < radiance.sum() / numpy.maximum(picture, 0).sum() < 0.95
    assert (radiance <= numpy.maximum(picture, 0) * 1.00001).all()
    upscaled = {name: (both, noise(48, 64, seed=9)) if name.endswith("Col") else both for name, both in layers.items()}
    picture, found = xrds.upscale(SUM, model=MODEL, layers=upscaled, denoise_first=networks, **IMAGES)
    assert all(numpy.isfinite(image).all() for image in found.values())
