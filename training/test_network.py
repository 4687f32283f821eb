"""Sizes of the network against the paper's tables 9 and 10, and properties of the pipeline."""
import math

import torch
import pytest

import pipeline
import weights
from cost import multiply_accumulates
from network import Network, NetworkConfig, relative_position_index, shift_mask
from start import initialise

FULL_INPUTS = dict(aux_inputs=("albedo", "normal", "colour"))
SMALL = dict(channels=8, aux_channels=4, head_channels=4, groups=1, blocks=1, window=4)


@pytest.mark.parametrize("groups, blocks, giga, million", [
    (3, 5, 723.68, 9.36), (3, 3, 519.13, 6.21), (3, 1, 314.59, 3.06), (2, 5, 507.86, 6.42), (1, 5, 292.04, 3.49)])
def test_sizes_match_the_paper(groups, blocks, giga, million):
    config = NetworkConfig(groups=groups, blocks=blocks, base="none", transfer="none")
    assert round(multiply_accumulates(config, 1024, 1024) / 1e9, 2) == giga
    parameters = sum(p.numel() for p in Network(config).parameters())
    assert parameters / 1e6 == pytest.approx(million, rel=0.005)


def test_weight_names():
    config = NetworkConfig(scale=4, **{**SMALL, "groups": 2})
    names = set(Network(config).state_dict())
    for name in ["lr_conv.weight", "aux_conv.bias", "aux_blocks.1.conv2.weight", "deshuffle.2.1.weight",
                 "groups.1.lr_conv.weight", "groups.0.aux_conv.weight", "groups.0.xm.self_attn.qkv.weight",
                 "groups.0.xm.cross_attn.kv.bias", "groups.0.xm.cross_attn.relative_position_bias_table",
                 "groups.0.xm.norm_aux.weight", "groups.0.xm.norm3.bias", "groups.0.xm.mlp.fc1.weight",
                 "groups.1.blocks.0.layers.2.attn.qkv.weight", "groups.1.blocks.0.layers.2.mlp.fc2.bias",
                 "groups.1.blocks.0.grow.2.weight", "groups.1.blocks.0.conv.weight", "groups.1.conv.weight",
                 "fuse.weight", "body_conv.weight", "up_pre.weight", "up.1.weight", "out.bias"]:
        assert name in names
    assert not any(name.endswith("index") for name in names)


@pytest.mark.parametrize("block, shapes", [
    ("rdb", {"grow.0.weight": (8, 8, 3, 3), "grow.2.weight": (8, 24, 3, 3), "grow.2.bias": (8,),
             "fuse.weight": (8, 32, 1, 1)}),
    ("rstb", {"layers.0.attn.qkv.weight": (24, 8), "layers.2.attn.qkv.weight": (24, 8),
              "layers.2.mlp.fc1.weight": (16, 8), "conv.weight": (8, 8, 3, 3)})])
def test_blocks_of_the_ablations(block, shapes):
    network = Network(NetworkConfig(block=block, **{**SMALL, "blocks": 2}))
    parameters = network.state_dict()
    for name, shape in shapes.items():
        assert parameters["groups.0.blocks.1." + name].shape == shape
    assert len([name for name in parameters if name.startswith("groups.0.blocks.1.")]) == {"rdb": 8, "rstb": 41}[block]
    x = torch.rand(1, 8, 8, 12)
    assert network.groups[0].blocks[1](x).shape == x.shape


def test_swin_blocks_shift_every_other_layer_of_a_group():
    blocks = Network(NetworkConfig(block="rstb", **{**SMALL, "blocks": 2})).groups[0].blocks
    assert [layer.shifted for block in blocks for layer in block.layers] == [False, True] * 3


def test_concat_in_place_of_the_cross_module():
    names = set(Network(NetworkConfig(cross="concat", **SMALL)).state_dict())
    assert "groups.0.concat.weight" in names and not any(".xm." in name for name in names)
    without = Network(NetworkConfig(cross="concat", base="bicubic", aux_inputs=(), **SMALL))
    assert not any("concat" in name or ".xm." in name for name in without.state_dict())
    f = torch.rand(1, 8, 4, 4)
    assert torch.equal(without.groups[0].joined(f, None), f)


def test_relative_position_index():
    index = relative_position_index(4)
    assert index[0, 0] == 3 * 7 + 3          # the token itself: the table's centre
    assert index[0, 15] == 0                 # query top left, key bottom right
    assert index[4, 0] == 4 * 7 + 3          # query one row below the key


def test_shifted_windows_do_not_mix_opposite_borders():
    mask = shift_mask(8, 8, 4, "cpu")
    assert mask.shape == (4, 16, 16)
    assert (mask[0] == 0).all()              # the first window wraps nothing
    assert mask[3, 0, 3] == -float("inf") and mask[3, 0, 1] == 0


@pytest.mark.parametrize("scale", [1, 2, 4, 8, 16])
def test_zero_output_layer_gives_the_base(scale):
    torch.manual_seed(scale)
    config = NetworkConfig(scale=scale, kernels=5, aux_skip=1, **SMALL)
    network = Network(config).eval()
    initialise(network, torch.Generator().manual_seed(1))
    colour, aux = torch.rand(1, 3, 5, 6) * 3, torch.rand(1, 6, 5 * scale, 6 * scale)
    radiance, raw, _ = pipeline.upscale(network, colour, aux)
    assert raw.shape == (1, 28, 5 * scale, 6 * scale)
    assert torch.allclose(radiance, pipeline.baseline(colour, aux, config), rtol=1e-5, atol=1e-6)


def test_guided_weights_against_the_formula():
    torch.manual_seed(0)
    scale, h, w = 4, 3, 5
    albedo, normal = torch.rand(1, 3, 4 * h, 4 * w).double(), torch.randn(1, 3, 4 * h, 4 * w).double() * 0.3
    log_weights = pipeline.guided_log_weights(torch.cat([albedo, normal], 1), NetworkConfig(scale=scale))
    b, m = pipeline.box_mean(albedo, scale)[0], pipeline.box_mean(normal, scale)[0]
    for py, px, j in [(0, 0, 0), (11, 19, 24), (5, 7, 13), (9, 2, 6)]:
        qy, qx = (py + 0.5) / scale - 0.5, (px + 0.5) / scale - 0.5
        iy, ix = round(qy) + j // 5 - 2, round(qx) + j % 5 - 2
        cy, cx = min(max(iy, 0), h - 1), min(max(ix, 0), w - 1)
        n = ((normal[0, :, py, px] - m[:, cy, cx]) ** 2).sum() / (2 * 0.2 ** 2)
        a = ((albedo[0, :, py, px] - b[:, cy, cx]) ** 2).sum() / (2 * 0.5 ** 2)
        space = ((qy - iy) ** 2 + (qx - ix) ** 2) / (2 * 0.75 ** 2)
        expected = torch.exp(torch.tensor(-space)) * (torch.exp(-n) * torch.exp(-a) + 1e-6)
        assert log_weights[0, py // scale, px // scale, py % scale, px % scale, j].exp() == pytest.approx(expected.item(), rel=1e-6)


@pytest.mark.parametrize("side", [3, 5])
def test_filtered(side):
    torch.manual_seed(side)
    equal = torch.full((1, 3, 4, 6), 0.3)
    logits = torch.randn(1, side ** 2, 4, 6) * 10
    assert torch.allclose(pipeline.filtered(pipeline.neighbours(equal, side), logits), equal)
    albedo = torch.rand(1, 3, 4, 6)
    for j in range(side ** 2):
        one_hot = torch.full((1, side ** 2, 4, 6), -100.0)
        one_hot[:, j] = 100.0
        found = pipeline.filtered(pipeline.neighbours(albedo, side), one_hot)
        y = (torch.arange(4) + j // side - side // 2).clamp(0, 3)
        x = (torch.arange(6) + j % side - side // 2).clamp(0, 5)
        assert torch.allclose(found, albedo[:, :, y][:, :, :, x], atol=1e-5)


def test_aux_kernels_are_the_last_channels_and_start_at_the_pixel():
    config = NetworkConfig(kernels=5, aux_kernels=3, **SMALL)
    network = Network(config)
    initialise(network, torch.Generator().manual_seed(1))
    raw = network.out.bias.view(1, -1, 1, 1)
    residual, logits, aux_logits, colour_logits = pipeline.split_output(raw, config)
    assert (residual.shape[1], logits.shape[1], aux_logits.shape[1], colour_logits) == (3, 25, 9, None)
    assert aux_logits.argmax() == 4 and not residual.any() and not logits.any()


FULL = dict(aux_inputs=("albedo", "colour", "normal"), kernels=5, aux_kernels=3, colour_kernels=5, aux_skip=1, **SMALL)


def random_network(config, deviation=0.3):
    network = Network(config).eval()
    initialise(network, torch.Generator().manual_seed(1))
    torch.nn.init.normal_(network.out.weight, std=deviation)
    return network


def test_colour_kernels_are_the_last_channels_and_start_small():
    config = NetworkConfig(**FULL)
    network = Network(config)
    assert network.out.weight.shape[0] == config.output_width == 3 + 25 + 9 + 25 + 1 and network.aux_conv.weight.shape[1] == 9
    initialise(network, torch.Generator().manual_seed(1))
    residual, logits, aux_logits, colour_logits = pipeline.split_output(network.out.bias.view(1, -1, 1, 1), config)
    assert aux_logits.argmax() == 4 and colour_logits.shape[1] == 26
    assert not colour_logits[:, :-1].any() and colour_logits[0, -1] == -3 and not network.out.weight.any()


@pytest.mark.parametrize("scale", [2, 4, 8])
def test_output_layer_of_zeros_blends_the_base_with_the_mean_around(scale):
    torch.manual_seed(scale)
    config = NetworkConfig(scale=scale, **{**FULL, "aux_kernels": 0})
    network = random_network(config, 0)
    colour, aux, full = torch.rand(1, 3, 5, 6) * 3, torch.rand(1, 6, 5 * scale, 6 * scale), torch.rand(1, 3, 5 * scale, 6 * scale)
    full[0, 0, 3, 3] = -1       # counts as 0
    radiance, raw, exposure = pipeline.upscale(network, colour, aux, full=full)
    albedo = aux[:, :3]
    around = lambda image: torch.nn.functional.avg_pool2d(torch.nn.functional.pad(image, (2,) * 4, mode="replicate"), 5, 1)
    mean = torch.log1p(exposure * around(full.clamp(min=0)) / (around(albedo) + 0.02))
    base = torch.log1p(exposure * pipeline.baseline(colour, aux, NetworkConfig(scale=scale, **SMALL)) / (albedo + 0.02))
    g = torch.sigmoid(torch.tensor(-3.0))
    expected = torch.expm1((1 - g) * base + g * mean) * (albedo + 0.02) / exposure
    assert torch.allclose(radiance, expected, rtol=1e-4, atol=1e-5)


def test_the_network_sees_the_colour_at_its_place():
    config = NetworkConfig(**FULL)
    aux, full = torch.rand(1, 6, 8, 8) * 5, torch.rand(1, 3, 8, 8) - 0.2
    seen = pipeline.network_aux(pipeline.clamped_aux(aux, config), 2 * full, 2.0, config)
    albedo = aux[:, :3].clamp(0, 4)
    assert torch.allclose(seen, torch.cat([albedo, torch.log1p((2 * full).clamp(min=0) / (albedo + 0.02)), aux[:, 3:]], 1))
    alone = NetworkConfig(aux_inputs=("colour",), base="bicubic", **SMALL)
    assert torch.allclose(pipeline.network_aux(pipeline.clamped_aux(None, alone), full, 1.0, alone), torch.log1p(full.clamp(min=0)))


def test_the_network_sees_lights_exposed_and_transformed():
    config = NetworkConfig(**{**FULL, "aux_inputs": ("albedo", "diffuse", "colour", "glossy")})
    assert config.guides == ("albedo", "diffuse", "glossy") and config.first_lights == (3, 6)
    aux, full = torch.rand(1, 9, 8, 8) * 5 - 0.2, torch.rand(1, 3, 8, 8)
    seen = pipeline.network_aux(pipeline.clamped_aux(aux, config), 2 * full, 2.0, config)
    expected = [torch.log1p(2 * aux[:, first:first + 3].clamp(min=0)) for first in (3, 6)]
    assert torch.equal(seen[:, 3:6], expected[0]) and torch.equal(seen[:, 9:], expected[1])
    network = random_network(config, 0)
    colour = torch.rand(1, 3, 2, 2)
    aux = torch.rand(1, 9, 8, 8)
    first, _, exposure = pipeline.upscale(network, colour, aux, full=full)
    brighter = pipeline.with_lights(aux, lambda light: 3 * light, config)
    second, _, other = pipeline.upscale(network, 3 * colour, brighter, full=3 * full)
    assert exposure == pytest.approx(3 * other) and torch.allclose(3 * first, second, rtol=1e-4)


def test_the_filter_of_the_auxiliary_images_leaves_the_colour():
    """A filter that moves albedo and normal by a pixel, a share of nearly one: the result is H over its own albedo times the moved one."""
    config = NetworkConfig(**FULL)
    network = random_network(config, 0)
    with torch.no_grad():
        residual, logits, aux_logits, colour_logits = network.out.bias.split(config.output_parts)
        aux_logits[:] = torch.tensor([-8.0] * 3 + [8.0] + [-8.0] * 5)       # the neighbour on the left
        colour_logits[:] = -8.0
        colour_logits[12], colour_logits[25] = 8.0, 30.0
        aux, full = torch.rand(1, 6, 32, 32), torch.rand(1, 3, 32, 32)
        radiance, _, _ = pipeline.upscale(network, torch.rand(1, 3, 8, 8), aux, 1.0, full)
    left = torch.arange(32).sub(1).clamp(min=0)
    assert torch.allclose(radiance, full * (aux[:, :3, :, left] + 0.02) / (aux[:, :3] + 0.02), rtol=1e-3, atol=1e-3)


PREFILTER = dict(kernels=5, aux_kernels=3, aux_skip=1, **SMALL)


def test_prefilter_starts_at_the_guided_means():
    config = NetworkConfig(prefilter=3, **PREFILTER)
    network = Network(config)
    initialise(network, torch.Generator().manual_seed(1))
    assert network.prefilter.weight.shape == (75, config.channels, 1, 1) and not network.prefilter.weight.any()
    assert [bias.unique().item() for bias in network.prefilter.bias.split(25)] == pytest.approx([0, math.log(3), 2 * math.log(3)])
    aux, raw = torch.rand(1, 6, 32, 48), network(torch.rand(1, 3, 8, 16), torch.rand(1, 6, 32, 64))
    assert raw[0].shape == (1, config.output_width, 32, 64) and raw[1].shape == (1, 75, 8, 16)
    even = torch.full((1, 3, 8, 12), 0.7) * pipeline.box_mean(aux[:, :3], 4)            # lit evenly
    found = pipeline.prefiltered(even, pipeline.box_mean(aux, 4), torch.zeros(1, 75, 8, 12), config)
    assert (torch.expm1(found) / 0.7 - 1).abs().max() < 0.06                           # but for the 0.02


@pytest.mark.parametrize("level, side", [(0, 1), (1, 3), (2, 9)])
@pytest.mark.parametrize("tap", [0, 7, 12, 23])
def test_prefilter_weighs_taps_of_all_levels(level, side, tap):
    """Of one tap alone the mean of side x side pixels, tap (dy, dx) sides away; beyond the border of a level its border."""
    torch.manual_seed(4)
    config = NetworkConfig(prefilter=3, transfer="none", **PREFILTER)
    colour, aux = torch.rand(1, 3, 60, 64).double(), torch.full((1, 6, 60, 64), 0.98).double()
    logits = torch.full((1, 75, 60, 64), -1e3).double()
    logits[:, 25 * level + tap] = 1e3
    found = pipeline.prefiltered(colour, aux, logits, config)
    y, x, half = 30 + (tap // 5 - 2) * side, 32 + (tap % 5 - 2) * side, side // 2
    assert torch.allclose(found[..., 30, 32], colour[..., y - half:y + half + 1, x - half:x + half + 1].mean((2, 3)), atol=1e-4)
    corner = colour
    for step in (1, 3)[:level]:
        corner = pipeline.neighbours(corner, 3, step).mean(2)
    y, x = (max(0, (tap // 5 - 2) * side), max(0, (tap % 5 - 2) * side))
    assert torch.allclose(found[..., 0, 0], corner[..., y, x], atol=1e-4)


def test_prefilter_removes_noise():
    torch.manual_seed(6)
    config = NetworkConfig(prefilter=2, **PREFILTER)
    network = Network(config).eval()
    initialise(network, torch.Generator().manual_seed(1))
    aux = torch.cat([torch.full((1, 3, 128, 128), 0.5), torch.zeros(1, 3, 128, 128)], 1)
    colour = 1 + 0.3 * torch.randn(1, 3, 32, 32)
    with torch.no_grad():
        radiance, _, _ = pipeline.upscale(network, colour, aux, 1.0)
        plain = pipeline.baseline(colour, aux, config, 1.0)
    assert (radiance - 1).std() < 0.35 * (plain - 1).std()
    assert abs(radiance.mean() - 1) < 0.02


def test_levelled_colour_has_the_means_of_the_merged_one():
    full = torch.rand(3, 8, 12, generator=torch.Generator().manual_seed(1)) + 0.1
    merged = torch.rand(3, 4, 6, generator=torch.Generator().manual_seed(2)) + 0.5
    found = pipeline.levelled_colour(full, merged, 2)
    assert torch.allclose(pipeline.box_mean(found[None], 2)[0], merged, rtol=0.03)      # the floor
    ratio = found / full
    assert torch.allclose(ratio[:, ::2, ::2], ratio[:, 1::2, 1::2])
    assert torch.allclose(pipeline.levelled_colour(3 * full, 3 * merged, 2), 3 * found)
    full[:, :2, :2], full[0, 4, 4] = 1e-6, float("nan")      # far below the merged colour; not finite
    found = pipeline.levelled_colour(full, merged, 2)
    assert (found[:, :2, :2] <= 8.001e-6).all() and found[0, 4, 4] == 0 and found.isfinite().all()
    assert not pipeline.levelled_colour(torch.zeros(3, 8, 12), torch.zeros(3, 4, 6), 2).any()


def test_merged_colour_weighs_by_samples():
    torch.manual_seed(1)
    low, full = torch.rand(1, 3, 4, 5), torch.rand(1, 3, 8, 10)
    box = full.view(1, 3, 4, 2, 5, 2).mean((3, 5))
    assert torch.allclose(pipeline.merged_colour(low, 16, full, 4, 2), (low + box) / 2)
    assert torch.allclose(pipeline.merged_colour(low, 4, full, 3, 2), 0.25 * low + 0.75 * box)
    full[0, :, :2, :2] = torch.tensor([[float("nan"), -5.0], [float("inf"), 0.0]])
    assert torch.allclose(pipeline.merged_colour(low, 4, full, 1, 2)[..., 0, 0], low[..., 0, 0] / 2)
    assert pipeline.merged_colour(low[0], 4, full[0], 1, 2).shape == (3, 4, 5)
    noise = torch.randn(2, 200, 200, generator=torch.Generator().manual_seed(2))        # four samples of variance 1 each: 20 make 1 / 20
    merged = pipeline.merged_colour(5 + 0.5 * noise[:1, :100, :100], 4, 5 + 0.5 * noise[1:], 4, 2)
    assert merged.var().item() == pytest.approx(1 / 20, rel=0.05)


def test_exposure_ignores_black_and_non_finite_pixels():
    colour = torch.full((3, 2, 2), 0.36)
    colour[:, 0, 0] = 0
    colour[0, 1, 1] = float("nan")
    assert pipeline.auto_exposure(colour) == pytest.approx(0.5)
    assert pipeline.auto_exposure(torch.zeros(3, 2, 2)) == 1.0
    negative = torch.tensor([0.5, -2.0, 0.25]).view(3, 1, 1)
    assert pipeline.auto_exposure(negative) == pipeline.auto_exposure(negative.clamp(min=0))


def test_exposure_follows_the_scale_of_the_image():
    colour = torch.rand(3, 8, 9, generator=torch.Generator().manual_seed(1)).double()
    exposure = pipeline.auto_exposure(colour)
    for factor in (1e-12, 1e-6, 1e6):
        assert pipeline.auto_exposure(factor * colour) == pytest.approx(exposure / factor)
    colour[:, 2:] = 1e-20
    assert pipeline.auto_exposure(colour) == pytest.approx(pipeline.auto_exposure(colour[:, :2]))


@pytest.mark.parametrize("fields", [dict(), dict(base="bicubic", aux_inputs=()), dict(transfer="none")])
def test_nothing_is_drawn_where_nothing_around_is_lit(fields):
    config = NetworkConfig(scale=4, **{**SMALL, **fields})
    network = Network(config).eval()
    with torch.no_grad():
        network.out.bias.fill_(2.0)      # a ghost everywhere
        colour, aux = torch.rand(1, 3, 8, 10), torch.rand(1, 6, 32, 40)
        aux = aux if config.aux_inputs else None
        colour[..., 4:] = 0
        radiance, _, _ = pipeline.upscale(network, colour, aux)
        assert not radiance[..., 4 * 6:].any() and radiance[..., :4 * 4].min() > 0
        assert not pipeline.upscale(network, torch.zeros_like(colour), aux)[0].any()


def test_ceiling_against_the_formula():
    config = NetworkConfig(scale=4, **SMALL)
    x = torch.rand(1, 3, 7, 9, generator=torch.Generator().manual_seed(2)).double() * 3
    found = pipeline.ceiling(x, config)
    for y, column in [(0, 0), (3, 4), (6, 8), (1, 7)]:
        around = x[0, :, max(0, y - 2):y + 3, max(0, column - 2):column + 3].flatten(1).max(1).values
        assert torch.allclose(found[0, :, y, column], torch.log1p(4 * torch.expm1(around)))


@pytest.mark.parametrize("fields", [dict(), dict(**FULL_INPUTS, colour_kernels=3)])
def test_model_file_round_trip(tmp_path, fields):
    config = NetworkConfig(scale=2, kernels=5, aux_skip=1, **fields, **SMALL)
    network = Network(config)
    initialise(network, torch.Generator().manual_seed(3))
    path = tmp_path / "m.safetensors"
    weights.save_model(path, network, {"license": "MIT"})
    again, metadata = weights.load_model(path)
    assert again.config == config and metadata["license"] == "MIT" and metadata["format"] == "xrds"
    for name, value in network.state_dict().items():
        assert torch.equal(value.half().float(), again.state_dict()[name]), name


def test_model_without_kernel_fields_is_the_plain_form():
    metadata = weights.metadata_of(NetworkConfig(**SMALL))
    for name in ("kernels", "aux_skip", "block", "aux_kernels", "colour_kernels", "cross"):
        del metadata[name]
    assert weights.config_of(metadata) == NetworkConfig(**SMALL)


@pytest.mark.parametrize("wrong", [dict(base="guided", aux_inputs=("normal",)), dict(kernels=5, base="bicubic"),
                                   dict(scale=3), dict(aux_skip=1, aux_inputs=(), base="none"), dict(head_channels=3),
                                   dict(block="rrdb"), dict(cross="add"), dict(aux_kernels=4),
                                   dict(aux_kernels=3, base="bicubic"), dict(colour_kernels=5), dict(**FULL_INPUTS, colour_kernels=4),
                                   dict(aux_inputs=("albedo", "colour"), colour_kernels=3, base="demodulated"),
                                   dict(**FULL_INPUTS, scale=1)])
def test_misuse_is_refused(wrong):
    with pytest.raises(ValueError):
        NetworkConfig(**{**SMALL, **wrong})


def test_a_model_without_a_base_is_measured_against_bicubic_upsampling():
    colour = torch.rand(1, 3, 8, 8)
    wanted, found = (pipeline.baseline(colour, None, NetworkConfig(aux_inputs=(), base=base, kernels=0)) for base in ("bicubic", "none"))
    assert torch.equal(wanted, found) and found.shape == (1, 3, 32, 32)
