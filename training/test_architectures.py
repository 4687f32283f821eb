"""The networks of others have the sizes that are published."""
import pytest
import torch

import architectures
from architectures import PAPER


# Millions of parameters: EDSR 43 and 1.5, RCAN 15.6, SwinIR 11.9 and about 0.9 for its lightweight form, of which ours has 0.93.
@pytest.mark.parametrize("name, millions, within", [("edsr", 43, 0.005), ("edsr_baseline", 1.5, 0.02), ("rcan", 15.6, 0.005), ("swinir", 11.9, 0.005),
                                                    ("swinir_light", 0.9, 0.04)])
def test_sizes_are_the_published_ones(name, millions, within):
    with torch.device("meta"):
        count = sum(value.numel() for key, value in architectures.network_of(PAPER[name]).named_parameters() if key != "mean")
    assert count / 1e6 == pytest.approx(millions, rel=within)


@pytest.mark.parametrize("name", PAPER)
def test_networks_enlarge_by_their_scale(name):
    config = PAPER[name]
    with torch.device("meta"):
        inputs = [torch.empty(1, 3, 16, 8)] + [torch.empty(1, config.aux_width, 64, 32)] * bool(config.aux_inputs)
        assert architectures.network_of(config)(*inputs).shape == (1, 3, 64, 32)
