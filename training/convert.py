"""Makes a model file of a PyTorch checkpoint of an official repository (EDSR-PyTorch, RCAN, SwinIR) or of BasicSR.

    python training/convert.py edsr_x4.pt edsr-x4.safetensors [--transfer log1p]

The architecture and its sizes are found in the names and shapes of the tensors. Only tensors are read (weights_only): a pickle that
holds anything else is refused. These networks were trained on photographs; what a renderer's radiance is to them is --transfer.
"""
import argparse
import pathlib
import pickle
import sys
import zipfile

import torch
from safetensors import SafetensorError
from safetensors.torch import save_file

import architectures

SCALES = (1, 2, 4, 8, 16)
NO_CHECKPOINT = "it holds more than tensors, is cut short, or is no checkpoint"
WRAPPERS = ("state_dict", "params_ema", "params-ema", "params", "model", "net")     # keys under which checkpoints keep their tensors
PREFIXES = ("module.", "netG.")                                                     # of all names, in some of them


def loaded(path):
    """What PyTorch has stored in a file. Raises ValueError on one that is cut short, of which PyTorch tells a fault of the system."""
    with open(path, "rb") as file:
        is_archive = file.read(4) == b"PK\x03\x04"
    if is_archive and not zipfile.is_zipfile(path):
        raise ValueError("the file is cut short: an archive's end is missing")
    try:
        return torch.load(path, map_location="cpu", weights_only=True)
    except RuntimeError as error:
        if "unexpected EOF" in str(error):      # of files from before PyTorch 1.6
            raise ValueError("the file is cut short") from error
        raise


def read_checkpoint(path):
    """The tensors by name. Raises pickle.UnpicklingError on a pickle of anything but tensors, ValueError on other contents."""
    stored = loaded(path)
    for key in WRAPPERS:
        if isinstance(stored, dict) and isinstance(stored.get(key), dict):
            stored = stored[key]
    if not isinstance(stored, dict) or not stored or not all(isinstance(value, torch.Tensor) for value in stored.values()):
        raise ValueError("it holds no tensors by name")
    for name, value in stored.items():
        if not isinstance(name, str) or value.is_complex():
            raise ValueError(f"'{name}' is no tensor of a network")
    for prefix in PREFIXES:
        stored = {name.removeprefix(prefix): value for name, value in stored.items()}
    return {name: value.float() for name, value in stored.items()}


def check(tensors, config):
    """Raises ValueError on what the engine would refuse of a model that PyTorch runs."""
    for name, value in tensors.items():
        if not value.isfinite().all():
            raise ValueError(f"tensor '{name}' holds a value that is not finite")
    if config.scale not in SCALES:
        raise ValueError(f"it upscales by {config.scale}, and the engine by powers of two up to 16")
    if config.channels % 4 != 0:
        raise ValueError(f"it has {config.channels} channels, and the engine takes multiples of 4")
    if config.window % 2 != 0:
        raise ValueError(f"its windows are of {config.window} pixels to a side, and the engine takes even ones")


def reason(error):
    """One line of the error's text, which PyTorch gives one for each tensor."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    text = " ".join(lines[:2]) or type(error).__name__
    return text if len(text) <= 300 else text[:300] + " ..."


def convert(source, target, transfer="log1p"):
    """Writes the model file and returns its configuration. Raises ValueError on a checkpoint of another network."""
    tensors = read_checkpoint(source)
    try:
        config = architectures.config_of_checkpoint(tensors, transfer)
        architectures.network_of(config).load_state_dict(tensors)      # every tensor there, none too much
    except (ArithmeticError, AttributeError, LookupError, RuntimeError) as error:
        raise ValueError(f"it is no network that is known: {reason(error)}") from error
    check(tensors, config)
    save_file({name: value.contiguous() for name, value in tensors.items()}, target,
              {**architectures.metadata_of(config), "license": "that of the checkpoint", "data": f"converted from {pathlib.Path(source).name}"})
    return config


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("target", type=pathlib.Path)
    parser.add_argument("--transfer", choices=("none", "log1p"), default="log1p")
    options = parser.parse_args()
    try:
        options.target.parent.mkdir(parents=True, exist_ok=True)
        print(convert(options.source, options.target, options.transfer))
    except (EOFError, pickle.UnpicklingError):      # PyTorch's own text advises to read it all the same
        sys.exit(f"{options.source} cannot be converted: {NO_CHECKPOINT}")
    except SafetensorError as error:
        sys.exit(f"{options.target} cannot be written: {reason(error)}")
    except OSError as error:
        sys.exit(f"{error.filename or options.source}: {error.strerror or error}")
    except (ValueError, AttributeError, RuntimeError) as error:
        sys.exit(f"{options.source} cannot be converted: {reason(error)}")
    except LookupError:     # of PyTorch's reader
        sys.exit(f"{options.source} cannot be converted: {NO_CHECKPOINT}")


if __name__ == "__main__":
    main()
