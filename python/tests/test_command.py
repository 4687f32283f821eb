"""python -m xrds is the command, and upscale() makes the picture of `xrds upscale`, bit for bit."""

import importlib.metadata
import pathlib
import subprocess
import sys
import warnings

import numpy
import pytest
from frames import MODEL, ROOT, frame, layers, noise, sample, write

import xrds


def command(*words):
    done = subprocess.run([sys.executable, "-m", "xrds", *map(str, words)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def picture(tmp_path, *words):
    command("upscale", *words, "-o", tmp_path / "out.exr", "--quiet")
    return layers(tmp_path / "out.exr")["RGB"]


def files(tmp_path, colour, **images):
    write(tmp_path / "low.exr", colour=colour)
    write(tmp_path / "full.exr", **images)
    return tmp_path / "low.exr", tmp_path / "full.exr"


def piece(row):
    """Of a sample, from there on, which is quick: sky at first, then all kinds of things."""
    colour, albedo, normal = sample("outdoor")
    full = slice(4 * row, 4 * row + 48)
    return colour[row:row + 12, :20], {"albedo": albedo[full, :80], "normal": normal[full, :80]}


def same(found, wanted):
    numpy.testing.assert_array_equal(found.view(numpy.uint32), numpy.ascontiguousarray(wanted).view(numpy.uint32))


def test_the_command_is_there_with_its_models():
    assert command("--version").strip() == f"xrds {xrds.__version__}"
    assert set(xrds.models()) <= set(command("info").split())
    assert subprocess.run([sys.executable, "-m", "xrds", "nothing"], capture_output=True).returncode == 2


def test_a_wheel_has_the_licences_of_what_is_compiled_in():
    try:
        files = importlib.metadata.files("xrds")
    except importlib.metadata.PackageNotFoundError:
        pytest.skip("xrds is not installed as a wheel")
    packages = ("nlohmann-json3-dev", "libcli11-dev", "libvulkan-volk-dev", "libopenexr-dev", "libimath-dev")
    of_packages = [f"{name}.txt" for name in packages if pathlib.Path("/usr/share/doc", name, "copyright").exists()]
    licences = {file.name: file.read_text() for file in files if "licenses" in file.parts}
    assert {"LICENSE", "nanobind.txt", "robin_map.txt", *of_packages} <= licences.keys()
    for name, holder in (("LICENSE", "The xrds authors"), ("nanobind.txt", "Wenzel Jakob"), ("robin_map.txt", "Thibaut Goetghebuer")):
        assert holder in licences[name] and "Copyright" in licences[name]


def test_a_sample(tmp_path):
    colour, albedo, normal = sample("outdoor")
    read = [ROOT / "samples" / f"outdoor_{kind}.exr" for kind in ("lr64", "aux16")]
    same(xrds.upscale(colour, albedo=albedo, normal=normal, model=MODEL), picture(tmp_path, *read, "--model", MODEL))


def test_the_model_that_suits_is_chosen(tmp_path):
    colour, images = piece(36)
    same(xrds.upscale(colour, **images), picture(tmp_path, *files(tmp_path, colour, **images)))


@pytest.mark.parametrize("constant", ["albedo", "normal"])
def test_an_image_that_tells_nothing_is_left_out(tmp_path, constant):
    colour, images = frame()
    images[constant][:] = 0, 0.5, 1
    with pytest.warns(UserWarning, match=f"The {constant} is the same everywhere; taking model xrds-x4-compact-"):
        found = xrds.upscale(colour, **images)
    same(found, picture(tmp_path, *files(tmp_path, colour, **images)))


def test_broken_pixels_are_repaired_alike(tmp_path):
    colour, images = frame()
    full = numpy.repeat(numpy.repeat(colour, 4, 0), 4, 1)
    colour[3, 4], colour[5, 6, 1], colour[7, 7], colour[3, 5] = numpy.nan, -2, (-1, numpy.inf, 1), -1
    images["normal"][5, 5], images["normal"][5, 6] = numpy.nan, -1
    same(xrds.upscale(colour, model=MODEL, **images), picture(tmp_path, *files(tmp_path, colour, **images), "--model", MODEL))
    for samples in (None, (64, 4)):
        words = ["--samples", "64,4"] if samples else []
        wanted = picture(tmp_path, *files(tmp_path, colour, beauty=full, **images), *words)
        same(xrds.upscale(colour, full_colour=full, samples=samples, **images), wanted)
    full[10:13, 20:24], full[13, 20], full[30, 30, 2] = numpy.nan, -1, numpy.inf
    for samples in (None, (64, 4)):
        words = ["--samples", "64,4"] if samples else []
        for model in ("xrds-x4-full", MODEL):
            wanted = picture(tmp_path, *files(tmp_path, colour, beauty=full, **images), "--model", model, *words)
            same(xrds.upscale(colour, full_colour=full, samples=samples, model=model, **images), wanted)


@pytest.mark.parametrize("words, options", [
    (["--precision", "fp16"], {"precision": "fp16"}),
    (["--exposure", "2"], {"exposure": 2.0}),
    (["--ensemble", "2"], {"ensemble": 2}),
    (["--skip", "safe"], {"skip": "safe"}),
    (["--memory", "16M"], {"memory": 16 << 20}),
    (["--wrap"], {"wrap": True}),
])
def test_options_are_those_of_the_command(tmp_path, words, options):
    colour, images = piece(0)
    found = xrds.upscale(colour, model=MODEL, **images, **options)
    same(found, picture(tmp_path, *files(tmp_path, colour, **images), "--model", MODEL, *words))


def test_exact_tiles_have_the_bits_of_the_whole():
    colour, albedo, normal = sample("outdoor")
    images = {"albedo": albedo, "normal": normal, "model": MODEL}
    whole = xrds.upscale(colour, **images)
    same(xrds.upscale(colour, memory=11_300_000, tiles="exact", **images), whole)
    assert not numpy.array_equal(xrds.upscale(colour, memory=11_300_000, **images), whole)


@pytest.mark.parametrize("samples", [None, (64, 4)])
def test_the_colour_of_the_full_render_is_merged(tmp_path, samples):
    low, images = frame()
    full = (numpy.repeat(numpy.repeat(low, 4, 0), 4, 1) * (0.5 + noise(48, 64, seed=4))).astype(numpy.float32)
    words = ["--samples", "64,4"] if samples else []
    wanted = picture(tmp_path, *files(tmp_path, low, beauty=full, **images), *words)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        same(xrds.upscale(low, full_colour=full, samples=samples, **images), wanted)


def test_skipping_takes_a_model_that_can_skip(tmp_path):
    low, images = frame()
    full = numpy.repeat(numpy.repeat(low, 4, 0), 4, 1)
    wanted = picture(tmp_path, *files(tmp_path, low, beauty=full, **images), "--samples", "2,1", "--skip", "safe")
    same(xrds.upscale(low, full_colour=full, samples=(2, 1), skip="safe", **images), wanted)
    same(xrds.upscale(low, samples=(2, 1), skip="safe", **images), xrds.upscale(low, model="xrds-x4-compact", **images))


def test_a_colour_of_other_light_is_left_out(tmp_path):
    low, images = frame()
    full = numpy.repeat(numpy.repeat(3 * low, 4, 0), 4, 1)
    with pytest.warns(UserWarning, match="other light"):
        found = xrds.upscale(low, full_colour=full, **images)
    same(found, xrds.upscale(low, **images))
