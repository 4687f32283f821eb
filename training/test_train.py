"""The trainer from shards to a model file, on tiny scenes: it learns, resumes, and starts one model from another."""
import re
import subprocess
import sys

import pytest
import torch

import ablations
import arguments
import arithmetic
import evaluate
import export
import pipeline
import shards
import train
import weights
from test_dataset import encoded, write_scene

TINY = ["--channels", "8", "--aux-channels", "4", "--head-channels", "8", "--groups", "1", "--crop", "8", "--batch", "1", "--warm-up", "1",
        "--device", "cpu", "--precision", "bfloat16", "--aux-kernels", "3"]


@pytest.fixture
def folders(tmp_path):
    """(scenes as OpenEXR, shards, run folder)"""
    scenes, packed = tmp_path / "scenes", tmp_path / "shards"
    scenes.mkdir()
    packed.mkdir()
    for name in ("s0000", "s0003"):
        write_scene(scenes, name, side=64)
    shards.write_shard(packed / "scenes-000.npz", encoded(scenes, "s0000", "s0003"), 1e9)
    return scenes, packed, tmp_path / "run"


def run(monkeypatch, module, *arguments):
    monkeypatch.setattr(sys, "argv", ["program", *map(str, arguments)])
    module.main()


def test_training_resumes_and_exports(folders, monkeypatch, tmp_path, capsys):
    scenes, packed, output = folders
    run(monkeypatch, train, packed, "--output", output, "--steps", 2, *TINY)
    first = torch.load(output / "checkpoint.pt", weights_only=False)
    assert (first["step"], first["scenes"]) == (2, 2)
    run(monkeypatch, train, packed, "--output", output, "--steps", 4, *TINY)
    second = torch.load(output / "checkpoint.pt", weights_only=False)
    assert second["step"] == 4
    assert "resumed at step 2" in (output / "log.txt").read_text()
    assert any(not torch.equal(first["network"][name], second["network"][name]) for name in first["network"])
    assert second["network"]["out.weight"].abs().max() > 0      # it starts at zero

    run(monkeypatch, train, packed, "--output", tmp_path / "scale1", "--steps", 1, "--scale", 1, "--start", output / "checkpoint.pt", *TINY[:-1], 5)
    assert "tensors of checkpoint" in (tmp_path / "scale1" / "log.txt").read_text()


def test_gradients_that_are_not_finite_change_nothing(monkeypatch):
    monkeypatch.setattr(sys, "argv", ["train.py", "shards", "--output", "run", *TINY])
    options = train.arguments_of_command_line()
    training = train.Training(train.config_of(options), options)
    parameters = list(training.network.parameters())
    def weights_after(value):
        for parameter in parameters:
            parameter.grad = torch.full_like(parameter, value)
        training.take_step(torch.nn.utils.clip_grad_norm_(parameters, 1.0))
        return [parameter.detach().clone() for parameter in parameters]
    before, after, later = weights_after(1.0), weights_after(float("nan")), weights_after(1.0)
    assert all(map(torch.equal, before, after)) and not any(map(torch.equal, after, later))
    assert all(torch.isfinite(weight).all() for weight in [*later, *training.average.parameters()])


def test_same_seed_same_weights(folders, monkeypatch, tmp_path):
    _, packed, _ = folders
    torch.set_num_threads(1)
    for name in ("one", "two"):
        run(monkeypatch, train, packed, "--output", tmp_path / name, "--steps", 2, *TINY)
    one, two = (torch.load(tmp_path / name / "checkpoint.pt", weights_only=False)["network"] for name in ("one", "two"))
    assert all(torch.equal(one[key], two[key]) for key in one)


@pytest.mark.parametrize("slow, chosen", [("bfloat16", "float32"), ("float32", "bfloat16")])
def test_the_faster_precision_is_taken_and_said(folders, monkeypatch, tmp_path, capsys, slow, chosen):
    _, packed, _ = folders
    torch.set_num_threads(1)
    monkeypatch.setattr(arithmetic, "probe_seconds", lambda device, precision: 0.6 if precision == slow else 0.1)
    network = {}
    for precision in ("auto", *arithmetic.TYPES):
        run(monkeypatch, train, packed, "--output", tmp_path / precision, "--steps", 2, *TINY, "--precision", precision)
        network[precision] = torch.load(tmp_path / precision / "checkpoint.pt", weights_only=False)["network"]
    same = {name: all(torch.equal(network["auto"][key], network[name][key]) for key in network["auto"]) for name in arithmetic.TYPES}
    assert same == {chosen: True, slow: False}
    line = f"training in {chosen}: a probe takes "
    assert line in capsys.readouterr().out and line in (tmp_path / "auto" / "log.txt").read_text()
    assert f"{slow} 600.0 ms" in (tmp_path / "auto" / "log.txt").read_text()
    assert torch.load(tmp_path / "auto" / "checkpoint.pt", weights_only=False)["options"]["precision"] == chosen


def test_an_asked_precision_is_not_probed(monkeypatch):
    monkeypatch.setattr(arithmetic, "probe_seconds", lambda *_: pytest.fail("probed"))
    assert arithmetic.choose("bfloat16", "cpu") == ("bfloat16", "training in bfloat16, as asked")


def test_the_probe_computes_in_the_type_that_it_times(monkeypatch):
    types, linear = set(), torch.nn.functional.linear
    monkeypatch.setattr(torch.nn.functional, "linear", lambda *images: types.add(linear(*images).dtype) or linear(*images))
    state = torch.get_rng_state()
    for precision, expected in arithmetic.TYPES.items():
        types.clear()
        assert arithmetic.probe_seconds("cpu", precision) > 0
        assert types == {expected}
    assert torch.equal(torch.get_rng_state(), state)        # a run of the same seed stays the same


def test_export_writes_a_model_and_its_card(folders, monkeypatch, tmp_path):
    scenes, packed, output = folders
    run(monkeypatch, train, packed, "--output", output, "--steps", 1, *TINY)
    monkeypatch.setattr(export, "SETTINGS", {4: ((64, 16), (64, 1))})
    model = tmp_path / "tiny.safetensors"
    run(monkeypatch, export, output / "checkpoint.pt", model, "--validation", scenes)
    network, metadata = weights.load_model(model)
    assert network.config.aux_kernels == 3 and metadata["steps"] == "1"
    card = model.with_suffix(".md").read_text()
    assert "learned 3 x 3 filter of the auxiliary images" in card and "| 64, 1 |" in card
    assert "in bfloat16, seed 1" in card and "--precision bfloat16" in card


def test_full_model_trains_evaluates_and_exports(folders, monkeypatch, tmp_path, capsys):
    scenes, packed, output = folders
    assert arguments.shares_of("1:0.3,4:0.7") == {1: 0.3, 4: 0.7} and arguments.shares_of("16") == {16: 1} and arguments.shares_of(None) is None
    monkeypatch.setattr(train, "FULL_VALIDATION_SPP", {4: "64-16,64-1"})
    run(monkeypatch, train, packed, "--output", output, "--steps", 2, "--validation", scenes, "--aux", "albedo,normal,colour",
        "--colour-kernels", 3, "--colour-shares", "64", "--aux-shares", "1:0.5,4:0.5", *TINY)
    assert "2 scenes" in (output / "log.txt").read_text() and "  64-1 " in (output / "log.txt").read_text()
    monkeypatch.setattr(export, "SETTINGS", {4: ((64, 16), (64, 0), (64, 1))})
    model = tmp_path / "tiny.safetensors"
    run(monkeypatch, export, output / "checkpoint.pt", model, "--validation", scenes)
    card = model.with_suffix(".md").read_text()
    assert weights.load_model(model)[0].config.colour_kernels == 3
    assert "learned 3 x 3 filter of the full-resolution colour" in card and "| 64, 1 |" in card and "converged |" not in card
    assert "--colour-kernels 3" in card and "--colour-shares 64 --aux-shares 1:0.5,4:0.5" in card
    run(monkeypatch, evaluate, scenes, "--model", model, "--spp", 64, "--aux-spp", 1, "--merge")
    assert "| tiny |" in capsys.readouterr().out
    with pytest.raises(SystemExit, match="converged"):
        run(monkeypatch, evaluate, scenes, "--model", model, "--spp", 64, "--aux-spp", 0)


@pytest.mark.parametrize("flags, sentence", [
    (("--scale", 3), "scale must be 1, 2, 4, 8 or 16, found 3"),
    (("--scale", 16), "--scale 16 has no usual samples to be measured at: choose them with --validation-spp"),
    (("--scale", 16, "--validation-spp", "64-16"), "has no scene with 64 spp colour and 16 spp aux at scale 16; it has colour at none"),
    (("--crop", 30), "--crop must be a multiple of the window, 8, found 30"),
    (("--crop", 32), "--crop 32 is more than scene s0000 of scenes-000.npz has at scale 4: 16 x 16 pixels"),
    (("--batch", 0), "argument --batch: must be at least 1, found 0"),
    (("--minutes", "nan"), "argument --minutes: must be more than 0, found nan"),
    (("--denoised-share", 2), "argument --denoised-share: must be from 0 to 1, found 2"),
    (("--steps", "x"), "argument --steps: 'x' is no whole number"),
    (("--aux", "albedo,light"), "--aux must be of albedo, .*, found albedo,light"),
    (("--aux", "albedo,albedo"), "aux_inputs must name each once, found albedo,albedo"),
    (("--aux", "albedo,normal,diffuse"), "none of the 2 scenes in .* has all that the model takes: .*, diffuse"),
    (("--channels", 6, "--head-channels", 6), "channels must be a multiple of 4 up to 512, found 6"),
    (("--window", 0), "window must be an even number from 2 to 16, found 0"),
    (("--aux-shares", "1:-1"), "argument --aux-shares: '1:-1' is not of the form"),
    (("--colour-shares", "3"), "no scene has colour of the samples of --colour-shares; there are 64"),
    (("--aux", "albedo,normal,colour", "--aux-shares", "0", "--validation-spp", "64-16"), "cannot train on converged auxiliary images"),
    (("--validation-spp", "3-3"), "has no scene with 3 spp colour and 3 spp aux at scale 4; it has colour at 64 and auxiliary images at 1, 16"),
    (("--validation-spp", "64"), "argument --validation-spp: '64' is not of the form 64-16,16-1"),
    (("--start", "nowhere.safetensors"), "nowhere.safetensors is no model that training can start from"),
    (("--device", "abacus"), "argument --device: 'abacus' cannot be used"),
])
def test_what_cannot_be_trained_is_said_at_once(folders, monkeypatch, capsys, flags, sentence):
    scenes, packed, output = folders
    with pytest.raises(SystemExit) as end:
        run(monkeypatch, train, packed, "--output", output, "--steps", 1, "--validation", scenes, *TINY, *flags)
    said = capsys.readouterr().err or str(end.value)
    assert re.fullmatch(rf"(program|train.py): .*{sentence}.*\n?", said)
    assert not (output / "checkpoint.pt").exists()


def test_shards_and_checkpoints_that_do_not_fit_are_a_sentence(folders, monkeypatch, tmp_path):
    scenes, packed, output = folders
    with pytest.raises(SystemExit, match="has no shards: shards.py makes them"):
        run(monkeypatch, train, scenes, "--output", output, "--steps", 1, *TINY)
    run(monkeypatch, train, packed, "--output", output, "--steps", 1, "--warm-up", 0, *TINY[:-2])
    with pytest.raises(SystemExit, match="is of a model with channels 8, head_channels 8: go on with that, or choose another --output"):
        run(monkeypatch, train, packed, "--output", output, "--steps", 2, *TINY[:-2], "--channels", 16, "--head-channels", 16)
    (packed / "scenes-001.npz").write_bytes(b"no shard")
    with pytest.raises(SystemExit, match="scenes-001.npz is no shard, or damaged"):
        run(monkeypatch, train, packed, "--output", output, "--steps", 2, *TINY[:-2])


def test_what_cannot_be_packed_or_exported_is_a_sentence(folders, monkeypatch, tmp_path, capsys):
    scenes, packed, output = folders
    def refused(sentence, module, *arguments):
        with pytest.raises(SystemExit) as end:
            run(monkeypatch, module, *arguments)
        assert re.search(sentence, capsys.readouterr().err or str(end.value))
    refused("has no files such as s0012_gt.exr", shards, packed, "--output", tmp_path / "other")
    refused("nowhere is no folder", shards, tmp_path / "nowhere", "--output", tmp_path / "other")
    refused("argument --noisy-bits: must be from 1 to 10, found 11", shards, scenes, "--output", tmp_path / "other", "--noisy-bits", 11)
    (scenes / "kitchen_gt.exr").write_bytes(b"")
    refused("kitchen_gt.exr must be named by a letter and a number", shards, scenes, "--output", tmp_path / "other")
    (scenes / "kitchen_gt.exr").unlink()
    model = tmp_path / "made" / "tiny.safetensors"
    refused("is no checkpoint of train.py: .*No such file", export, output / "checkpoint.pt", model, "--validation", scenes)
    run(monkeypatch, train, packed, "--output", output, "--steps", 1, *TINY)
    torch.save({"state_dict": {}}, tmp_path / "other.pt")
    refused("is no checkpoint of train.py: it is of another program", export, tmp_path / "other.pt", model, "--validation", scenes)
    refused("no scene with 3 spp colour and 3 spp aux .*--spp chooses", export, output / "checkpoint.pt", model, "--validation", scenes, "--spp", "3-3")
    assert not model.exists()
    refused("argument --parallel: must be at least 1", ablations, packed, "--validation", scenes, "--output", output, "--parallel", 0)
    monkeypatch.setitem(ablations.VARIANTS, "compact", ("all", ["--crop", "30"]))
    monkeypatch.setattr(subprocess, "run", lambda command, **_: (_ for _ in ()).throw(subprocess.CalledProcessError(2, command)))
    refused("a training ended with code 2", ablations, packed, "--validation", scenes, "--output", output, "--only", "compact")


def test_a_card_tells_the_limits_of_its_own_data(folders, monkeypatch, tmp_path):
    scenes, packed, output = folders
    run(monkeypatch, train, packed, "--output", output, "--steps", 1, *TINY)
    def card(*flags):
        run(monkeypatch, export, output / "checkpoint.pt", tmp_path / "tiny.safetensors", "--validation", scenes, "--spp", "64-16,64-1", *flags)
        return (tmp_path / "tiny.md").read_text()
    assert "Cycles" not in card() and "- Data: 2 {rooms}" in card("--data", "{scenes} {rooms}")
    assert "## Known limits\n- Rooms alone.\n- Reflections" in card("--limits", "Rooms alone.")


def test_merging_changes_what_every_method_gets(folders):
    scenes, _, _ = folders
    case = next(evaluate.cases_of(scenes, 4, 64, 16))
    assert torch.equal(case.merged, pipeline.merged_colour(case.colour, 64, case.full, 16, 4))
    with torch.no_grad():
        plain, merged = (evaluate.methods_of(4, [], merge)["guided"](case) for merge in (False, True))
    assert not torch.allclose(plain, merged)
    assert next(evaluate.cases_of(scenes, 4, 64, 0)).full is None       # the reference is no input
