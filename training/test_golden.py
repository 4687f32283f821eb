"""The golden files in tests/golden are what the code computes."""
import pathlib

import pytest
import torch
from safetensors.torch import load_file

import golden
import weights

FOLDER = pathlib.Path(__file__).parent.parent / "tests" / "golden"


@pytest.mark.parametrize("name", golden.CASES)
def test_golden_file_is_reproduced(name):
    network, _ = weights.load_model(FOLDER / f"{name}.model.safetensors", torch.float64)
    tensors = {key: value.double() for key, value in load_file(FOLDER / f"{name}.io.safetensors").items()}
    image = lambda key: tensors[key].permute(2, 0, 1)[None]
    aux, full = golden.given(network.config, [image(golden.KEYS.get(kind, "aux")) for kind in network.config.aux_inputs])
    with torch.no_grad():
        output, raw = golden.outputs_of(network, image("colour"), aux, tensors["exposure"].item(), full)
    assert torch.allclose(raw, image("network"), rtol=1e-6, atol=1e-6)
    assert torch.allclose(output, image("output"), rtol=1e-6, atol=1e-6)
