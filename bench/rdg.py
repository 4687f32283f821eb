"""RDG (Zheng and others, CVPR 2025), a rival of `xrds upscale --temporal`: x4 of sequences, each frame with the features of the one before it.

Runs the small network of https://github.com/sunny2109/RDG from the user's own copy of that repository (Apache-2.0), with PyTorch. It has been trained
on pictures (sRGB) of 1000 samples a pixel with normals, albedo, depth and motion of the same low resolution, so it is given the low-resolution colour
without its noise, by Open Image Denoise with prefiltered guides, and box means of the guides. What is brighter than white is lost.
Needs `pip install einops opencv-python-headless torchvision` and bench/oidn-requirements.txt.
"""
import pathlib
import sys
import types

import numpy as np
import oidn
import pyoidn
import torch

SCALE, FEATURES = 4, 16    # of the small network
CHECKPOINT = "checkpoints/RDG_Small.pth"


def network(checkout):
    """The network with its weights. Its packages import the whole of BasicSR, of which it needs four files."""
    for name in ("basicsr", "basicsr.archs", "basicsr.utils"):
        package = types.ModuleType(name)
        package.__path__ = [str(pathlib.Path(checkout, *name.split(".")))]
        sys.modules[name] = package
    from basicsr.archs.rdg_arch import RDG
    found = RDG(num_feat=FEATURES, scale=SCALE)
    found.load_state_dict(torch.load(pathlib.Path(checkout, CHECKPOINT), map_location="cpu", weights_only=True)["params"])
    return found.eval()


def box_mean(image):
    height, width, channels = image.shape
    return image.reshape(height // SCALE, SCALE, width // SCALE, SCALE, channels).mean((1, 3))


def between_extremes(image):
    return (image - image.min()) / max(image.max() - image.min(), 1e-6)


def upscaled(checkout, frames, to_srgb, to_linear):
    """Linear radiance [height, width, 3] of each frame of one scene.

    frames: {"colour": of the low resolution, "albedo", "normal", "depth", "motion": of the full one} of each; motion leads to the frame before, in
    pixels. The first has none before it."""
    device = pyoidn.Device()
    device.commit()
    inputs = {"Image": [], "Normal": [], "BRDF": [], "Depth": [], "Motion": []}
    for frame in frames:
        guides = {name: np.ascontiguousarray(box_mean(frame[name])) for name in ("albedo", "normal", "depth", "motion")}
        inputs["Image"].append(to_srgb(oidn.denoise(device, {"color": frame["colour"], "albedo": guides["albedo"], "normal": guides["normal"]}, prefilter=True)[0]))
        inputs["Normal"].append((guides["normal"] + 1) / 2)
        inputs["BRDF"].append(between_extremes(guides["albedo"]))
        inputs["Depth"].append(between_extremes(guides["depth"]))
        inputs["Motion"].append(guides["motion"] / SCALE)
    inputs["Motion"] = inputs["Motion"][1:] + inputs["Motion"][:1]    # it reads the motion of frame i at i - 1
    tensors = {name: torch.from_numpy(np.stack(images).astype(np.float32)).permute(0, 3, 1, 2)[None] for name, images in inputs.items()}
    with torch.inference_mode():
        results = network(checkout)(tensors)[0].permute(0, 2, 3, 1).numpy()
    return [to_linear(np.clip(result, 0, 1)) for result in results]
