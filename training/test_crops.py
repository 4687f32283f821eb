"""Crops keep colour, auxiliary images and target consistent, and a batch takes few operations."""
import pytest
import torch
from torch.profiler import ProfilerActivity, profile

import crops
import dataset
import pipeline
from crops import Crops, Variation
from network import NetworkConfig
from test_dataset import FULL, SMALL, FakeScenes, scene_of_one_noise

INNER = slice(8, -8)
NO_KERNELS = {"slice", "select", "view", "flatten", "expand", "as_strided", "as_strided_", "narrow", "unsqueeze", "reshape", "transpose", "detach",
              "_unsafe_view", "resolve_conj", "empty_like", "clone", "to", "_to_copy", "matmul"}


def variation(upside_down=False, mirrored=False, transposed=False, **others):
    """Of one crop."""
    one = lambda flag: torch.tensor([flag])
    same = dict(colours=torch.eye(3)[None], tint=torch.ones(1, 3), turns=torch.eye(3)[None])
    return Variation(one(upside_down), one(mirrored), one(transposed), **{**same, **others})


def applied(change, image, matrices):
    return crops.varied(image[None], change.places(*image.shape[1:]), matrices)[0]


def test_mirrors_turn_the_normal_along():
    colour, aux = torch.rand(3, 12, 12), torch.rand(6, 48, 48)
    upside_down, mirrored, transposed = variation(upside_down=True), variation(mirrored=True), variation(transposed=True)
    turned = lambda change: applied(change, aux, change.auxiliary(("albedo", "normal")))
    assert torch.equal(applied(mirrored, colour, mirrored.light())[:, :, 0], colour[:, :, -1])
    assert torch.equal(applied(upside_down, colour, upside_down.light())[:, 0], colour[:, -1])
    assert torch.equal(turned(mirrored)[3, :, 0], -aux[3, :, -1])
    assert torch.equal(turned(mirrored)[4, :, 0], aux[4, :, -1])
    assert torch.equal(turned(upside_down)[4, 0], -aux[4, -1])
    assert torch.equal(turned(transposed)[3, 2, 5], -aux[4, 5, 2])       # what pointed up points left
    assert torch.equal(turned(transposed)[0, 2, 5], aux[0, 5, 2])


def test_transposition_comes_after_the_mirrors():
    image = torch.arange(3 * 16).view(3, 4, 4).float()
    change = variation(mirrored=True, transposed=True)
    assert torch.equal(applied(change, image, change.light()), image.flip(2).transpose(1, 2))
    aux = torch.zeros(6, 4, 4)
    aux[3], aux[4] = 0.6, 0.8                                # points right and up; after the mirror left and up, then left and down
    assert torch.allclose(applied(change, aux, change.auxiliary(("albedo", "normal")))[3:5, 0, 0], torch.tensor([-0.8, 0.6]))


def test_light_is_tinted_after_its_colours_are_exchanged():
    tint, order = torch.tensor([[1.0, 2, 4]]), torch.eye(3)[[2, 0, 1]][None]
    change = variation(colours=order, tint=tint)
    image = torch.rand(3, 4, 4)
    assert torch.equal(applied(change, image, change.light()), image[[2, 0, 1]] * tint[0, :, None, None])
    aux = torch.rand(12, 4, 4)
    found = applied(change, aux, change.auxiliary(("albedo", "depth", "diffuse", "glossy")))
    assert torch.equal(found[:3], aux[:3][[2, 0, 1]]) and torch.equal(found[3:6], aux[3:6])
    assert torch.equal(found[9:], aux[9:][[2, 0, 1]] * tint[0, :, None, None])


def test_rotations_are_rotations():
    turns = crops.random_rotations(5, torch.Generator().manual_seed(3))
    assert torch.allclose(turns @ turns.mT, torch.eye(3).expand(5, 3, 3), atol=1e-5)
    assert torch.allclose(torch.linalg.det(turns), torch.ones(5), atol=1e-5)


def test_converged_aux_of_a_crop_varies_with_the_noisy_one():
    scenes = FakeScenes()
    scene = scenes.scenes[0]
    scene.put(("aux", 16), scene.aux[0])        # no noise: both must stay the same
    batch = Crops(scenes, 8, seed=4, aux_shares={16: 1}).batch(6)
    assert torch.equal(batch["clean"], batch["aux"][:, :, INNER, INNER])


def test_noise_of_a_count_without_render_is_scaled():
    scenes = FakeScenes()
    scene = scenes.scenes[0]
    scene.put(("aux", 16), scene.aux[0] + 0.25)
    for spp, noise in ((16, 0.25), (64, 0.125), (4, 0.5)):
        batch = Crops(scenes, 8, seed=4, aux_shares={spp: 1}).batch(6)
        difference = (batch["aux"][:, :, INNER, INNER] - batch["clean"])[:, :3]
        assert torch.allclose(difference, torch.full_like(difference, noise), atol=4e-3)


def test_crops_are_parts_of_their_images():
    scenes = FakeScenes(side=16)
    scene = scenes.scenes[0]
    loader = Crops(scenes, 8, seed=4, aux_shares={16: 1})
    loader.variation = lambda count: Variation(*torch.zeros(3, count, dtype=torch.bool), torch.eye(3).expand(count, 3, 3), torch.ones(count, 3),
                                               torch.eye(3).expand(count, 3, 3))
    batch = loader.batch(32)
    places = set()
    for colour, aux, target in zip(batch["colour"], batch["aux"], batch["target"]):
        (y, x), = [(y, x) for y in range(9) for x in range(9) if torch.equal(colour[:, 2:-2, 2:-2], scene.colours[64][:, y:y + 8, x:x + 8].float())]
        assert torch.equal(target, scene.target[:, 4 * y:4 * y + 32, 4 * x:4 * x + 32].float())
        assert torch.equal(aux, scene.bordered["aux", 16][:, 4 * y:4 * y + 48, 4 * x:4 * x + 48].float())
        places.add((y, x))
    assert len(places) > 20 and {0, 8} <= {y for y, _ in places} and {0, 8} <= {x for _, x in places}


def test_crops_of_a_full_model():
    scenes = FakeScenes(FULL)
    scenes.scenes[0], clean, noise = scene_of_one_noise((4,))
    loader = Crops(scenes, 8, seed=4)
    assert loader.aux_shares == dataset.FULL_SHARES
    batch = loader.batch(8)
    assert batch["full"].shape == (8, 3, 48, 48) and batch["aux"].shape == (8, 6, 48, 48) and batch["clean"].shape == (8, 6, 32, 32)
    ratio = batch["full"][:, :, INNER, INNER] / batch["target"]          # mirrored, turned and tinted as the target is
    assert ((ratio - 1).abs().mean((1, 2, 3)) < 0.2).all() and ratio.mean().item() == pytest.approx(1, abs=0.02)
    low, box = batch["colour"][:, :, 2:-2, 2:-2], pipeline.box_mean(batch["full"][:, :, INNER, INNER], 4)
    truth = pipeline.box_mean(batch["target"], 4)
    share = ((low - truth) * (box - truth)).sum((1, 2, 3)) / (box - truth).square().sum((1, 2, 3))
    expected = torch.tensor([16 * spp / (64 + 16 * spp) for spp in (1, 2, 4, 8, 16)])
    assert ((share[:, None] - expected).abs().min(1).values < 0.02).all()       # the colour is the merged one
    with pytest.raises(ValueError, match="converged"):
        Crops(scenes, 8, seed=4, aux_shares={0: 1})


def test_renders_of_few_samples_are_not_imitated_by_those_of_more():
    scenes = FakeScenes(FULL)
    scenes.scenes = [scene_of_one_noise(counts)[0] for counts in ((1,), (4,), (16,))]
    for count, fitting in ((1, 1), (2, 1), (4, 2), (16, 3)):
        loader = Crops(scenes, 8, seed=4, aux_shares={count: 1})
        assert {min(loader.scene_and_render()[0].full) for _ in range(60)} == set((1, 4, 16)[:fitting])
    scenes.scenes = scenes.scenes[2:]
    assert Crops(scenes, 8, seed=4, aux_shares={1: 1}).scene_and_render() == (scenes.scenes[0], 1)      # there is no other


def test_scale_1_takes_colour_and_aux_of_one_render(monkeypatch):
    scenes = FakeScenes(NetworkConfig(**{**SMALL.__dict__, "scale": 1}))
    torch.manual_seed(6)
    clean = 0.5 + torch.rand(6, 12, 12)
    decoded = {"colour": {}, "target": clean[:3].half(), "aux": {0: clean.half()}}
    for spp in (1, 4):                                              # each render has a noise of its own
        image = clean + 0.1 * torch.randn(12, 12)
        decoded["aux"][spp], decoded["colour"][1, spp] = image.half(), image[:3].half()
    scenes.scenes = [dataset.Scene(decoded, scenes.config, "cpu")]
    monkeypatch.setattr(dataset, "SAME_RENDER_SHARE", 1.0)
    seen = set()
    for spp in (1, 2, 4, 8, 16):
        loader = Crops(scenes, 8, seed=4, colour_shares={spp: 1})
        loader.variation = lambda count: variation()
        batch = loader.batch(1)
        inner = (..., slice(2, -2), slice(2, -2))
        difference = (batch["colour"] - batch["aux"][:, :3])[inner]
        assert torch.allclose(difference, torch.zeros_like(difference), atol=4e-3)
        seen.add(round((batch["colour"][inner] - batch["target"]).std().item(), 4))
    assert len(seen) == 5


@pytest.mark.parametrize("config", [SMALL, FULL], ids=["plain", "full"])
def test_a_batch_takes_few_operations_whatever_its_size(config):
    scenes = FakeScenes(config, side=16)
    loader = Crops(scenes, 8, seed=4)
    loader.batch(64)                    # what is made once is there
    def operations(count):
        """Those that would be kernels on a device: on images, and neither views nor made of others that are counted."""
        with profile(activities=[ProfilerActivity.CPU], record_shapes=True) as profiled:
            loader.batch(count)
        on_images = (event for event in profiled.events() if any(len(shape) >= 3 and shape[-1] >= 8 for shape in event.input_shapes if shape))
        return sum(event.name.removeprefix("aten::") not in NO_KERNELS for event in on_images)
    assert max(operations(2), operations(16)) <= 40
