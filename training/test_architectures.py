"""The networks of others have the sizes that are published; their golden files and the converter's files are theirs."""
import dataclasses
import pathlib
import pickle
import re

import pytest
import torch
from safetensors.torch import load_file

import architectures
import convert
import golden
import golden_networks
from architectures import ARCHITECTURES, GOLDEN, MILLIONS, PAPER, edsr, rcan, rdn, swinir
from architectures.common import DIV2K_MEAN

FOLDER = pathlib.Path(__file__).parent.parent / "tests" / "golden"


@pytest.mark.parametrize("name", MILLIONS)
def test_sizes_are_the_published_ones(name):
    millions, within = MILLIONS[name]
    with torch.device("meta"):
        count = sum(value.numel() for key, value in architectures.network_of(PAPER[name]).named_parameters() if key != "mean")
    assert count / 1e6 == pytest.approx(millions, rel=within)


@pytest.mark.parametrize("name", PAPER)
def test_networks_enlarge_by_their_scale(name):
    config = PAPER[name]
    with torch.device("meta"):
        inputs = [torch.empty(1, 3, 16, 8)] + [torch.empty(1, config.aux_width, 64, 32)] * bool(config.aux_inputs)
        assert architectures.network_of(config)(*inputs).shape == (1, 3, 64, 32)


@pytest.mark.parametrize("name", GOLDEN)
def test_golden_file_is_reproduced(name):
    network = architectures.network_of(GOLDEN[name][2])
    network.load_state_dict(load_file(FOLDER / f"{name}.model.safetensors"))
    tensors = {key: value.double() for key, value in load_file(FOLDER / f"{name}.io.safetensors").items()}
    images = {name: value.permute(2, 0, 1)[None] for name, value in tensors.items() if value.dim() == 3}
    auxiliary = {name: images[golden.KEYS[name]] for name in network.config.aux_inputs}
    with torch.no_grad():
        output, raw = golden_networks.upscaled(network.double(), images["colour"], auxiliary, tensors["exposure"].item())
    assert torch.allclose(raw, tensors["network"].permute(2, 0, 1)[None], rtol=1e-6, atol=1e-6)
    assert torch.allclose(output, tensors["output"].permute(2, 0, 1)[None], rtol=1e-6, atol=1e-6)


def official(config):
    """A checkpoint with random weights under the names of the official repository, and its network."""
    network = architectures.network_of(config)
    tensors = dict(network.state_dict())
    del tensors["mean"]
    if config.architecture == "swinir":
        tensors["layers.0.residual_group.blocks.1.attn_mask"] = torch.zeros(4, 16, 16)
        tensors["layers.0.residual_group.blocks.0.attn.relative_position_index"] = torch.zeros(16, 16)
        return {"params": tensors}, network
    for name, sign in (("sub_mean", -1), ("add_mean", 1)) if config.architecture in ("edsr", "rcan") else ():
        tensors[name + ".weight"] = torch.eye(3).view(3, 3, 1, 1)
        tensors[name + ".bias"] = sign * 255 * torch.tensor(DIV2K_MEAN)
    return tensors, network


def as_converted(config):
    """A golden configuration with what is in the code of the official repositories, not in the tensors."""
    paper = PAPER[config.architecture]
    in_code = {"range": paper.range, "transfer": "log1p"} | ({"residual_divisor": 1} if config.architecture == "edsr" else {})
    return dataclasses.replace(config, **in_code)


CONVERTED = [as_converted(config) for _, _, config in GOLDEN.values() if hasattr(ARCHITECTURES[config.architecture], "config_of_checkpoint")]


@pytest.mark.parametrize("config", CONVERTED + [
    edsr.Config(scale=2, channels=8, blocks=3, range=255), edsr.Config(channels=256, blocks=1, residual_divisor=10, range=255),
    rcan.Config(scale=8, channels=16, groups=2, blocks=3, reduction=8, range=255), swinir.Config(channels=12, groups=2, blocks=2, window=4, head_channels=6),
    swinir.Config(scale=2, channels=20, groups=1, blocks=2, window=8, head_channels=5, upsampler="pixelshuffledirect")],
    ids=lambda config: f"{config.architecture}_x{config.scale}_{config.channels}")
def test_official_checkpoints_convert(config, tmp_path):
    checkpoint, network = official(config)
    torch.save(checkpoint, tmp_path / "official.pt")
    assert convert.convert(tmp_path / "official.pt", tmp_path / "model.safetensors") == config
    stored = load_file(tmp_path / "model.safetensors")
    assert set(stored) == set(network.state_dict())
    for name, value in network.state_dict().items():
        assert torch.allclose(stored[name], value), name


def basicsr_name(name, config):
    """What BasicSR calls a tensor of EDSR or RCAN."""
    place, _, kind = name.rpartition(".")
    last = {f"body.{config.groups if config.architecture == 'rcan' else config.blocks}": "conv_after_body", "head.0": "conv_first", "tail.1": "conv_last"}
    if place in last:
        return f"{last[place]}.{kind}"
    if place.startswith("tail.0."):
        return name.replace("tail.0.", "upsample.")
    if config.architecture == "edsr":
        return name.replace(".body.0.", ".conv1.").replace(".body.2.", ".conv2.")
    _, group, _, block, *inside = place.split(".")
    if not inside:      # the convolution behind the blocks of a group
        return f"body.{group}.conv.{kind}"
    inside = {"body.3.conv_du.0": "3.attention.1", "body.3.conv_du.2": "3.attention.3"}.get(".".join(inside), inside[-1])
    return f"body.{group}.residual_group.{block}.rcab.{inside}.{kind}"


BASICSR = [edsr.Config(scale=4, channels=8, blocks=3, range=255), edsr.Config(scale=2, channels=256, blocks=1, residual_divisor=10, range=255),
           edsr.Config(scale=1, channels=8, blocks=1, range=255), rcan.Config(scale=8, channels=16, groups=2, blocks=3, reduction=8, range=255)]


@pytest.mark.parametrize("config", BASICSR, ids=lambda config: f"{config.architecture}_x{config.scale}_{config.channels}")
def test_checkpoints_of_basicsr_convert(config, tmp_path):
    network = architectures.network_of(config)
    torch.save({"params": {basicsr_name(name, config): value for name, value in network.state_dict().items() if name != "mean"}}, tmp_path / "basicsr.pth")
    assert convert.convert(tmp_path / "basicsr.pth", tmp_path / "model.safetensors") == config
    stored = load_file(tmp_path / "model.safetensors")
    assert set(stored) == set(network.state_dict())
    for name, value in network.state_dict().items():
        assert torch.equal(stored[name], value), name


def test_scale_3_of_basicsr_is_refused(tmp_path):
    config = edsr.Config(scale=2, channels=8, blocks=1, range=255)
    tensors = {basicsr_name(name, config): value for name, value in architectures.network_of(config).state_dict().items() if name != "mean"}
    with pytest.raises(ValueError, match="scale 3"):
        converting(tensors | {"upsample.0.weight": torch.zeros(72, 8, 3, 3)}, tmp_path)


class Hostile:
    def __reduce__(self):
        return (print, ("ran",))


def test_a_pickle_that_runs_code_is_refused(tmp_path, capsys):
    torch.save({"head.0.weight": Hostile()}, tmp_path / "hostile.pt")
    with pytest.raises(pickle.UnpicklingError):
        convert.convert(tmp_path / "hostile.pt", tmp_path / "model.safetensors")
    assert "ran" not in capsys.readouterr().out


def test_other_checkpoints_are_refused(tmp_path):
    checkpoint, _ = official(edsr.Config(scale=2, channels=8, blocks=1, range=255))
    del checkpoint["tail.1.bias"]
    torch.save(checkpoint, tmp_path / "cut.pt")
    with pytest.raises(ValueError, match="tail.1.bias"):
        convert.convert(tmp_path / "cut.pt", tmp_path / "model.safetensors")
    torch.save([1, 2], tmp_path / "list.pt")
    with pytest.raises(ValueError, match="no tensors"):
        convert.convert(tmp_path / "list.pt", tmp_path / "model.safetensors")


def test_scale_3_is_refused(tmp_path):
    config = rdn.Config(scale=2, channels=8, blocks=1, layers=1, growth=8, range=255)
    checkpoint, _ = official(config)
    checkpoint["UPNet.0.weight"] = torch.zeros(9 * config.growth, 8, 3, 3)
    torch.save(checkpoint, tmp_path / "x3.pt")
    with pytest.raises(ValueError, match="scale 3"):
        convert.convert(tmp_path / "x3.pt", tmp_path / "model.safetensors")


def test_the_lightweight_form_of_scale_3_is_refused(tmp_path):
    config = next(one for _, _, one in GOLDEN.values() if one.architecture == "swinir" and one.scale == 2 and one.channels == 12)
    checkpoint, _ = official(config)
    checkpoint["params"] |= {"upsample.0.weight": torch.zeros(27, 12, 3, 3), "upsample.0.bias": torch.zeros(27)}
    torch.save(checkpoint, tmp_path / "x3.pt")
    with pytest.raises(ValueError, match="upscales by 3"):
        convert.convert(tmp_path / "x3.pt", tmp_path / "model.safetensors")


def converting(tensors, folder):
    """What convert() does with a checkpoint of these tensors."""
    torch.save(tensors, folder / "odd.pt")
    return convert.convert(folder / "odd.pt", folder / "odd.safetensors")


@pytest.mark.parametrize("wrap", [
    lambda tensors: {"state_dict": {"params_ema": tensors, "params": {}}, "epoch": 3}, lambda tensors: {"net": tensors}, lambda tensors: {"params-ema": tensors},
    lambda tensors: {"module.netG." + name: value for name, value in tensors.items()}])
def test_wrapped_checkpoints_convert(wrap, tmp_path):
    config = edsr.Config(scale=2, channels=8, blocks=1, range=255)
    assert converting(wrap(official(config)[0]), tmp_path) == config


def test_names_that_only_begin_like_swinir_are_of_no_known_network(tmp_path):
    with pytest.raises(ValueError, match="names of none of edsr, rcan"):
        converting({"params": {"conv_first.weight": torch.zeros(64, 3, 3, 3), "body.0.conv1.weight": torch.zeros(64, 64, 3, 3)}}, tmp_path)


@pytest.mark.parametrize("name, value, reason", [
    ("head.0.bias", torch.full((8,), float("nan")), "'head.0.bias' holds a value that is not finite"),
    ("body.999999999.weight", torch.zeros(8, 8, 3, 3), "number 999999999"),
    ("head.0.weight", torch.zeros(8, 3, 3, 3, dtype=torch.complex64), "no tensor of a network"),
    (7, torch.zeros(8), "no tensor of a network")])
def test_what_the_engine_would_refuse_is_refused(name, value, reason, tmp_path):
    checkpoint, _ = official(edsr.Config(scale=2, channels=8, blocks=1, range=255))
    with pytest.raises(ValueError, match=reason):
        converting(checkpoint | {name: value}, tmp_path)
    assert not (tmp_path / "odd.safetensors").exists()


@pytest.mark.parametrize("config, reason", [
    (edsr.Config(scale=2, channels=10, blocks=1, range=255), "10 channels"),
    (swinir.Config(channels=12, groups=1, blocks=2, window=7, head_channels=6), "windows are of 7 pixels")])
def test_sizes_that_the_engine_does_not_take_are_refused(config, reason, tmp_path):
    with pytest.raises(ValueError, match=reason):
        converting(official(config)[0], tmp_path)


def message(source, target, monkeypatch):
    """With what converting ends."""
    monkeypatch.setattr("sys.argv", ["convert.py", str(source), str(target)])
    with pytest.raises(SystemExit) as ended:
        convert.main()
    return ended.value.code


@pytest.mark.parametrize("is_archive, share", [(True, 0.1), (True, 0.5), (True, 0.99), (False, 0.5), (False, 0.99)])
def test_a_file_that_is_cut_short_is_told(is_archive, share, tmp_path, monkeypatch):
    checkpoint, _ = official(edsr.Config(scale=2, channels=8, blocks=1, range=255))
    torch.save(checkpoint, tmp_path / "x.pth", _use_new_zipfile_serialization=is_archive)
    whole = (tmp_path / "x.pth").read_bytes()
    (tmp_path / "x.pth").write_bytes(whole[:int(share * len(whole))])
    assert re.search(r"x\.pth cannot be converted: the file is cut short[^\n]*\Z", message(tmp_path / "x.pth", tmp_path / "model.safetensors", monkeypatch))


def test_files_that_cannot_be_read_or_written_are_named(tmp_path, monkeypatch):
    assert message(tmp_path / "none.pth", tmp_path / "model.safetensors", monkeypatch) == f"{tmp_path / 'none.pth'}: No such file or directory"
    torch.save(official(edsr.Config(scale=2, channels=8, blocks=1, range=255))[0], tmp_path / "x.pth")
    (tmp_path / "folder").mkdir()
    assert message(tmp_path / "x.pth", tmp_path / "folder", monkeypatch).startswith(f"{tmp_path / 'folder'} cannot be written: ")


@pytest.mark.parametrize("contents", [b"no pickle at all", b"text", b"PK\x03\x04 cut", b""])
def test_what_is_no_checkpoint_ends_with_a_sentence(contents, tmp_path, monkeypatch):
    (tmp_path / "x.pt").write_bytes(contents)
    assert re.search(r"cannot be converted: [^\n]+\Z", message(tmp_path / "x.pt", tmp_path / "model.safetensors", monkeypatch))
