"""Every layout of pixels gives the same picture."""

import numpy
import pytest
from frames import MODEL, frame, noise

import xrds


class OnlyDlpack:
    """An array of a library that knows nothing of numpy."""

    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **options):
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


def read_only(image):
    image = image.copy()
    image.flags.writeable = False
    return image


def padded(image):
    rows = numpy.zeros((image.shape[0], image.shape[1] + 5, image.shape[2]), image.dtype)
    rows[:, 2:-3] = image
    return rows[:, 2:-3]


def packed(image):
    """At places that are no multiples of the numbers' size."""
    pixels = numpy.zeros(image.shape, numpy.dtype([("id", "u1"), ("value", image.dtype)]))
    pixels["value"] = image
    return pixels["value"]


LAYOUTS = {
    "planes": lambda image: numpy.ascontiguousarray(image.transpose(2, 0, 1)).transpose(1, 2, 0),
    "fortran": numpy.asfortranarray,
    "bottom up": lambda image: image[::-1].copy()[::-1],
    "mirrored": lambda image: image[:, ::-1].copy()[:, ::-1],
    "blue first": lambda image: image[..., ::-1].copy()[..., ::-1],
    "padded": padded,
    "packed": packed,
    "of another machine": lambda image: image.astype(">f4"),
    "read only": read_only,
    "dlpack": OnlyDlpack,
    "alpha": lambda image: numpy.dstack([image, numpy.ones(image.shape[:2], image.dtype)])[..., :3],
}


@pytest.mark.parametrize("layout", LAYOUTS.values(), ids=LAYOUTS.keys())
def test_any_layout_is_read(layout):
    colour, images = frame()
    wanted = xrds.upscale(colour, model=MODEL, **images)
    found = xrds.upscale(layout(colour), model=MODEL, **{name: layout(image) for name, image in images.items()})
    numpy.testing.assert_array_equal(found, wanted)


@pytest.mark.parametrize("layout", ["planes", "bottom up", "blue first", "padded"])
def test_any_layout_is_written(layout):
    colour, images = frame()
    wanted = xrds.upscale(colour, model=MODEL, **images)
    out = LAYOUTS[layout](numpy.full(wanted.shape, -1, numpy.float32))
    assert xrds.upscale(colour, model=MODEL, out=out, **images) is out
    numpy.testing.assert_array_equal(out, wanted)


def test_the_result_has_the_type_of_the_colour():
    colour, images = frame()
    half = colour.astype(numpy.float16)
    found = xrds.upscale(half, model=MODEL, **images)
    wanted = xrds.upscale(half.astype(numpy.float32), model=MODEL, **images)
    assert (found.dtype, wanted.dtype) == (numpy.float16, numpy.float32)
    numpy.testing.assert_array_equal(found, wanted.astype(numpy.float16))


def test_alpha_comes_along():
    colour, images = frame()
    rgba = numpy.dstack([colour, numpy.ones(colour.shape[:2], numpy.float32)])
    rgba[:, :8, 3] = 0
    found = xrds.upscale(rgba, model=MODEL, **images)
    assert found.shape == (48, 64, 4)
    numpy.testing.assert_array_equal(found[..., :3], xrds.upscale(colour, model=MODEL, **images))
    assert (found[:, 0, 3] == 0).all() and (found[:, -1, 3] == 1).all()


@pytest.mark.parametrize("height, width", [(1, 1), (5, 3), (13, 19)])
def test_odd_sizes(height, width):
    colour, images = frame(height, width)
    found = xrds.upscale(colour, model=MODEL, **images)
    assert found.shape == (4 * height, 4 * width, 3) and numpy.isfinite(found).all()


def test_pixels_that_are_not_finite_are_filled():
    colour, images = frame()
    colour[3, 4] = numpy.nan
    images["albedo"][7, 8, 1] = numpy.inf
    assert numpy.isfinite(xrds.upscale(colour, model=MODEL, **images)).all()
    with xrds.Upscaler(colour.shape[1], colour.shape[0], MODEL) as upscaler:
        upscaler(colour, **images)
        assert upscaler.repairs == xrds.Repairs(colour=1, auxiliary=1, output=0)


def test_tensors_of_torch():
    torch = pytest.importorskip("torch")
    colour, images = frame()
    tensors = {name: torch.from_numpy(image) for name, image in images.items()}
    wanted = xrds.upscale(colour, model=MODEL, **images)
    found = xrds.upscale(torch.from_numpy(colour), model=MODEL, **tensors)
    assert isinstance(found, numpy.ndarray)
    numpy.testing.assert_array_equal(found, wanted)
    out = torch.full((3, 48, 64), -1.0).permute(1, 2, 0)
    assert xrds.upscale(torch.from_numpy(colour), model=MODEL, out=out, **tensors) is out
    numpy.testing.assert_array_equal(out.numpy(), wanted)
    with pytest.raises(TypeError, match="float16 or float32"):
        xrds.upscale(torch.from_numpy(colour).to(torch.bfloat16), model=MODEL, **tensors)
    learned = torch.from_numpy(colour).requires_grad_()
    numpy.testing.assert_array_equal(xrds.upscale(learned, model=MODEL, **tensors), wanted)


def test_colours_are_merged_by_their_samples():
    low, full = noise(6, 5, 4), noise(24, 20, seed=2)
    merged = xrds.merge_colour(low, full, samples=(64, 4))
    means = full.reshape(6, 4, 5, 4, 3).mean((1, 3))
    numpy.testing.assert_allclose(merged[..., :3], 0.5 * low[..., :3] + 0.5 * means, rtol=1e-5)
    numpy.testing.assert_array_equal(merged[..., 3], low[..., 3])
    assert xrds.merge_colour(low.astype(numpy.float16), full).dtype == numpy.float16
