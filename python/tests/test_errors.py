"""What cannot be is answered with a sentence, and nothing is lost."""

import numpy
import pytest
from frames import MODEL, frame, noise

import xrds

COLOUR, IMAGES = frame()
ALBEDO, NORMAL = IMAGES["albedo"], IMAGES["normal"]


@pytest.mark.parametrize("change, words", [
    ({"colour": COLOUR[0]}, r"colour has the shape \[16, 3\]"),
    ({"colour": COLOUR[..., :2]}, r"colour has the shape \[12, 16, 2\], expected \[height, width, 3\]"),
    ({"colour": COLOUR[:0]}, r"colour has the shape \[0, 16, 3\]"),
    ({"albedo": ALBEDO[:-1]}, "albedo is 64 x 47 pixels, expected a whole multiple of the colour's 16 x 12"),
    ({"albedo": ALBEDO[:, :8]}, "albedo is 8 x 48 pixels"),
    ({"normal": NORMAL[::2, ::2]}, "normal is 32 x 24 pixels and the albedo 64 x 48"),
    ({"normal": None}, "takes albedo and normal, but no normal was given"),
    ({"depth": ALBEDO[..., 0]}, "takes albedo and normal, and no depth"),
    ({"model": "xrds-x2-compact"}, "64 x 48"),
    ({"out": noise(5, 5)}, "output image is 5 x 5 pixels, expected 64 x 48"),
    ({"out": ALBEDO}, "shares memory with the albedo"),
    ({"ensemble": 3}, "ensemble is 3, expected 1, 2, 4 or 8"),
    ({"ensemble": 0}, "ensemble is 0"),
    ({"ensemble": 2**40}, "ensemble is 1099511627776"),
    ({"memory": -1}, "memory is -1, expected a whole number"),
    ({"memory": 1e6 + 0.5}, r"memory is 1000000\.5"),
    ({"exposure": 0.0}, "exposure is 0"),
    ({"exposure": float("nan")}, "exposure is nan"),
    ({"skip": -1.0}, "skip"),
    ({"skip": "always"}, "skip is 'always', expected 'safe'"),
    ({"precision": "fp8"}, "precision is 'fp8', expected 'fp32' or 'fp16'"),
    ({"tune": "often"}, "tune is 'often'"),
    ({"full_colour": ALBEDO, "samples": (0, 1)}, "samples are 0 and 1"),
    ({"samples": (-4, 1)}, "samples are -4 and 1"),
    ({"samples": (float("inf"), 1)}, "samples are inf and 1"),
    ({"full_colour": ALBEDO, "samples": (1, 2, 3)}, "samples are 1 and 2 and 3, expected two"),
])
def test_arguments_that_cannot_be(change, words):
    with pytest.raises(ValueError, match=words) as caught:
        xrds.upscale(**{"colour": COLOUR, "albedo": ALBEDO, "normal": NORMAL, "model": MODEL, **change})
    assert isinstance(caught.value, xrds.Error)
    assert str(caught.value).endswith(".")


@pytest.mark.parametrize("change, words", [
    ({"colour": [[1.0]]}, "colour is of type list"),
    ({"colour": None}, "colour is None"),
    ({"colour": COLOUR.astype(numpy.float64)}, "colour has numbers of another type, expected float16 or float32"),
    ({"albedo": ALBEDO.astype(numpy.int32)}, "albedo has numbers of another type"),
    ({"out": numpy.broadcast_to(numpy.float32(0), (48, 64, 3))}, "out is of type ndarray, expected an array that can"),
    ({"out": "out.exr"}, "out is of type str"),
])
def test_what_is_no_array(change, words):
    with pytest.raises(TypeError, match=words):
        xrds.upscale(**{"colour": COLOUR, "albedo": ALBEDO, "normal": NORMAL, "model": MODEL, **change})


@pytest.mark.parametrize("change, words", [
    ({"memory": "64M"}, "memory is '64M', expected a number of bytes, or None"),
    ({"exposure": "auto"}, "exposure is 'auto', expected a number, or None"),
    ({"full_colour": ALBEDO, "samples": 64}, r"samples are 64, expected two numbers, as \(64, 16\)"),
    ({"samples": "64"}, "number of samples is '6', expected two numbers"),
    ({"skip": (1,)}, r"skip is \(1,\), expected 'safe', 'off', a number, or None"),
    ({"wrap": "no"}, "wrap is 'no', expected True or False"),
    ({"merged": 1}, "merged is 1, expected True or False"),
    ({"layers": [ALBEDO]}, "layers are of type list, expected a dict of arrays by their names, or None"),
    ({"progress": 3}, "progress is 3, expected a function, or None"),
])
def test_what_is_of_another_kind(change, words):
    with pytest.raises(TypeError, match=words):
        xrds.upscale(**{"colour": COLOUR, "albedo": ALBEDO, "normal": NORMAL, "model": MODEL, **change})


def test_sizes_are_whole_numbers():
    with pytest.raises(TypeError, match="width is 8.0, expected a whole number of pixels"):
        xrds.Upscaler(16 / 2, 16)
    with pytest.raises(TypeError, match="size or scale is 7.5, expected a whole number"):
        xrds.TemporalFilter(8, 7.5, 4)
    assert xrds.Upscaler(numpy.int64(16), 12, MODEL, ensemble=2.0).width == 16


@pytest.mark.parametrize("change, words", [
    ({"model": "xrds-x4-giant"}, "There is no model 'xrds-x4-giant': give .* one of the shipped models, .*, xrds-x4-nano, "),
    ({"model": "/nowhere/model.safetensors"}, "/nowhere/model.safetensors"),
    ({"device": "no such device"}, 'No Vulkan device matches "no such device"'),
    ({"device": 77}, "77"),
])
def test_the_world(change, words):
    with pytest.raises(xrds.Error, match=words) as caught:
        xrds.upscale(**{"colour": COLOUR, "albedo": ALBEDO, "normal": NORMAL, "model": MODEL, **change})
    assert not isinstance(caught.value, ValueError)


@pytest.mark.parametrize("options", [{}, {"tiles": "exact"}, {"precision": "fp16"}])
def test_too_little_memory(options):
    with pytest.raises(xrds.OutOfMemory, match="0 MB are allowed: allow more"):
        xrds.upscale(COLOUR, model=MODEL, memory=1, **options, **IMAGES)


def test_nothing_is_lost():
    wanted = xrds.upscale(COLOUR, model=MODEL, **IMAGES)
    albedo = ALBEDO.copy()
    for out in (ALBEDO, ALBEDO[::-1], noise(5, 5)):
        with pytest.raises(ValueError):
            xrds.upscale(COLOUR, model=MODEL, out=out, **IMAGES)
    numpy.testing.assert_array_equal(ALBEDO, albedo)
    numpy.testing.assert_array_equal(xrds.upscale(COLOUR, model=MODEL, **IMAGES), wanted)


def test_a_scale_without_a_model():
    with pytest.raises(xrds.Error, match=r"^No model is shipped that upscales by 3 .*\.$"):
        xrds.upscale(COLOUR, albedo=noise(36, 48), normal=noise(36, 48))


def test_a_closed_upscaler_is_refused():
    with xrds.Upscaler(16, 12, MODEL) as upscaler:
        upscaler(COLOUR, **IMAGES)
        assert upscaler.device_bytes > 0 and upscaler.exposure > 0
    with pytest.raises(xrds.ArgumentError, match="upscaler was closed"):
        upscaler(COLOUR, **IMAGES)
    assert upscaler.device_bytes == 0
    device = xrds.Device()
    device.close()
    with pytest.raises(xrds.ArgumentError, match="device was closed"):
        xrds.Upscaler(16, 12, MODEL, device=device)


def test_numbers_as_the_command_takes_them():
    wanted = xrds.upscale(COLOUR, model=MODEL, **IMAGES)
    numpy.testing.assert_array_equal(xrds.upscale(COLOUR, model=MODEL, skip="off", memory=64e6, **IMAGES), wanted)


def test_frames_of_another_size_are_refused():
    with xrds.Upscaler(8, 12, MODEL) as upscaler, pytest.raises(ValueError, match="16 x 12 pixels, expected 8 x 12"):
        upscaler(COLOUR, **IMAGES)
    for size in (0, -1, 2**32):
        with pytest.raises(ValueError, match="pixels, expected 1 to 4294967295"):
            xrds.Upscaler(size, 12, MODEL)
