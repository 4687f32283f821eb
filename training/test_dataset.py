"""Scenes keep colour, auxiliary images and target consistent; shards give back what was put in."""
import numpy as np
import pytest
import torch

import dataset
import images
import pipeline
import shards
import train
import weights
from crops import Crops
from network import Network, NetworkConfig
from start import initialise, start_from

SMALL = NetworkConfig(channels=8, aux_channels=4, head_channels=4, groups=1, blocks=1, window=4, kernels=5, aux_skip=1, aux_kernels=3)
FULL = NetworkConfig(**{**SMALL.__dict__, "aux_inputs": ("albedo", "colour", "normal"), "colour_kernels": 5})


class FakeScenes:
    """One scene of random images in the layout of dataset.Scenes."""

    def __init__(self, config=SMALL, side=12):
        torch.manual_seed(5)
        self.config = config
        high = config.scale * side
        decoded = {"colour": {(config.scale, 64): torch.rand(3, side, side).half()}, "target": torch.rand(3, high, high).half(),
                   "aux": {spp: torch.cat([torch.rand(3, high, high), torch.rand(3, high, high) - 0.5]).half() for spp in (0, 16)}}
        if config.full:
            decoded["colour"][1, 16] = torch.rand(3, high, high).half()
        self.scenes = [dataset.Scene(decoded, config, "cpu")]

    def __len__(self):
        return 1


def test_borders_repeat_whole_low_resolution_pixels():
    image = torch.arange(3 * 8 * 8).view(3, 8, 8)
    bordered = dataset.with_border(image, 4)                # blocks of 2 x 2 pixels, two around
    assert torch.equal(bordered[:, 4:-4, 4:-4], image)
    for first in (0, 2):
        assert torch.equal(bordered[:, first:first + 2, 4:-4], image[:, 0:2])
        assert torch.equal(bordered[:, 4:-4, 8 + 2 + first:8 + 4 + first], image[:, :, 6:8])


@pytest.mark.parametrize("config", [SMALL, FULL], ids=["plain", "full"])
@pytest.mark.parametrize("place", [(0, 0), (2, 2), (4, 4)])
def test_forward_of_a_crop_is_the_pipeline(place, config):
    scenes, size = FakeScenes(config), 8
    scene = scenes.scenes[0]
    network = Network(config)
    initialise(network, torch.Generator().manual_seed(1))
    torch.nn.init.normal_(network.out.bias, std=0.5)        # kernels and residual of the bias alone: no receptive field
    y, x = place
    def crop(key, scale):
        return scene.bordered[key][None, :, scale * y:scale * (y + size + 4), scale * x:scale * (x + size + 4)].float()
    batch = {"colour": crop(("colour", 64), 1), "aux": crop(("aux", 16), 4), "target": crop(("target",), 4)[:, :, 8:-8, 8:-8], "exposure": torch.ones(1)}
    full = scene.full[16].float()[None] if config.full else None
    if config.full:
        batch["full"] = crop(("full", 16), 4)
    result, target, aux = train.forward(network, batch, "cpu", "bfloat16")
    with torch.no_grad():
        whole, _, _ = pipeline.upscale(network, scene.colours[64].float()[None], scene.aux[16].float()[None], 1.0, full)
    here = (..., slice(4 * y, 4 * (y + size)), slice(4 * x, 4 * (x + size)))
    inside = (..., slice(8, -8), slice(8, -8))      # what kernels at the border of a crop reach is not filtered
    assert torch.allclose(result[inside], whole[here][inside], rtol=0.02, atol=0.01)    # the network's part is bfloat16
    assert torch.equal(target, scene.target.float()[None][here])
    assert aux.shape == (1, 6, 32, 32)


def test_noise_of_other_counts_is_scaled():
    scene = FakeScenes().scenes[0]
    noise = scene.aux[16].float() - scene.aux[0].float()
    assert torch.allclose(scene.noisy_aux(64).float() - scene.aux[0].float(), noise / 2, atol=2e-3)
    assert torch.allclose(scene.noisy_aux(4).float() - scene.aux[0].float(), 2 * noise, atol=4e-3)
    assert torch.equal(scene.noisy_aux(16), scene.aux[16].float())


def scene_of_one_noise(counts):
    """(scene, clean, noise) of a full model: colour of 64 samples without noise, one render at each count whose images share a noise."""
    torch.manual_seed(7)
    clean, noise = 1 + torch.rand(6, 48, 48), 0.1 * torch.randn(48, 48)
    decoded = {"colour": {(4, 64): pipeline.box_mean(clean[None, :3], 4)[0].half()}, "target": clean[:3].half(), "aux": {0: clean.half()}}
    for spp in counts:
        decoded["aux"][spp] = (clean + noise * (4 / spp) ** 0.5).half()
        decoded["colour"][1, spp] = decoded["aux"][spp][:3]
    decoded["aux"][2] = (clean - 1).half()                     # a count without colour: never used
    return dataset.Scene(decoded, FULL, "cpu"), clean, noise


def test_colour_and_aux_of_an_imitated_render_share_their_noise():
    scene, clean, noise = scene_of_one_noise((1, 4))
    assert set(scene.full) == {1, 4}
    for spp, count in ((1, 1), (2, 2), (4, 4), (8, 8), (16, 16)):
        full, samples = scene.noisy_full(spp)
        have, share = scene.nearest_full(spp)
        assert samples == pytest.approx(count)
        assert torch.allclose(full - clean[:3], noise.expand(3, 48, 48) * (4 / spp) ** 0.5, atol=4e-3)
        assert torch.allclose(share * (scene.aux[have].float() - clean), noise.expand(6, 48, 48) * (4 / spp) ** 0.5, atol=8e-3)
    scene, clean, noise = scene_of_one_noise((16,))
    full, samples = scene.noisy_full(1)                         # at most twice the noise: that of 4 samples
    assert samples == 4 and torch.allclose(full - clean[:3], noise.expand(3, 48, 48), atol=4e-3)
    scene.target.zero_()
    assert scene.noisy_full(1)[0].min() >= 0


def test_scale_1_imitates_the_counts_that_were_not_rendered():
    config = NetworkConfig(**{**SMALL.__dict__, "scale": 1})
    torch.manual_seed(6)
    clean, noise = 0.5 + torch.rand(6, 12, 12), 0.1 * torch.randn(2, 12, 12)
    decoded = {"colour": {}, "target": clean[:3].half(), "aux": {0: clean.half()}}
    for spp, own in zip((1, 8), noise):
        decoded["aux"][spp], decoded["colour"][1, spp] = (clean + own).half(), (clean[:3] + own).half()
    scene = dataset.Scene(decoded, config, "cpu")
    assert set(scene.colours) == {1, 2, 4, 8, 16}
    for spp, have, own in ((1, 1, 0), (2, 1, 0), (4, 1, 0), (8, 8, 1), (16, 8, 1)):
        colour, aux = scene.colours[spp].float() - clean[:3], scene.aux[spp].float() - clean
        assert torch.allclose(colour, noise[own].expand(3, 12, 12) * (have / spp) ** 0.5, atol=4e-3)
        assert torch.allclose(aux, noise[own].expand(6, 12, 12) * (have / spp) ** 0.5, atol=4e-3)
    del decoded["colour"][1, 1]
    assert set(dataset.Scene(decoded, config, "cpu").colours) == {4, 8, 16}      # half to four times the samples


def write_scene(folder, name, side=16, depth_of=(), lights=False):
    """A scene of plain R, G, B colour and albedo and normal, as render.py names the files, with depth in those of `depth_of`, with `lights`."""
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
        light = {f"ViewLayer.{part}": image(side, side) for part in ("DiffDir", "DiffInd", "GlossDir", "GlossInd")} if lights else {}
        write(kind, **layers(), **depth, **light)
    write("lr64", **{"ViewLayer.Combined": image(side // 4, side // 4)})


def write(path, source, name, noisy_every, noisy_bits=3):
    shards.write_shard(path, encoded(source, name, noisy_every=noisy_every, noisy_bits=noisy_bits), 1e6)
    return path


def encoded(folder, *names, **options):
    """What write_shard takes, of scenes of a folder."""
    return ((name, shards.encode(folder, name, int(name[1:]), **options)) for name in names)


def test_shards_give_back_scenes(tmp_path, monkeypatch):
    source, output = tmp_path / "scenes", tmp_path / "shards"
    source.mkdir()
    output.mkdir()
    for name in ("s0000", "s0001"):
        write_scene(source, name)
    left = encoded(source, "s0000", "s0001")
    assert shards.write_shard(output / "scenes-000.npz", left, 1) == 1      # full after the first
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
    colour = images.read_exr(source / "s0001_aux1.exr", "colour")
    ((_, fine),) = shards.read_shard(write(output / "other.npz", source, "s0001", 1, 6))
    (output / "other.npz").unlink()
    assert torch.allclose(noisy["colour"][1, 1].float(), colour, rtol=0.07, atol=1e-5)
    assert torch.allclose(fine["colour"][1, 1].float(), colour, rtol=0.009, atol=1e-5)
    monkeypatch.setattr(shards, "NOISY_STEP", {1: 1 / 8})
    with pytest.raises(ValueError, match="pack its scenes again"):
        list(shards.read_shard(output / "scenes-000.npz"))
    monkeypatch.undo()
    scenes = dataset.Scenes([output], SMALL)
    shards.write_shard(output / "scenes-001.npz", left, 1e6)
    scenes.refresh()
    assert len(scenes) == 2
    full = dataset.Scenes([output], FULL)
    assert [list(scene.full) for scene in full.scenes] == [[1]]     # s0001 keeps no noisy colour
    assert "full" in Crops(full, 2, seed=1).batch(1)


def test_processes_decode_the_same_scenes_in_the_same_order(tmp_path, monkeypatch):
    for name in ("s0000", "s0001", "s0002"):
        write_scene(tmp_path, name)
    write(tmp_path / "scenes-000.npz", tmp_path, "s0001", 1)
    shards.write_shard(tmp_path / "scenes-001.npz", encoded(tmp_path, "s0000", "s0002"), 1e6)
    started = []
    class Pool(dataset.concurrent.futures.ProcessPoolExecutor):
        def __init__(self, processes, *arguments):
            started.append(processes)
            super().__init__(processes, *arguments)
    monkeypatch.setattr(dataset.concurrent.futures, "ProcessPoolExecutor", Pool)
    few = dataset.Scenes([tmp_path], SMALL, processes=8)
    assert not started                                              # not worth a process
    monkeypatch.setattr(dataset, "SCENES_A_PROCESS", 1)
    one, many = (dataset.Scenes([tmp_path], SMALL, processes=count) for count in (1, 2))
    assert started == [2]
    for found in (few, one, many):
        assert [(path.name, name) for path, name in (scene.origin for scene in found.scenes)] == [
            ("scenes-000.npz", "s0001"), ("scenes-001.npz", "s0000"), ("scenes-001.npz", "s0002")]
        for scene, other in zip(found.scenes, one.scenes):
            assert list(scene.bordered) == list(other.bordered) and scene.base_error == other.base_error
            assert all(torch.equal(image, other.bordered[key]) for key, image in scene.bordered.items())


def test_packed_scenes_are_completed_by_renders(tmp_path, monkeypatch):
    """A scene packed with one noisy colour gets those of all its renders; its other arrays stay."""
    source, old, new = tmp_path / "scenes", tmp_path / "old", tmp_path / "new"
    for folder in (source, old):
        folder.mkdir()
    write_scene(source, "s0000", depth_of=("gt", "aux1", "aux16"))
    write_scene(source, "s0001")
    shards.write_shard(old / "scenes-000.npz", encoded(source, "s0000", "s0001"), 1e6)
    for path in source.glob("s0001_*"):
        path.unlink()                                               # not rendered again: not in the new shards
    monkeypatch.setattr("sys.argv", ["shards.py", str(source), "--complete", str(old), "--output", str(new), "--noisy-bits", "6"])
    shards.main()
    ((name, packed),) = shards.read_packed(new / "scenes-000.npz")
    (_, before), _ = shards.read_packed(old / "scenes-000.npz")
    assert name == "s0000" and set(packed) == {*before, "x1lr16"}
    assert all(np.array_equal(packed[kind], before[kind]) for kind in before if kind != "x1lr1")      # which has more bits now
    scene = shards.decode(packed)
    for spp in (1, 16):
        assert torch.allclose(scene["colour"][1, spp].float(), images.read_exr(source / f"s0000_aux{spp}.exr", "colour"), rtol=0.009, atol=1e-5)
    assert shards.encode(source, "s0000", 0, 0, 6).keys() == packed.keys()      # packed so from the first
    shards.main()
    assert [path.name for path in new.iterdir()] == ["scenes-000.npz"]          # they are there


@pytest.mark.parametrize("with_depth, converged", [(("gt", "aux1", "aux16"), "gt"), (("aux1", "aux16"), "aux16")])
def test_shards_keep_depth(tmp_path, with_depth, converged):
    write_scene(tmp_path, "s0000", depth_of=with_depth)
    write_scene(tmp_path, "s0001")
    shards.write_shard(tmp_path / "scenes-000.npz", encoded(tmp_path, "s0000", "s0001"), 1e6)
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
    assert Crops(scenes, 2, seed=1).batch(1)["aux"].shape[1] == 9


def test_shards_keep_lights_which_crops_tint_as_colours(tmp_path):
    write_scene(tmp_path, "s0000", depth_of=("gt", "aux1", "aux16"), lights=True)
    write_scene(tmp_path, "s0001", depth_of=("gt", "aux1", "aux16"))
    shards.write_shard(tmp_path / "scenes-000.npz", encoded(tmp_path, "s0000", "s0001", noisy_every=0, noisy_bits=6), 1e6)
    (_, lit), (_, unlit) = shards.read_shard(tmp_path / "scenes-000.npz")
    assert all(len(aux) == 9 for aux in unlit["aux"].values())
    channels = images.channels_of(tmp_path / "s0000_aux1.exr")
    for first, name in ((9, "Diff"), (12, "Gloss")):
        true = channels[f"ViewLayer.{name}Dir.G"] + channels[f"ViewLayer.{name}Ind.G"]
        assert np.allclose(lit["aux"][1][first + 1].float(), true, rtol=0.01, atol=1e-3)
    config = NetworkConfig(**{**SMALL.__dict__, "aux_inputs": ("albedo", "normal", "colour", "diffuse", "glossy")})
    scenes = dataset.Scenes([tmp_path], config)
    assert len(scenes) == 1
    scene = scenes.scenes[0]
    for aux in scene.aux.values():      # lights that are the colour of the same render stay it
        aux[6:9] = 0.25
    for image in (scene.target, *scene.full.values()):
        image[:] = 0.25
    crop = Crops(scenes, 2, seed=1).batch(1)
    inner = (0, slice(None), slice(8, -8), slice(8, -8))
    assert torch.allclose(crop["aux"][inner][6:9], crop["full"][inner], rtol=1e-3) and crop["aux"].shape[1] == 12
    assert len({round(value, 4) for value in crop["full"][inner][:, 0, 0].tolist()}) == 3


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
    taken = start_from(target, path)
    same = lambda a, b: torch.allclose(a, b, rtol=1e-3, atol=1e-4)
    assert same(target.deshuffle[1][2].weight, source.deshuffle[1][1].weight)       # the last step from the last
    assert same(target.deshuffle[1][0].weight, source.deshuffle[1][0].weight)
    assert same(target.up[2].weight, source.up[1].weight)
    assert same(target.out.weight[:28], source.out.weight[:28])                     # residual and kernel logits
    assert taken > 60
    albedo_alone = Network(NetworkConfig(**{**SMALL.__dict__, "aux_inputs": ("albedo",)}))
    start_from(albedo_alone, path)
    assert same(albedo_alone.aux_conv.weight, source.aux_conv.weight[:, :3])
    deeper = Network(NetworkConfig(**{**SMALL.__dict__, "aux_inputs": ("albedo", "normal", "depth")}))
    start_from(deeper, path)
    weight = torch.cat([source.aux_conv.weight, torch.zeros(4, 3, 3, 3)], 1)        # a further input changes nothing at first
    assert torch.allclose(deeper.aux_conv.weight, weight, atol=2e-3)
    pointwise = Network(NetworkConfig(**{**SMALL.__dict__, "output_side": 1}))
    start_from(pointwise, path)
    assert torch.allclose(pointwise.out.weight[:, :, 0, 0], source.out.weight.sum((2, 3)), atol=2e-3)       # float16 in the file
    back = Network(SMALL)
    weights.save_model(path, pointwise)
    start_from(back, path)
    centre = back.out.weight[:, :, 1, 1].clone()
    assert torch.allclose(centre, pointwise.out.weight[:, :, 0, 0], atol=2e-3)
    assert (back.out.weight != 0).sum() == (centre != 0).sum()


def test_full_model_starts_as_the_plain_one(tmp_path):
    torch.manual_seed(1)
    plain, path = Network(SMALL).eval(), tmp_path / "model.safetensors"
    initialise(plain, torch.Generator().manual_seed(1))
    torch.nn.init.normal_(plain.out.weight, std=0.1)
    weights.save_model(path, plain)
    plain, _ = weights.load_model(path)
    network = Network(FULL).eval()
    initialise(network, torch.Generator().manual_seed(2))
    start_from(network, path)
    assert not network.aux_conv.weight[:, 3:6].any()                    # the colour, second of three
    assert torch.equal(network.aux_conv.weight[:, 6:], plain.aux_conv.weight[:, 3:])
    assert not network.out.weight[37:].any() and not network.out.bias[37:-1].any() and network.out.bias[-1] == -3
    colour, aux, full = torch.rand(1, 3, 8, 8), torch.rand(1, 6, 32, 32), torch.rand(1, 3, 32, 32)
    with torch.no_grad():
        before, raw, _ = pipeline.upscale(plain, colour, aux)
        after, raw_full, _ = pipeline.upscale(network, colour, aux, full=full)
        assert torch.allclose(raw_full[:, :37], raw, atol=1e-5)
        assert not torch.equal(before, after) and (after - before).abs().mean() < 0.05 * before.mean()
        network.out.bias[-1] = -100
        assert torch.allclose(pipeline.upscale(network, colour, aux, full=full)[0], before, rtol=1e-4, atol=1e-5)
    back = Network(SMALL).eval()
    weights.save_model(path, network)
    start_from(back, path)
    assert all(torch.equal(value, plain.state_dict()[name]) for name, value in back.state_dict().items())
