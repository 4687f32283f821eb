"""Frames of an animation, merged along their motion."""

import numpy
import pytest
from frames import MODEL, frame, noise

import xrds

WIDTH, HEIGHT, SCALE = 32, 24, 4
FULL = (SCALE * HEIGHT, SCALE * WIDTH)
ALBEDO = numpy.full((*FULL, 3), 0.5, numpy.float32)
NORMAL = numpy.zeros((*FULL, 3), numpy.float32) + numpy.float32([0, 0, 1])
STILL = numpy.zeros((*FULL, 2), numpy.float32)


def still(seed, **more):
    """A frame of even light and noise, seen by a camera that stands still."""
    images = {"colour": noise(HEIGHT, WIDTH, seed=seed), "full_colour": noise(*FULL, seed=100 + seed)}
    fields = {**images, "albedo": ALBEDO, "normal": NORMAL, "depth": numpy.ones(FULL, numpy.float32),
              "to_previous": STILL, "to_next": STILL, **more}
    return xrds.TemporalFrame(**fields)


@pytest.fixture(scope="module")
def merging():
    with xrds.TemporalFilter(WIDTH, HEIGHT, SCALE) as made:
        assert made.device_bytes > 0
        yield made


def test_the_progress_of_an_upscaler_may_ask_for_its_memory(merging):
    heard = []
    with xrds.Upscaler(8, 8, MODEL, device=merging.device) as upscaler:
        upscaler(noise(8, 8), albedo=noise(32, 32), normal=noise(32, 32), progress=lambda stage, share: heard.append(merging.device_bytes))
    assert set(heard) == {merging.device_bytes}


def test_broken_pixels_count_as_their_neighbours(merging):
    even = numpy.full_like(noise(*FULL), 0.5)
    broken = even.copy()
    broken[40:43, 50:53], broken[7, 7, 1] = numpy.nan, numpy.inf
    frames = [still(seed, full_colour=even, albedo=even, normal=even) for seed in range(2)]
    wanted = merging(*frames[:1], frames[1:])
    found = merging(still(0, full_colour=broken, albedo=broken, normal=broken), frames[1:])
    for name in ("full_colour", "albedo", "normal"):
        numpy.testing.assert_array_equal(getattr(found, name), getattr(wanted, name))


def test_noise_gets_less(merging):
    frames = [still(seed) for seed in range(11)]
    merged = merging(frames[5], frames[4::-1], frames[6:])
    for name, given in (("colour", frames[5].colour), ("full_colour", frames[5].full_colour)):
        found = getattr(merged, name)
        assert found.shape == given.shape and found.dtype == numpy.float32
        assert found.std() < 0.6 * given.std()
    assert merged.low_counts.shape == (HEIGHT, WIDTH) and merged.low_counts.mean() > 4
    assert merged.full_counts.shape == FULL
    numpy.testing.assert_allclose(merged.albedo, ALBEDO, atol=1e-4)
    assert merged.depth is frames[5].depth


def test_a_frame_alone_stays(merging):
    alone = still(1)
    merged = merging(alone)
    numpy.testing.assert_allclose(merged.colour, alone.colour, rtol=1e-4)
    assert (merged.low_counts == 1).all()


def test_what_moves_away_is_no_help(merging):
    gone = numpy.full((*FULL, 2), 1e6, numpy.float32)
    merged = merging(still(1, to_previous=gone), [still(2)])
    numpy.testing.assert_allclose(merged.colour, still(1).colour, rtol=1e-4)


def test_the_result_is_the_same_again_and_of_other_layouts(merging):
    def other(frame):
        return xrds.TemporalFrame(
            numpy.asfortranarray(frame.colour), frame.full_colour[:, :, ::-1][:, :, ::-1], frame.albedo.astype(numpy.float16),
            frame.normal.astype(numpy.float16), numpy.asfortranarray(frame.depth), frame.to_previous.astype(numpy.float16), frame.to_next)

    frames = [still(seed) for seed in (1, 2, 3)]
    first, second = merging(frames[0], frames[1:2], frames[2:]), merging(other(frames[0]), [other(frames[1])], [other(frames[2])])
    assert (first.colour == second.colour).all() and (first.full_colour == second.full_colour).all()


def test_live_the_last_result_is_the_history(merging):
    history = merging(still(1))
    for seed in (2, 3, 4):
        history = merging(still(seed), [history])
    assert history.low_counts.mean() > 2.5
    assert history.colour.std() < 0.7 * still(4).colour.std()


def test_cycles_motion():
    vector = numpy.arange(2 * 3 * 4, dtype=numpy.float32).reshape(2, 3, 4)
    to_previous, to_next = xrds.cycles_motion(vector)
    assert (to_previous[1, 2] == [20, -21]).all() and (to_next[1, 2] == [-22, 23]).all()
    with pytest.raises(xrds.ArgumentError, match="height, width, 4"):
        xrds.cycles_motion(vector[..., :2])


def test_a_merged_frame_is_upscaled():
    """What upscale() merges by itself is the same as merged before, with layers that add up to the picture."""
    colour, guides = frame()
    images = {**guides, "full_colour": noise(48, 64, seed=4), "model": MODEL}
    both = xrds.merge_colour(colour, images["full_colour"], samples=(64, 16))
    picture = xrds.upscale(both, merged=True, **images)
    assert (picture == xrds.upscale(colour, samples=(64, 16), **images)).all()
    with xrds.Upscaler(16, 12, MODEL) as upscaler:
        assert (picture == upscaler(both, full_colour=images["full_colour"], merged=True, **guides)).all()
    lights = {"Emit": colour / 4, "Env": 3 * colour / 4, "Combined": colour}
    shared, found = xrds.upscale(both, merged=True, layers=lights, **images)
    assert (shared == picture).all() and sorted(found) == ["Emit", "Env"]
    numpy.testing.assert_allclose(found["Emit"] + found["Env"], picture, rtol=1e-5)


@pytest.mark.parametrize(
    "fields, words",
    [
        ({"colour": noise(HEIGHT, WIDTH + 1)}, "33 x 24"),
        ({"albedo": ALBEDO[1:]}, "128 x 95"),
        ({"depth": ALBEDO}, "depth has the shape"),
        ({"to_next": STILL[..., :1]}, "to_next has the shape"),
        ({"low_counts": numpy.ones(FULL, numpy.float32)}, "low_counts has the shape"),
    ],
)
def test_refusals(merging, fields, words):
    with pytest.raises(xrds.ArgumentError, match=words):
        merging(still(1, **fields))


def test_no_such_filter():
    with pytest.raises(xrds.ArgumentError, match="scale must be"):
        xrds.TemporalFilter(WIDTH, HEIGHT, 3)
    with pytest.raises(xrds.ArgumentError, match="no frame"):
        xrds.TemporalFilter(0, HEIGHT, 4)
    with pytest.raises(xrds.ArgumentError, match="temporal filter was closed"):
        with xrds.TemporalFilter(8, 8, 1) as closed:
            closed.close()
            closed(xrds.TemporalFrame(noise(8, 8)))
