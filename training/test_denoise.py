"""Open Image Denoise on the images of scenes, where it is installed."""
import pytest
import torch

import dataset
import denoise
import evaluate
import pipeline
from crops import Crops
from network import Network, NetworkConfig
from test_dataset import FULL, FakeScenes

pytest.importorskip("pyoidn")


def noisy(side, seed):
    """(a gradient of light, the same with noise [3, side, side], albedo and normal [6, side, side])"""
    clean = torch.linspace(0.2, 1, side).expand(3, side, side)
    noise = torch.randn(3, side, side, generator=torch.Generator().manual_seed(seed))
    return clean, (clean + 0.2 * noise).clamp(min=0), torch.cat([torch.full((3, side, side), 0.5), torch.zeros(2, side, side), torch.ones(1, side, side)])


def test_noise_goes():
    clean, colour, aux = noisy(64, 1)
    colour[0, 3, 3] = float("nan")      # counts as 0
    found = denoise.denoised(colour, aux)
    assert found.shape == clean.shape and found.isfinite().all()
    assert (found - clean).square().mean() < 0.05 * 0.2 ** 2


def test_low_resolution_takes_box_means_of_the_guides():
    clean, colour, _ = noisy(32, 2)
    _, _, aux = noisy(128, 3)
    assert (denoise.denoised_low(colour, aux, 4) - clean).square().mean() < 0.1 * 0.2 ** 2


def test_guides_lose_their_noise_and_lights_keep_their_albedo():
    _, _, clean = noisy(64, 4)
    guides = clean + 0.1 * torch.randn(clean.shape, generator=torch.Generator().manual_seed(5))
    guides[:3, 20:40, 20:40] = 3.0
    found = denoise.denoised_guides(torch.cat([guides, torch.full((3, 64, 64), 7.0)]))
    dark = torch.ones(64, 64, dtype=torch.bool)
    dark[18:42, 18:42] = False
    assert (found[:6] - clean)[:, dark].square().mean() < 0.05 * 0.1 ** 2
    assert (found[:3, 24:36, 24:36] - 3.0).abs().max() < 0.1
    assert (found[6:] == 7.0).all()


def test_a_case_is_denoised_after_merging():
    clean, full, aux = noisy(128, 4)
    low_clean, low, _ = noisy(32, 5)
    low = low_clean + 0.25 * (low - low_clean)
    guides = aux + 0.1 * torch.randn(aux.shape, generator=torch.Generator().manual_seed(6))
    case = evaluate.Case("s", low, guides, full, pipeline.merged_colour(low, 16, full, 1, 4), clean)
    found = case.denoised(4)
    assert (found.full - clean).square().mean() < 0.05 * 0.2 ** 2
    assert (found.merged - low_clean).square().mean() < (found.colour - low_clean).square().mean() + 1e-4 < 0.1 * 0.2 ** 2
    assert (found.aux - aux).square().mean() < 0.05 * 0.1 ** 2
    converged = evaluate.Case("s", low, guides, None, low, clean, clean=True).denoised(4)
    assert converged.full is None and torch.equal(converged.aux, guides)


def test_crops_of_denoised_images_are_made_once(monkeypatch):
    scenes, calls = FakeScenes(FULL, side=16), []
    monkeypatch.setattr(denoise, "denoised_guides", lambda aux, first_lights: calls.append("guides") or torch.full(aux.shape, 0.25))
    monkeypatch.setattr(denoise, "denoised", lambda colour, guides: calls.append("full") or torch.zeros_like(colour))
    monkeypatch.setattr(denoise, "denoised_low", lambda colour, guides, scale: calls.append("low") or torch.ones_like(colour))
    crops = Crops(scenes, 8, seed=1, aux_shares={16: 1}, denoised_share=1)
    for _ in range(3):
        crop = crops.batch(1)
        assert not crop["full"].any() and (crop["colour"].amax((2, 3)) == crop["colour"].amin((2, 3))).all()
        assert crop["aux"][0, :3].eq(0.25).all()
    assert sorted(calls) == ["full", "guides", "low"]


def test_crops_of_models_without_the_full_colour_are_denoised_too(monkeypatch):
    scenes, calls = FakeScenes(NetworkConfig(scale=2, base="guided"), side=16), []
    monkeypatch.setattr(denoise, "denoised_low", lambda colour, aux, scale: calls.append(aux) or torch.ones_like(colour))
    crops = Crops(scenes, 8, seed=1, aux_shares={0: 1}, denoised_share=1)
    for _ in range(3):
        colour = crops.batch(1)["colour"]
        assert (colour.amax((2, 3)) == colour.amin((2, 3))).all()
    assert len(calls) == 1 and torch.equal(calls[0], scenes.scenes[0].aux[0].float())


def test_colours_are_denoised_with_albedo_and_normal():
    with pytest.raises(ValueError, match="albedo and normal"):
        Crops(FakeScenes(NetworkConfig(base="guided", aux_inputs=("albedo",)), side=16), 8, seed=1, denoised_share=1)


def test_what_is_denoised_at_scale_1_was_rendered(monkeypatch):
    config = NetworkConfig(scale=1, base="guided")
    image = lambda channels: torch.rand(channels, 32, 32).half()
    decoded = {"colour": {(1, spp): image(3) for spp in (1, 8)}, "target": image(3), "aux": {spp: image(6) for spp in (0, 1, 8)}}
    scenes = FakeScenes(config)
    scenes.scenes, seen = [dataset.Scene(decoded, config, "cpu")], set()
    assert set(scenes.scenes[0].colours) > {1, 8}               # noise of others is scaled
    monkeypatch.setattr(dataset.Scene, "denoised_colour", lambda self, spp, count: seen.add((spp, count)) or ("colour", spp))
    monkeypatch.setattr(dataset.Scene, "denoised_aux", lambda self, count: ("aux", count))
    crops = Crops(scenes, 8, seed=1, aux_shares={0: 1}, denoised_share=1)
    for _ in range(60):
        crops.draw()
    assert seen == {(1, 1), (8, 8), (1, 0), (8, 0)}             # of one render, or with converged guides


def test_what_changes_in_a_denoised_colour_is_taken_in_parts():
    config = NetworkConfig(scale=1, denoised_darker=75, denoised_brighter=25)
    before, after = torch.tensor([4.0, 1, 2, -1]).view(1, 1, 1, 4), torch.tensor([0.0, 5, 2, 4]).view(1, 1, 1, 4)
    assert pipeline.restrained(after, before, config).flatten().tolist() == [1, 2, 2, 1]
    whole = NetworkConfig(scale=1)
    assert torch.equal(pipeline.restrained(after, before, whole), after)


def test_models_of_scale_1_are_measured_behind_the_denoiser(monkeypatch):
    config, image = NetworkConfig(scale=1, denoised_darker=0, denoised_brighter=0, channels=8, aux_channels=4, head_channels=4, groups=1, blocks=1), torch.rand(3, 8, 8)
    network = Network(config)
    case = evaluate.Case("scene", image, torch.rand(6, 8, 8), None, image, image)
    monkeypatch.setattr(evaluate.denoise, "denoised_guides", lambda aux, lights: aux)
    monkeypatch.setattr(evaluate.denoise, "denoised_low", lambda colour, aux, scale: 0.5 * colour)
    assert torch.equal(evaluate.result_of(network, case.denoised(1)), 0.5 * image)      # nothing of the change
    assert not torch.equal(evaluate.result_of(network, case), image)
