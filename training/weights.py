"""Model files: safetensors with float16 weights under the names of network.py and the configuration in `__metadata__`."""
import dataclasses

import torch
from safetensors import safe_open
from safetensors.torch import save_file

from network import Network, NetworkConfig

# The fields that every file states; the others take their defaults where a file is older than they are.
REQUIRED = ("scale", "channels", "aux_channels", "aux_inputs", "groups", "blocks", "window", "head_channels", "transfer", "base")

def metadata_of(config):
    """The configuration as the string-to-string metadata of the file."""
    fields = dataclasses.asdict(config)
    fields["aux_inputs"] = ",".join(config.aux_inputs)
    return {"format": "xrds", "version": "1", **{key: str(value) for key, value in fields.items()}}


def config_of(metadata):
    """NetworkConfig from file metadata; absent optional fields take the paper's plain form."""
    if metadata.get("format") != "xrds" or metadata.get("version") != "1":
        raise ValueError(f"not a version 1 xrds model: {metadata.get('format')!r} {metadata.get('version')!r}")
    values = {}
    for field in dataclasses.fields(NetworkConfig):
        text = metadata[field.name] if field.name in REQUIRED else metadata.get(field.name, str(field.default))
        if field.name == "aux_inputs":
            values[field.name] = tuple(text.split(",")) if text else ()
        else:
            values[field.name] = field.type(text)
    return NetworkConfig(**values)


def save_model(path, network, provenance=None):
    """Writes the parameters rounded to float16; provenance: further metadata (license, data, seed, steps, metrics)."""
    tensors = {name: value.detach().to("cpu", torch.float16).contiguous() for name, value in network.state_dict().items()}
    for name, value in tensors.items():
        if not torch.isfinite(value).all():
            raise ValueError(f"{name} does not fit float16")
    save_file(tensors, path, {**metadata_of(network.config), **(provenance or {})})


def load_model(path, dtype=torch.float32):
    """Reads a model file. Returns (network in evaluation mode, metadata)."""
    with safe_open(path, framework="pt") as file:
        metadata = file.metadata() or {}
        tensors = {name: file.get_tensor(name) for name in file.keys()}
    network = Network(config_of(metadata))
    network.load_state_dict(tensors)
    return network.to(dtype).eval(), metadata
