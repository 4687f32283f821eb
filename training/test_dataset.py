"""Crops and flips keep colour, weights, normals and target consistent."""
import torch

import dataset
import pipeline


class FakeScenes:
    """One scene of random images in the layout of dataset.Scenes."""
    scale = 4

    def __init__(self, side=12):
        torch.manual_seed(5)
        self.colour = torch.rand(1, 2, 3, side, side)
        albedo, normal = torch.rand(1, 3, 3, 4 * side, 4 * side), torch.rand(1, 3, 3, 4 * side, 4 * side) - 0.5
        self.aux = torch.cat([albedo, normal], 2)
        self.log_weights = pipeline.guided_log_weights(albedo[0], normal[0], 4)[None]
        self.target = torch.rand(1, 3, 4 * side, 4 * side)
        self.exposure, self.base_error = torch.ones(1, 2), torch.ones(1)

    def __len__(self):
        return 1


def test_weights_of_a_crop_belong_to_its_images():
    crops = dataset.Crops(FakeScenes(), 8, seed=2)
    for _ in range(12):         # every combination of flips occurs
        crop = crops.one()
        whole = pipeline.guided_log_weights(crop["aux"][None, :3], crop["aux"][None, 3:], 4)[0]
        inner = slice(8, 24)    # two low-resolution pixels from the border: no neighbour outside of the crop
        assert torch.allclose(whole[:, inner, inner], crop["log_weights"][:, inner, inner], atol=1e-4)
        means = pipeline.box_mean(crop["aux"][None, :3], 4)[0]
        assert torch.allclose(means, crop["albedo_mean"][:, 2:-2, 2:-2], atol=1e-6)


def test_flips_mirror_every_image_and_turn_the_normal():
    crop = {"colour": torch.rand(3, 12, 12), "albedo_mean": torch.rand(3, 12, 12), "aux": torch.rand(6, 32, 32),
            "target": torch.rand(3, 32, 32), "log_weights": torch.rand(5, 5, 32, 32)}
    upside_down, mirrored = dataset.flip_axis(crop, 1), dataset.flip_axis(crop, 2)
    assert torch.equal(mirrored["target"][:, :, 0], crop["target"][:, :, -1])
    assert torch.equal(upside_down["colour"][:, 0], crop["colour"][:, -1])
    assert torch.equal(mirrored["aux"][3, :, 0], -crop["aux"][3, :, -1])
    assert torch.equal(mirrored["aux"][4, :, 0], crop["aux"][4, :, -1])
    assert torch.equal(upside_down["aux"][4, 0], -crop["aux"][4, -1])
    assert torch.equal(upside_down["log_weights"][0, :, 0], crop["log_weights"][4, :, -1])
    assert torch.equal(mirrored["log_weights"][:, 0, :, 0], crop["log_weights"][:, 4, :, -1])


def test_flipping_twice_changes_nothing():
    crop = dataset.Crops(FakeScenes(), 8, seed=3).one()
    crop["log_weights"] = crop["log_weights"].view(5, 5, 32, 32)
    for axis in (1, 2):
        twice = dataset.flip_axis(dataset.flip_axis(crop, axis), axis)
        assert all(torch.equal(twice[key], crop[key]) for key in crop)
