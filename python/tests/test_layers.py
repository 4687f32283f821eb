"""Layers of light: they add up to the picture."""

import numpy
import pytest
from frames import MODEL, frame, noise

import xrds

COLOUR, IMAGES = frame(24, 32)
LIGHT = {"DiffDir": noise(24, 32, seed=5), "DiffInd": noise(24, 32, seed=6) / 4, "Emit": noise(24, 32, seed=7) / 4}
LOW, FULL = noise(24, 32, seed=8), noise(96, 128, seed=9)
LAYERS = {**LIGHT, "DiffCol": (LOW, FULL)}
SUM = (LIGHT["DiffDir"] + LIGHT["DiffInd"]) * LOW + LIGHT["Emit"]


def total(found, dot=""):
    return (found[dot + "DiffDir"] + found[dot + "DiffInd"]) * found[dot + "DiffCol"] + found[dot + "Emit"]


def test_add_up_to_the_picture():
    picture, found = xrds.upscale(SUM, model=MODEL, layers=LAYERS, **IMAGES)
    assert list(sorted(found)) == sorted(LAYERS)
    assert all(image.shape == (96, 128, 3) and image.dtype == numpy.float32 and image.min() >= 0 for image in found.values())
    numpy.testing.assert_allclose(total(found), picture, rtol=1e-5)
    assert (found["DiffCol"] == FULL).all()
    assert (picture == xrds.upscale(SUM, model=MODEL, **IMAGES)).all()


def test_with_view_layer_merged_and_halves():
    layers = {"ViewLayer." + name: array for name, array in LAYERS.items()}
    with xrds.Upscaler(32, 24, MODEL) as upscaler:
        full = noise(96, 128, seed=10)
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
        ({"Emit": noise(24, 31)}, "31 x 24"),
        ({"DiffDir": COLOUR, "DiffCol": (LOW, LOW)}, "full-resolution colour pass"),
    ],
)
def test_refusals(layers, words):
    with pytest.raises(xrds.ArgumentError, match=words):
        xrds.upscale(SUM, model=MODEL, layers=layers, **IMAGES)


def test_not_with_skipped_windows():
    with pytest.raises(xrds.ArgumentError, match="leaves out windows"):
        xrds.upscale(SUM, model=MODEL, layers=LAYERS, skip="safe", **IMAGES)
