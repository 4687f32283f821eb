"""The golden files in tests/golden/unet are what the code computes, and the curves are inverted."""
import pathlib

import pytest
import torch
from safetensors.torch import load_file

import unet

FOLDER = pathlib.Path(__file__).parent.parent / "tests" / "golden" / "unet"


@pytest.mark.parametrize("name", unet.CASES)
def test_golden_file_is_reproduced(name):
    network, metadata = unet.load(FOLDER / f"{name}.model.safetensors")
    images = {key: value.double().permute(2, 0, 1)[None] if value.dim() == 3 else value.double()
              for key, value in load_file(FOLDER / f"{name}.io.safetensors").items()}
    guides = [images[guide] for guide in metadata["aux_inputs"].split(",") if guide]
    if metadata["input"] == "hdr":
        assert unet.binned_exposure(images["colour"]) == pytest.approx(images["exposure"].item(), rel=1e-6)
    with torch.no_grad():
        output, raw = unet.denoise(network, metadata["input"], images["colour"], guides, images["exposure"].item())
    assert images["network"].std() > 0.01
    assert torch.allclose(raw, images["network"], rtol=1e-6, atol=1e-6)
    assert torch.allclose(output, images["output"], rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("kind", ["hdr", "ldr", "normal"])
def test_decoding_inverts_encoding(kind):
    values = torch.tensor([1e-7, 1e-4, 0.02, 0.5, 0.99], dtype=torch.float64)
    assert torch.allclose(unet.decoded(kind, unet.encoded(kind, values)), values, rtol=1e-4, atol=1e-9)
