"""Progress, cancelling, interrupts and threads."""

import gc
import os
import signal
import threading
import time
import weakref

import numpy
import pytest
from frames import MODEL, ROOT, frame

import xrds

COLOUR, IMAGES = frame()
LARGE, LARGE_IMAGES = frame(128, 128)  # a good part of a second on a CPU


@pytest.fixture(scope="module")
def large():
    with xrds.Upscaler(128, 128, MODEL) as upscaler:
        upscaler(LARGE, **LARGE_IMAGES)
        yield upscaler


def test_progress_is_heard():
    heard = []
    with xrds.Upscaler(16, 12, MODEL, progress=lambda *step: heard.append(step)) as upscaler:
        upscaler(COLOUR, progress=lambda *step: heard.append(step), **IMAGES)
    stages = {stage for stage, _ in heard}
    assert {"loading", "upscaling"} <= stages <= {"loading", "compiling", "upscaling"}
    assert all(0 <= share <= 1 for _, share in heard)
    shares = [share for stage, share in heard if stage == "upscaling"]
    assert shares == sorted(shares) and shares[-1] == 1


def test_false_cancels(large):
    with pytest.raises(xrds.Cancelled):
        large(LARGE, progress=lambda stage, share: False, **LARGE_IMAGES)
    with pytest.raises(xrds.Cancelled):
        xrds.Upscaler(20, 20, MODEL, progress=lambda stage, share: False)
    assert numpy.isfinite(large(LARGE, **LARGE_IMAGES)).all()


def test_what_the_progress_raises_comes_through(large):
    def raising(stage, share):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        large(LARGE, progress=raising, **LARGE_IMAGES)


def test_a_call_within_the_progress_is_refused(large):
    again = lambda: large(LARGE, **LARGE_IMAGES)  # noqa: E731
    for call in (lambda: xrds.upscale(COLOUR, **IMAGES), xrds.devices, lambda: xrds.Upscaler(8, 8, MODEL), again):
        with pytest.raises(xrds.Error, match="cannot make another"):
            large(LARGE, progress=lambda stage, share: call(), **LARGE_IMAGES)


def test_the_progress_may_ask_what_is_known():
    known = []
    with xrds.Upscaler(16, 12, MODEL) as upscaler:
        for colour in (COLOUR, 2 * COLOUR):
            before = upscaler.exposure
            upscaler(colour, progress=lambda stage, share: known.append((upscaler.exposure, upscaler.device_bytes)), **IMAGES)
            assert {exposure for exposure, _ in known} == {before} and {held for _, held in known} == {upscaler.device_bytes}
            assert upscaler.exposure not in (0, before)
            known.clear()


def test_what_is_dropped_is_gone():
    upscaler = xrds.Upscaler(8, 8, MODEL)
    kept = weakref.ref(upscaler)
    del upscaler
    assert kept() is None  # with its memory of the device, though nothing was collected


def test_numpy_may_say_no(large):
    with pytest.raises(xrds.Cancelled):
        large(LARGE, progress=lambda stage, share: numpy.float64(share) < 0, **LARGE_IMAGES)


def test_upscalers_may_be_dropped_within_the_progress(large):
    others = [xrds.Upscaler(8, 8, MODEL, device=large.device)]

    def drop(stage, share):
        others.clear()
        gc.collect()

    large(LARGE, progress=drop, **LARGE_IMAGES)


@pytest.fixture
def interruptible():
    """Python ignores Ctrl-C where it was started in the background of a script."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("interruptible")
def test_an_interrupt_ends_a_frame(large):
    started = time.monotonic()
    large(LARGE, **LARGE_IMAGES)
    whole = time.monotonic() - started
    began = []

    def begun(stage, share):
        if not began:
            began.append(time.monotonic())
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        large(LARGE, progress=begun, **LARGE_IMAGES)
    assert time.monotonic() - began[0] < whole
    timer = threading.Timer(whole / 4, os.kill, (os.getpid(), signal.SIGINT))  # without a progress
    with pytest.raises(KeyboardInterrupt):
        timer.start()
        for _ in range(50):
            large(LARGE, **LARGE_IMAGES)
    timer.join()


def test_other_threads_run_meanwhile(large):
    steps, ends = [0], threading.Event()

    def count():
        while not ends.is_set():
            steps[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    before, started = steps[0], time.monotonic()
    large(LARGE, **LARGE_IMAGES)
    seconds, during = time.monotonic() - started, steps[0] - before
    ends.set()
    thread.join()
    assert during > 50 * seconds  # of a thousand in a second where nothing else runs


def test_threads_wait_for_each_other(large):
    wanted = xrds.upscale(COLOUR, model=MODEL, **IMAGES)
    wrong = []

    def run():
        for _ in range(2):
            if not (xrds.upscale(COLOUR, model=MODEL, **IMAGES) == wanted).all():
                wrong.append("upscale")
            with xrds.Upscaler(16, 12, MODEL, device=large.device) as own:
                if not (own(COLOUR, **IMAGES) == wanted).all():
                    wrong.append("own")

    threads = [threading.Thread(target=run) for _ in range(3)]
    for thread in threads:
        thread.start()
    large(LARGE, progress=lambda stage, share: None, **LARGE_IMAGES)
    xrds.release()
    large(LARGE, progress=lambda stage, share: None, **LARGE_IMAGES)
    for thread in threads:
        thread.join(60)
    assert not wrong and not any(thread.is_alive() for thread in threads)


def test_the_next_call_takes_what_was_made_ready():
    stages = []
    xrds.upscale(COLOUR, model=MODEL, **IMAGES)
    xrds.upscale(COLOUR, model=MODEL, progress=lambda stage, share: stages.append(stage), **IMAGES)
    assert set(stages) == {"upscaling"}


def test_devices_are_described():
    found = xrds.devices()
    device = xrds.Device()
    assert device.description().uuid in [one.uuid for one in found]
    by_uuid = xrds.Device(device.description().uuid)
    assert by_uuid.description() == device.description()
    assert xrds.Device(0).description().name == found[0].name
    device.close()
    with pytest.raises(xrds.Error):
        device.description()


def test_models_are_described(monkeypatch):
    model = xrds.Model(MODEL)
    assert (model.name, model.scale, model.inputs) == (MODEL, 4, ("albedo", "normal"))
    assert model.metadata("license") == "MIT" and model.metadata("nothing") is None
    assert MODEL in xrds.models()
    monkeypatch.setenv("XRDS_MODELS", str(ROOT / "tests" / "golden"))
    assert {MODEL, "s4_guided.model"} <= set(xrds.models())
    found = xrds.upscale(COLOUR, model=model, **IMAGES)
    numpy.testing.assert_array_equal(found, xrds.upscale(COLOUR, model=MODEL, **IMAGES))
