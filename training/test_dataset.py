"""Crops, mirrors and turns keep colour, auxiliary images and target consistent; shards give back what was put in."""
import numpy as np
import pytest
import torch

import dataset
import images
import pipeline
import shards
import train
import weights
from network import Network, NetworkConfig, initialise

SMALL = NetworkConfig(channels=8, aux_channels=4, head_channels=4, groups=1, blocks=1, window=4, kernels=5, aux_skip=1, aux_kernels=3)


class FakeScenes:
    """One scene of random images in the layout of dataset.Scenes."""

    def __init__(self, config=SMALL, side=12):
        torch.manual_seed(5)
        self.config = config
        high = config.scale * side
        decoded = {"colour": {(config.scale, 64): torch.rand(3, side, side).half()}, "target": torch.rand(3, high, high).half(),
                   "aux": {spp: torch.cat([torch.rand(3, high, high), torch.rand(3, high, high) - 0.5]).half() for spp in (0, 16)}}
        self.scenes = [dataset.Scene(decoded, config, "cpu")]

    def __len__(self):
        return 1


def test_cut_repeats_whole_low_resolution_pixels_outside():
    image = torch.arange(4 * 8 * 8).view(4, 8, 8)
    crop = dataset.cut(image, 0, 1, 2, 1, 2)                # two of the four rows of 2 x 2 blocks, a border of one block
    assert torch.equal(crop[:, :2], image[:, 0:2])          # above the image: its first row of blocks again
    assert torch.equal(crop[:, 2:], image[:, 0:6])
    assert torch.equal(dataset.cut(image, 1, 1, 2, 1, 2), image[:, 0:8, 0:8])


@pytest.mark.parametrize("place", [(0, 0), (2, 2), (4, 4)])
def test_forward_of_a_crop_is_the_pipeline(place):
    scenes, size = FakeScenes(), 8
    scene = scenes.scenes[0]
    network = Network(SMALL)
    initialise(network, torch.Generator().manual_seed(1))
    torch.nn.init.normal_(network.out.bias, std=0.5)        # kernels and residual of the bias alone: no receptive field
    y, x = place
    batch = {"colour": dataset.cut(scene.colours[64], y, x, size, 2, 1).float()[None],
             "aux": dataset.cut(scene.aux[16], y, x, size, 2, 4).float()[None],
             "target": dataset.cut(scene.target, y, x, size, 0, 4).float()[None], "exposure": torch.ones(1)}
    result, target, _ = train.forward(network, batch, "cpu", "bfloat16")
    with torch.no_grad():
        whole, _, _ = pipeline.upscale(network, scene.colours[64].float()[None], scene.aux[16].float()[None], 1.0)
    here = (..., slice(4 * y, 4 * (y + size)), slice(4 * x, 4 * (x + size)))
    inside = (..., slice(8, -8), slice(8, -8))      # what kernels at the border of a crop reach is not filtered
    assert torch.allclose(result[inside], whole[here][inside], rtol=0.02, atol=0.01)    # the network's part is bfloat16
    assert torch.equal(target, scene.target.float()[None][here])


def test_mirrors_turn_the_normal_along():
    crop = {"colour": torch.rand(3, 12, 12), "aux": torch.rand(6, 48, 48), "target": torch.rand(3, 32, 32)}
    copies = [{key: value.clone() for key, value in crop.items()} for _ in range(3)]
    upside_down, mirrored = dataset.mirror(copies[0], 1, 3), dataset.mirror(copies[1], 2, 3)
    turned = dataset.transpose(copies[2], 3)
    assert torch.equal(mirrored["target"][:, :, 0], crop["target"][:, :, -1])
    assert torch.equal(upside_down["colour"][:, 0], crop["colour"][:, -1])
    assert torch.equal(mirrored["aux"][3, :, 0], -crop["aux"][3, :, -1])
    assert torch.equal(mirrored["aux"][4, :, 0], crop["aux"][4, :, -1])
    assert torch.equal(upside_down["aux"][4, 0], -crop["aux"][4, -1])
    assert torch.equal(turned["aux"][3, 2, 5], -crop["aux"][4, 5, 2])       # what pointed up points left
    assert torch.equal(turned["aux"][0, 2, 5], crop["aux"][0, 5, 2])


def test_rotations_are_rotations():
    generator = torch.Generator().manual_seed(3)
    for _ in range(5):
        turn = dataset.random_rotation(generator)
        assert torch.allclose(turn @ turn.T, torch.eye(3), atol=1e-5)
        assert torch.linalg.det(turn) == pytest.approx(1, abs=1e-5)


def test_converged_aux_of_a_crop_varies_with_the_noisy_one():
    scenes = FakeScenes()
    scenes.scenes[0].aux[16] = scenes.scenes[0].aux[0]          # no noise: both must stay the same
    batch = dataset.Crops(scenes, 8, seed=4, aux_shares={16: 1}).batch(6)
    inner = slice(8, -8)
    assert torch.equal(batch["clean"], batch["aux"][:, :, inner, inner])


def test_noise_of_other_counts_is_scaled():
    scene = FakeScenes().scenes[0]
    noise = scene.aux[16].float() - scene.aux[0].float()
    assert torch.allclose(scene.noisy_aux(64).float() - scene.aux[0].float(), noise / 2, atol=2e-3)
    assert torch.allclose(scene.noisy_aux(4).float() - scene.aux[0].float(), 2 * noise, atol=4e-3)
    assert scene.noisy_aux(16) is scene.aux[16]


def test_scale_1_takes_colour_and_aux_of_one_render():
    config = NetworkConfig(**{**SMALL.__dict__, "scale": 1})
    torch.manual_seed(6)
    clean = 0.5 + torch.rand(6, 12, 12)
    noise = 0.1 * torch.randn(12, 12)
    decoded = {"colour": {(1, 4): (clean[:3] + noise).half()}, "target": clean[:3].half(), "aux": {0: clean.half(), 4: (clean + noise).half()}}
    scene = dataset.Scene(decoded, config, "cpu")
    assert set(scene.colours) == {2, 4, 8, 16}                      # half to four times the samples
    for spp in scene.colours:
        colour, aux = scene.colours[spp].float() - clean[:3], scene.aux[spp].float() - clean
        assert torch.allclose(colour, noise.expand(3, 12, 12) * (4 / spp) ** 0.5, atol=4e-3)
        assert torch.allclose(aux, noise.expand(6, 12, 12) * (4 / spp) ** 0.5, atol=4e-3)
    assert scene.exposure.keys() == scene.colours.keys()
    scenes = FakeScenes(config)
    scenes.scenes = [scene]
    crops = dataset.Crops(scenes, 8, seed=4)
    crops.varied = lambda crop: crop
    crops.number = lambda: 0.5 * dataset.SAME_RENDER_SHARE          # the same render, and the middle of the image
    crop = crops.one()
    inner = (..., slice(2, -2), slice(2, -2))
    assert torch.allclose((crop["colour"] - crop["aux"][:3])[inner], torch.zeros(3, 8, 8), atol=4e-3)


def write_scene(folder, name, side=16, depth_of=()):
    """A scene of plain R, G, B colour and albedo and normal, as render.py names the files, with depth in those of `depth_of`."""
    import OpenEXR
    random = np.random.default_rng(7)
    def write(kind, **planes):
        channels = {f"{layer}.{c}": plane[..., k].copy() for layer, plane in planes.items() for k, c in enumerate("Z" if "Depth" in layer else "XYZ" if "Normal" in layer else "RGB")}
        OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}, channels).write(str(folder / f"{name}_{kind}.exr"))
    def image(*shape):
        return random.random((*shape, 3), np.float32)
    layers = lambda: {"ViewLayer.Combined": 40 * image(side, side) ** 4, "ViewLayer.Denoising Albedo": image(side, side),
                      "ViewLayer.Denoising Normal": 2 * image(side, side) - 1}
    for kind in ("gt", "aux1", "aux16"):
        depth = {"ViewLayer.Denoising Depth": 9 * image(side, side)[..., :1] * (random.random((side, side, 1)) < 0.8)} if kind in depth_of else {}
        write(kind, **layers(), **depth)
    write("lr64", **{"ViewLayer.Combined": image(side // 4, side // 4)})


def write(path, source, name, noisy_every):
    shards.write_shard(path, [(source, name)], 1e6, noisy_every)
    return path


def test_shards_give_back_scenes(tmp_path, monkeypatch):
    source, output = tmp_path / "scenes", tmp_path / "shards"
    source.mkdir()
    output.mkdir()
    for name in ("s0000", "s0001"):
        write_scene(source, name)
    left = shards.write_shard(output / "scenes-000.npz", [(source, "s0000"), (source, "s0001")], 1)
    assert [name for _, name in left] == ["s0001"]                  # full after the first
    assert not list(output.glob("*.part"))
    assert shards.scenes_in(output / "scenes-000.npz") == {"s0000"}
    ((name, scene),) = shards.read_shard(output / "scenes-000.npz")
    target = images.read_exr(source / "s0000_gt.exr", "colour")
    assert torch.allclose(scene["target"].float(), target, rtol=2.0 ** -7, atol=1e-6)
    for spp, step in ((0, shards.CONVERGED_STEP), (16, shards.noisy_step(16)), (1, shards.noisy_step(1))):
        true = torch.cat(images.read_exr(source / f"s0000_{f'aux{spp}' if spp else 'gt'}.exr", "albedo", "normal"))
        assert ((scene["aux"][spp].float() - true).abs() <= 0.51 * step + 1e-3).all()
    assert set(scene["colour"]) == {(4, 64), (1, 1)}                # turn 0 of 3 keeps a noisy colour
    ((_, quiet),) = shards.read_shard(write(output / "other.npz", source, "s0001", 3))
    ((_, noisy),) = shards.read_shard(write(output / "other.npz", source, "s0001", 1))
    (output / "other.npz").unlink()
    assert set(quiet["colour"]) == {(4, 64)} and set(noisy["colour"]) == {(4, 64), (1, 1)}
    monkeypatch.setattr(shards, "NOISY_STEP", {1: 1 / 8})
    with pytest.raises(ValueError, match="pack its scenes again"):
        list(shards.read_shard(output / "scenes-000.npz"))
    monkeypatch.undo()
    scenes = dataset.Scenes([output], SMALL)
    shards.write_shard(output / "scenes-001.npz", left, 1e6)
    scenes.refresh()
    assert len(scenes) == 2


@pytest.mark.parametrize("with_depth, converged", [(("gt", "aux1", "aux16"), "gt"), (("aux1", "aux16"), "aux16")])
def test_shards_keep_depth(tmp_path, with_depth, converged):
    write_scene(tmp_path, "s0000", depth_of=with_depth)
    write_scene(tmp_path, "s0001")
    shards.write_shard(tmp_path / "scenes-000.npz", [(tmp_path, "s0000"), (tmp_path, "s0001")], 1e6)
    (_, deep), (_, flat) = shards.read_shard(tmp_path / "scenes-000.npz")
    assert all(len(aux) == 6 for aux in flat["aux"].values())
    for spp, kind, step in ((0, converged, shards.DEPTH_STEP), (1, "aux1", shards.noisy_step(1) / 4), (16, "aux16", shards.noisy_step(16) / 4)):
        true, found = images.read_auxiliary(tmp_path / f"s0000_{kind}.exr")[6:], deep["aux"][spp][6:].float()
        assert found.shape == true.shape == (3, 16, 16)
        assert ((found[1] - true[1]).abs() <= 0.51 * step + 1e-3).all()
        assert (found[:, true[1] == 1] > 0.95).all()            # background, a step from 1 in the middle plane, four in the last
    with_depth_input = NetworkConfig(**{**SMALL.__dict__, "aux_inputs": ("albedo", "normal", "depth")})
    scenes = dataset.Scenes([tmp_path], with_depth_input)
    assert len(scenes) == 1 and scenes.scenes[0].aux[16].shape[0] == 9
    assert len(dataset.Scenes([tmp_path], SMALL)) == 2
    assert dataset.Crops(scenes, 2, seed=1).one()["aux"].shape[0] == 9


def test_relative_depth():
    depth = torch.tensor([[[2.0, 8, 32, 0, -1, float("inf"), float("nan"), 1e8]]])
    relative = pipeline.relative_depth(depth)
    assert relative.shape == (3, 1, 8)
    assert torch.allclose(relative[:, 0, :3], torch.tensor([[0.5, 0.8, 32 / 34], [0.2, 0.5, 0.8], [2 / 34, 0.2, 0.5]]))
    assert (relative[:, 0, 3:] == 1).all()                      # background
    assert torch.allclose(pipeline.depth_planes(relative[1:2]), relative)
    assert torch.allclose(pipeline.relative_depth(1000 * depth)[:, :, :3], relative[:, :, :3])
    assert (pipeline.relative_depth(torch.zeros(1, 2, 2)) == 1).all()


def test_weights_start_from_another_scale(tmp_path):
    source, target = Network(SMALL), Network(NetworkConfig(**{**SMALL.__dict__, "scale": 8, "aux_kernels": 0}))
    path = tmp_path / "model.safetensors"
    weights.save_model(path, source)
    taken = train.start_from(target, path)
    same = lambda a, b: torch.allclose(a, b, rtol=1e-3, atol=1e-4)
    assert same(target.deshuffle[1][2].weight, source.deshuffle[1][1].weight)       # the last step from the last
    assert same(target.deshuffle[1][0].weight, source.deshuffle[1][0].weight)
    assert same(target.up[2].weight, source.up[1].weight)
    assert same(target.out.weight[:28], source.out.weight[:28])                     # residual and kernel logits
    assert taken > 60
    albedo_alone = Network(NetworkConfig(**{**SMALL.__dict__, "aux_inputs": ("albedo",)}))
    train.start_from(albedo_alone, path)
    assert same(albedo_alone.aux_conv.weight, source.aux_conv.weight[:, :3])
    deeper = Network(NetworkConfig(**{**SMALL.__dict__, "aux_inputs": ("albedo", "normal", "depth")}))
    train.start_from(deeper, path)
    weight = torch.cat([source.aux_conv.weight, torch.zeros(4, 3, 3, 3)], 1)        # a further input changes nothing at first
    assert torch.allclose(deeper.aux_conv.weight, weight, atol=2e-3)
    pointwise = Network(NetworkConfig(**{**SMALL.__dict__, "output_side": 1}))
    train.start_from(pointwise, path)
    assert torch.allclose(pointwise.out.weight[:, :, 0, 0], source.out.weight.sum((2, 3)), atol=2e-3)       # float16 in the file
    back = Network(SMALL)
    weights.save_model(path, pointwise)
    train.start_from(back, path)
    centre = back.out.weight[:, :, 1, 1].clone()
    assert torch.allclose(centre, pointwise.out.weight[:, :, 0, 0], atol=2e-3)
    assert (back.out.weight != 0).sum() == (centre != 0).sum()
